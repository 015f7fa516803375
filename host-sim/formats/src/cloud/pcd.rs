//! PCD files of the Point Cloud Library: ascii, binary, binary_compressed.
//!
//! Read here and not by a crate: the one that there is believes the sizes in the header.

use crate::cloud::Cloud;
use crate::cloud::lzf;
use crate::cloud::number::Number;
use crate::cloud::rings;
use crate::scan_error::ScanError;

const PCD: &str = "PCD";

/// No header is longer.
const MAX_HEADER_BYTES: usize = 65_536;

const ADVICE: &str = "its HEIGHT is 1. Rows and columns are lost when a cloud is filtered, down-sampled or merged, and when \
    points without a return are removed: save it before that, as the driver gives it (HEIGHT above 1)";

/// Whether a file begins as a PCD.
pub(crate) fn is_pcd(head: &[u8]) -> bool {
    let text = String::from_utf8_lossy(head);
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| line.starts_with("VERSION ") || line.starts_with("FIELDS "))
}

/// Reads a file.
pub(crate) fn read(bytes: &[u8]) -> Result<Cloud, ScanError> {
    let (header, data) = Header::parse(bytes)?;
    let Header { rows, columns, .. } = header;
    let count = ScanError::check_pixels(rows, columns)?;
    let [x, y, z] = header.coordinates;
    if rows == 1 {
        let ring = header.ring.ok_or(ScanError::Unorganised { points: columns, advice: ADVICE })?;
        return rings::rows_of(&header.points([x, y, z, ring], data, count)?, ADVICE);
    }
    let points = header.points([x, y, z], data, count)?;
    Ok(Cloud { rows, columns, points })
}

/// What the lines at the start of the file say.
struct Header {
    rows: usize,
    columns: usize,
    /// Position of the scanner, in the unit of the points.
    origin: [f32; 3],
    /// x, y, z.
    coordinates: [Field; 3],
    /// The ring of a spinning lidar.
    ring: Option<Field>,
    /// Bytes and values of a point.
    stride: usize,
    values: usize,
    /// How the points are stored.
    data: String,
}

/// One field of a point.
#[derive(Clone, Copy)]
struct Field {
    number: Number,
    /// Bytes and values of the point that lie before it.
    offset: usize,
    values_before: usize,
    /// How many bytes lie between points where the file stores field by field.
    bytes: usize,
}

impl Header {
    /// Returns the header, and what follows it.
    fn parse(bytes: &[u8]) -> Result<(Header, &[u8]), ScanError> {
        let (mut names, mut sizes, mut types, mut counts) = (vec![], vec![], vec![], vec![]);
        let (mut rows, mut columns, mut origin, mut at) = (None, None, [0.0; 3], 0);
        let lacks = |what: &str| ScanError::lacks(PCD, format!("a line {what} in its header"));
        let data = loop {
            let rest = &bytes[at..bytes.len().min(MAX_HEADER_BYTES)];
            let end = rest.iter().position(|&b| b == b'\n').ok_or_else(|| lacks("DATA"))?;
            at += end + 1;
            let line = String::from_utf8_lossy(&rest[..end]);
            let mut words = line.split_whitespace().map(str::to_string);
            let key = words.next().unwrap_or_default();
            let mut whole = || words.next().and_then(|word| word.parse().ok());
            match key.as_str() {
                "FIELDS" => names = words.collect(),
                "SIZE" => sizes = words.collect(),
                "TYPE" => types = words.collect(),
                "COUNT" => counts = words.collect(),
                "WIDTH" => columns = whole(),
                "HEIGHT" => rows = whole(),
                "VIEWPOINT" => words.zip(&mut origin).for_each(|(word, x)| *x = word.parse().unwrap_or(0.0)),
                "DATA" => break words.next().unwrap_or_default(),
                _ => {}
            }
        };
        let (rows, columns) = (rows.ok_or_else(|| lacks("HEIGHT"))?, columns.ok_or_else(|| lacks("WIDTH"))?);
        let (mut stride, mut values, mut found, mut ring) = (0usize, 0usize, [None; 3], None);
        for (i, name) in names.iter().enumerate() {
            let kind = types.get(i).zip(sizes.get(i)).and_then(|(kind, size)| Number::of(kind, size.parse().ok()?));
            let number = kind.ok_or_else(|| lacks("TYPE and SIZE that fit FIELDS"))?;
            let count = match counts.get(i) {
                Some(count) => count.parse().ok().filter(|count| (1..=4096).contains(count)),
                None => Some(1),
            };
            let count: usize = count.ok_or_else(|| lacks("COUNT that fits FIELDS"))?;
            let bytes = number.bytes() * count;
            let field = Field { number, offset: stride, values_before: values, bytes };
            if let Some(axis) = ["x", "y", "z"].iter().position(|axis| name == axis) {
                found[axis] = Some(field);
            }
            if rings::NAMES.contains(&name.as_str()) {
                ring = Some(field);
            }
            (stride, values) = (stride + bytes, values + count);
        }
        let [Some(x), Some(y), Some(z)] = found else { return Err(ScanError::lacks(PCD, "fields x, y and z")) };
        Ok((Header { rows, columns, origin, coordinates: [x, y, z], ring, stride, values, data }, &bytes[at..]))
    }

