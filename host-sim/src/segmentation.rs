//! Whole scans through the core: beams and memory from a geometry file, rows pushed one by one, results collected.

use std::error::Error;
use std::fmt;
use std::ops::ControlFlow;

use scanseg_core::{
    Area, Beams, Columns, Config, ConfigError, EdgeRow, Finished, Join, LabelRow, MAX_COLUMNS, MAX_ROWS, Memory, Pixel,
    PushError, Row, Segment, Sink, Sizes, Trace, TurnAxis, bearing_row,
};

pub use crate::approach::{Approach, Segmenter};
use crate::format::{self, Angles, Geometry, GeometryError, Kind, RangeImage};

/// The beams of a scan, as the core wants them: `f32`, radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanBeams {
    kind: Kind,
    /// Column angles, if they are listed.
    columns_rad: Vec<f32>,
    /// One angle per row: turn, elevation, or 0 for a pinhole.
    rows_rad: Vec<f32>,
}

impl ScanBeams {
    /// The beams of an image of `rows` x `columns` pixels. Even azimuths that go round, but not exactly once, become a
    /// list, so that the angle across the seam is the true one.
    ///
    /// # Errors
    /// If the geometry does not fit the image, see [`Geometry::fits`].
    pub fn new(geometry: &Geometry, rows: usize, columns: usize) -> Result<ScanBeams, GeometryError> {
        geometry.fits(rows, columns)?;
        let list = |angles: &Angles, count| (0..count).map(|i| radians(angles.at(i))).collect::<Vec<_>>();
        let (rows_rad, columns_rad) = match &geometry.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => {
                let listed = matches!(beam_deg, Angles::Listed(_));
                (list(turn_deg, rows), if listed { list(beam_deg, columns) } else { vec![] })
            }
            Kind::Spinning { azimuth_deg, elevation_deg, wraps } => {
                let listed = match azimuth_deg {
                    Angles::Listed(_) => true,
                    Angles::Even { step, .. } => {
                        *wraps && (step.abs() * columns as f64 - 360.0).abs() > 0.009 * step.abs()
                    }
                };
                (list(elevation_deg, rows), if listed { list(azimuth_deg, columns) } else { vec![] })
            }
            Kind::Pinhole { .. } => (vec![0.0; rows], vec![]),
        };
        Ok(ScanBeams { kind: geometry.kind.clone(), columns_rad, rows_rad })
    }

    /// For the core.
    pub fn beams(&self) -> Beams<'_> {
        let columns = |angles: &Angles| match *angles {
            Angles::Even { start, step } if self.columns_rad.is_empty() => {
                Columns::Even { start_rad: radians(start), step_rad: step.to_radians() as f32 }
            }
            _ => Columns::Listed(&self.columns_rad),
        };
        match &self.kind {
            Kind::Nodding { beam_deg, turn_axis, .. } => {
                let axis = match turn_axis {
                    format::TurnAxis::Y => TurnAxis::Y,
                    format::TurnAxis::Z => TurnAxis::Z,
                };
                Beams::Nodding { columns: columns(beam_deg), axis }
            }
            Kind::Spinning { azimuth_deg, wraps, .. } => {
                Beams::Spinning { columns: columns(azimuth_deg), wraps: *wraps }
            }
            &Kind::Pinhole { fx, fy, cx, cy, .. } => {
                let [fx_px, fy_px, cx_px, cy_px] = [fx, fy, cx, cy].map(|px| px as f32);
                Beams::Pinhole { fx_px, fy_px, cx_px, cy_px }
            }
        }
    }

    /// The angle to push with each row, radians.
    pub fn rows_rad(&self) -> &[f32] {
        &self.rows_rad
    }
}

/// Within one turn, where `f32` is finest.
fn radians(deg: f64) -> f32 {
    (deg % 360.0).to_radians() as f32
}

/// The slices that a segmenter works in.
#[derive(Clone, Debug)]
pub struct OwnedMemory {
    ranges: Vec<f32>,
    bearings: Vec<u16>,
    words: Vec<u32>,
    areas: Vec<Area>,
}

