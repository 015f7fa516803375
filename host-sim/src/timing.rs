//! The time that the core alone takes for a scan: all rows from memory, labels and planes out.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use scanseg_core::{AnyConfig, AnySegmenter, LabelRow, Segment, Segmenter, Sink};

use crate::segmentation::{OwnedMemory, ScanBeams, Segmentation, SegmentationError, check_size};
use scanseg_formats::{Geometry, RangeImage};

/// Smaller segments are not asked for their planes.
const MIN_PIXELS: u32 = 30;

/// The times of some rounds over one scan, on one core.
#[derive(Clone, Debug, PartialEq)]
pub struct Timing {
    /// Nanoseconds per point of each round, rising; not empty.
    pub ns_per_point: Vec<f64>,
    /// Segments of 30 pixels or more.
    pub segments: usize,
}

impl Timing {
    /// Times `rounds` rounds, 1 or more, after one that warms up.
    ///
    /// # Errors
    /// As [`crate::segmentation::Segmentation::of`].
    pub fn of<'a>(
        scan: &RangeImage,
        geometry: &Geometry,
        config: impl Into<AnyConfig<'a>>,
        max_labels: Option<usize>,
        rounds: usize,
    ) -> Result<Timing, SegmentationError> {
        check_size(scan)?;
        let beams = ScanBeams::new(geometry, scan.rows, scan.columns)?;
        let config = config.into();
        let mut memory = OwnedMemory::new(config, scan.columns, max_labels);
        let mut ns_per_point = Vec::new();
        let mut segmenter = AnySegmenter::new(config, beams.beams(), scan.columns, memory.memory())?;
        for round in 0..=rounds.max(1) {
            let started = Instant::now();
            for (row, row_m) in scan.range_m.chunks(scan.columns).enumerate() {
                segmenter.push_row(black_box(row_m), beams.row(row), &mut Consumer)?;
            }
            black_box(segmenter.finish(&mut Consumer));
            let ns = started.elapsed().as_secs_f64() * 1e9;
            if round > 0 {
                ns_per_point.push(ns / scan.range_m.len() as f64);
            }
        }
        ns_per_point.sort_by(f64::total_cmp);
        let segments = Segmentation::of(scan, geometry, config, max_labels, || ())?.of_pixels(MIN_PIXELS).len();
        Ok(Timing { ns_per_point, segments })
    }

    /// Returns the median round, nanoseconds per point.
    pub fn median_ns(&self) -> f64 {
        let ns = &self.ns_per_point;
        (ns[(ns.len() - 1) / 2] + ns[ns.len() / 2]) / 2.0
    }
}

/// Takes the rows and asks the larger segments for their planes.
struct Consumer;

impl Sink for Consumer {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        black_box(row);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if segment.pixels() >= MIN_PIXELS {
            black_box(segment.plane());
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_median_is_the_middle_of_the_rounds() {
        let timing = |ns: &[f64]| Timing { ns_per_point: ns.to_vec(), segments: 0 }.median_ns();
        assert_eq!([timing(&[7.0]), timing(&[1.0, 2.0, 9.0]), timing(&[1.0, 2.0, 4.0, 9.0])], [7.0, 2.0, 3.0]);
    }
}
