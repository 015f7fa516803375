//! The plane segmenter: rows in, labels and planar segments out. The default: right at the noise of
//! real scanners.
//!
//! ```text
//! row r arrives
//!   noise of the ranges, from the row itself             measure, noise
//!   what the row is off by: its turn, or its offset      turn, median
//!   pixels that go on with a plane above                 follow
//!   areas and their planes grow by their runs            grower, run_sums, weighted, areas
//!   lines in what follows no plane                       line
//!   each line joins an area above it, or begins one      join
//!   by what share beam angles are too small              stretch
//!   neighbours join                                      neighbours, join, tried
//!   pieces across what hides the rest join               borders, bridge
//!   what the next row has above it                       carried
//!   what nothing can go on with is complete              areas
//! ```
//!
//! Everything of row r happens when row r arrives.

use core::fmt;
use core::ops::ControlFlow;

use crate::beam::Beams;
use crate::error::{ConfigError, PushError};
use crate::memory::Memory;
use crate::plane::areas::{Areas, FULL};
use crate::plane::carried::Carried;
use crate::plane::config::PlaneConfig;
use crate::plane::follow::{Followed, follow};
use crate::plane::grower::Grower;
use crate::plane::measure::Measured;
use crate::plane::neighbours::join_neighbours;
use crate::plane::noise::{Spread, Variance};
use crate::plane::rules::{LAST_BRIDGES, LEAST_BRIDGES, LEFT_OF_RING, LEFT_OF_TURN};
use crate::plane::scanline::{Cached, Scanline};
use crate::plane::stretch::{Stretch, seen};
use crate::plane::tried::{Tried, tried_len};
use crate::plane::turn::Turns;
use crate::row::bits::{CHUNK, load, pack_where, words};
use crate::row::fan::{Fan, RowBeam};
use crate::row::slots::NONE;
use crate::row::within::{at, part_mut, split_mut};
use crate::row_beams::RowBeams;
use crate::scan::{Finished, Progress, Segmenter, Status};
use crate::sink::{EdgeRow, LabelRow, RowSlots, Sink};

/// Segments a scan while it comes in, row by row, by planes that go on from row to row. Its latency
/// is 0 rows.
///
/// The [crate's front page](crate) has a whole program.
///
/// ```
/// use scanseg_core::{Beams, ConfigError, PlaneConfig, PlaneSegmenter, Ranging, buffers};
///
/// const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.005)); // 5 mm of noise
///
/// fn main() -> Result<(), ConfigError> {
///     // a depth camera of 640 columns
///     let beams = Beams::Pinhole { fx_px: 575.8, fy_px: 575.8, cx_px: 319.5, cy_px: 239.5 };
///     let mut buffers = <buffers!(640, CONFIG)>::EMPTY;
///     let segmenter = PlaneSegmenter::new(CONFIG, beams, 640, buffers.memory())?;
///     println!("{segmenter:?}");
///     Ok(())
/// }
/// ```
pub struct PlaneSegmenter<'a> {
    config: PlaneConfig,
    stated: Variance,
    measured: Measured,
    fan: Fan<'a>,
    columns: usize,
    progress: Progress,
    turns: Turns,
    stretch: Stretch,
    scratch: &'a mut [f32],
    /// Slots of this row and above it, cuts of a row, and slots of the first row.
    slots: &'a mut [u16],
    /// Turn angle of the first row, radians.
    first_rad: f32,
    bits: &'a mut [u32],
    areas: Areas<'a>,
}

impl fmt::Debug for PlaneSegmenter<'_> {
    /// Writes what is set and how far the scan has come, not the memory.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PlaneSegmenter")
            .field("ranging", &self.config.ranging)
            .field("columns", &self.columns)
            .field("rows", &self.progress.rows)
            .finish_non_exhaustive()
    }
}