impl OwnedMemory {
    /// Enough for images of `columns` columns, 1 to [`MAX_COLUMNS`], with `max_labels` live labels; without it, for as
    /// many as any image needs.
    pub fn new(columns: usize, config: &Config<'_>, max_labels: Option<usize>) -> OwnedMemory {
        let sizes = Sizes::of(columns, config);
        OwnedMemory {
            ranges: vec![0.0; sizes.ranges],
            bearings: vec![0; sizes.bearings],
            words: vec![0; sizes.words],
            areas: vec![Area::EMPTY; max_labels.unwrap_or(sizes.areas).min(sizes.areas)],
        }
    }

    /// For [`Segmenter::new`].
    pub fn memory(&mut self) -> Memory<'_> {
        Memory {
            ranges: &mut self.ranges,
            bearings: &mut self.bearings,
            words: &mut self.words,
            areas: &mut self.areas,
        }
    }
}

/// All that the segmentation of a scan gives.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// `rows * columns` labels with all joins applied; 0 in no segment.
    pub labels: Vec<u32>,
    /// `rows * columns` edges, before the closing. Region-based: where lines end, see [`scanseg_core::Sink::edges`].
    pub edges: Vec<bool>,
    /// `rows * columns` edges, after the closing. Region-based: pixels on no line. A pixel without a return is none.
    pub closed_edges: Vec<bool>,
    /// The segments, the one with the most pixels first; where pixels are equal the lower label first. Segment number n,
    /// counted from 1, is at n - 1.
    pub segments: Vec<Segment>,
    /// Pixels that got no label because the table of live labels was full.
    pub unlabelled: u32,
}

impl Segmentation {
    /// Segments a scan. `row_done` is called after each row.
    ///
    /// # Errors
    /// [`SegmentationError`]: the geometry does not fit, the image is too large, or the configuration is wrong.
    pub fn of(
        scan: &RangeImage,
        geometry: &Geometry,
        approach: Approach,
        config: &Config<'_>,
        max_labels: Option<usize>,
        mut row_done: impl FnMut(),
    ) -> Result<Segmentation, SegmentationError> {
        check_size(scan)?;
        let beams = ScanBeams::new(geometry, scan.rows, scan.columns)?;
        let mut memory = OwnedMemory::new(scan.columns, config, max_labels);
        let pixels = scan.rows * scan.columns;
        let mut collected = Collected {
            columns: scan.columns,
            labels: vec![0; pixels],
            edges: vec![false; pixels],
            closed_edges: vec![false; pixels],
            segments: vec![],
            joined_into: vec![],
        };
        let mut segmenter = Segmenter::new(approach, *config, beams.beams(), scan.columns, memory.memory())?;
        for (row_m, &row_rad) in scan.range_m.chunks(scan.columns).zip(beams.rows_rad()) {
            segmenter.push_row(row_m, row_rad, &mut collected)?;
            row_done();
        }
        let unlabelled = match segmenter.finish(&mut collected) {
            Finished::Complete { unlabelled, .. } => unlabelled,
            Finished::Stopped => unreachable!("the sink never breaks off"),
        };
        let Collected { mut labels, edges, closed_edges, mut segments, mut joined_into, .. } = collected;
        // joins go to smaller labels, so that these are final when a larger one asks
        for label in 0..joined_into.len() {
            joined_into[label] = joined_into[joined_into[label] as usize];
        }
        for label in &mut labels {
            *label = joined_into.get(*label as usize).copied().unwrap_or(*label);
        }
        segments.sort_by_key(|s| (u32::MAX - s.pixels(), s.label));
        Ok(Segmentation { rows: scan.rows, columns: scan.columns, labels, edges, closed_edges, segments, unlabelled })
    }

    /// The segments of at least `min_pixels` pixels.
    pub fn of_pixels(&self, min_pixels: u32) -> &[Segment] {
        &self.segments[..self.segments.partition_point(|s| s.pixels() >= min_pixels)]
    }

    /// The segment number of each pixel, from 1, the largest; 0 for no segment and for those below `min_pixels`.
    pub fn numbers(&self, min_pixels: u32) -> Vec<u32> {
        let last = self.segments.iter().map(|s| s.label.0).max().unwrap_or(0);
        let mut number_of = vec![0; last as usize + 1];
        for (number, segment) in (1..).zip(self.of_pixels(min_pixels)) {
            number_of[segment.label.0 as usize] = number;
        }
        self.labels.iter().map(|&label| number_of[label as usize]).collect()
    }
}

