//! A whole scan through the core, all results collected.

use std::time::{Duration, Instant};

use scanseg_core::{AnyConfig, AnySegmenter, Finished, Segment, Segmenter};
use scanseg_formats::{Geometry, RangeImage};

use crate::segmentation::apart::Apart;
use crate::segmentation::beams::ScanBeams;
use crate::segmentation::collected::{Collected, numbered};
use crate::segmentation::error::{SegmentationError, check_size};
use crate::segmentation::memory::OwnedMemory;
use crate::segmentation::noise::FoundNoise;

/// All that the segmentation of a scan gives.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// `rows * columns` labels with all joins applied; 0 in no segment.
    pub labels: Vec<u32>,
    /// `rows * columns` edges, before the closing. Region-based: where lines end, see
    /// [`scanseg_core::Sink::edges`].
    pub edges: Vec<bool>,
    /// `rows * columns` edges, after the closing. Region-based: pixels on no line. A pixel without
    /// a return is none.
    pub closed_edges: Vec<bool>,
    /// The segments, the one with the most pixels first; where pixels are equal the lower label
    /// first. Segment number n, counted from 1, is at n - 1.
    pub segments: Vec<Segment>,
    /// Pixels that got no label because the table of live labels was full.
    pub unlabelled: u32,
    /// The noise that counted at the range of each pixel, metres; by edges and by regions empty.
    pub range_noise_m: Vec<f32>,
    /// The noise of the ranges at the end of the scan; none by edges and by regions, which take
    /// what is stated, and without a return.
    pub noise: Option<FoundNoise>,
    /// The share by which the beam angles of a turning scanner were found to be too small; 0 where they are right: see
    /// [`scanseg_core::PlaneSegmenter::beam_stretch`]. Planes are those along the beams so found.
    pub beam_stretch: f32,
    /// The time that the core took for all rows, without that of collecting what it found.
    pub core_time: Duration,
}