impl Segmenter for PlaneSegmenter<'_> {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> Result<Status, PushError> {
        let beam = self.progress.begin_row(ranges_m, beams.into(), self.columns, (&self.fan, &self.config.ranging))?;
        Ok(match self.grow(beam, ranges_m, sink) {
            ControlFlow::Continue(unlabelled) => {
                self.progress.labelled(unlabelled);
                Status::Labelled { row: beam.row, unlabelled }
            }
            ControlFlow::Break(()) => {
                self.reset();
                Status::Stopped
            }
        })
    }

    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished {
        let mut ended = self.close_round(sink);
        if ended.is_continue() {
            ended = self.areas.bridge(LAST_BRIDGES * self.columns as u32, sink);
        }
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
        if core::mem::take(&mut self.stretch).share != 0.0 {
            self.fan.stretch(0.0);
        }
        self.measured = Measured::NONE;
        self.slots.fill(NONE);
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
        let needed = config.sizes(columns);
        memory.check(&needed)?;
        let scratch = part_mut(memory.numbers, 0..needed.numbers);
        let slots = part_mut(memory.halves, 0..needed.halves);
        let (tried, bits) = split_mut(memory.words, tried_len(columns));
        let (ranging, rules) = (&config.ranging, config.rules);
        let areas = Areas::new(memory.areas, Tried::new(tried), fan.axis(), rules, config.round);
        let stated = Variance::stated(ranging, rules.least_noise_m);
        let (progress, turns, measured) = (Progress::default(), Turns::default(), Measured::NONE);
        let mut segmenter = Self {
            config,
            stated,
            measured,
            fan,
            columns,
            progress,
            turns,
            stretch: Stretch::default(),
            scratch,
            slots,
            first_rad: 0.0,
            bits,
            areas,
        };
        segmenter.reset();
        Ok(segmenter)
    }

    /// The standard deviation of a range that counted in the last row, metres: that stated or that
    /// measured in the scan, whichever is larger, but no more than six times that stated, and at least
    /// [`Rules::least_noise_m`]. Before the first row and after [`Segmenter::finish`] it is that stated.
    ///
    /// [`Rules::least_noise_m`]: crate::Rules::least_noise_m
    #[must_use]
    pub fn range_noise_m(&self, range_m: f32) -> f32 {
        libm::sqrtf(self.measured.variance(&self.stated, self.config.rules).at(range_m))
    }

    /// [`PlaneSegmenter::range_noise_m`] of many ranges. What rows have told is looked at once, which takes
    /// longer than all of the rest.
    pub fn range_noises_m(&self, ranges_m: &[f32]) -> impl Iterator<Item = f32> {
        let variance = self.measured.variance(&self.stated, self.config.rules);
        ranges_m.iter().map(move |&range_m| libm::sqrtf(variance.at(range_m)))
    }

    /// The standard deviation of a range as the rows of this scan so far tell it, whatever was
    /// stated, metres; none where too few returns at about this range have come. A measurement is
    /// right to a quarter or so; less than a quarter of what was stated is not told from none.
    #[must_use]
    pub fn measured_noise_m(&self, range_m: f32) -> Option<f32> {
        self.measured.alone(range_m, &self.stated, self.config.rules).map(libm::sqrtf)
    }

    /// The share by which beam angles are too small, as the walls of this scan so far tell it; 0 where
    /// they are right, or nothing tells. 0.01: a beam that is said to be 30 deg from the middle one is
    /// 30.3 deg from it. From then on beams are taken to be there, and planes are those of the points
    /// along such beams.
    ///
    /// Only the beams of [`Beams::Nodding`] that lie in the plane of their row tell it, and only walls of two
    /// directions together, seen over 11 deg or more: one wall alone may be bent. Less than 0.003
    /// does not count, and more than 0.12 is not found. The next scan begins with 0.
    #[must_use]
    pub fn beam_stretch(&self) -> f32 {
        self.stretch.share
    }

    /// The pixels along a row, and down a column, whose errors counted as one in the last row: those stated
    /// ([`Ranging::noise_correlation_px`]), or 4 where fewer were and the scan so far tells that neighbours
    /// err alike, as those of most depth cameras do. It tells where columns are finer than 0.13 deg, and
    /// from about the fifth row on. Before the first row and after [`Segmenter::finish`] it is that stated.
    ///
    /// [`Ranging::noise_correlation_px`]: crate::Ranging::noise_correlation_px
    #[must_use]
    pub fn noise_correlation_px(&self) -> f32 {
        self.measured.alike_px(self.config.ranging.noise_correlation_px)
    }

    /// Joins across the seam of a full turn: areas of the first row go on with those of the last ones.
    fn close_round<S: Sink + ?Sized>(&mut self, sink: &mut S) -> ControlFlow<()> {
        let Self { config, fan, columns, areas, .. } = self;
        let (_, rest) = split_mut(self.slots, *columns);
        let (above, rest) = split_mut(rest, *columns);
        let (_, first) = split_mut(rest, *columns);
        let beam = RowBeam { row: 0, beams: self.first_rad.into() };
        let (frame, variance) = (fan.frame(beam), self.measured.variance(&self.stated, config.rules));
        for (column, (&slot, &before)) in first.iter().zip(&*above).enumerate() {
            if slot >= FULL || before >= FULL {
                continue;
            }
            let (one, other) = (areas.root(slot), areas.root(before));
            if one != other && areas.has_plane(one) && areas.has_plane(other) && areas.is_due(one, other) {
                let [u, _] = fan.ray(&frame, column);
                areas.join_neighbour(one, other, u, &variance, sink)?;
            }
        }
        ControlFlow::Continue(())
    }

    fn grow<S: Sink + ?Sized>(&mut self, beam: RowBeam, ranges_m: &[f32], sink: &mut S) -> ControlFlow<(), u32> {
        let Self { config, fan, columns, areas, turns, .. } = self;
        let (columns, rules) = (*columns, config.rules);
        let (slots, rest) = split_mut(self.slots, columns);
        let (above, rest) = split_mut(rest, columns);
        let (cuts, first) = split_mut(rest, columns);
        let mut packed = self.bits.chunks_exact_mut(words(columns).max(1));
        let mut packed = || packed.next().unwrap_or_default();
        let mut carried = Carried { slots: above, ages: [packed(), packed()] };
        let mut followed = Followed { returns: packed(), free: packed(), was_left: packed(), was_on: packed() };
        let mut line = scanline(config, fan, beam, ranges_m, &self.stated);
        self.measured.look_at(&line, beam.row, rules);
        line.alike_px = self.measured.alike_px(line.alike_px);
        line.variance = self.measured.variance(&self.stated, rules);
        areas.row = beam.row as u16;
        areas.weigh(1.0 / (line.alike_px * line.alike_px));
        if let Some(by) = turns.of_row(&line, carried.slots, areas, beam.beams.turn_rad, self.scratch) {
            if fan.spins() {
                (line.offset_m, line.known_rows) = (by, f32::from(turns.rows));
            } else {
                line.turned_rad = by;
            }
        }
        let told2 = turns.told2(&line, rules);
        let left2 = told2 * if line.offset_m != 0.0 { LEFT_OF_RING } else { LEFT_OF_TURN };
        // a turn stays in the sums, an offset is taken off
        line.off2 = if line.offset_m != 0.0 { left2 } else { told2 };
        (areas.turn_rad2, areas.ring_m2) = if fan.spins() { (0.0, told2) } else { (line.off2, 0.0) };
        follow(&line, carried.slots, areas, left2, &mut followed, slots);

        let Followed { returns, free, .. } = followed;
        let mut grower = Grower { line: &line, returns, cached: Cached::empty() };
        grower.extend(areas, slots);
        let unlabelled = grower.take_lines(areas, carried.slots, slots, free, cuts);
        let mut cached = grower.cached;
        let stretched = self.stretch.look_at(&line, areas, slots, &mut cached);

        for (word, free) in free.iter_mut().enumerate().filter(|(_, free)| **free != 0) {
            let mut copy = [0; CHUNK];
            let slots = load(slots, word * CHUNK, &mut copy);
            *free &= pack_where(|i| at(slots, i) == NONE);
        }
        sink.edges(&EdgeRow { row: beam.row, columns, words: free })?;

        join_neighbours(areas, &line, carried.slots, slots, &mut cached, sink)?;
        if let Some(turn_rad) = areas.seam_rad.take() {
            turns.learn_turn(turn_rad, &line, rules);
        }
        areas.bridge((columns as u32 / 4).max(LEAST_BRIDGES), sink)?;
        if beam.row == 0 {
            self.first_rad = beam.beams.turn_rad;
            for (to, &slot) in first.iter_mut().zip(&*slots) {
                *to = slot;
            }
        }
        areas.settle([slots, carried.slots, first]);
        carried.take(slots, returns, areas);
        areas.close(false, sink)?;
        let (slots, table) = (RowSlots::Pixels(slots), areas.table());
        sink.row(&LabelRow { row: beam.row, columns, returns, slots, table })?;
        if let Some(more) = stretched {
            areas.change_planes(|middle, fitted| seen(fitted, fan, middle, more));
            fan.stretch(self.stretch.share);
        }
        ControlFlow::Continue(unlabelled)
    }
}

/// A row as it was pushed.
fn scanline<'r>(
    config: &'r PlaneConfig,
    fan: &'r Fan<'r>,
    beam: RowBeam<'r>,
    ranges_m: &'r [f32],
    stated: &Variance,
) -> Scanline<'r> {
    let ranging = &config.ranging;
    // where a beam without a return points, nobody knows
    let frame = fan.frame_of(beam, |column| ranging.clean(at(ranges_m, column)) > 0.0);
    Scanline {
        ranging,
        fan,
        frame,
        ranges_m,
        wraps: fan.wraps(),
        variance: *stated,
        spread: Spread::new(ranging, config.rules),
        alike_px: ranging.noise_correlation_px,
        turned_rad: 0.0,
        offset_m: 0.0,
        known_rows: 0.0,
        // stated where rows turn; none is stated of the offsets of rings
        off2: if fan.turns() { ranging.turn_noise_rad * ranging.turn_noise_rad } else { 0.0 },
        gap_columns: config.rules.gap_columns,
    }
}
