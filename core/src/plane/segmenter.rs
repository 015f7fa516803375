//! The plane segmenter: rows in, labels and planar segments out. The default: right at the noise of
//! real scanners.
//!
//! ```text
//! row r arrives
//!   noise as the row tells it                            noise
//!   turn of the row beyond what was reported             turn
//!   pixels that go on with a plane that is carried       follow
//!   lines in what follows no plane                       line
//!   each line joins an area above it, or begins one      join
//!   neighbours, and pieces across a gap, join            join
//!   what no column carries on is complete                areas
//! ```
//!
//! Everything of row r happens when row r arrives. Each column carries the area that it saw last
//! across up to three rows without a return.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::fmt;
use core::ops::{ControlFlow, Range};

use crate::beam::Beams;
use crate::error::{ConfigError, PushError};
use crate::memory::Memory;
use crate::plane::areas::{Areas, FULL, tried_pairs};
use crate::plane::config::PlaneConfig;
use crate::plane::follow::{Followed, RowNoise, follow};
use crate::plane::join::join_neighbours;
use crate::plane::line::lines;
use crate::plane::noise::{Measured, Variance};
use crate::plane::row::{Cached, RowView};
use crate::plane::turn::Turns;
use crate::row::bits::{CHUNK, load, pack, words};
use crate::row::fan::{Fan, RowBeam};
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part, part_mut, put, split_mut};
use crate::scan::{Finished, Progress, Segmenter, Status};
use crate::sink::{EdgeRow, LabelRow, RowSlots, Sink};

/// Looks for pieces across gaps at the end of a scan, for each column; a row has a quarter.
const LAST_BRIDGES: u32 = 64;

/// Segments a scan while it comes in, row by row, by planes that go on from row to row. Its latency
/// is 0 rows.
///
/// ```
/// use core::ops::ControlFlow;
/// use scanseg_core::{
///     Beams, Columns, LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Segmenter, Sink,
///     TurnAxis, buffers,
/// };
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
/// const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));
/// let columns = Columns::Even { start_rad: -0.5, step_rad: 0.01 };
/// let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
/// let mut buffers = <buffers!(101, CONFIG)>::EMPTY;
/// let mut segmenter = PlaneSegmenter::new(CONFIG, beams, 101, buffers.memory())?;
/// for row in 0..50 {
///     segmenter.push_row(&[2.0; 101], 0.01 * row as f32, &mut Print)?;
/// }
/// segmenter.finish(&mut Print);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct PlaneSegmenter<'a> {
    config: PlaneConfig,
    variance: Variance,
    measured: Measured,
    fan: Fan<'a>,
    columns: usize,
    progress: Progress,
    turns: Turns,
    scratch: &'a mut [f32],
    /// Slots of a row; those that the columns carry on to the next; cuts of a row.
    halves: &'a mut [u16],
    bits: &'a mut [u32],
    areas: Areas<'a>,
}

impl fmt::Debug for PlaneSegmenter<'_> {
    /// Writes what is set and how far the scan has come, not the memory.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlaneSegmenter")
            .field("config", &self.config)
            .field("columns", &self.columns)
            .field("rows", &self.progress.rows)
            .finish_non_exhaustive()
    }
}

