//! The region-based segmenter: rows in, labels and segments out (paper section 4).
//!
//! Everything of row r happens when row r arrives: its points, its lines, and what regions take them.

use core::ops::ControlFlow;

use crate::beam::{Beams, Fan, POINT_UNIT_M, RowBeam};
use crate::bits::{CHUNK, load, mask, pack, store, touching_runs, words};
use crate::config::Config;
use crate::error::{ConfigError, PushError};
use crate::event::{EdgeRow, LabelRow, RunLabels, Sink};
use crate::label::{Labels, frontier_words};
use crate::line::{RowPoints, Turns, find_lines};
use crate::memory::Memory;
use crate::region::Regions;
use crate::segmenter::{Finished, Status, check_row};
use crate::within::{part_mut, split_mut};

/// Packed rows, as they are used when row r arrives.
struct BitRows<'a> {
    /// Pixels of row r with a return.
    returns: &'a mut [u32],
    /// Pixels of row r where the bearing angle turns; then its breaks.
    turns: &'a mut [u32],
    /// Pixels of lines, and first pixels of lines, of rows r and r - 1; row q at q % 2.
    lines: [&'a mut [u32]; 2],
    starts: [&'a mut [u32]; 2],
}

impl<'a> BitRows<'a> {
    fn of(bits: &'a mut [u32], columns: usize) -> Self {
        let mut rows = bits.chunks_exact_mut(words(columns).max(1));
        let mut row = || rows.next().unwrap_or_default();
        Self { returns: row(), turns: row(), lines: [row(), row()], starts: [row(), row()] }
    }
}

/// Segments a scan while it comes in, row by row, by growing regions from the lines of each row. Used as
/// [`EdgeSegmenter`](crate::EdgeSegmenter) is, with the same [`Memory`].
pub struct RegionSegmenter<'a> {
    config: Config<'a>,
    turns: Turns,
    fan: Fan<'a>,
    columns: usize,
    /// Rows pushed in this scan.
    rows: usize,
    unlabelled: u32,
    /// Points of the row, metres: x, y, z.
    points: &'a mut [f32],
    /// One per column, for the lines.
    doublings: &'a mut [u16],
    /// See [`BitRows`].
    bits: &'a mut [u32],
    labels: Labels<'a>,
}

impl<'a> RegionSegmenter<'a> {
    /// Rows between the row pushed and the row whose labels it decides: none.
    pub const LATENCY_ROWS: usize = 0;

    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`](crate::MAX_COLUMNS). Checks the configuration
    /// once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too small.
    pub fn new(config: Config<'a>, beams: Beams<'a>, columns: usize, memory: Memory<'a>) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        let needed = memory.check(columns, &config)?;
        let points = part_mut(memory.ranges, 0..3 * columns);
        let doublings = part_mut(memory.bearings, 0..columns);
        let (frontier, bits) = split_mut(part_mut(memory.words, 0..needed.words), frontier_words(columns));
        let labels = Labels::new(memory.areas, frontier, config.max_range_m);
        let turns = Turns::new(&config);
        let mut segmenter =
            Self { config, turns, fan, columns, rows: 0, unlabelled: 0, points, doublings, bits, labels };
        segmenter.reset();
        Ok(segmenter)
    }

    /// Drops what was pushed; the next row is the first of a new scan. [`RegionSegmenter::finish`] does this by itself.
    pub fn reset(&mut self) {
        self.rows = 0;
        self.unlabelled = 0;
        self.bits.fill(0);
        self.labels.reset();
    }

    /// Takes the next row; see [`EdgeSegmenter::push_row`](crate::EdgeSegmenter::push_row). Gives the sink the labels of
    /// this row, and the joins and segments that it brings.
    ///
    /// # Errors
    /// [`PushError`]: the row was not taken and the segmenter is as it was before.
    pub fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
        check_row(ranges_m, turn_rad, self.rows, self.columns)?;
        let row = self.rows;
        self.rows += 1;
        self.locate(ranges_m, RowBeam { row, turn_rad });
        Ok(match self.grow(row, sink) {
            ControlFlow::Continue(unlabelled) => Status::Labelled { row, unlabelled },
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    /// Ends the scan: completes all segments. The next row pushed is the first of a new scan.
    pub fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        let (rows, unlabelled) = (self.rows, self.unlabelled);
        let ended = self.labels.finish(sink);
        self.reset();
        match ended {
            ControlFlow::Continue(()) => Finished::Complete { rows, unlabelled },
            ControlFlow::Break(()) => Finished::Stopped,
        }
    }

    /// Points of the row, and its returns.
    fn locate(&mut self, ranges_m: &[f32], at: RowBeam) {
        let frame = self.fan.frame(at);
        let BitRows { returns, .. } = BitRows::of(self.bits, self.columns);
        for (word, returns) in returns.iter_mut().enumerate() {
            let from = word * CHUNK;
            let clean = load(ranges_m, from, &mut [0.0; CHUNK]).map(|range_m| self.config.clean(range_m));
            *returns = pack(&clean.map(|range_m| range_m > 0.0)) & mask(word, self.columns);
            let mut points = [[0.0; CHUNK]; 3];
            self.fan.points_as(|c| c * POINT_UNIT_M, &frame, from, &clean, &mut points);
            for (axis, points) in self.points.chunks_exact_mut(self.columns.max(1)).zip(&points) {
                store(axis, from, points);
            }
        }
    }

    /// Lines of the row, and the regions that take them.
    fn grow<S: Sink>(&mut self, row: usize, sink: &mut S) -> ControlFlow<(), u32> {
        let columns = self.columns;
        let mut axes = self.points.chunks_exact(columns.max(1));
        let mut axis = || axes.next().unwrap_or_default();
        let BitRows { returns, turns, mut lines, mut starts } = BitRows::of(self.bits, columns);
        let points = RowPoints { axes: [axis(), axis(), axis()], returns, wraps: self.fan.wraps() };
        if row.is_multiple_of(2) {
            lines.swap(0, 1);
            starts.swap(0, 1);
        }
        let [above, lines] = lines;
        let [above_starts, starts] = starts;
        let seam = find_lines(&self.turns, &points, self.doublings, turns, starts, lines);
        for (((edges, returns), starts), lines) in turns.iter_mut().zip(&*returns).zip(&*starts).zip(&*lines) {
            *edges = returns & (starts | !lines);
        }
        sink.edges(&EdgeRow { row, columns, words: turns })?;
        let mut regions = Regions::new(&self.config, points);
        let (above, here) = (touching_runs(above, above_starts, columns), touching_runs(lines, starts, columns));
        let unlabelled = self.labels.label_row(row, above, here, seam, &mut regions, sink)?;
        self.unlabelled = self.unlabelled.saturating_add(unlabelled);
        let labels = RunLabels::Runs { areas: lines, starts, labels: &self.labels };
        sink.row(&LabelRow { row, columns, returns, labels })?;
        ControlFlow::Continue(unlabelled)
    }
}