    /// Returns the values of some fields of each point. The first three are its coordinates, as seen
    /// from where the scanner stood: beams start there. How it was turned does not matter to them.
    fn points<const N: usize>(
        &self,
        fields: [Field; N],
        data: &[u8],
        count: usize,
    ) -> Result<Vec<[f32; N]>, ScanError> {
        let mut points = match self.data.as_str() {
            "ascii" => self.ascii(&fields, data, count)?,
            "binary" => self.binary(&fields, data, count)?,
            "binary_compressed" => self.compressed(&fields, data, count)?,
            other => {
                return Err(ScanError::damaged(PCD, format!("DATA {other} is not ascii, binary or binary_compressed")));
            }
        };
        if self.origin != [0.0; 3] {
            points.iter_mut().flat_map(|point| point.iter_mut().zip(self.origin)).for_each(|(x, origin)| *x -= origin);
        }
        Ok(points)
    }

    /// One line per point.
    fn ascii<const N: usize>(
        &self,
        fields: &[Field; N],
        data: &[u8],
        count: usize,
    ) -> Result<Vec<[f32; N]>, ScanError> {
        // a digit and a blank for each value
        self.check_bytes(count, 2 * self.values, data.len())?;
        let text = std::str::from_utf8(data).map_err(|e| ScanError::damaged(PCD, e))?;
        let mut points = Vec::with_capacity(count);
        for (i, line) in text.lines().filter(|line| !line.trim().is_empty()).take(count).enumerate() {
            let mut words = line.split_whitespace().enumerate();
            let mut point = [f32::NAN; N];
            let mut found = 0;
            // they may stand in any order
            while let Some((place, word)) = words.next().filter(|_| found < N) {
                if let Some(axis) = fields.iter().position(|field| field.values_before == place) {
                    let damaged = || ScanError::damaged(PCD, format!("point {i}: `{word}` is not a number"));
                    point[axis] = word.parse().map_err(|_| damaged())?;
                    found += 1;
                }
            }
            if found < N {
                return Err(ScanError::damaged(PCD, format!("point {i} has no x, y and z")));
            }
            points.push(point);
        }
        let found = points.len();
        if found < count {
            return Err(ScanError::damaged(PCD, format!("it ends after {found} of {count} points")));
        }
        Ok(points)
    }

    /// Each point after the other.
    fn binary<const N: usize>(
        &self,
        fields: &[Field; N],
        data: &[u8],
        count: usize,
    ) -> Result<Vec<[f32; N]>, ScanError> {
        self.check_bytes(count, self.stride, data.len())?;
        let value = |field: &Field, i| field.number.at(data, i * self.stride + field.offset) as f32;
        Ok((0..count).map(|i| fields.each_ref().map(|field| value(field, i))).collect())
    }

    /// Packed field by field: all x, then all y.
    fn compressed<const N: usize>(
        &self,
        fields: &[Field; N],
        data: &[u8],
        count: usize,
    ) -> Result<Vec<[f32; N]>, ScanError> {
        let size = |at: usize| Some(u32::from_le_bytes(*data.get(at..at + 4)?.first_chunk()?) as usize);
        let damaged = |what: String| ScanError::damaged(PCD, what);
        let sizes = size(0).zip(size(4)).ok_or_else(|| damaged("no sizes before its packed points".into()))?;
        let packed = data[8..].get(..sizes.0).ok_or_else(|| {
            damaged(format!("{} bytes of packed points, of which the file has {}", sizes.0, data.len() - 8))
        })?;
        if Some(sizes.1) != self.stride.checked_mul(count) {
            return Err(damaged(format!("{count} points of {} bytes are not {} bytes", self.stride, sizes.1)));
        }
        let unpacked = lzf::unpack(packed, sizes.1).map_err(|e| ScanError::damaged(PCD, e))?;
        let value = |field: &Field, i: usize| field.number.at(&unpacked, field.offset * count + i * field.bytes) as f32;
        Ok((0..count).map(|i| fields.each_ref().map(|field| value(field, i))).collect())
    }

    fn check_bytes(&self, count: usize, each: usize, found: usize) -> Result<(), ScanError> {
        let needed = count as u128 * each as u128;
        if needed <= found as u128 {
            return Ok(());
        }
        let what = format!("{count} points need {needed} bytes, the file has {found}");
        Err(ScanError::damaged(PCD, what))
    }
}