impl Segmenter for PlaneSegmenter<'_> {
    fn push_row<S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        turn_rad: f32,
        sink: &mut S,
    ) -> Result<Status, PushError> {
        let row = self.progress.begin_row(ranges_m, turn_rad, self.columns)?;
        Ok(match self.grow(RowBeam { row, turn_rad }, ranges_m, sink) {
            ControlFlow::Continue(unlabelled) => {
                self.progress.labelled(unlabelled);
                Status::Labelled { row, unlabelled }
            }
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished {
        let mut ended = self.areas.bridge(LAST_BRIDGES * self.columns as u32, sink);
        if ended.is_continue() {
            ended = self.areas.close(true, sink);
        }
        let finished = self.progress.finished(ended);
        self.reset();
        finished
    }

    fn reset(&mut self) {
        self.progress = Progress::default();
        self.turns = Turns::default();
        self.measured = Measured::NONE;
        self.halves.fill(NONE);
        self.bits.fill(0);
        self.areas.reset();
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

impl<'a> PlaneSegmenter<'a> {
    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`](crate::MAX_COLUMNS).
    /// Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too
    /// small.
    pub fn new(config: PlaneConfig, beams: Beams<'a>, columns: usize, memory: Memory<'a>) -> Result<Self, ConfigError> {
        config.check()?;
        let fan = Fan::new(beams, columns)?;
        memory.check(&config.sizes(columns))?;
        let variance = Variance::new(config.ranging.range_noise_m, &config.noise, config.rules.least_noise_m);
        let (tried, bits) = split_mut(memory.words, tried_pairs(columns));
        let mut areas = Areas::new(memory.areas, tried, config.rules);
        areas.axis = fan.axis();
        let mut segmenter = Self {
            config,
            variance,
            measured: Measured::NONE,
            fan,
            columns,
            progress: Progress::default(),
            turns: Turns::default(),
            scratch: memory.numbers,
            halves: memory.halves,
            bits,
            areas,
        };
        segmenter.reset();
        Ok(segmenter)
    }

    fn grow<S: Sink + ?Sized>(&mut self, beam: RowBeam, ranges_m: &[f32], sink: &mut S) -> ControlFlow<(), u32> {
        let columns = self.columns;
        let (slots, rest) = split_mut(self.halves, columns);
        let (carried, cuts) = split_mut(rest, columns);
        let mut bits = self.bits.chunks_exact_mut(words(columns).max(1));
        let mut packed = || bits.next().unwrap_or_default();
        let (ages0, ages1) = (packed(), packed());
        let mut followed = Followed { returns: packed(), free: packed(), was_left: packed(), was_on: packed() };
        let frame = self.fan.frame(beam);
        let alike = self.config.noise.correlation_px.max(1.0);
        let mut row = RowView {
            ranging: &self.config.ranging,
            fan: &self.fan,
            frame,
            ranges_m,
            wraps: self.fan.wraps(),
            variance: self.variance,
            alike: alike * alike,
            alike_row: alike,
            turned_rad: 0.0,
            offset_m: 0.0,
            shared_rad2: 0.0,
            stated_rad2: self.config.noise.turn_rad * self.config.noise.turn_rad,
            gap_columns: self.config.rules.gap_columns,
        };
        row.measure(columns, beam.row, &mut self.measured);
        row.variance = self.measured.variance(&self.variance, self.config.rules);
        let areas = &mut self.areas;
        areas.row = beam.row as u16;

        if let Some(by) =
            self.turns.of_row(&row, carried, areas, self.config.noise.turn_rad, beam.turn_rad, self.scratch)
        {
            if row.fan.spins() {
                row.offset_m = by;
            } else {
                row.turned_rad = by;
            }
        }
        areas.turn_rad2 = self.turns.variance_rad2() + self.config.noise.turn_rad * self.config.noise.turn_rad;
        row.shared_rad2 = row.turned_rad * row.turned_rad
            + self.turns.variance_rad2()
            + self.config.noise.turn_rad * self.config.noise.turn_rad;
        let beam_rad = self.config.rules.least_beam_rad.max(self.config.noise.beam_rad);
        let noise = RowNoise {
            beam_rad2: beam_rad * beam_rad,
            flat_m2: self.config.noise.flatness_m * self.config.noise.flatness_m,
            turn_rad: row.turned_rad,
            turn_rad2: 0.25 * self.turns.variance_rad2() + self.config.noise.turn_rad * self.config.noise.turn_rad,
        };
        follow(&row, carried, areas, &noise, &mut followed, slots);
        let Followed { returns, free, .. } = followed;

        let mut cached = Cached::EMPTY;
        {
            // runs of one area, across what is missing; planes as they were before this row
            let mut start = 0;
            while start < columns {
                let slot = at(slots, start);
                let mut end = start + part(slots, start..columns).iter().take_while(|&&s| s == slot).count();
                if slot < FULL {
                    // across missing pixels
                    loop {
                        let gap = part(slots, end..columns).iter().take_while(|&&s| s == NONE).count();
                        let next = end + gap;
                        if gap == 0
                            || gap > usize::from(self.config.rules.gap_columns)
                            || next >= columns
                            || at(slots, next) != slot
                            || (end..next).any(|c| at(returns, c / CHUNK) >> (c % CHUNK) & 1 == 1)
                        {
                            break;
                        }
                        end = next + part(slots, next..columns).iter().take_while(|&&s| s == slot).count();
                    }
                    let m = areas.get(slot).fitted.m;
                    let run = start..end;
                    let (sums, errors, count) = row.sums::<false>(run.clone(), m, &mut cached);
                    areas.extend(slot, &run, &sums, &errors, count);
                }
                start = end;
            }
        }

        let mut unlabelled = 0;
        let mut at_column = 0;
        while let Some(run) = free_run(free, returns, at_column, columns, usize::from(self.config.rules.gap_columns)) {
            at_column = run.end;
            let rules = self.config.rules;
            let areas = &mut *areas;
            let free = &*free;
            lines(run, &row, rules, cuts, &mut cached, |run, cached| {
                let (line, points) = row.fitted(run.clone(), cached);
                let slot = areas.area_for(carried, &run, &line, points);
                if slot == FULL {
                    unlabelled += points;
                }
                for column in run {
                    if at(free, column / CHUNK) >> (column % CHUNK) & 1 == 1 {
                        put(slots, column, slot);
                    }
                }
                ControlFlow::<()>::Continue(())
            })?;
        }

        for (word, free) in free.iter_mut().enumerate().filter(|(_, free)| **free != 0) {
            let none = load(slots, word * CHUNK, &mut [0; CHUNK]).map(|slot| slot == NONE);
            *free &= pack(&none);
        }
        sink.edges(&EdgeRow { row: beam.row, columns, words: free })?;

        join_neighbours(areas, &row, carried, slots, &mut cached, sink)?;
        if let Some(turn_rad) = areas.seam_rad.take() {
            self.turns.learn(turn_rad);
        }
        areas.bridge((columns as u32 / 4).max(16), sink)?;
        areas.settle([slots, carried]);

        // what the next row sees above it
        for word in 0..words(columns) {
            let (here, a0, a1) = (at(returns, word), at(ages0, word), at(ages1, word));
            let missing = !here;
            let old = missing & a0 & a1;
            put(ages0, word, missing & !a0 | old);
            put(ages1, word, missing & (a0 ^ a1) | old);
            let from = word * CHUNK;
            let width = CHUNK.min(columns - from);
            let new = part(slots, from..from + width);
            for (i, (to, &slot)) in part_mut(carried, from..from + width).iter_mut().zip(new).enumerate() {
                let keep = missing >> i & 1 == 1;
                let gone = old >> i & 1 == 1;
                *to = if !keep {
                    slot
                } else if gone {
                    NONE
                } else {
                    *to
                };
            }
        }
        for run in equal_runs(carried) {
            let slot = at(carried, run.start);
            if slot < FULL {
                areas.carry(slot);
            }
        }
        areas.close(false, sink)?;
        let (slots, table) = (RowSlots::Pixels(slots), areas.table());
        sink.row(&LabelRow { row: beam.row, columns, returns, slots, table })?;
        ControlFlow::Continue(unlabelled)
    }
}

/// The next run of free pixels from a column on, across up to `gap` pixels without a return.
fn free_run(free: &[u32], returns: &[u32], from: usize, columns: usize, gap: usize) -> Option<Range<usize>> {
    let mut runs = crate::row::bits::runs(free, columns).from(from);
    let mut run = runs.next()?;
    for next in runs {
        let missing = |c: usize| at(returns, c / CHUNK) >> (c % CHUNK) & 1 == 0;
        if next.start - run.end > gap || !(run.end..next.start).all(missing) {
            break;
        }
        run.end = next.end;
    }
    Some(run)
}
