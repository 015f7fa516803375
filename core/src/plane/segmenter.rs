//! The plane segmenter: rows in, labels and planar segments out. The default: right at the noise of
//! real scanners.
//!
//! ```text
//! row r arrives
//!   turn of the row beyond what was reported             turn
//!   pixels that go on with a plane of row r - 1          follow
//!   lines in what follows no plane                       line
//!   each line joins an area above it, or begins one      join
//!   planes are computed anew                             surface
//!   neighbours, and pieces across a gap, join            join
//!   what has not grown is complete                       surface
//! ```
//!
//! Everything of row r happens when row r arrives.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::fmt;
use core::ops::ControlFlow;

use crate::area::live_labels;
use crate::beam::Beams;
use crate::error::{ConfigError, PushError};
use crate::memory::Memory;
use crate::plane::config::PlaneConfig;
use crate::plane::follow::{Followed, follow};
use crate::plane::join::{area_for, join_neighbours};
use crate::plane::line::lines;
use crate::plane::noise::Noise;
use crate::plane::scanline::{Lanes, Scanline};
use crate::plane::surface::{FULL, PLANE_LEN, Surfaces};
use crate::plane::turn::RowTurns;
use crate::row::bits::{CHUNK, load, pack, runs, words};
use crate::row::fan::{Fan, RowBeam};
use crate::row::points::RowPoints;
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part_mut, split_mut};
use crate::scan::{Finished, Progress, Segmenter, Status};
use crate::sink::{EdgeRow, LabelRow, RowSlots, Sink};

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
    range_m2: f32,
    fan: Fan<'a>,
    columns: usize,
    progress: Progress,
    turns: RowTurns,
    scratch: &'a mut [f32],
    /// Slots of two rows, row q at q % 2; then the cuts of a row.
    slots: &'a mut [u16],
    bits: &'a mut [u32],
    surfaces: Surfaces<'a>,
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
        let ended = self.surfaces.close(true, sink);
        let finished = self.progress.finished(ended);
        self.reset();
        finished
    }

    fn reset(&mut self) {
        self.progress = Progress::default();
        self.turns = RowTurns::default();
        self.slots.fill(NONE);
        self.surfaces.reset();
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
        let areas = memory.areas.len().min(live_labels(columns));
        let (planes, scratch) = split_mut(memory.numbers, PLANE_LEN * areas);
        let (slots, marks) = split_mut(memory.halves, 3 * columns);
        let (table, max_range_m) = (part_mut(memory.areas, 0..areas), config.ranging.max_range_m);
        let surfaces = Surfaces::new(table, planes, marks, max_range_m, config.rules);
        let (noise_m, least_m) = (config.ranging.range_noise_m, config.rules.least_noise_m);
        let range_m2 = noise_m * noise_m + least_m * least_m;
        let (progress, turns, bits) = (Progress::default(), RowTurns::default(), memory.words);
        let mut segmenter = Self { config, range_m2, fan, columns, progress, turns, scratch, slots, bits, surfaces };
        segmenter.reset();
        Ok(segmenter)
    }

    fn grow<S: Sink + ?Sized>(&mut self, beam: RowBeam, ranges_m: &[f32], sink: &mut S) -> ControlFlow<(), u32> {
        let columns = self.columns;
        let (even, rest) = split_mut(self.slots, columns);
        let (odd, cuts) = split_mut(rest, columns);
        let (above, slots) = if beam.row.is_multiple_of(2) { (&*odd, even) } else { (&*even, odd) };
        let mut bits = self.bits.chunks_exact_mut(words(columns).max(1));
        let mut packed = || bits.next().unwrap_or_default();
        let mut followed = Followed { returns: packed(), free: packed(), was_left: packed(), was_on: packed() };
        let frame = self.fan.frame(beam);
        let ranging = &self.config.ranging;
        let line = Scanline { ranging, fan: &self.fan, frame, ranges_m, wraps: self.fan.wraps() };
        self.surfaces.row = beam.row as u16;

        let row_noise = self.turns.of_row(&line, above, &self.surfaces, self.range_m2, self.scratch);
        follow(&line, above, &self.surfaces, &row_noise, &mut followed, slots);
        let Followed { returns, free, .. } = followed;

        let mut points = RowPoints::new(&self.fan, frame, ranges_m);
        for run in equal_runs(slots) {
            let slot = at(slots, run.start);
            if slot < FULL {
                self.surfaces.extend(slot, &run, &points.moments(run.clone()));
            }
        }
        let noise = Noise {
            range_m2: f64::from(self.range_m2),
            turn_rad2: f64::from(self.turns.variance_rad2()),
            axis: self.fan.axis(),
        };
        let unlabelled =
            take_lines(&mut self.surfaces, &line, &mut points, above, slots, Free { pixels: free, cuts }, &noise);

        for (word, free) in free.iter_mut().enumerate().filter(|(_, free)| **free != 0) {
            let none = load(slots, word * CHUNK, &mut [0; CHUNK]).map(|slot| slot == NONE);
            *free &= pack(&none);
        }
        sink.edges(&EdgeRow { row: beam.row, columns, words: free })?;

        self.surfaces.refit();
        join_neighbours(&mut self.surfaces, &line, above, slots, &noise, sink)?;
        self.surfaces.bridge(&noise, sink)?;
        self.surfaces.settle(slots);
        self.surfaces.close(false, sink)?;
        let (slots, table) = (RowSlots::Pixels(slots), self.surfaces.table());
        sink.row(&LabelRow { row: beam.row, columns, returns, slots, table })?;
        ControlFlow::Continue(unlabelled)
    }
}

/// The pixels of a row that follow no plane, and where they are cut into lines.
struct Free<'a> {
    /// Packed.
    pixels: &'a [u32],
    /// Scratch, one element per column.
    cuts: &'a mut [u16],
}

/// Cuts the pixels that follow no plane into lines, and gives each to an area of the row above or
/// to a new one. Returns the pixels of lines that found the table of areas full.
fn take_lines(
    surfaces: &mut Surfaces,
    row: &Scanline,
    points: &mut RowPoints,
    above: &[u16],
    slots: &mut [u16],
    free: Free,
    noise: &Noise,
) -> u32 {
    let mut unlabelled = 0;
    let Free { pixels, cuts } = free;
    let (mut lanes, mut at_chunk) = (Lanes::EMPTY, usize::MAX);
    for run in runs(pixels, slots.len()) {
        let place = |column: usize| {
            if at_chunk != column / CHUNK {
                at_chunk = column / CHUNK;
                row.lanes(at_chunk * CHUNK, &mut lanes);
            }
            let (i, range_m) = (column % CHUNK, lanes.range_m[column % CHUNK]);
            [range_m * lanes.cos[i], range_m * lanes.sin[i]]
        };
        let (range_m2, rules) = (noise.range_m2 as f32, surfaces.rules);
        lines(run, range_m2, rules, cuts, place, |found| {
            let moments = points.moments(found.columns.clone());
            let slot = area_for(surfaces, above, &found.columns, &moments, f64::from(found.chi_square), noise);
            part_mut(slots, found.columns.clone()).fill(slot);
            if slot == FULL {
                unlabelled += found.columns.len() as u32;
            }
        });
    }
    unlabelled
}
