//! The edge-based segmenter: rows in, labels and segments out (paper section 4).
//!
//! ```text
//! row r arrives
//!   bearing angles of row r           (needs the row that each trace reaches back to)
//!   roof and step edges of row r - 1  (Sobel needs three rows of bearing angles)
//!   dilation of row r - 2
//!   erosion of row r - 3              -> labels, joins, complete segments of row r - 3
//! ```

use core::ops::{ControlFlow, Range};

use crate::beam::{Beams, Fan, Frame, RowBeam};
use crate::bearing::TraceRow;
use crate::bits::{CHUNK, load, mask, pack, runs, words};
use crate::closing::Shape;
use crate::config::{Config, MAX_TRACE_ROWS};
use crate::edge::{GAP, Sobel, Thresholds, bearings};
use crate::error::{ConfigError, PushError};
use crate::event::{EdgeRow, LabelRow, RunLabels, Sink};
use crate::label::{Growth, Labels, frontier_words};
use crate::memory::{Memory, padded_row};
use crate::plane::Moments;
use crate::within::{at, part, part_mut, split_mut};

/// Rows between the row pushed and the row whose labels it decides, of [`EdgeSegmenter`]; no approach needs more.
pub const LATENCY_ROWS: usize = 3;

/// The most columns of an image.
pub const MAX_COLUMNS: usize = 16_384;

/// The most rows of a scan.
pub const MAX_ROWS: usize = 65_535;

/// What `push_row` of a segmenter did, and what to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// The row is stored; no labels yet. Push the next row.
    Buffered,
    /// The sink was given the labels of `row`. Push the next row, or finish.
    Labelled {
        /// The row that was given out.
        row: usize,
        /// Pixels in it that got no label because the table of live labels was full. Nothing to do for this scan; give
        /// the next one a larger table.
        unlabelled: u32,
    },
    /// The sink broke off. The scan is dropped; the next row pushed is the first of a new scan.
    Stopped,
}

/// How a scan ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Finished {
    /// All rows were given out. The next row pushed is the first of a new scan.
    Complete {
        /// Rows of the scan.
        rows: usize,
        /// Pixels that got no label because the table of live labels was full.
        unlabelled: u32,
    },
    /// The sink broke off. What was left is dropped.
    Stopped,
}

/// Whether row number `row` of an image can be taken.
pub(crate) fn check_row(ranges_m: &[f32], turn_rad: f32, row: usize, columns: usize) -> Result<(), PushError> {
    if ranges_m.len() != columns {
        return Err(PushError::RowLength { expected: columns, got: ranges_m.len() });
    }
    // turn angles of 1000 turns still have a resolution of 0.03 deg; NaN is not within
    if !(-6300.0..=6300.0).contains(&turn_rad) {
        return Err(PushError::TurnAngle { turn_rad });
    }
    if row == MAX_ROWS { Err(PushError::TooManyRows) } else { Ok(()) }
}

/// The rows of a ring of three, from row `row` on.
fn ring<T>(rows: [T; 3], row: usize) -> [T; 3] {
    let [a, b, c] = rows;
    match row % 3 {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    }
}