impl Segmentation {
    /// Segments a scan. `row_done` is called after each row.
    ///
    /// # Errors
    /// [`SegmentationError`]: the geometry does not fit, the image is too large, or the
    /// configuration is wrong.
    pub fn of<'a>(
        scan: &RangeImage,
        geometry: &Geometry,
        config: impl Into<AnyConfig<'a>>,
        max_labels: Option<usize>,
        mut row_done: impl FnMut(),
    ) -> Result<Segmentation, SegmentationError> {
        check_size(scan)?;
        let beams = ScanBeams::new(geometry, scan.rows, scan.columns)?;
        let config = config.into();
        let mut memory = OwnedMemory::new(config, scan.columns, max_labels);
        let mut collected = Collected::new(scan.rows, scan.columns);
        let mut segmenter = AnySegmenter::new(config, beams.beams(), scan.columns, memory.memory())?;
        let (begun, mut core_time) = (Instant::now(), Duration::ZERO);
        let mut apart = Apart::new(&mut collected, || begun.elapsed());
        for (row, row_m) in scan.range_m.chunks(scan.columns).enumerate() {
            let pushed = Instant::now();
            segmenter.push_row(row_m, beams.row(row), &mut apart)?;
            core_time += pushed.elapsed();
            row_done();
        }
        let noise = FoundNoise::of(&segmenter, &scan.range_m, &config.ranging());
        let (range_noise_m, beam_stretch) = match &segmenter {
            AnySegmenter::Plane(planes) => (planes.range_noises_m(&scan.range_m).collect(), planes.beam_stretch()),
            AnySegmenter::Edge(_) | AnySegmenter::Region(_) => (vec![], 0.0),
        };
        let finishing = Instant::now();
        let unlabelled = match segmenter.finish(&mut apart) {
            Finished::Complete { unlabelled, .. } => unlabelled,
            Finished::Stopped => unreachable!("the sink never breaks off"),
        };
        core_time = (core_time + finishing.elapsed()).saturating_sub(apart.spent);
        let (rows, columns, labels, segments) = (scan.rows, scan.columns, collected.labels(), collected.segments());
        let Collected { edges, closed_edges, .. } = collected;
        Ok(Segmentation {
            rows,
            columns,
            labels,
            edges,
            closed_edges,
            segments,
            unlabelled,
            range_noise_m,
            noise,
            beam_stretch,
            core_time,
        })
    }

    /// Returns the segments of at least `min_pixels` pixels.
    pub fn of_pixels(&self, min_pixels: u32) -> &[Segment] {
        &self.segments[..self.segments.partition_point(|s| s.pixels() >= min_pixels)]
    }

    /// Returns the segment number of each pixel, from 1, the largest; 0 for no segment and for
    /// those below `min_pixels`.
    pub fn numbers(&self, min_pixels: u32) -> Vec<u32> {
        numbered(&self.labels, &self.segments, min_pixels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_core::{EdgeConfig, MAX_COLUMNS, MAX_ROWS, TurnAxis};
    use scanseg_formats::{Angles, Depth, Kind};

    fn geometry(kind: Kind) -> Geometry {
        Geometry::of(kind)
    }

    fn camera() -> Geometry {
        geometry(Kind::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 4.0, cy_px: 10.0, depth: Depth::Z })
    }

    #[test]
    fn pixels_get_the_label_that_remains_of_all_joins() {
        // Three teeth of a comb: labels 1, 2, 3. The bar joins the last two first, then these with
        // the first.
        let (rows, columns) = (20, 9);
        let mut range_m = vec![0.0; rows * columns];
        for row in 0..rows {
            let filled = if row < 12 {
                vec![0, 4, 8]
            } else if row < 16 {
                vec![0, 4, 5, 6, 7, 8]
            } else {
                (0..columns).collect()
            };
            filled.into_iter().for_each(|column| range_m[row * columns + column] = 2.0);
        }
        let scan = RangeImage { rows, columns, range_m };
        let mut rows_done = 0;
        let done = Segmentation::of(&scan, &camera(), EdgeConfig::paper(), None, || rows_done += 1).unwrap();
        assert_eq!((done.segments.len(), rows_done, done.unlabelled), (1, rows, 0));
        let expected: Vec<u32> = scan.range_m.iter().map(|&m| u32::from(m > 0.0)).collect();
        assert_eq!(done.labels, expected);
        assert_eq!(done.numbers(1), expected);
        assert_eq!(done.numbers(done.segments[0].pixels() + 1), vec![0; rows * columns]);
    }

    #[test]
    fn segments_come_by_size_then_label() {
        // columns of 1, 3, 3, 2 pixels with gaps between them
        let (rows, columns) = (3, 7);
        let lengths = [1, 0, 3, 0, 3, 0, 2];
        let range_m = (0..rows * columns).map(|i| if i / columns < lengths[i % columns] { 2.0 } else { 0.0 }).collect();
        let scan = RangeImage { rows, columns, range_m };
        let done = Segmentation::of(&scan, &camera(), EdgeConfig::paper(), None, || {}).unwrap();
        let found: Vec<_> = done.segments.iter().map(|s| (s.pixels(), s.first_column)).collect();
        assert_eq!(found, [(3, 2), (3, 4), (2, 6), (1, 0)]);
        assert_eq!(done.numbers(2)[..columns], [0, 0, 1, 0, 2, 0, 3]);
        assert_eq!(done.of_pixels(3).len(), 2);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let image = |rows, columns| RangeImage { rows, columns, range_m: vec![1.0; rows * columns] };
        let run = |scan: &RangeImage, geometry: &Geometry| {
            Segmentation::of(scan, geometry, EdgeConfig::paper(), None, || {}).map(|_| ()).unwrap_err()
        };
        let wide = run(&image(1, MAX_COLUMNS + 1), &camera());
        assert_eq!(wide, SegmentationError::Size { rows: 1, columns: MAX_COLUMNS + 1 });
        assert!(matches!(run(&image(MAX_ROWS + 1, 1), &camera()), SegmentationError::Size { .. }));
        assert!(matches!(run(&image(0, 0), &camera()), SegmentationError::Size { .. }));
        let (beam_deg, turn_deg) = (Angles::Even { start_deg: 0.0, step_deg: 1.0 }, Angles::Listed(vec![0.0, 1.0]));
        let kind = Kind::Nodding { beam_deg, turn_deg, turn_axis: TurnAxis::Y };
        assert!(matches!(run(&image(3, 4), &geometry(kind)), SegmentationError::Geometry(_)));
        let kind = Kind::Pinhole { fx_px: 1e9, fy_px: 1.0, cx_px: 0.0, cy_px: 0.0, depth: Depth::Z };
        assert!(matches!(run(&image(3, 4), &geometry(kind)), SegmentationError::Config(_)));
    }
}
