//! Scans for the streaming segmenter: the same scan for it and for the reference, and a record of
//! what it reports.

use crate::reference::beams::{Beams as ReferenceBeams, TurnAxis as ReferenceAxis};
use crate::reference::closing::Element as ReferenceElement;
use crate::reference::labels::Class;
use crate::reference::{Image, Segmentation, Settings, Size, Trace as ReferenceTrace, segment_counts};
use scanseg_core::{
    AnyConfig, AnySegmenter, Area, Beams, COUNTS_PER_RAD, Columns, EdgeConfig, EdgeRow, Element, Finished, Join, Label,
    LabelRow, MAX_LATENCY_ROWS, Memory, Pixel, PushError, Ranging, Row, Segment, Segmenter, Sink, Sizes, Status, Trace,
    TurnAxis, bearing_row,
};
use std::collections::BTreeMap;
use std::ops::ControlFlow;

/// Column angles, radians; as [`Columns`], with the list owned.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// Column `c` at `start_rad + c * step_rad`.
    Even {
        /// Angle of column 0.
        start_rad: f32,
        /// From a column to the next.
        step_rad: f32,
    },
    /// One per column.
    Listed(Vec<f32>),
}

impl Angles {
    fn columns(&self) -> Columns<'_> {
        match *self {
            Angles::Even { start_rad, step_rad } => Columns::Even { start_rad, step_rad },
            Angles::Listed(ref list) => Columns::Listed(list),
        }
    }

    fn exact(&self, columns: usize) -> Vec<f64> {
        match *self {
            Angles::Even { start_rad, step_rad } => {
                (0..columns).map(|c| f64::from(start_rad) + c as f64 * f64::from(step_rad)).collect()
            }
            Angles::Listed(ref list) => list.iter().map(|&angle| angle.into()).collect(),
        }
    }
}

/// Where beams point; as [`Beams`].
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs)]
pub enum Rig {
    Nodding { angles: Angles, axis: TurnAxis },
    Spinning { angles: Angles, wraps: bool },
    Pinhole { fx_px: f32, fy_px: f32, cx_px: f32, cy_px: f32 },
}

/// A whole scan.
#[derive(Clone, Debug)]
pub struct Scan {
    /// Columns of the image.
    pub columns: usize,
    /// Ranges, row by row, metres.
    pub range_m: Vec<f32>,
    /// Turn angle or elevation of each row, radians.
    pub turn_rad: Vec<f32>,
    /// Where the beams point.
    pub rig: Rig,
}

impl Scan {
    /// The scan of a scene that gives the range along a direction.
    pub fn of(columns: usize, turn_rad: Vec<f32>, rig: Rig, range_m: impl Fn([f64; 3]) -> f64) -> Scan {
        let mut scan = Scan { columns, range_m: Vec::new(), turn_rad, rig };
        let beams = scan.reference_beams();
        scan.range_m = scan.size().pixels().map(|pixel| range_m(beams.direction(pixel).into()) as f32).collect();
        scan
    }

    /// The shape of the image.
    pub fn size(&self) -> Size {
        let wraps = matches!(self.rig, Rig::Spinning { wraps: true, .. });
        Size { rows: self.turn_rad.len(), columns: self.columns, wraps }
    }

    /// The ranges of a row.
    pub fn row_m(&self, row: usize) -> &[f32] {
        &self.range_m[row * self.columns..][..self.columns]
    }

    /// Its first rows.
    pub fn cut(&self, rows: usize) -> Scan {
        let range_m = self.range_m[..rows * self.columns].to_vec();
        Scan { range_m, turn_rad: self.turn_rad[..rows].to_vec(), ..self.clone() }
    }

