//! A segmented scan, as everything that is written of it takes it.

use scanseg_core::{Ranging, Segment};
use scanseg_formats::{Geometry, RangeImage};

/// A segmented scan.
#[derive(Clone, Copy)]
pub struct Segmented<'a> {
    /// Its ranges, without what is no return.
    pub image: &'a RangeImage,
    /// Its beams.
    pub geometry: &'a Geometry,
    /// The errors of its scanner.
    pub ranging: &'a Ranging,
    /// The noise at the range of each pixel, metres; empty for that of `ranging`.
    pub range_noise_m: &'a [f32],
    /// The label of the segment of each pixel, from 1 on; 0 for none.
    pub labels: &'a [u32],
    /// The segments: label 1, 2, 3, ...
    pub segments: &'a [Segment],
}

impl Segmented<'_> {
    /// Returns the point of a pixel; none where it has no range.
    pub fn point_m(&self, pixel: usize) -> Option<[f64; 3]> {
        let (range_m, columns) = (self.image.range_m[pixel], self.image.columns);
        (range_m > 0.0).then(|| point_m(self.geometry, pixel / columns, pixel % columns, range_m))
    }

    /// Returns the pixels of each segment.
    pub(super) fn pixels(&self) -> Vec<Vec<usize>> {
        let mut pixels = vec![vec![]; self.segments.len()];
        for (pixel, &label) in self.labels.iter().enumerate() {
            if let Some(segment) = (label as usize).checked_sub(1) {
                pixels[segment].push(pixel);
            }
        }
        pixels
    }
}

/// Returns the point of a pixel with a return, metres. Listed angles must have an entry for it, see
/// [`Geometry::fits`].
pub fn point_m(geometry: &Geometry, row: usize, column: usize, range_m: f32) -> [f64; 3] {
    let (origin, direction) = (geometry.origin(row, column), geometry.direction(row, column));
    [0, 1, 2].map(|axis| origin[axis] + direction[axis] * f64::from(range_m))
}

pub(super) fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