/// The bearing angles of a scan along a trace, as [`bearing_row`] gives them; 0 where there is none.
///
/// # Errors
/// As [`Segmentation::of`].
pub fn bearing_image(
    scan: &RangeImage,
    geometry: &Geometry,
    config: &Config<'_>,
    trace: Trace,
) -> Result<Vec<u16>, SegmentationError> {
    check_size(scan)?;
    let beams = ScanBeams::new(geometry, scan.rows, scan.columns)?;
    let row = |row: usize| Row {
        ranges_m: &scan.range_m[row * scan.columns..(row + 1) * scan.columns],
        turn_rad: beams.rows_rad()[row],
        row,
    };
    let mut counts = vec![0; scan.rows * scan.columns];
    for (now, out) in counts.chunks_mut(scan.columns).enumerate() {
        if let Some(before) = now.checked_sub(usize::from(trace.rows)) {
            bearing_row(config, beams.beams(), trace, row(now), row(before), out)?;
        }
    }
    Ok(counts)
}

/// Whether the core takes images of this size: up to [`MAX_ROWS`] x [`MAX_COLUMNS`] pixels, and not empty.
///
/// # Errors
/// [`SegmentationError::Size`] if not.
pub fn check_size(scan: &RangeImage) -> Result<(), SegmentationError> {
    let fits = (1..=MAX_ROWS).contains(&scan.rows) && (1..=MAX_COLUMNS).contains(&scan.columns);
    if fits { Ok(()) } else { Err(SegmentationError::Size { rows: scan.rows, columns: scan.columns }) }
}

struct Collected {
    columns: usize,
    labels: Vec<u32>,
    edges: Vec<bool>,
    closed_edges: Vec<bool>,
    segments: Vec<Segment>,
    /// The label that each label was joined into; itself if none.
    joined_into: Vec<u32>,
}

impl Sink for Collected {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        for (i, pixel) in (row.row() * self.columns..).zip(row.pixels()) {
            match pixel {
                Pixel::Segment(label) => self.labels[i] = label.0,
                Pixel::Edge => self.closed_edges[i] = true,
                Pixel::NoReturn | Pixel::Unlabelled => {}
            }
        }
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        let known = self.joined_into.len() as u32;
        self.joined_into.extend(known..=join.from.0.max(known.saturating_sub(1)));
        self.joined_into[join.from.0 as usize] = join.into.0;
        self.segments.retain(|segment| segment.label != join.from);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.retain(|known| known.label != segment.label);
        self.segments.push(*segment);
        ControlFlow::Continue(())
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        for run in row.runs() {
            let start = row.row() * self.columns;
            self.edges[start + run.start..start + run.end].fill(true);
        }
        ControlFlow::Continue(())
    }
}

/// Why a scan cannot be segmented.
#[derive(Clone, Debug, PartialEq)]
pub enum SegmentationError {
    /// The geometry does not fit the image.
    Geometry(GeometryError),
    /// The image is empty or larger than the core takes.
    Size {
        /// Rows of the image.
        rows: usize,
        /// Columns of the image.
        columns: usize,
    },
    /// The core refuses the configuration or the beams.
    Config(ConfigError),
    /// The core refuses a row.
    Push(PushError),
}

impl fmt::Display for SegmentationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SegmentationError::Geometry(e) => e.fmt(f),
            SegmentationError::Size { rows, columns } => {
                write!(f, "{rows} rows x {columns} columns is not within 1 x 1 to {MAX_ROWS} x {MAX_COLUMNS}")
            }
            SegmentationError::Config(e) => e.fmt(f),
            SegmentationError::Push(e) => e.fmt(f),
        }
    }
}

impl Error for SegmentationError {}

impl From<GeometryError> for SegmentationError {
    fn from(e: GeometryError) -> Self {
        SegmentationError::Geometry(e)
    }
}

impl From<ConfigError> for SegmentationError {
    fn from(e: ConfigError) -> Self {
        SegmentationError::Config(e)
    }
}