    /// The beams for the segmenter.
    pub fn beams(&self) -> Beams<'_> {
        match self.rig {
            Rig::Nodding { ref angles, axis } => Beams::Nodding { columns: angles.columns(), axis },
            Rig::Spinning { ref angles, wraps } => Beams::Spinning { columns: angles.columns(), wraps },
            Rig::Pinhole { fx_px, fy_px, cx_px, cy_px } => Beams::Pinhole { fx_px, fy_px, cx_px, cy_px },
        }
    }

    /// The same beams for the reference.
    pub fn reference_beams(&self) -> ReferenceBeams {
        let turn_rad = self.turn_rad.iter().map(|&turn| turn.into()).collect();
        match self.rig {
            Rig::Nodding { ref angles, axis } => {
                let axis = match axis {
                    TurnAxis::Y => ReferenceAxis::Y,
                    TurnAxis::Z => ReferenceAxis::Z,
                };
                ReferenceBeams::Nodding { beam_rad: angles.exact(self.columns), turn_rad, axis }
            }
            Rig::Spinning { ref angles, .. } => {
                ReferenceBeams::Spinning { azimuth_rad: angles.exact(self.columns), elevation_rad: turn_rad }
            }
            Rig::Pinhole { fx_px, fy_px, cx_px, cy_px } => {
                let [fx, fy, cx, cy] = [fx_px, fy_px, cx_px, cy_px].map(f64::from);
                ReferenceBeams::Pinhole { fx, fy, cx, cy }
            }
        }
    }

    /// The image for the reference, with the limits of the ranges.
    pub fn image(&self, ranging: &Ranging) -> Image {
        let &Ranging { min_range_m, max_range_m, .. } = ranging;
        Image { min_range_m, max_range_m, ..Image::new(self.size(), self.range_m.clone()) }
    }

    /// The bearing angles that the core finds along a trace, in counts.
    pub fn counts(&self, ranging: &Ranging, trace: Trace) -> Vec<u16> {
        let mut counts = vec![0; self.range_m.len()];
        let row = |row| Row { ranges_m: self.row_m(row), beams: self.turn_rad[row].into(), row };
        for (now, out) in counts.chunks_mut(self.columns).enumerate() {
            // above the image there is none
            if let Some(before) = now.checked_sub(trace.rows.into()) {
                bearing_row(ranging, self.beams(), trace, row(now), row(before), out).unwrap();
            }
        }
        counts
    }

    /// What the reference finds, given the bearing angles that the core finds.
    pub fn expected(&self, config: &EdgeConfig) -> Segmentation {
        let counts = config.traces.iter().map(|&trace| self.counts(&config.ranging, trace)).collect();
        segment_counts(&self.image(&config.ranging), &self.reference_beams(), &settings(config), counts)
    }

    /// Everything that a fresh segmenter of this configuration, with a table of `areas` live
    /// labels, reports.
    pub fn record<'a>(&'a self, config: impl Into<AnyConfig<'a>>, areas: usize) -> Record {
        let config = config.into();
        let mut room = Room::new(self.columns, config, areas);
        let mut segmenter = AnySegmenter::new(config, self.beams(), self.columns, room.memory()).unwrap();
        let mut record = Record::default();
        self.feed(&mut segmenter, &mut record).unwrap();
        record
    }

    /// Pushes all rows and finishes, until the record breaks off.
    pub fn feed(&self, segmenter: &mut impl Segmenter, record: &mut Record) -> Result<(), PushError> {
        for row in 0..self.turn_rad.len() {
            let status = segmenter.push_row(self.row_m(row), self.turn_rad[row], record)?;
            record.statuses.push(status);
            if status == Status::Stopped {
                return Ok(());
            }
        }
        record.finished = Some(segmenter.finish(record));
        Ok(())
    }
}

/// The settings of the reference that are those of a configuration; thresholds round as in the
/// core.
pub fn settings(config: &EdgeConfig) -> Settings {
    Settings {
        traces: config.traces.iter().map(|&trace| reference_trace(trace)).collect(),
        roof_eighths: (config.roof_angle_rad * (COUNTS_PER_RAD / 2.0)).round_ties_even() as u32,
        step_counts: (config.step_angle_rad * COUNTS_PER_RAD).round_ties_even() as u32,
        step_range_m: 3.0 * std::f32::consts::SQRT_2 * config.ranging.range_noise_m,
        element: match config.closing {
            Element::Plus => ReferenceElement::Plus,
            Element::Square => ReferenceElement::Square,
        },
    }
}

/// The reference's form of a trace.
pub fn reference_trace(trace: Trace) -> ReferenceTrace {
    ReferenceTrace { rows: trace.rows.into(), columns: trace.columns.into() }
}

/// Memory of a segmenter, filled with rubbish.
#[expect(missing_docs)]
pub struct Room {
    pub numbers: Vec<f32>,
    pub halves: Vec<u16>,
    pub words: Vec<u32>,
    pub areas: Vec<Area>,
}