/// Packed rows, as they are used when row r arrives.
struct BitRows<'a> {
    /// Step edges of row r - 1, then of row r.
    steps: &'a mut [u32],
    /// Edges of rows r - 1, r - 2, r - 3; row q at q % 3.
    edges: [&'a mut [u32]; 3],
    /// Dilated edges of rows r - 2, r - 3, r - 4; row q at q % 3.
    dilated: [&'a mut [u32]; 3],
    /// Pixels of row r - 3 with a return.
    returns: &'a mut [u32],
    /// Area pixels of rows r - 3 and r - 4; row q at q % 2.
    areas: [&'a mut [u32]; 2],
}

impl<'a> BitRows<'a> {
    fn of(bits: &'a mut [u32], columns: usize) -> Self {
        let mut rows = bits.chunks_exact_mut(words(columns).max(1));
        let mut row = || rows.next().unwrap_or_default();
        Self {
            steps: row(),
            edges: [row(), row(), row()],
            dilated: [row(), row(), row()],
            returns: row(),
            areas: [row(), row()],
        }
    }
}

/// Segments a scan while it comes in, row by row, by the edges in its bearing-angle images.
///
/// ```
/// use core::ops::ControlFlow;
/// use scanseg_core::{Beams, Columns, Config, EdgeSegmenter, LabelRow, Segment, Sink, TurnAxis, buffers};
///
/// struct Print;
/// impl Sink for Print {
///     fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
///         ControlFlow::Continue(())
///     }
///     fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
///         println!("{}: {} pixels, {:?}", segment.label, segment.pixels(), segment.plane());
///         ControlFlow::Continue(())
///     }
/// }
///
/// const CONFIG: Config = Config::paper();
/// let columns = Columns::Even { start_rad: -0.5, step_rad: 0.01 };
/// let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
/// let mut buffers = <buffers!(101, CONFIG)>::EMPTY;
/// let mut segmenter = EdgeSegmenter::new(CONFIG, beams, 101, buffers.memory())?;
/// for row in 0..50 {
///     segmenter.push_row(&[2.0; 101], 0.01 * row as f32, &mut Print)?;
/// }
/// segmenter.finish(&mut Print);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct EdgeSegmenter<'a> {
    config: Config<'a>,
    thresholds: Thresholds,
    fan: Fan<'a>,
    shape: Shape,
    /// Rows pushed in this scan.
    rows: usize,
    unlabelled: u32,
    /// Turn angle of row q at q % len.
    turns_rad: [f32; MAX_TRACE_ROWS as usize + 1],
    /// Ranges of the last rows, row q at q % stored rows; 0 for no return.
    ranges: &'a mut [f32],
    /// Per trace the bearing angles, in eighths, of two rows: row q at q % 2; where the image wraps, the first column also beyond
    /// the last.
    bearings: &'a mut [u16],
    /// See [`BitRows`].
    bits: &'a mut [u32],
    labels: Labels<'a>,
}

impl<'a> EdgeSegmenter<'a> {
    /// Rows between the row pushed and the row whose labels it decides.
    pub const LATENCY_ROWS: usize = LATENCY_ROWS;

    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`]. Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too small.
    pub fn new(config: Config<'a>, beams: Beams<'a>, columns: usize, memory: Memory<'a>) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        let needed = memory.check(columns, &config)?;
        let ranges = part_mut(memory.ranges, 0..needed.ranges);
        let bearings = part_mut(memory.bearings, 0..needed.bearings);
        let (frontier, bits) = split_mut(part_mut(memory.words, 0..needed.words), frontier_words(columns));
        let labels = Labels::new(memory.areas, frontier, config.max_range_m);
        let shape = Shape { columns, wraps: fan.wraps(), element: config.closing };
        let thresholds = Thresholds::new(&config);
        let turns_rad = [0.0; MAX_TRACE_ROWS as usize + 1];
        let mut segmenter =
            Self { config, thresholds, fan, shape, rows: 0, unlabelled: 0, turns_rad, ranges, bearings, bits, labels };
        segmenter.reset();
        Ok(segmenter)
    }

    /// Drops what was pushed; the next row is the first of a new scan. [`EdgeSegmenter::finish`] does this by itself.
    pub fn reset(&mut self) {
        self.rows = 0;
        self.unlabelled = 0;
        self.bearings.fill(GAP);
        self.bits.fill(0);
        self.labels.reset();
    }

    /// Takes the next row: one range per column in metres, and the row's turn angle (nodding) or elevation (spinning) in
    /// radians; pinhole beams do not use it. NaN, infinite and non-positive ranges, and those outside of the configured
    /// limits, are pixels without a return.
    ///
    /// Gives the sink the labels of the row [`LATENCY_ROWS`] earlier, and the joins and segments that it brings. Work is
    /// linear in the columns; nothing allocates or blocks.
    ///
    /// # Errors
    /// [`PushError`]: the row was not taken and the segmenter is as it was before.
    pub fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
        check_row(ranges_m, turn_rad, self.rows, self.shape.columns)?;
        let row = self.rows;
        self.rows += 1;
        let turns = self.turns_rad.len();
        self.turns_rad[row % turns] = turn_rad;
        for index in 0..self.config.traces.len() {
            self.trace_row(index, row, Some(ranges_m));
        }
        let done = self.decide(row, sink);
        let stored = self.stored(row);
        for (to, &range_m) in part_mut(self.ranges, stored).iter_mut().zip(ranges_m) {
            *to = self.config.clean(range_m);
        }
        Ok(match done {
            ControlFlow::Continue(None) => Status::Buffered,
            ControlFlow::Continue(Some(unlabelled)) => Status::Labelled { row: row - LATENCY_ROWS, unlabelled },
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    /// Ends the scan: gives out the rows that were still waiting and completes all segments. The next row pushed is the
    /// first of a new scan.
    pub fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        let rows = self.rows;
        let ended = self.drain(sink);
        let unlabelled = self.unlabelled;
        self.reset();
        match ended {
            ControlFlow::Continue(()) => Finished::Complete { rows, unlabelled },
            ControlFlow::Break(()) => Finished::Stopped,
        }
    }

    fn drain(&mut self, sink: &mut impl Sink) -> ControlFlow<()> {
        for index in 0..self.config.traces.len() {
            self.trace_row(index, self.rows, None);
        }
        for row in self.rows..self.rows + LATENCY_ROWS {
            self.decide(row, sink)?;
        }
        self.labels.finish(sink)
    }

    /// Where the ranges of a row are stored.
    fn stored(&self, row: usize) -> Range<usize> {
        // neither is 0, which the compiler does not know
        let rows = self.ranges.len() / self.shape.columns.max(1);
        let start = row % rows.max(1) * self.shape.columns;
        start..start + self.shape.columns
    }

    fn beam(&self, row: usize) -> RowBeam {
        RowBeam { row, turn_rad: self.turns_rad[row % self.turns_rad.len()] }
    }

    /// Bearing angles of row `row` along one trace, and with them the roof edges of the row before. `now` is `None` for
    /// the row below the image.
    fn trace_row(&mut self, index: usize, row: usize, now: Option<&[f32]>) {
        let Shape { columns, wraps, .. } = self.shape;
        let Some(&trace) = self.config.traces.get(index) else { return };
        let before = row.checked_sub(usize::from(trace.rows));
        let lanes = TraceRow::new(&self.fan, trace, self.beam(row), self.beam(before.unwrap_or(row)), columns);
        let before = match before {
            Some(before) if trace.rows > 0 => Some(part(self.ranges, self.stored(before))),
            // above the image
            None => Some(&[][..]),
            _ => None,
        };
        let config = self.config;
        let mut bearings = Bearings { config: &config, thresholds: self.thresholds, lanes, now, before };

        let mut rows = self.bearings.chunks_exact_mut(padded_row(columns).max(1)).skip(2 * index);
        let (Some(even), Some(odd)) = (rows.next(), rows.next()) else { return };
        // rows r - 1 and r - 2; row r takes the place of r - 2
        let (centre, above) = if row.is_multiple_of(2) { (odd, even) } else { (even, odd) };
        let BitRows { steps, edges, .. } = BitRows::of(self.bits, columns);
        // before row 0 there is no row, and what is found for it is not used
        let [edges, ..] = ring(edges, row + 2);
        if index == 0 {
            for (edges, steps) in edges.iter_mut().zip(&mut *steps) {
                *edges = core::mem::take(steps);
            }
        }
        let (last, beyond) = ((columns - 1) / CHUNK, columns % CHUNK);
        let mut below = [GAP; CHUNK];
        let mut left = [GAP; 3];
        if wraps {
            bearings.chunk(last, &mut below);
            let at = |row: &[u16]| row.get(columns - 1).copied().unwrap_or(GAP);
            left = [at(above), at(centre), below[(columns - 1) % CHUNK]];
        }
        let mut sobel = Sobel::new(&self.thresholds, left);
        let mut first = GAP;
        let mut waiting: Option<(&mut u32, u32)> = None;
        let (mut edges, mut steps) = (edges.iter_mut(), steps.iter_mut());
        let rows = above.as_chunks_mut::<CHUNK>().0.iter_mut().zip(centre.as_chunks::<CHUNK>().0);
        for (chunk, (above, centre)) in rows.enumerate() {
            let step_word = bearings.chunk(chunk, &mut below) & mask(chunk, columns);
            if chunk == 0 {
                first = below[0];
            }
            if wraps && chunk == columns / CHUNK {
                // the column beyond the last is the first
                below[beyond] = first;
            }
            let roofs = sobel.next(above, centre, &below);
            *above = below;
            if let Some((word, roofs_left)) = waiting.take() {
                *word |= roofs_left | (roofs << (CHUNK - 1));
            }
            if let (Some(edges), Some(steps)) = (edges.next(), steps.next()) {
                *steps |= step_word;
                waiting = Some((edges, (roofs >> 1) & mask(chunk, columns)));
            }
        }
        if let Some((word, roofs)) = waiting {
            *word |= roofs;
        }
    }

    /// Closing and labels for the rows that row `row` decides. Gives the unlabelled pixels of row `row - LATENCY_ROWS`,
    /// or `None` where there is no such row yet.
    fn decide<S: Sink>(&mut self, row: usize, sink: &mut S) -> ControlFlow<(), Option<u32>> {
        let columns = self.shape.columns;
        let rows = self.rows;
        let BitRows { edges, dilated, .. } = BitRows::of(self.bits, columns);
        if let Some(edge) = row.checked_sub(1).filter(|&edge| edge < rows) {
            sink.edges(&EdgeRow { row: edge, columns, words: edges[edge % 3] })?;
        }
        let within = |row: Option<usize>| row.filter(|&row| row < rows).map(|row| row % 3);
        if let Some(centre) = row.checked_sub(2).filter(|&centre| centre < rows) {
            let above = within(centre.checked_sub(1)).map(|i| &*edges[i]);
            let below = within(Some(centre + 1)).map(|i| &*edges[i]);
            self.shape.dilate(above, &*edges[centre % 3], below, dilated[centre % 3]);
        }
        let Some(done) = row.checked_sub(LATENCY_ROWS) else { return ControlFlow::Continue(None) };
        if done >= rows {
            return ControlFlow::Continue(None);
        }
        let (ranges, frame) = (part(self.ranges, self.stored(done)), self.fan.frame(self.beam(done)));
        let BitRows { dilated, returns, mut areas, .. } = BitRows::of(self.bits, columns);
        let (even, odd) = areas.split_at_mut(1);
        let (current, before) =
            if done.is_multiple_of(2) { (&mut *even[0], &*odd[0]) } else { (&mut *odd[0], &*even[0]) };
        let above = within(done.checked_sub(1)).map(|i| &*dilated[i]);
        let below = within(Some(done + 1)).map(|i| &*dilated[i]);
        self.shape.erode(above, &*dilated[done % 3], below, current);
        let mut copy = [0.0; CHUNK];
        for (chunk, (area, returns)) in current.iter_mut().zip(returns.iter_mut()).enumerate() {
            let ranges = load(ranges, chunk * CHUNK, &mut copy);
            *returns = pack(&ranges.map(|range_m| range_m.to_bits() != 0));
            *area = !*area & *returns;
        }
        let mut points = RowPoints { fan: &self.fan, frame, ranges, chunk: usize::MAX, points: [[0; CHUNK]; 3] };
        let last = columns - 1;
        let seam = self.shape.wraps && at(current, 0) & at(current, last / CHUNK) >> (last % CHUNK) & 1 == 1;
        let (above, here) = (runs(before, columns), runs(current, columns));
        let unlabelled = self.labels.label_row(done, above, here, seam, &mut points, sink)?;
        self.unlabelled = self.unlabelled.saturating_add(unlabelled);
        let labels = RunLabels::Runs { areas: current, starts: &[], labels: &self.labels };
        sink.row(&LabelRow { row: done, columns, returns, labels })?;
        ControlFlow::Continue(Some(unlabelled))
    }
}

/// Bearing angles of a row along one trace, chunk by chunk.
struct Bearings<'a> {
    config: &'a Config<'a>,
    thresholds: Thresholds,
    lanes: TraceRow<'a>,
    /// The row, as it was pushed; `None` below the image.
    now: Option<&'a [f32]>,
    /// The row that the trace reaches back to; `None` for this row, empty above the image.
    before: Option<&'a [f32]>,
}

impl Bearings<'_> {
    /// Bearing angles of a chunk in eighths; returns its step edges, packed.
    #[inline(always)]
    fn chunk(&mut self, chunk: usize, eighths: &mut [u16; CHUNK]) -> u32 {
        let Some(now) = self.now.filter(|_| self.before.is_none_or(|before| !before.is_empty())) else {
            *eighths = [GAP; CHUNK];
            return 0;
        };
        let pairs = self.lanes.chunk(chunk * CHUNK, now, self.before.unwrap_or(now));
        bearings(&pairs, self.config, &self.thresholds, eighths)
    }
}

/// The points of a row, chunk by chunk.
pub(crate) struct RowPoints<'a> {
    pub fan: &'a Fan<'a>,
    pub frame: Frame,
    pub ranges: &'a [f32],
    /// The chunk that `points` holds.
    pub chunk: usize,
    pub points: [[i32; CHUNK]; 3],
}

impl Growth for RowPoints<'_> {
    const TAKES_ALL: bool = true;

    fn moments(&mut self, run: Range<usize>) -> Moments {
        let mut moments = Moments::default();
        let mut column = run.start;
        while column < run.end {
            let chunk = column / CHUNK;
            let from = chunk * CHUNK;
            if self.chunk != chunk {
                self.fan.points(&self.frame, from, load(self.ranges, from, &mut [0.0; CHUNK]), &mut self.points);
                self.chunk = chunk;
            }
            let end = run.end.min(from + CHUNK);
            moments.add_points(&self.points, column - from, end - from);
            column = end;
        }
        moments
    }
}
