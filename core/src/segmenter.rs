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
use crate::bits::{CHUNK, load, mask, pack, store, words};
use crate::closing::Shape;
use crate::config::{Config, MAX_TRACE_ROWS};
use crate::edge::{Halo, Thresholds, eighth, is_step, roofs};
use crate::error::{ConfigError, PushError};
use crate::event::{EdgeRow, LabelRow, Sink};
use crate::label::{Labels, frontier_words};
use crate::memory::{Memory, Sizes};
use crate::plane::Moments;

/// Rows between the row pushed and the row whose labels it decides.
pub const LATENCY_ROWS: usize = 3;

/// The most columns of an image.
pub const MAX_COLUMNS: usize = 16_384;

/// The most rows of a scan.
pub const MAX_ROWS: usize = 65_535;

/// What [`EdgeSegmenter::push_row`] did, and what to do next.
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
    /// Per trace the bearing angles, in eighths, of two rows: row q at q % 2.
    bearings: &'a mut [u16],
    bits: BitRows<'a>,
    labels: Labels<'a>,
}

impl<'a> EdgeSegmenter<'a> {
    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`]. Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too small.
    pub fn new(config: Config<'a>, beams: Beams<'a>, columns: usize, memory: Memory<'a>) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        let needed = Sizes::of(columns, &config);
        for (field, needed, got) in [
            ("ranges", needed.ranges, memory.ranges.len()),
            ("bearings", needed.bearings, memory.bearings.len()),
            ("words", needed.words, memory.words.len()),
            ("areas", 1, memory.areas.len()),
        ] {
            if got < needed {
                return Err(ConfigError::Memory { field, needed, got });
            }
        }
        let ranges = &mut memory.ranges[..needed.ranges];
        let bearings = &mut memory.bearings[..needed.bearings];
        let (frontier, rest) = memory.words.split_at_mut(frontier_words(columns));
        let mut rows = rest.chunks_exact_mut(words(columns));
        let mut row = || rows.next().unwrap_or_default();
        let bits = BitRows {
            steps: row(),
            edges: [row(), row(), row()],
            dilated: [row(), row(), row()],
            returns: row(),
            areas: [row(), row()],
        };
        let labels = Labels::new(memory.areas, frontier);
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
        self.bearings.fill(0);
        let [areas, earlier] = &mut self.bits.areas;
        for row in [&mut *self.bits.steps, areas, earlier] {
            row.fill(0);
        }
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
        let columns = self.shape.columns;
        if ranges_m.len() != columns {
            return Err(PushError::RowLength { expected: columns, got: ranges_m.len() });
        }
        // turn angles of 1000 turns still have a resolution of 0.03 deg; NaN is not within
        if !(-6300.0..=6300.0).contains(&turn_rad) {
            return Err(PushError::TurnAngle { turn_rad });
        }
        if self.rows == MAX_ROWS {
            return Err(PushError::TooManyRows);
        }
        let row = self.rows;
        self.rows += 1;
        let turns = self.turns_rad.len();
        self.turns_rad[row % turns] = turn_rad;
        for index in 0..self.config.traces.len() {
            self.trace_row(index, row, Some(ranges_m));
        }
        let done = self.decide(row, sink);
        let stored = self.stored(row);
        for (to, &range_m) in self.ranges[stored].iter_mut().zip(ranges_m) {
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
        for row in self.rows..self.rows + LATENCY_ROWS {
            if row == self.rows {
                for index in 0..self.config.traces.len() {
                    self.trace_row(index, row, None);
                }
            }
            self.decide(row, sink)?;
        }
        self.labels.finish(sink)
    }

    /// Where the ranges of a row are stored.
    fn stored(&self, row: usize) -> Range<usize> {
        let rows = self.ranges.len() / self.shape.columns;
        let start = row % rows * self.shape.columns;
        start..start + self.shape.columns
    }

    fn beam(&self, row: usize) -> RowBeam {
        RowBeam { row, turn_rad: self.turns_rad[row % self.turns_rad.len()] }
    }

    /// Bearing angles of row `row` along one trace, and with them the roof edges of the row before. `now` is `None` for
    /// the row below the image.
    fn trace_row(&mut self, index: usize, row: usize, now: Option<&[f32]>) {
        let Shape { columns, wraps, .. } = self.shape;
        let trace = self.config.traces[index];
        let before = row.checked_sub(usize::from(trace.rows));
        let lanes = TraceRow::new(&self.fan, trace, self.beam(row), self.beam(before.unwrap_or(row)), columns);
        let before = match before {
            Some(before) if trace.rows > 0 => Some(&self.ranges[self.stored(before)]),
            // above the image
            None => Some(&[][..]),
            _ => None,
        };
        let config = self.config;
        let mut bearings = Bearings { config: &config, thresholds: self.thresholds, lanes, now, before };

        let (even, odd) = self.bearings[2 * index * columns..][..2 * columns].split_at_mut(columns);
        // rows r - 1 and r - 2; row r takes the place of r - 2 once that was used
        let (centre_row, above_row) = if row.is_multiple_of(2) { (&*odd, even) } else { (&*even, odd) };
        let BitRows { steps: step_row, edges, .. } = &mut self.bits;
        // before row 0 there is no row, and what is found for it is not used
        let edge_row = &mut *edges[(row + 2) % 3];
        let chunks = words(columns);
        let last = columns - 1;

        // the columns beyond the left and right ends, of (above, centre, below)
        let mut left = [0; 3];
        let mut beyond = [0; 3];
        let mut next = [0; CHUNK];
        if wraps {
            bearings.chunk(last / CHUNK, &mut next);
            left = [above_row[last], centre_row[last], next[last % CHUNK]];
        }
        let mut next_steps = bearings.chunk(0, &mut next);
        if wraps {
            beyond = [above_row[0], centre_row[0], next[0]];
        }
        for chunk in 0..chunks {
            let from = chunk * CHUNK;
            let here = (columns - from).min(CHUNK);
            let steps = next_steps & mask(chunk, columns);
            let mut below = [0; CHUNK + 2];
            below[1..=CHUNK].copy_from_slice(&next);
            let mut right = beyond;
            if chunk + 1 < chunks {
                next_steps = bearings.chunk(chunk + 1, &mut next);
                right = [above_row[from + CHUNK], centre_row[from + CHUNK], next[0]];
            }
            let above = halo(left[0], above_row, from, right[0], here);
            let centre = halo(left[1], centre_row, from, right[1], here);
            (below[0], below[here + 1]) = (left[2], right[2]);
            left = [above[here], centre[here], below[here]];
            let roofs = roofs(&above, &centre, &below, &self.thresholds) & mask(chunk, columns);
            if index == 0 {
                edge_row[chunk] = roofs | step_row[chunk];
                step_row[chunk] = steps;
            } else {
                edge_row[chunk] |= roofs;
                step_row[chunk] |= steps;
            }
            store(above_row, from, &below[1..]);
        }
    }

    /// Closing and labels for the rows that row `row` decides. Gives the unlabelled pixels of row `row - LATENCY_ROWS`,
    /// or `None` where there is no such row yet.
    fn decide<S: Sink>(&mut self, row: usize, sink: &mut S) -> ControlFlow<(), Option<u32>> {
        let columns = self.shape.columns;
        let rows = self.rows;
        let BitRows { edges, dilated, returns, areas, .. } = &mut self.bits;
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
        let (even, odd) = areas.split_at_mut(1);
        let (current, before) =
            if done.is_multiple_of(2) { (&mut *even[0], &*odd[0]) } else { (&mut *odd[0], &*even[0]) };
        let above = within(done.checked_sub(1)).map(|i| &*dilated[i]);
        let below = within(Some(done + 1)).map(|i| &*dilated[i]);
        self.shape.erode(above, &*dilated[done % 3], below, current);
        let stored = done % (self.ranges.len() / columns) * columns;
        let ranges = &self.ranges[stored..stored + columns];
        for (chunk, (area, returns)) in current.iter_mut().zip(returns.iter_mut()).enumerate() {
            *returns = pack(&load(ranges, chunk * CHUNK, &mut [0.0; CHUNK]).map(|range_m| range_m > 0.0));
            *area = !*area & *returns;
        }
        let at = RowBeam { row: done, turn_rad: self.turns_rad[done % self.turns_rad.len()] };
        let frame = self.fan.frame(at);
        let mut points = RowPoints { fan: &self.fan, frame, ranges, chunk: usize::MAX, points: [[0; CHUNK]; 3] };
        let moments = |run| points.moments(run);
        let unlabelled = self.labels.label_row(done, before, current, &self.shape, moments, sink)?;
        self.unlabelled = self.unlabelled.saturating_add(unlabelled);
        sink.row(&LabelRow { row: done, columns, returns, areas: current, labels: &self.labels })?;
        ControlFlow::Continue(Some(unlabelled))
    }
}

/// The chunk of `here` columns that starts at column `from`, with the columns beside it.
#[inline(always)]
fn halo(left: u16, row: &[u16], from: usize, right: u16, here: usize) -> Halo {
    let mut halo = [0; CHUNK + 2];
    halo[1..=CHUNK].copy_from_slice(load(row, from, &mut [0; CHUNK]));
    (halo[0], halo[here + 1]) = (left, right);
    halo
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
            *eighths = [0; CHUNK];
            return 0;
        };
        // arrays and thresholds of its own, so that the compiler need not look whether slices overlap
        let (mut out, mut steps, thresholds) = ([0; CHUNK], [false; CHUNK], self.thresholds);
        self.lanes.chunk(chunk * CHUNK, now, self.before.unwrap_or(now), self.config, |i, now_m, before_m, count| {
            out[i] = eighth(count);
            steps[i] = is_step(count, now_m, before_m, &thresholds);
        });
        *eighths = out;
        pack(&steps)
    }
}

/// The points of a row, chunk by chunk.
struct RowPoints<'a> {
    fan: &'a Fan<'a>,
    frame: Frame,
    ranges: &'a [f32],
    /// The chunk that `points` holds.
    chunk: usize,
    points: [[i32; CHUNK]; 3],
}

impl RowPoints<'_> {
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
