//! PLY files whose comments or range grid say how the points lie in rows and columns.

use std::borrow::Cow;
use std::io::{BufRead, Cursor};

use ply_rs_bw::parser::{ParseError, Parser, Reader};
use ply_rs_bw::ply::{ElementDef, Encoding, Header, PropertyAccess, PropertyAccessResult, PropertyType};

use crate::cloud::Cloud;
use crate::scan_error::ScanError;

const PLY: &str = "PLY";

const ADVICE: &str = "its header has no num_cols and num_rows. Save it organised: as PCD with HEIGHT above 1, or as PLY with \
    `obj_info num_cols` and `obj_info num_rows` and all points, row by row, nan where nothing was measured";

/// Reads a file.
pub(crate) fn read(bytes: &[u8]) -> Result<Cloud, ScanError> {
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = Parser::<Point>::new().read_header(&mut reader).map_err(damaged)?;
    let points = count(&header, "vertex");
    let (rows, columns) = size(&header).ok_or(ScanError::Unorganised { points, advice: ADVICE })?;
    let pixels = ScanError::check_pixels(rows, columns)?;
    let grid = header.elements.contains_key("range_grid");
    let cells = if grid { count(&header, "range_grid") } else { points };
    if cells != pixels {
        return Err(ScanError::damaged(PLY, format!("{rows} rows x {columns} columns are not {cells} points")));
    }
    let data = &bytes[reader.get_ref().position() as usize..];
    check_counts(&header, data.len())?;
    let data = if header.encoding == Encoding::Ascii { Cow::from(numbers_only(data)) } else { Cow::from(data) };
    let mut reader = Reader::new(&*data);
    let (mut vertices, mut indices) = (vec![], None);
    for (name, element) in &header.elements {
        match name.as_str() {
            "vertex" => vertices = elements::<Point>(&mut reader, element, &header)?,
            "range_grid" => indices = Some(elements::<Cell>(&mut reader, element, &header)?),
            _ => _ = elements::<Skipped>(&mut reader, element, &header)?,
        }
        if !vertices.is_empty() && indices.is_some() == grid {
            break;
        }
    }
    let points = match indices {
        None => vertices.iter().map(|vertex| vertex.0).collect(),
        Some(cells) => {
            let point = |cell: &Cell| match cell.0 {
                None => Some([f32::NAN; 3]),
                Some(index) => vertices.get(index).map(|vertex| vertex.0),
            };
            let points: Option<_> = cells.iter().map(point).collect();
            points.ok_or_else(|| ScanError::damaged(PLY, "its range_grid refers to points that are not there"))?
        }
    };
    Ok(Cloud { rows, columns, points })
}

/// Returns a text in which what is not a number is 0, which the parser takes: a point in the origin
/// was not measured either.
fn numbers_only(text: &[u8]) -> Vec<u8> {
    let mut text = text.to_vec();
    let mut at = 0;
    while at + 3 <= text.len() {
        if [b"nan", b"inf"].iter().any(|word| text[at..at + 3].eq_ignore_ascii_case(*word)) {
            text[at..at + 3].fill(b'0');
            at += 2;
        }
        at += 1;
    }
    text
}

fn damaged(e: ParseError) -> ScanError {
    ScanError::damaged(PLY, e)
}

fn count(header: &Header, element: &str) -> usize {
    header.elements.get(element).map_or(0, |element| element.count)
}

/// Returns rows and columns by the comments: `num_rows 480`, `height: 480`.
fn size(header: &Header) -> Option<(usize, usize)> {
    let notes = || header.obj_infos.iter().chain(&header.comments);
    let number = |keys: &[&str]| {
        notes().find_map(|note| {
            let mut words = note.split(|c: char| c.is_whitespace() || c == ':' || c == '=').filter(|w| !w.is_empty());
            let key = words.next()?.to_ascii_lowercase();
            let value = words.next()?.parse().ok()?;
            keys.contains(&key.as_str()).then_some(value)
        })
    };
    number(&["num_rows", "rows", "height"]).zip(number(&["num_cols", "num_columns", "cols", "columns", "width"]))
}

/// Checks that the rest of the file, `left` bytes, can have as many elements as the header says.
fn check_counts(header: &Header, left: usize) -> Result<(), ScanError> {
    let least_bytes = |element: &ElementDef| -> u128 {
        let of_property = |kind: &PropertyType| match (header.encoding, kind) {
            // a digit, and what parts it from the next
            (Encoding::Ascii, _) => 2,
            (_, PropertyType::Scalar(kind) | PropertyType::List(kind, _)) => scalar_bytes(kind),
        };
        // a line without properties has its end
        let of_line = u128::from(header.encoding == Encoding::Ascii && element.properties.is_empty());
        of_line + element.properties.values().map(|property| of_property(&property.data_type)).sum::<u128>()
    };
    let each: Vec<_> = header.elements.values().map(|element| (element.count as u128, least_bytes(element))).collect();
    let needed = each.iter().map(|(count, bytes)| count * bytes).sum::<u128>();
    // the last line may lack its end
    let ascii = u128::from(header.encoding == Encoding::Ascii);
    if each.iter().any(|&(count, bytes)| count > 0 && bytes == 0) || needed > left as u128 + ascii {
        return Err(ScanError::damaged(PLY, format!("its elements need {needed} bytes or more, the file has {left}")));
    }
    Ok(())
}

fn scalar_bytes(kind: &ply_rs_bw::ply::ScalarType) -> u128 {
    use ply_rs_bw::ply::ScalarType::*;
    match kind {
        Char | UChar => 1,
        Short | UShort => 2,
        Int | UInt | Float => 4,
        Double => 8,
    }
}

fn elements<E: PropertyAccess>(
    reader: &mut Reader<impl BufRead>,
    element: &ElementDef,
    header: &Header,
) -> Result<Vec<E>, ScanError> {
    Parser::<E>::new().read_payload_for_element(reader, element, header).map_err(damaged)
}

/// x, y and z of a vertex.
struct Point([f32; 3]);

impl Point {
    fn set(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        match ["x", "y", "z"].iter().position(|axis| *axis == name) {
            Some(axis) => {
                self.0[axis] = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

impl PropertyAccess for Point {
    fn new() -> Self {
        Point([f32::NAN; 3])
    }

    fn set_float(&mut self, name: &str, value: f32) -> PropertyAccessResult {
        self.set(name, value)
    }

    fn set_double(&mut self, name: &str, value: f64) -> PropertyAccessResult {
        self.set(name, value as f32)
    }

    fn set_int(&mut self, name: &str, value: i32) -> PropertyAccessResult {
        self.set(name, value as f32)
    }

    fn set_short(&mut self, name: &str, value: i16) -> PropertyAccessResult {
        self.set(name, value.into())
    }
}

/// The vertex of a pixel; of several the first.
struct Cell(Option<usize>);

impl PropertyAccess for Cell {
    fn new() -> Self {
        Cell(None)
    }

    fn set_list_int(&mut self, name: &str, value: Vec<i32>) -> PropertyAccessResult {
        if name == "vertex_indices" {
            // a negative one is not there
            self.0 = value.first().map(|&index| usize::try_from(index).unwrap_or(usize::MAX));
        }
        PropertyAccessResult::Set
    }

    fn set_list_uint(&mut self, name: &str, value: Vec<u32>) -> PropertyAccessResult {
        if name == "vertex_indices" {
            self.0 = value.first().map(|&index| index as usize);
        }
        PropertyAccessResult::Set
    }
}

/// What is of no use.
struct Skipped;

impl PropertyAccess for Skipped {
    fn new() -> Self {
        Skipped
    }
}
