//! The points of a scan with the colour and the label of their segment, organised.

use scanseg_formats::Axes;

use crate::export::segmented::Segmented;
use crate::picture::label_colour;

/// Returns a binary PCD file with HEIGHT rows of WIDTH columns: x, y, z in metres, nan where there is no
/// return; rgb as the Point Cloud Library packs it; label, 0 for no segment.
pub fn pcd(scan: &Segmented<'_>) -> Vec<u8> {
    let (rows, columns) = (scan.image.rows, scan.image.columns);
    let mut bytes = format!(
        "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z rgb label\nSIZE 4 4 4 4 4\n\
         TYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH {columns}\nHEIGHT {rows}\nVIEWPOINT 0 0 0 1 0 0 0\n\
         POINTS {}\nDATA binary\n",
        rows * columns
    )
    .into_bytes();
    (0..rows * columns).for_each(|pixel| bytes.extend(record(scan, pixel, Axes::Forward)));
    bytes
}

/// Bytes of a point in [`record`].
pub(super) const RECORD_BYTES: usize = 20;

/// Returns x, y, z, rgb and label of a pixel, little end first, in these axes.
pub(super) fn record(scan: &Segmented<'_>, pixel: usize, axes: Axes) -> [u8; RECORD_BYTES] {
    let label = scan.labels[pixel];
    let [red, green, blue] = label_colour(label);
    let point = scan.point_m(pixel).map_or([f32::NAN; 3], |point| axes.back(point.map(|x| x as f32)));
    let words = [point[0].to_bits(), point[1].to_bits(), point[2].to_bits(), u32::from_be_bytes([0, red, green, blue])];
    let mut bytes = [0; RECORD_BYTES];
    for (to, word) in bytes.chunks_exact_mut(4).zip(words.into_iter().chain([label])) {
        to.copy_from_slice(&word.to_le_bytes());
    }
    bytes
}

/// Bytes of a vertex of [`ply`].
const VERTEX_BYTES: usize = 19;

/// Returns a binary PLY file with a vertex for each return: x, y, z in metres, red, green, blue, and
/// label, 0 for no segment. A range grid tells the vertex of each pixel, row by row.
pub fn ply(scan: &Segmented<'_>) -> Vec<u8> {
    let (rows, columns) = (scan.image.rows, scan.image.columns);
    let returns = scan.image.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    let mut bytes = format!(
        "ply\nformat binary_little_endian 1.0\nobj_info num_cols {columns}\nobj_info num_rows {rows}\n\
         element vertex {returns}\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n\
         property uchar green\nproperty uchar blue\nproperty int label\nelement range_grid {}\n\
         property list uchar int vertex_indices\nend_header\n",
        rows * columns
    )
    .into_bytes();
    bytes.reserve(returns * (VERTEX_BYTES + 4) + rows * columns);
    for pixel in 0..rows * columns {
        let Some(point) = scan.point_m(pixel) else { continue };
        let label = scan.labels[pixel];
        let mut vertex = [0; VERTEX_BYTES];
        for (to, x) in vertex.as_chunks_mut().0.iter_mut().zip(point) {
            *to = (x as f32).to_le_bytes();
        }
        vertex[12..15].copy_from_slice(&label_colour(label));
        vertex[15..].copy_from_slice(&label.to_le_bytes());
        bytes.extend_from_slice(&vertex);
    }
    let mut vertex = 0u32;
    for range_m in &scan.image.range_m {
        let measured = *range_m > 0.0;
        bytes.push(measured.into());
        if measured {
            bytes.extend_from_slice(&vertex.to_le_bytes());
            vertex += 1;
        }
    }
    bytes
}
