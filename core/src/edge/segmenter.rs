//! The edge-based segmenter: rows in, labels and segments out (paper section 4).
//!
//! ```text
//! row r arrives
//!   bearing angles of row r           (needs the row that each trace reaches back to)
//!   roof and step edges of row r - 1  (Sobel needs three rows of bearing angles)
//!   dilation of row r - 2
//!   erosion of row r - 3              -> labels, joins, complete segments of row r - 3
//! ```
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::fmt;
use core::ops::{ControlFlow, Range};

use crate::beam::Beams;
use crate::config::Ranging;
use crate::edge::bearing::TraceRow;
use crate::edge::closing::Shape;
use crate::edge::config::EdgeConfig;
use crate::edge::rows::{BitRows, LATENCY_ROWS, StoredRows, padded_row, ring, stored_row};
use crate::edge::sobel::{GAP, Sobel, Thresholds, bearings};
use crate::error::{ConfigError, PushError};
use crate::label::{Growth, Labels, frontier_words};
use crate::memory::Memory;
use crate::moments::Moments;
use crate::row::bits::{CHUNK, load, mask, pack, runs};
use crate::row::fan::{Fan, RowBeam};
use crate::row::points::RowPoints;
use crate::row::within::{at, part_mut, split_mut};
use crate::row_beams::RowBeams;
use crate::scan::{Finished, Progress, Segmenter, Status};
use crate::sink::{EdgeRow, LabelRow, RowSlots, Sink};

/// Segments a scan while it comes in, row by row, by the edges in its bearing-angle images.
///
/// The [crate's front page](crate) has a whole program; with this configuration it is the same:
///
/// ```
/// use scanseg_core::{Beams, Columns, ConfigError, EdgeConfig, EdgeSegmenter, TurnAxis, buffers};
///
/// const CONFIG: EdgeConfig = EdgeConfig::paper();
///
/// fn main() -> Result<(), ConfigError> {
///     let columns = Columns::Even { start_rad: -0.9, step_rad: 0.01 };
///     let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
///     let mut buffers = <buffers!(181, CONFIG)>::EMPTY;
///     let segmenter = EdgeSegmenter::new(CONFIG, beams, 181, buffers.memory())?;
///     println!("{segmenter:?}");
///     Ok(())
/// }
/// ```
pub struct EdgeSegmenter<'a> {
    config: EdgeConfig<'a>,
    thresholds: Thresholds,
    fan: Fan<'a>,
    shape: Shape,
    progress: Progress,
    rows: StoredRows<'a>,
    /// Per trace the bearing angles, in eighths, of two rows: row q at q % 2; where the image
    /// wraps, the first column also beyond the last.
    bearings: &'a mut [u16],
    /// See [`BitRows`].
    bits: &'a mut [u32],
    labels: Labels<'a>,
}

impl fmt::Debug for EdgeSegmenter<'_> {
    /// Writes what is set and how far the scan has come, not the memory.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("EdgeSegmenter")
            .field("config", &self.config)
            .field("columns", &self.shape.columns)
            .field("rows", &self.progress.rows)
            .finish_non_exhaustive()
    }
}

