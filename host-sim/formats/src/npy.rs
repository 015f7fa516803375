//! NumPy's `.npy` files: depths (rows x columns) or points (rows x columns x 3).
//!
//! Format: NEP 1, versions 1 to 3.

use crate::cloud::number::Number;
use crate::scan_error::ScanError;

const NPY: &str = "npy";

/// The first bytes of every such file.
pub(crate) const SIGNATURE: &[u8] = b"\x93NUMPY";

const ADVICE: &str =
    "an array of N x 3. Save it as rows x columns x 3, nan where nothing was measured, before points are left out";

/// What a file holds.
pub(crate) enum Array {
    /// A distance for each pixel, row by row; `whole` if they are counts.
    Depths { rows: usize, columns: usize, values: Vec<f32>, whole: bool },
    /// A point for each pixel, row by row.
    Points { rows: usize, columns: usize, points: Vec<[f32; 3]> },
}

/// Reads a file.
pub(crate) fn read(bytes: &[u8]) -> Result<Array, ScanError> {
    let damaged = |what: &str| ScanError::damaged(NPY, what);
    let size = |at: usize, n: usize| -> Option<usize> {
        let bytes = bytes.get(at..at + n)?;
        Some(bytes.iter().rev().fold(0, |size, byte| size << 8 | usize::from(*byte)))
    };
    let length = if bytes.get(6) == Some(&1) { size(8, 2).map(|n| (10, n)) } else { size(8, 4).map(|n| (12, n)) };
    let (start, length) = length.ok_or_else(|| damaged("no header"))?;
    let end = start + length;
    let header = bytes.get(start..end).ok_or_else(|| damaged("its header ends early"))?;
    let header = String::from_utf8_lossy(header);
    let after = |key: &str| {
        let text = &header[header.find(&format!("'{key}'"))? + key.len() + 2..];
        Some(text.trim_start().strip_prefix(':')?.trim_start())
    };
    let lacks = |what: &str| ScanError::lacks(NPY, format!("{what} in its header"));
    let shape =
        after("shape").and_then(|text| text.strip_prefix('(')?.split_once(')')).ok_or_else(|| lacks("shape"))?.0;
    let shape: Option<Vec<usize>> =
        shape.split(',').map(str::trim).filter(|n| !n.is_empty()).map(|n| n.parse().ok()).collect();
    let shape = shape.ok_or_else(|| lacks("shape"))?;
    if after("fortran_order").is_none_or(|text| !text.starts_with("False")) {
        return Err(ScanError::lacks(NPY, "its rows one after the other: save numpy.ascontiguousarray(a)"));
    }
    let kind =
        after("descr").and_then(|text| text.strip_prefix('\'')?.split_once('\'')).ok_or_else(|| lacks("descr"))?.0;
    let number = number_of(kind).ok_or_else(|| {
        ScanError::lacks(NPY, format!("numbers that are little-endian and real or whole (it has {kind:.20})"))
    })?;
    let (rows, columns, each) = match shape[..] {
        [points, 3] => return Err(ScanError::Unorganised { points, advice: ADVICE }),
        [rows, columns] | [rows, columns, 1] => (rows, columns, 1),
        [rows, columns, 3] => (rows, columns, 3),
        _ => {
            let what = format!("the shape rows x columns or rows x columns x 3 (it has {shape:?})");
            return Err(ScanError::lacks(NPY, what));
        }
    };
    let pixels = ScanError::check_pixels(rows, columns)?;
    let (needed, data) = (pixels * each * number.bytes(), &bytes[end..]);
    if needed != data.len() {
        let what = format!("{rows} x {columns} x {each} values are {needed} bytes, the file has {}", data.len());
        return Err(ScanError::damaged(NPY, what));
    }
    let value = |i: usize| number.at(data, i * number.bytes()) as f32;
    Ok(if each == 1 {
        let whole = !matches!(number, Number::F32 | Number::F64);
        Array::Depths { rows, columns, values: (0..pixels).map(value).collect(), whole }
    } else {
        let points = (0..pixels).map(|i| [3 * i, 3 * i + 1, 3 * i + 2].map(value)).collect();
        Array::Points { rows, columns, points }
    })
}

/// `<f4`, `|u1`.
fn number_of(kind: &str) -> Option<Number> {
    let kind = kind.strip_prefix(['<', '|'])?;
    let (letter, bytes) = kind.split_at_checked(1)?;
    Number::of(&letter.to_ascii_uppercase(), bytes.parse().ok()?)
}
