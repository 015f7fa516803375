//! The plane segmenter: rows in, labels and planar segments out. The default: right at the noise of real scanners.
//!
//! ```text
//! row r arrives
//!   turn of the row beyond what was reported            turn
//!   pixels that go on with a plane of row r - 1         follow
//!   lines in what follows no plane                      piece
//!   each line joins an area above it, or begins one     surface
//!   planes; neighbours on a common plane join; pieces of a plane across a gap join; what has not grown is complete
//! ```
//!
//! Everything of row r happens when row r arrives.

use core::ops::{ControlFlow, Range};

use crate::beam::{Beams, Fan, RowBeam};
use crate::bits::{CHUNK, load, mask, pack, runs, words};
use crate::config::Config;
use crate::error::{ConfigError, PushError};
use crate::event::{EdgeRow, LabelRow, RunLabels, Sink};
use crate::follow::{Followed, follow};
use crate::label::{Growth, live_labels};
use crate::memory::Memory;
use crate::piece::lines;
use crate::plane::Moments;
use crate::scanline::{Lanes, Scanline};
use crate::segmenter::{Finished, RowPoints, Status, check_row};
use crate::surface::{FULL, MARKS_LEN, NONE, Noise, PLANE_LEN, Surfaces};
use crate::turn::{Turns, scratch_len};
use crate::within::{at, part, part_mut, put, split_mut};

/// Least standard deviation of a range, metres: beams are not quite where they are said to be, ranges are rounded, walls
/// are not quite flat.
const LEAST_NOISE_M: f32 = 0.002;

/// Areas above a line that are tried.
const TRIED: usize = 8;

/// Pairs of neighbours that were tried last.
const REMEMBERED_PAIRS: usize = 8;

/// Numbers of [`Memory::ranges`] that images of `columns` columns need.
pub(crate) const fn numbers_len(columns: usize) -> usize {
    PLANE_LEN * live_labels(columns) + scratch_len(columns)
}

/// Elements of [`Memory::bearings`]: slots of two rows, cuts of a row, marks of the areas.
pub(crate) const fn slots_len(columns: usize) -> usize {
    3 * columns + MARKS_LEN * live_labels(columns)
}

/// Segments a scan while it comes in, row by row, by planes that go on from row to row. Used as
/// [`EdgeSegmenter`](crate::EdgeSegmenter) is, with the same [`Memory`]. Of the configuration only the limits and the noise
/// of the ranges matter.
pub struct PlaneSegmenter<'a> {
    config: Config<'a>,
    range_m2: f32,
    fan: Fan<'a>,
    columns: usize,
    /// Rows pushed in this scan.
    rows: usize,
    unlabelled: u32,
    turns: Turns,
    scratch: &'a mut [f32],
    /// Slots of two rows, row q at q % 2; then the cuts of a row.
    slots: &'a mut [u16],
    bits: &'a mut [u32],
    surfaces: Surfaces<'a>,
}

