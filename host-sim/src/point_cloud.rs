//! Segmented scans as point clouds, for programs that show or process them.

use scanseg_formats::{Geometry, RangeImage};

use crate::picture::label_colour;

/// Returns the point of a pixel with a return, metres. Listed angles must have an entry for it, see
/// [`Geometry::fits`].
pub fn point_m(geometry: &Geometry, row: usize, column: usize, range_m: f32) -> [f64; 3] {
    let (origin, direction) = (geometry.origin(row, column), geometry.direction(row, column));
    [0, 1, 2].map(|axis| origin[axis] + direction[axis] * f64::from(range_m))
}

/// Returns a PLY file (binary, little endian) with a point for each return, row by row: `x`, `y`,
/// `z` in metres in the scanner's frame (x ahead, y left, z up), `red`, `green`, `blue` as in the
/// pictures, and `label`, 0 for no segment. The geometry and the labels must have the scan's size.
pub fn ply(scan: &RangeImage, geometry: &Geometry, labels: &[u32]) -> Vec<u8> {
    let returns = || scan.range_m.iter().enumerate().filter(|(_, range_m)| **range_m > 0.0);
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nproperty uchar green\nproperty uchar blue\nproperty int label\nend_header\n",
        returns().count()
    )
    .into_bytes();
    for (i, &range_m) in returns() {
        for metres in point_m(geometry, i / scan.columns, i % scan.columns, range_m) {
            bytes.extend((metres as f32).to_le_bytes());
        }
        bytes.extend(label_colour(labels[i]));
        bytes.extend(labels[i].to_le_bytes());
    }
    bytes
}