impl Segmenter for EdgeSegmenter<'_> {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> Result<Status, PushError> {
        let ranging = self.config.ranging;
        let beam = self.progress.begin_row(ranges_m, beams.into(), self.shape.columns, (&self.fan, &ranging))?;
        let row = beam.row;
        for index in 0..self.config.traces.len() {
            self.trace_row(index, row, Some((ranges_m, beam)));
        }
        let done = self.decide(row, sink);
        self.rows.keep(&beam, ranges_m.iter().map(|&range_m| ranging.clean(range_m)));
        Ok(match done {
            ControlFlow::Continue(None) => Status::Buffered,
            ControlFlow::Continue(Some(unlabelled)) => Status::Labelled { row: row - LATENCY_ROWS, unlabelled },
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished {
        let ended = self.drain(sink);
        let finished = self.progress.finished(ended);
        self.reset();
        finished
    }

    fn reset(&mut self) {
        self.progress = Progress::default();
        self.bearings.fill(GAP);
        self.bits.fill(0);
        self.labels.reset();
    }

    fn latency_rows(&self) -> usize {
        LATENCY_ROWS
    }
}

impl<'a> EdgeSegmenter<'a> {
    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`](crate::MAX_COLUMNS).
    /// Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too
    /// small.
    pub fn new(
        config: EdgeConfig<'a>,
        beams: Beams<'a>,
        columns: usize,
        memory: Memory<'a>,
    ) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        let needed = config.sizes_for(&beams, columns);
        memory.check(&needed)?;
        let stride = stored_row(columns, matches!(beams, Beams::Free { .. }));
        let rows = StoredRows::new(part_mut(memory.numbers, 0..needed.numbers), columns, stride);
        let bearings = part_mut(memory.halves, 0..needed.halves);
        let (frontier, bits) = split_mut(part_mut(memory.words, 0..needed.words), frontier_words(columns));
        let labels = Labels::new(memory.areas, frontier, config.ranging.max_range_m);
        let shape = Shape { columns, wraps: fan.wraps(), element: config.closing };
        let thresholds = Thresholds::new(&config);
        let mut segmenter =
            Self { config, thresholds, fan, shape, progress: Progress::default(), rows, bearings, bits, labels };
        segmenter.reset();
        Ok(segmenter)
    }

    fn drain<S: Sink + ?Sized>(&mut self, sink: &mut S) -> ControlFlow<()> {
        let rows = self.progress.rows;
        for index in 0..self.config.traces.len() {
            self.trace_row(index, rows, None);
        }
        for row in rows..rows + LATENCY_ROWS {
            self.decide(row, sink)?;
        }
        self.labels.finish(sink)
    }

    /// Bearing angles of row `row` along one trace, and with them the roof edges of the row before.
    /// `now` is `None` for the row below the image.
    fn trace_row(&mut self, index: usize, row: usize, now: Option<(&[f32], RowBeam)>) {
        let Shape { columns, wraps, .. } = self.shape;
        let Some(&trace) = self.config.traces.get(index) else { return };
        let kept = |row: usize| self.rows.row(row);
        // below the image the beams do not matter
        let here = now.map_or_else(|| kept(row).1, |(_, beam)| beam);
        let (before, beam) = match row.checked_sub(usize::from(trace.rows)) {
            Some(before) if trace.rows > 0 => {
                let (ranges_m, beam) = kept(before);
                (Some(ranges_m), beam)
            }
            // above the image
            None => (Some(&[][..]), here),
            _ => (None, here),
        };
        let lanes = TraceRow::new(&self.fan, trace, [here, beam], columns);
        let (ranging, now) = (self.config.ranging, now.map(|(ranges_m, _)| ranges_m));
        let bearings = Bearings { ranging: &ranging, thresholds: self.thresholds, lanes, now, before };

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
        bearings.find_edges(columns, wraps, above, centre, edges, steps);
    }

    /// Closes and labels the rows that row `row` decides. Returns the unlabelled pixels of row
    /// `row - LATENCY_ROWS`, or `None` where there is no such row yet.
    fn decide<S: Sink + ?Sized>(&mut self, row: usize, sink: &mut S) -> ControlFlow<(), Option<u32>> {
        let columns = self.shape.columns;
        let rows = self.progress.rows;
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
        let (ranges, beam) = self.rows.row(done);
        let frame = self.fan.frame(beam);
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
        let mut points = RowPoints::new(&self.fan, frame, ranges);
        let last = columns - 1;
        let seam = self.shape.wraps && at(current, 0) & at(current, last / CHUNK) >> (last % CHUNK) & 1 == 1;
        let (above, here) = (runs(before, columns), runs(current, columns));
        let unlabelled = self.labels.label_row(done, above, here, seam, &mut points, sink)?;
        self.progress.labelled(unlabelled);
        let (table, slots) = self.labels.labelled();
        let slots = RowSlots::Runs { areas: current, starts: &[], slots };
        sink.row(&LabelRow { row: done, columns, returns, slots, table })?;
        ControlFlow::Continue(Some(unlabelled))
    }
}

/// Bearing angles of a row along one trace, chunk by chunk.
struct Bearings<'a> {
    ranging: &'a Ranging,
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
        bearings(&pairs, self.ranging, &self.thresholds, eighths)
    }

    /// Adds the step edges of the row to `steps`, and the roof edges of the row before to `edges`.
    /// `centre` has the bearing angles of the row before, `above` those of the row before that; the
    /// row's own take its place.
    fn find_edges(
        mut self,
        columns: usize,
        wraps: bool,
        above: &mut [u16],
        centre: &[u16],
        edges: &mut [u32],
        steps: &mut [u32],
    ) {
        let (last, beyond) = ((columns - 1) / CHUNK, columns % CHUNK);
        let mut below = [GAP; CHUNK];
        let mut left = [GAP; 3];
        if wraps {
            self.chunk(last, &mut below);
            let at = |row: &[u16]| row.get(columns - 1).copied().unwrap_or(GAP);
            left = [at(above), at(centre), below[(columns - 1) % CHUNK]];
        }
        let mut sobel = Sobel::new(&self.thresholds, left);
        let mut first = GAP;
        let mut waiting: Option<(&mut u32, u32)> = None;
        let (mut edges, mut steps) = (edges.iter_mut(), steps.iter_mut());
        let rows = above.as_chunks_mut::<CHUNK>().0.iter_mut().zip(centre.as_chunks::<CHUNK>().0);
        for (chunk, (above, centre)) in rows.enumerate() {
            let step_word = self.chunk(chunk, &mut below) & mask(chunk, columns);
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
}

impl Growth for RowPoints<'_> {
    const TAKES_ALL: bool = true;

    fn moments(&mut self, run: Range<usize>) -> Moments {
        RowPoints::moments(self, run)
    }
}