impl<'a> PlaneSegmenter<'a> {
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
        memory.check(columns, &config)?;
        let areas = memory.areas.len().min(live_labels(columns));
        let (planes, scratch) = split_mut(memory.ranges, PLANE_LEN * areas);
        let (slots, marks) = split_mut(memory.bearings, 3 * columns);
        let surfaces = Surfaces::new(part_mut(memory.areas, 0..areas), planes, marks, config.max_range_m);
        let noise_m = config.range_noise_m;
        let range_m2 = noise_m * noise_m + LEAST_NOISE_M * LEAST_NOISE_M;
        let (turns, bits) = (Turns::default(), memory.words);
        let mut segmenter =
            Self { config, range_m2, fan, columns, rows: 0, unlabelled: 0, turns, scratch, slots, bits, surfaces };
        segmenter.reset();
        Ok(segmenter)
    }

    /// Drops what was pushed; the next row is the first of a new scan. [`PlaneSegmenter::finish`] does this by itself.
    pub fn reset(&mut self) {
        self.rows = 0;
        self.unlabelled = 0;
        self.turns = Turns::default();
        self.slots.fill(NONE);
        self.surfaces.reset();
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
        Ok(match self.grow(RowBeam { row, turn_rad }, ranges_m, sink) {
            ControlFlow::Continue(unlabelled) => {
                self.unlabelled = self.unlabelled.saturating_add(unlabelled);
                Status::Labelled { row, unlabelled }
            }
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    /// Ends the scan: completes all segments. The next row pushed is the first of a new scan.
    pub fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        let (rows, unlabelled) = (self.rows, self.unlabelled);
        let ended = self.surfaces.close(true, sink);
        self.reset();
        match ended {
            ControlFlow::Continue(()) => Finished::Complete { rows, unlabelled },
            ControlFlow::Break(()) => Finished::Stopped,
        }
    }

    fn grow<S: Sink>(&mut self, beam: RowBeam, ranges_m: &[f32], sink: &mut S) -> ControlFlow<(), u32> {
        let columns = self.columns;
        let (even, rest) = split_mut(self.slots, columns);
        let (odd, cuts) = split_mut(rest, columns);
        let (above, slots) = if beam.row.is_multiple_of(2) { (&*odd, even) } else { (&*even, odd) };
        let mut bits = self.bits.chunks_exact_mut(words(columns).max(1));
        let mut packed = || bits.next().unwrap_or_default();
        let mut followed = Followed { returns: packed(), free: packed(), was_left: packed(), was_on: packed() };
        let frame = self.fan.frame(beam);
        let line = Scanline { config: &self.config, fan: &self.fan, frame, ranges_m, wraps: self.fan.wraps() };
        self.surfaces.row = beam.row as u16;

        let row_noise = self.turns.of_row(&line, above, &self.surfaces, self.range_m2, self.scratch);
        follow(&line, above, &self.surfaces, &row_noise, &mut followed, slots);
        let Followed { returns, free, .. } = followed;

        let mut points =
            RowPoints { fan: &self.fan, frame, ranges: ranges_m, chunk: usize::MAX, points: [[0; CHUNK]; 3] };
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
        let mut unlabelled = 0;
        let (mut lanes, mut at_chunk) = (Lanes::EMPTY, usize::MAX);
        for run in runs(free, columns) {
            let place = |column: usize| {
                if at_chunk != column / CHUNK {
                    at_chunk = column / CHUNK;
                    line.lanes(at_chunk * CHUNK, &mut lanes);
                }
                let (i, range_m) = (column % CHUNK, lanes.range_m[column % CHUNK]);
                [range_m * lanes.cos[i], range_m * lanes.sin[i]]
            };
            let surfaces = &mut self.surfaces;
            lines(run, self.range_m2, cuts, place, |found| {
                let moments = points.moments(found.columns.clone());
                let slot = area_for(surfaces, above, &found.columns, &moments, f64::from(found.squares), &noise);
                part_mut(slots, found.columns.clone()).fill(slot);
                if slot == FULL {
                    unlabelled += found.columns.len() as u32;
                }
                ControlFlow::<()>::Continue(())
            })?;
        }

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
        let labels = RunLabels::Slots { slots, table: self.surfaces.table() };
        sink.row(&LabelRow { row: beam.row, columns, returns, labels })?;
        ControlFlow::Continue(unlabelled)
    }
}

/// The runs of equal slots of a row, from the left.
pub(crate) fn equal_runs(slots: &[u16]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut start = 0;
    core::iter::from_fn(move || {
        let &slot = slots.get(start)?;
        let end = start + part(slots, start..slots.len()).iter().take_while(|&&s| s == slot).count();
        let run = start..end;
        start = end;
        Some(run)
    })
}

/// The area that a line belongs to: of those above it the one that it fits best for each pixel that touches, or a new one.
fn area_for(
    surfaces: &mut Surfaces,
    above: &[u16],
    line: &Range<usize>,
    moments: &Moments,
    squares: f64,
    noise: &Noise,
) -> u16 {
    let near = line.start.saturating_sub(1)..above.len().min(line.end + 1);
    let mut tried = [(NONE, 0u32); TRIED];
    let mut count = 0;
    for run in equal_runs(part(above, near.clone())) {
        let slot = at(above, near.start + run.start);
        if slot >= FULL {
            continue;
        }
        match tried.iter_mut().take(count).find(|tried| tried.0 == slot) {
            Some(known) => known.1 += run.len() as u32,
            None if count < TRIED => {
                tried[count] = (slot, run.len() as u32);
                count += 1;
            }
            None => {}
        }
    }
    let mut best = (f64::MAX, NONE);
    for &(slot, touching) in tried.iter().take(count) {
        if touching < 2 && line.len() > 3 {
            continue;
        }
        if let Some(badly) = surfaces.takes(slot, moments, squares, noise) {
            let badly = badly / f64::from(touching);
            if badly < best.0 {
                best = (badly, slot);
            }
        }
    }
    match best.1 {
        NONE => surfaces.begin(line, moments, squares, noise),
        slot => {
            surfaces.extend(slot, line, moments);
            slot
        }
    }
}

/// Joins areas that are neighbours in this row, or from this row to the one above, and have a common plane.
fn join_neighbours<S: Sink>(
    surfaces: &mut Surfaces,
    line: &Scanline,
    above: &[u16],
    slots: &[u16],
    noise: &Noise,
    sink: &mut S,
) -> ControlFlow<()> {
    let mut done = [(NONE, NONE); REMEMBERED_PAIRS];
    let mut next = 0;
    let columns = slots.len();
    for from in (0..columns).step_by(CHUNK) {
        // columns whose neighbour to the right or above is of another area
        let [here, up, right] =
            [(slots, from), (above, from), (slots, from + 1)].map(|(row, from)| *load(row, from, &mut [NONE; CHUNK]));
        let mut differ: [bool; CHUNK] = core::array::from_fn(|i| (here[i] != up[i]) | (here[i] != right[i]));
        // the neighbour may be in the next chunk, or across the seam
        put(&mut differ, CHUNK.min(columns - from) - 1, true);
        let mut bits = pack(&differ) & mask(from / CHUNK, columns);
        while bits != 0 {
            let column = from + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let slot = at(slots, column);
            if slot >= FULL {
                continue;
            }
            let beside = |ahead: usize| match column + ahead {
                c if c < columns => at(slots, c),
                c if line.wraps => at(slots, c - columns),
                _ => NONE,
            };
            let right = if beside(1) < FULL { beside(1) } else { beside(2) };
            for other in [right, at(above, column)] {
                if other >= FULL || other == slot {
                    continue;
                }
                let pair = (slot.min(other), slot.max(other));
                if done.contains(&pair) {
                    continue;
                }
                done[next % REMEMBERED_PAIRS] = pair;
                next += 1;
                let (one, other) = (surfaces.root(slot), surfaces.root(other));
                if one != other && surfaces.size(one).0 > 1 && surfaces.size(other).0 > 1 {
                    if surfaces.try_join(one, other, noise, sink)? {
                        continue;
                    }
                    let inverse_m = |plane| line.inverse_m(column, plane);
                    if let Some(fit) = surfaces.bends(one, other, noise, inverse_m) {
                        surfaces.join(one, other, &fit, sink)?;
                    }
                }
            }
        }
    }
    ControlFlow::Continue(())
}
