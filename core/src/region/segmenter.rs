//! The region-based segmenter: rows in, labels and segments out (paper section 4).
//!
//! Everything of row r happens when row r arrives: its points, its lines, and what regions take
//! them.

use core::fmt;
use core::ops::ControlFlow;

use crate::beam::Beams;
use crate::error::{ConfigError, PushError};
use crate::label::{Labels, frontier_words};
use crate::memory::Memory;
use crate::moments::POINT_UNIT_M;
use crate::region::config::RegionConfig;
use crate::region::growth::Regions;
use crate::region::line::{Points, TurnThresholds, find_lines};
use crate::region::rows::BitRows;
use crate::row::bits::{CHUNK, load, mask, pack, store, touching_runs};
use crate::row::fan::{Fan, RowBeam};
use crate::row::within::{part_mut, split_mut};
use crate::row_beams::RowBeams;
use crate::scan::{Finished, Progress, Segmenter, Status};
use crate::sink::{EdgeRow, LabelRow, RowSlots, Sink};

/// Segments a scan while it comes in, row by row, by growing regions from the lines of each row.
/// Its latency is 0 rows.
pub struct RegionSegmenter<'a> {
    config: RegionConfig,
    thresholds: TurnThresholds,
    fan: Fan<'a>,
    columns: usize,
    progress: Progress,
    /// Points of the row, metres: x, y, z.
    points: &'a mut [f32],
    /// One per column, for the lines.
    doublings: &'a mut [u16],
    /// See [`BitRows`].
    bits: &'a mut [u32],
    labels: Labels<'a>,
}

impl fmt::Debug for RegionSegmenter<'_> {
    /// Writes what is set and how far the scan has come, not the memory.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("RegionSegmenter")
            .field("config", &self.config)
            .field("columns", &self.columns)
            .field("rows", &self.progress.rows)
            .finish_non_exhaustive()
    }
}

impl Segmenter for RegionSegmenter<'_> {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> Result<Status, PushError> {
        let beam = self.progress.begin_row(ranges_m, beams.into(), self.columns, (&self.fan, &self.config.ranging))?;
        let row = beam.row;
        self.locate(ranges_m, beam);
        Ok(match self.grow(row, sink) {
            ControlFlow::Continue(unlabelled) => Status::Labelled { row, unlabelled },
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished {
        let ended = self.labels.finish(sink);
        let finished = self.progress.finished(ended);
        self.reset();
        finished
    }

    fn reset(&mut self) {
        self.progress = Progress::default();
        self.bits.fill(0);
        self.labels.reset();
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

impl<'a> RegionSegmenter<'a> {
    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`](crate::MAX_COLUMNS).
    /// Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too
    /// small.
    pub fn new(
        config: RegionConfig,
        beams: Beams<'a>,
        columns: usize,
        memory: Memory<'a>,
    ) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        let needed = config.sizes(columns);
        memory.check(&needed)?;
        let points = part_mut(memory.numbers, 0..needed.numbers);
        let doublings = part_mut(memory.halves, 0..needed.halves);
        let (frontier, bits) = split_mut(part_mut(memory.words, 0..needed.words), frontier_words(columns));
        let labels = Labels::new(memory.areas, frontier, config.ranging.max_range_m);
        let thresholds = TurnThresholds::new(&config);
        let progress = Progress::default();
        let mut segmenter = Self { config, thresholds, fan, columns, progress, points, doublings, bits, labels };
        segmenter.reset();
        Ok(segmenter)
    }

    /// Points of the row, and its returns.
    fn locate(&mut self, ranges_m: &[f32], at: RowBeam) {
        let frame = self.fan.frame(at);
        let BitRows { returns, .. } = BitRows::of(self.bits, self.columns);
        for (word, returns) in returns.iter_mut().enumerate() {
            let from = word * CHUNK;
            let clean = load(ranges_m, from, &mut [0.0; CHUNK]).map(|range_m| self.config.ranging.clean(range_m));
            *returns = pack(&clean.map(|range_m| range_m > 0.0)) & mask(word, self.columns);
            let mut points = [[0.0; CHUNK]; 3];
            self.fan.points_as(|c| c * POINT_UNIT_M, &frame, from, &clean, &mut points);
            for (axis, points) in self.points.chunks_exact_mut(self.columns.max(1)).zip(&points) {
                store(axis, from, points);
            }
        }
    }

    /// Lines of the row, and the regions that take them.
    fn grow<S: Sink + ?Sized>(&mut self, row: usize, sink: &mut S) -> ControlFlow<(), u32> {
        let columns = self.columns;
        let mut axes = self.points.chunks_exact(columns.max(1));
        let mut axis = || axes.next().unwrap_or_default();
        let BitRows { returns, turns, mut lines, mut starts } = BitRows::of(self.bits, columns);
        let points = Points { axes: [axis(), axis(), axis()], returns, wraps: self.fan.wraps() };
        if row.is_multiple_of(2) {
            lines.swap(0, 1);
            starts.swap(0, 1);
        }
        let [above, lines] = lines;
        let [above_starts, starts] = starts;
        let seam = find_lines(&self.thresholds, &points, self.doublings, turns, starts, lines);
        for (((edges, returns), starts), lines) in turns.iter_mut().zip(&*returns).zip(&*starts).zip(&*lines) {
            *edges = returns & (starts | !lines);
        }
        sink.edges(&EdgeRow { row, columns, words: turns })?;
        let mut regions = Regions::new(&self.config, points);
        let (above, here) = (touching_runs(above, above_starts, columns), touching_runs(lines, starts, columns));
        let unlabelled = self.labels.label_row(row, above, here, seam, &mut regions, sink)?;
        self.progress.labelled(unlabelled);
        let (table, slots) = self.labels.labelled();
        let slots = RowSlots::Runs { areas: lines, starts, slots };
        sink.row(&LabelRow { row, columns, returns, slots, table })?;
        ControlFlow::Continue(unlabelled)
    }
}
