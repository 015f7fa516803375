//! PLY files whose comments or range grid say how the points lie in rows and columns.
//!
//! Read here and not by a crate: the one that is kept takes no `nan` in a text, believes the counts in
//! the header, and takes 9 s of processor time to build.

use crate::cloud::Cloud;
use crate::cloud::number::Number;
use crate::cloud::ply_header::{Element, Form, Header, Property, damaged};
use crate::cloud::rings;
use crate::scan_error::ScanError;

const ADVICE: &str = "its header has no num_cols and num_rows. Save it organised: as PCD with HEIGHT above 1, or as PLY with \
    `obj_info num_cols` and `obj_info num_rows` and all points, row by row, nan where nothing was measured";

/// Reads a file.
pub(crate) fn read(bytes: &[u8]) -> Result<Cloud, ScanError> {
    let (header, data) = Header::parse(bytes)?;
    let count = |name: &str| header.elements.iter().find(|element| element.name == name).map(|element| element.count);
    let vertices = count("vertex").unwrap_or(0);
    let Some((rows, columns)) = header.size else { return by_rings(&header, data, vertices) };
    let pixels = ScanError::check_pixels(rows, columns)?;
    let cells = count("range_grid").unwrap_or(vertices);
    if cells != pixels {
        return Err(damaged(format!("{rows} rows x {columns} columns are not {cells} points")));
    }
    check_counts(&header, data.len())?;
    let mut values = Values { form: header.form, data };
    let (mut points, mut grid) = (vec![], None);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => points = read_points(&mut values, element, ["x", "y", "z"].map(|axis| [axis; 2]))?,
            "range_grid" => grid = Some(read_grid(&mut values, element)?),
            _ => (0..element.count).try_for_each(|_| values.element(element, |_, _| ()))?,
        }
    }
    let points = match grid {
        None => points,
        Some(cells) => {
            let point = |cell: &Option<usize>| cell.map_or(Some([f32::NAN; 3]), |vertex| points.get(vertex).copied());
            let in_place: Option<_> = cells.iter().map(point).collect();
            in_place.ok_or_else(|| damaged("its range_grid refers to points that are not there"))?
        }
    };
    Ok(Cloud { rows, columns, points })
}

/// Returns the rows of points without size, if they say their ring.
fn by_rings(header: &Header, data: &[u8], vertices: usize) -> Result<Cloud, ScanError> {
    let refused = ScanError::Unorganised { points: vertices, advice: ADVICE };
    let is_ring = |property: &Property| rings::NAMES.contains(&property.name.as_str());
    let of_rings = |element: &Element| element.name == "vertex" && element.properties.iter().any(is_ring);
    if !header.elements.iter().any(of_rings) {
        return Err(refused);
    }
    ScanError::check_pixels(1, vertices)?;
    check_counts(header, data.len())?;
    let mut values = Values { form: header.form, data };
    for element in &header.elements {
        if of_rings(element) {
            let points = read_points(&mut values, element, [["x"; 2], ["y"; 2], ["z"; 2], rings::NAMES])?;
            return rings::rows_of(&points, ADVICE);
        }
        (0..element.count).try_for_each(|_| values.element(element, |_, _| ()))?;
    }
    Err(refused)
}

/// Checks that a file can have as many elements as its header says, in `left` bytes.
fn check_counts(header: &Header, left: usize) -> Result<(), ScanError> {
    let least_bytes = |element: &Element| -> u128 {
        let of_property = |property: &Property| match header.form {
            // a digit, and what parts it from the next
            Form::Ascii => 2,
            Form::Binary { .. } => property.length.unwrap_or(property.number).bytes() as u128,
        };
        element.properties.iter().map(of_property).sum()
    };
    let needed: u128 = header.elements.iter().map(|element| element.count as u128 * least_bytes(element)).sum();
    // the last number of a text may end with the file
    let is_empty = |element: &Element| element.count > 0 && element.properties.is_empty();
    if header.elements.iter().any(is_empty) || needed > left as u128 + 1 {
        return Err(damaged(format!("its elements need {needed} bytes or more, the file has {left}")));
    }
    Ok(())
}

/// Returns some properties of each point; each may have either name.
fn read_points<const N: usize>(
    values: &mut Values,
    element: &Element,
    names: [[&str; 2]; N],
) -> Result<Vec<[f32; N]>, ScanError> {
    let place = |p: &Property| names.iter().position(|either| either.contains(&p.name.as_str()));
    let axes: Vec<_> = element.properties.iter().map(place).collect();
    if (0..N).any(|axis| !axes.contains(&Some(axis))) {
        return Err(ScanError::lacks("PLY", "x, y and z"));
    }
    let mut points = Vec::with_capacity(element.count);
    for _ in 0..element.count {
        let mut point = [f32::NAN; N];
        values.element(element, |property, value| {
            if let Some(axis) = axes[property] {
                point[axis] = value as f32;
            }
        })?;
        points.push(point);
    }
    Ok(points)
}

/// Returns the vertex of each pixel; of several the first.
fn read_grid(values: &mut Values, element: &Element) -> Result<Vec<Option<usize>>, ScanError> {
    let mut cells = Vec::with_capacity(element.count);
    for _ in 0..element.count {
        let mut vertex = None;
        values.element(element, |property, value| {
            if element.properties[property].name == "vertex_indices" && vertex.is_none() {
                // a negative one is not there
                vertex = Some(if value < 0.0 { usize::MAX } else { value as usize });
            }
        })?;
        cells.push(vertex);
    }
    Ok(cells)
}

/// The values that follow the header.
struct Values<'a> {
    form: Form,
    data: &'a [u8],
}

impl Values<'_> {
    /// Reads an element, and gives each value with the number of its property.
    fn element(&mut self, element: &Element, mut each: impl FnMut(usize, f64)) -> Result<(), ScanError> {
        for (i, property) in element.properties.iter().enumerate() {
            let count = match property.length {
                Some(length) => self.number(length)?,
                None => 1.0,
            };
            // a length that is not a number, or negative, is none
            for _ in 0..count as usize {
                each(i, self.number(property.number)?);
            }
        }
        Ok(())
    }

    fn number(&mut self, number: Number) -> Result<f64, ScanError> {
        let early = || damaged("it ends before its last point");
        match self.form {
            Form::Binary { little_endian } => {
                let (bytes, rest) = self.data.split_at_checked(number.bytes()).ok_or_else(early)?;
                self.data = rest;
                Ok(if little_endian { number.at(bytes, 0) } else { number.big_endian(bytes) })
            }
            Form::Ascii => {
                let text = self.data.trim_ascii_start();
                let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
                let (word, rest) = text.split_at(end);
                self.data = rest;
                let word = str::from_utf8(word).map_err(damaged)?;
                if word.is_empty() {
                    return Err(early());
                }
                word.parse().map_err(|_| damaged(format!("`{word:.20}` is not a number")))
            }
        }
    }
}