impl From<PushError> for SegmentationError {
    fn from(e: PushError) -> Self {
        SegmentationError::Push(e)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::format::Depth;

    fn geometry(kind: Kind) -> Geometry {
        let (min_range_m, max_range_m, range_noise_m) = (None, None, None);
        Geometry { unit_m: 0.001, no_return: vec![], min_range_m, max_range_m, range_noise_m, kind }
    }

    fn camera() -> Geometry {
        geometry(Kind::Pinhole { fx: 100.0, fy: 100.0, cx: 4.0, cy: 10.0, depth: Depth::Z })
    }

    #[test]
    fn even_angles_stay_even_unless_the_seam_would_be_wrong() {
        let spinning = |step, columns, wraps| {
            let azimuth_deg = Angles::Even { start: 540.0, step };
            let elevation_deg = Angles::Listed(vec![10.0, -5.0]);
            let geometry = geometry(Kind::Spinning { azimuth_deg, elevation_deg, wraps });
            ScanBeams::new(&geometry, 2, columns).unwrap()
        };
        let closed = spinning(-3.6, 100, true);
        let Beams::Spinning { columns: Columns::Even { start_rad, step_rad }, wraps: true } = closed.beams() else {
            panic!("{closed:?}");
        };
        assert_eq!((start_rad, step_rad), (std::f32::consts::PI, (-3.6f64).to_radians() as f32));
        assert_eq!(closed.rows_rad(), [10f64, -5.0].map(|deg| deg.to_radians() as f32));
        // half a step is missing at the seam
        let open = spinning(-3.582, 100, true);
        let Beams::Spinning { columns: Columns::Listed(list), wraps: true } = open.beams() else { panic!("{open:?}") };
        assert_eq!((list.len(), list[99]), (100, (540.0f64 - 99.0 * 3.582).to_radians() as f32));
        let apart = spinning(-3.582, 100, false);
        assert!(matches!(apart.beams(), Beams::Spinning { columns: Columns::Even { .. }, wraps: false }));
    }

    #[test]
    fn pixels_get_the_label_that_remains_of_all_joins() {
        // Three teeth of a comb: labels 1, 2, 3. The bar joins the last two first, then these with the first.
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
        let done =
            Segmentation::of(&scan, &camera(), Approach::Edge, &Config::paper(), None, || rows_done += 1).unwrap();
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
        let done = Segmentation::of(&scan, &camera(), Approach::Edge, &Config::paper(), None, || {}).unwrap();
        let found: Vec<_> = done.segments.iter().map(|s| (s.pixels(), s.first_column)).collect();
        assert_eq!(found, [(3, 2), (3, 4), (2, 6), (1, 0)]);
        assert_eq!(done.numbers(2)[..columns], [0, 0, 1, 0, 2, 0, 3]);
        assert_eq!(done.of_pixels(3).len(), 2);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let image = |rows, columns| RangeImage { rows, columns, range_m: vec![1.0; rows * columns] };
        let run = |scan: &RangeImage, geometry: &Geometry| {
            Segmentation::of(scan, geometry, Approach::Edge, &Config::paper(), None, || {}).map(|_| ()).unwrap_err()
        };
        let wide = run(&image(1, MAX_COLUMNS + 1), &camera());
        assert_eq!(wide, SegmentationError::Size { rows: 1, columns: MAX_COLUMNS + 1 });
        assert!(matches!(run(&image(MAX_ROWS + 1, 1), &camera()), SegmentationError::Size { .. }));
        assert!(matches!(run(&image(0, 0), &camera()), SegmentationError::Size { .. }));
        let (beam_deg, turn_deg) = (Angles::Even { start: 0.0, step: 1.0 }, Angles::Listed(vec![0.0, 1.0]));
        let kind = Kind::Nodding { beam_deg, turn_deg, turn_axis: format::TurnAxis::Y };
        assert!(matches!(run(&image(3, 4), &geometry(kind)), SegmentationError::Geometry(_)));
        let kind = Kind::Pinhole { fx: 1e9, fy: 1.0, cx: 0.0, cy: 0.0, depth: Depth::Z };
        assert!(matches!(run(&image(3, 4), &geometry(kind)), SegmentationError::Config(_)));
    }
}