impl Room {
    /// For images of `columns` columns, with a table of `areas` live labels.
    pub fn new<'a>(columns: usize, config: impl Into<AnyConfig<'a>>, areas: usize) -> Room {
        Room::of(config.into().sizes_with(columns, areas))
    }

    /// As much as this.
    pub fn of(sizes: Sizes) -> Room {
        Room {
            numbers: vec![f32::NAN; sizes.numbers],
            halves: vec![0xa5a5; sizes.halves],
            words: vec![0xa5a5_a5a5; sizes.words],
            areas: vec![Area::EMPTY; sizes.areas],
        }
    }

    /// For the `new` of any segmenter.
    pub fn memory(&mut self) -> Memory<'_> {
        let Room { numbers, halves, words, areas } = self;
        Memory { numbers, halves, words, areas }
    }
}

/// What a sink was told.
#[derive(Clone, Debug, PartialEq)]
#[expect(missing_docs)]
pub enum Event {
    Edges { row: usize, edges: Vec<bool> },
    Join(Join),
    Segment(Segment),
    Row { row: usize, pixels: Vec<Pixel> },
}

/// A sink that records everything.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Columns of the image, as rows of labels tell.
    pub columns: usize,
    /// In the order in which they came.
    pub events: Vec<Event>,
    /// What each push returned.
    pub statuses: Vec<Status>,
    /// What `finish` returned.
    pub finished: Option<Finished>,
    /// Break off at the event with this index.
    pub break_at: Option<usize>,
}

