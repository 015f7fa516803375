//! Organised clouds: PointCloud2.

use std::ops::RangeInclusive;

use crate::cloud::number::Number;
use crate::cloud::{Cloud, rings};
use crate::file::Cause;
use crate::ros::cdr::decode;
use crate::ros::messages::PointCloud2;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;

const FORMAT: &str = "PointCloud2";
/// Three coordinates of `f32`. Points without bytes would be as many as a message likes to claim.
const LEAST_POINT_BYTES: usize = 12;

/// Returns the scan of a message.
pub fn scan(name: String, data: &[u8], options: &ReadOptions) -> Result<Scan, Cause> {
    points(&decode(FORMAT, data)?)?.into_scan(name, options)
}

/// Returns the points of a message.
pub fn points(message: &PointCloud2<'_>) -> Result<Cloud, ScanError> {
    let [rows, columns, point_step, row_step] =
        [message.height, message.width, message.point_step, message.row_step].map(|n| n as usize);
    let pixels = ScanError::check_pixels(rows, columns)?;
    let readers = ["x", "y", "z"].map(|axis| reader(message, &[axis], REAL));
    let [Some(x), Some(y), Some(z)] = readers else {
        return Err(ScanError::lacks(FORMAT, "x, y and z in floating point"));
    };
    if point_step < LEAST_POINT_BYTES {
        return Err(ScanError::damaged(FORMAT, "its points are too short for three coordinates"));
    }
    let last = (rows - 1).checked_mul(row_step).and_then(|start| start.checked_add(columns.checked_mul(point_step)?));
    let long = columns.checked_mul(point_step).is_some_and(|bytes| bytes <= row_step || rows == 1);
    if !long || last.is_none_or(|end| end > message.data.len()) {
        return Err(ScanError::damaged(FORMAT, "its rows are longer than its data"));
    }
    if rows == 1 {
        let ring = reader(message, &rings::NAMES, RING);
        let ring = ring.ok_or(ScanError::Unorganised { points: columns, advice: ADVICE })?;
        let of_rings = message.data.chunks_exact(point_step).take(columns);
        let of_rings = of_rings.map(|point| [&x, &y, &z, &ring].map(|read| read(point)));
        return rings::rows_of(&of_rings.collect::<Vec<_>>(), ADVICE);
    }
    let mut points = Vec::with_capacity(pixels);
    for row in 0..rows {
        for column in 0..columns {
            let point = &message.data[row * row_step + column * point_step..][..point_step];
            points.push([&x, &y, &z].map(|read| read(point)));
        }
    }
    Ok(Cloud { rows, columns, points })
}

const ADVICE: &str = "its height is 1, and its points say no ring: take the cloud as the driver gives it";

/// Whether a cloud has rows, or points that say theirs.
pub fn has_rows(message: &PointCloud2<'_>) -> bool {
    message.height > 1 || reader(message, &rings::NAMES, RING).is_some()
}

/// Types of fields, by their numbers: those of coordinates, and of rings.
const REAL: RangeInclusive<u8> = 7..=8;
const RING: RangeInclusive<u8> = 2..=7;

/// Returns what reads the field of a point that has one of these names and types; NaN beyond its end.
fn reader(
    message: &PointCloud2<'_>,
    names: &[&str],
    types: RangeInclusive<u8>,
) -> Option<impl Fn(&[u8]) -> f32 + use<>> {
    let field = message.fields.iter().find(|field| names.contains(&field.name.as_str()))?;
    let (at, big) = (field.offset as usize, message.is_bigendian);
    let number = match field.datatype {
        datatype if !types.contains(&datatype) => return None,
        2 => Number::U8,
        3 => Number::I16,
        4 => Number::U16,
        5 => Number::I32,
        6 => Number::U32,
        7 => Number::F32,
        8 => Number::F64,
        _ => return None,
    };
    Some(move |point: &[u8]| {
        let bytes = at.checked_add(number.bytes()).and_then(|end| point.get(at..end));
        bytes.map_or(f32::NAN, |bytes| if big { number.big_endian(bytes) } else { number.at(bytes, 0) } as f32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::made_up;
    use crate::ros::messages::{Header, PointField};

    fn message(data: &[u8]) -> PointCloud2<'_> {
        let field = |name: &str, offset| PointField { name: name.into(), offset, datatype: 7, count: 1 };
        PointCloud2 {
            header: Header::default(),
            height: 2,
            width: 3,
            fields: vec![field("x", 0), field("intensity", 12), field("z", 8), field("y", 4)],
            is_bigendian: false,
            point_step: 16,
            row_step: 50,
            data,
        }
    }

    fn data() -> Vec<u8> {
        let mut data = vec![];
        for row in 0..2 {
            for column in 0..3 {
                let point = [1.0 + row as f32, column as f32, 0.5, 9.0];
                data.extend(point.iter().flat_map(|x| x.to_le_bytes()));
            }
            data.extend([0; 2]);
        }
        data
    }

    #[test]
    fn points_lie_in_their_rows() {
        let data = data();
        let bytes = made_up::cdr(&message(&data));
        let scan = scan("x".into(), &bytes, &ReadOptions::default()).unwrap();
        assert_eq!((scan.image.rows, scan.image.columns, scan.measured), (2, 3, 6));
        assert!((scan.image.range_m[5] - (4.0f32 + 4.0 + 0.25).sqrt()).abs() < 1e-6);
        assert!((scan.geometry.direction(1, 2)[1] - 2.0 / 8.25f64.sqrt()).abs() < 1e-6);
    }

    #[test]
    fn false_claims_are_refused() {
        let data = data();
        let refused = |change: fn(&mut PointCloud2<'_>)| {
            let mut message = message(&data);
            change(&mut message);
            points(&message).map(|_| ()).unwrap_err().to_string()
        };
        assert!(refused(|m| m.row_step = 60).contains("longer than its data"));
        assert!(refused(|m| m.row_step = 40).contains("longer than its data"));
        assert!(refused(|m| m.point_step = u32::MAX).contains("longer than its data"));
        assert!(refused(|m| (m.point_step, m.row_step, m.width) = (0, 0, 1 << 20)).contains("too short"));
        assert!(refused(|m| m.point_step = 8).contains("too short"));
        assert!(refused(|m| m.width = u32::MAX).contains("pixels"));
        assert!(refused(|m| m.fields[0].datatype = 5).contains("x, y and z"));
        assert!(refused(|m| m.fields.clear()).contains("x, y and z"));
        // a field beyond the point is no coordinate
        let mut beyond = message(&data);
        beyond.fields[0].offset = 14;
        assert!(points(&beyond).unwrap().points.iter().all(|point| point[0].is_nan()));
    }
}
