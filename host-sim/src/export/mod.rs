//! Segmented scans for other programs: points, outlines of the segments, recordings.
//!
//! Coordinates are metres in the scanner's frame: x forward, y left, z up.

mod convex;
pub mod mcap;
mod outline;
pub mod outlines;
mod planarity;
pub mod points;
mod ros;

pub use outline::Outline;
pub use planarity::{Planarity, Verdict};

use scanseg_core::{Ranging, Segment};
use scanseg_formats::{Geometry, RangeImage};

/// A segmented scan.
#[derive(Clone, Copy)]
pub struct Segmented<'a> {
    /// Its ranges.
    pub image: &'a RangeImage,
    /// Its beams.
    pub geometry: &'a Geometry,
    /// The errors of its scanner.
    pub ranging: &'a Ranging,
    /// The noise at the range of each pixel, metres; empty for that of `ranging`.
    pub range_noise_m: &'a [f32],
    /// The number of the segment of each pixel, from 1 on; 0 for none.
    pub numbers: &'a [u32],
    /// The segments: number 1, 2, 3, ...
    pub segments: &'a [Segment],
}

impl Segmented<'_> {
    /// Returns where the beam of a pixel starts and its direction.
    fn beam(&self, pixel: usize) -> ([f64; 3], [f64; 3]) {
        let (row, column) = (pixel / self.image.columns, pixel % self.image.columns);
        (self.geometry.origin(row, column), self.geometry.direction(row, column))
    }

    /// Returns the point of a pixel; none where it has no range.
    pub fn point(&self, pixel: usize) -> Option<[f64; 3]> {
        let range_m = f64::from(self.image.range_m[pixel]);
        let (origin, direction) = self.beam(pixel);
        (range_m > 0.0).then(|| [0, 1, 2].map(|i| origin[i] + range_m * direction[i]))
    }

    /// Returns the pixels of each segment.
    fn pixels(&self) -> Vec<Vec<usize>> {
        let mut pixels = vec![vec![]; self.segments.len()];
        for (pixel, &number) in self.numbers.iter().enumerate() {
            if let Some(segment) = (number as usize).checked_sub(1) {
                pixels[segment].push(pixel);
            }
        }
        pixels
    }

    /// Returns an outline for each segment, as [`Outline`] says; none of one without a plane.
    pub fn outlines(&self) -> Vec<Option<Outline>> {
        let pixels = self.pixels();
        let outline = |(segment, pixels): (&Segment, &Vec<usize>)| {
            Outline::of(&segment.plane()?, pixels.iter().filter_map(|&pixel| self.point(pixel)))
        };
        self.segments.iter().zip(&pixels).map(outline).collect()
    }

    /// Returns how planar each segment is.
    pub fn planarities(&self) -> Vec<Planarity> {
        let pixels = self.pixels();
        self.segments.iter().zip(&pixels).map(|(segment, pixels)| Planarity::of(self, segment, pixels)).collect()
    }
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