impl Record {
    fn take(&mut self, event: Event) -> ControlFlow<()> {
        self.events.push(event);
        if self.break_at == Some(self.events.len() - 1) { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    }

    /// The edges before closing, of an image of `columns` columns.
    pub fn edges(&self, columns: usize) -> Vec<bool> {
        let mut bits = Vec::new();
        for event in &self.events {
            if let Event::Edges { row, edges } = event {
                assert_eq!(*row * columns, bits.len(), "rows of edges in their order");
                // runs do not tell the number of columns
                bits.extend(edges.iter().chain(std::iter::repeat(&false)).take(columns));
                assert!(edges.len() <= columns);
            }
        }
        bits
    }

    /// All pixels.
    pub fn pixels(&self) -> Vec<Pixel> {
        let rows = self.events.iter().filter_map(|event| match event {
            Event::Row { pixels, .. } => Some(pixels.as_slice()),
            _ => None,
        });
        rows.collect::<Vec<_>>().concat()
    }

    /// The label of each pixel's area after all joins; 0 for no area or no label.
    pub fn labels(&self) -> Vec<u32> {
        let mut into = BTreeMap::new();
        for event in &self.events {
            if let Event::Join(join) = event {
                assert!(into.insert(join.from.0, join.into.0).is_none(), "{join:?}: joined before");
            }
        }
        let root = |mut label| {
            while let Some(&next) = into.get(&label) {
                label = next;
            }
            label
        };
        let label = |&pixel: &Pixel| if let Pixel::Segment(Label(label)) = pixel { root(label) } else { 0 };
        self.pixels().iter().map(label).collect()
    }

    /// The segments by label; of those reported more than once the last report.
    pub fn segments(&self) -> BTreeMap<u32, Segment> {
        let segments = self.events.iter().filter_map(|event| match event {
            Event::Segment(segment) => Some((segment.label.0, *segment)),
            _ => None,
        });
        segments.collect()
    }

    /// Unlabelled pixels, row by row.
    pub fn unlabelled(&self, columns: usize) -> Vec<u32> {
        let count = |row: &[Pixel]| row.iter().filter(|&&pixel| pixel == Pixel::Unlabelled).count() as u32;
        self.pixels().chunks(columns).map(count).collect()
    }

    /// Asserts what is promised of the order of events in a scan that was not broken off:
    /// - after row r is pushed come the edges of row r - 1, then joins and segments, then the
    ///   labels of row r - [`MAX_LATENCY_ROWS`];
    /// - labels are 1, 2, 3, ... and a row begins the next ones without a gap;
    /// - a join ends a greater label in favour of a smaller one that lives, and a label that has
    ///   ended comes no more;
    /// - a segment is complete the row after its last one, and every label ends in a join or a
    ///   segment.
    pub fn assert_order(&self, rows: usize) {
        self.assert_order_of(rows, MAX_LATENCY_ROWS, MAX_LATENCY_ROWS);
    }

    /// [`Record::assert_order`] for the region-based approach, where everything of row r comes as
    /// it is pushed.
    pub fn assert_order_of_regions(&self, rows: usize) {
        self.assert_order_of(rows, 0, 1);
    }

    /// `ahead`: rows of edges that have come before the labels of a row, its own among them.
    fn assert_order_of(&self, rows: usize, latency_rows: usize, ahead: usize) {
        let mut done = 0;
        let mut edges = 0;
        let mut begun = 0;
        // the row that has the pixels that decided it; `rows` while finishing
        let mut ended = BTreeMap::new();
        let mut seen = Vec::new();
        let check_seen = |seen: &mut Vec<u32>, begun: &mut u32| {
            seen.sort();
            for label in seen.drain(..) {
                assert!(label <= *begun + 1, "label {label} after {begun}");
                *begun = (*begun).max(label);
            }
        };
        for event in &self.events {
            match event {
                Event::Edges { row, .. } => {
                    assert_eq!(*row, edges);
                    // the labels of row r come before the edges of row r + ahead
                    assert!(seen.is_empty() && done == (edges + 1).saturating_sub(ahead), "edges of {row}");
                    edges += 1;
                }
                Event::Join(Join { from, into }) => {
                    assert!(into < from);
                    assert!(!ended.contains_key(into), "{into} lives");
                    assert!(ended.insert(*from, done).is_none(), "{from} lives");
                    seen.extend([from.0, into.0]);
                }
                Event::Segment(segment) => {
                    assert!(segment.label.0 <= begun && done > 0);
                    assert_eq!(usize::from(segment.last_row), done - 1, "{segment:?}");
                    assert!(ended.insert(segment.label, done).is_none(), "{segment:?}: ended before");
                }
                Event::Row { row, pixels } => {
                    assert_eq!(*row, done);
                    assert!(edges == (done + ahead).min(rows), "labels of row {row} after edges of {edges}");
                    for pixel in pixels {
                        if let Pixel::Segment(label) = pixel {
                            assert!(!ended.contains_key(label), "row {row}: {label} lives");
                            seen.push(label.0);
                        }
                    }
                    check_seen(&mut seen, &mut begun);
                    done += 1;
                }
            }
        }
        assert!((edges, done) == (rows, rows) && seen.is_empty());
        assert_eq!(ended.len(), begun as usize, "every label ends once");
        let unlabelled = if rows > 0 { self.unlabelled(self.columns) } else { Vec::new() };
        let expected = |row: usize| match row.checked_sub(latency_rows) {
            None => Status::Buffered,
            Some(row) => Status::Labelled { row, unlabelled: unlabelled[row] },
        };
        assert_eq!(self.statuses, (0..rows).map(expected).collect::<Vec<_>>());
        let unlabelled = unlabelled.iter().sum();
        assert_eq!(self.finished, Some(Finished::Complete { rows, unlabelled }));
    }
}

impl Sink for Record {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.columns = row.columns();
        let pixels: Vec<_> = row.pixels().collect();
        // the two views of a row agree
        let mut from_runs = vec![None; row.columns()];
        for (run, label) in row.runs() {
            from_runs[run].fill(Some(label.map_or(Pixel::Unlabelled, Pixel::Segment)));
        }
        for (pixel, from_run) in pixels.iter().zip(from_runs) {
            let area = matches!(pixel, Pixel::Segment(_) | Pixel::Unlabelled).then_some(*pixel);
            assert_eq!(area, from_run, "row {}", row.row());
        }
        self.take(Event::Row { row: row.row(), pixels })
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.take(Event::Join(join))
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.take(Event::Segment(*segment))
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        let mut edges = Vec::new();
        for run in row.runs() {
            edges.resize(run.start, false);
            edges.resize(run.end, true);
        }
        self.take(Event::Edges { row: row.row(), edges })
    }
}

/// The class of a reported pixel.
pub fn class(pixel: Pixel) -> Class {
    match pixel {
        Pixel::NoReturn => Class::NoReturn,
        Pixel::Edge => Class::Edge,
        Pixel::Segment(_) | Pixel::Unlabelled => Class::Area,
    }
}
