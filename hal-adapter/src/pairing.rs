//! Which turn angle belongs to which beam.
//!
//! The scanner sends no time. What is known is when the start byte of a telegram came, and how the scanner works: its mirror
//! turns 75 times a second; a turn measures one beam every degree, from right to left; the telegram starts when the last
//! beam has been measured. A complete scan in steps of 0.5 degree merges two turns (even columns the first, odd columns the
//! second), one in steps of 0.25 degree four. At 0.5 rad/s a tilt moves by 0.38 degree between two mirror turns, so
//! neighbouring columns of one telegram can differ by most of a step.
//!
//! The tilt is sampled as the telegrams come. Two samples give its rate, and with it the turn angle of every beam.
//!
//! What that buys, simulated: a floor 1 m below a scanner that tilts at 0.5 rad/s, seen up to 6 m away, encoder of 14 bits;
//! distance of the points from the floor, root mean square:
//!
//! | | latched angle | [`RowTurn::turn_rad`] | [`RowTurn::beam_turn_rad`] |
//! |---|---|---|---|
//! | complete scans, 0.5 degree | 10.1 mm | 5.6 mm | 0.21 mm |
//! | interlaced, 0.5 degree | 3.0 mm | 1.1 mm | 0.20 mm |
//!
//! `cargo test -p scanseg-sim --test pairing -- --nocapture` prints these figures and more, and fails if they are others.

use core::f32::consts::{PI, TAU};

use crate::lms2xx::{Scan, Settings, Variant};

/// One turn of the mirror, in microseconds.
pub const MIRROR_TURN_US: f32 = 1e6 / 75.0;

/// Turn angle of the scanner and when it was so.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Latch {
    /// Turn angle in radians, best within -pi to pi: far from 0 it loses digits, and beyond 6300 no segmenter takes it.
    pub turn_rad: f32,
    /// Time in microseconds, any origin.
    pub time_us: u64,
}

/// When, before the start byte, the beams of a telegram were measured.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sweep {
    /// Bearing of the first column from the right edge of the field of view, and step between columns, quarter degrees.
    first_quarter: u16,
    step_quarters: u16,
    /// Field of view, quarter degrees.
    view_quarters: u16,
    /// Mirror turns merged in the telegram (1, 2 or 4) less one: these bits of a column's number in the whole scan say which
    /// turn it is of.
    turn_mask: u16,
    first_column: u16,
    columns: u16,
}

impl Sweep {
    /// The sweep of a scan by a scanner that is set to `variant`.
    #[must_use]
    pub fn of(scan: &Scan<'_>, variant: Variant) -> Self {
        let (first_quarter, turns) = match scan.partial_quarter() {
            Some(quarter) => (u16::from(quarter), 1),
            None => (0, variant.turns()),
        };
        Self {
            first_quarter,
            step_quarters: 4 / turns,
            view_quarters: 4 * variant.view_deg(),
            turn_mask: turns - 1,
            first_column: scan.first_column(),
            columns: scan.columns(),
        }
    }

    /// Columns in the telegram.
    #[must_use]
    pub fn columns(&self) -> u16 {
        self.columns
    }

    /// How long before the telegram's start byte this column (0 is its first) was measured, in microseconds. Columns
    /// beyond the last are extrapolated.
    #[must_use]
    pub fn age_us(&self, column: u16) -> f32 {
        let column = column.saturating_add(self.first_column);
        let turns_after = f32::from(self.turn_mask - (column & self.turn_mask));
        let quarter = f32::from(self.first_quarter) + f32::from(column) * f32::from(self.step_quarters);
        (turns_after + (f32::from(self.view_quarters) - quarter) / 1440.0) * MIRROR_TURN_US
    }

    /// The mean of [`Sweep::age_us`] over the telegram's columns: the age of the row as a whole.
    #[must_use]
    pub fn mean_age_us(&self) -> f32 {
        // sums in whole quarter degrees of the mirror's turn
        let [first, columns, turns] = [self.first_column, self.columns, self.turn_mask + 1].map(i32::from);
        let quarters = columns * i32::from(self.first_quarter)
            + i32::from(self.step_quarters) * (columns * (2 * first + columns - 1) / 2);
        // how many columns before a column are of a turn; the first column is of turn 0
        let of_turn = |turn: i32, column: i32| (column + turns - 1 - turn).checked_div(turns).unwrap_or(0);
        let turns_after: i32 =
            (0..turns).map(|turn| (turns - 1 - turn) * (of_turn(turn, first + columns) - of_turn(turn, first))).sum();
        let sum = turns_after * 1440 + columns * i32::from(self.view_quarters) - quarters;
        sum as f32 / (1440.0 * columns.max(1) as f32) * MIRROR_TURN_US
    }
}

/// Samples of the tilt that are kept.
const KEPT: usize = 6;

/// Follows the tilt, and says how it turned while a telegram's beams were measured.
///
/// The tilt is sampled at each start byte, or more often, whenever it suits: there must be a sample behind the beams of a
/// telegram, and one before them. Of frequent samples only some are kept.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pairing {
    period_us: u32,
    /// From the middle beam of a telegram to its start byte, and half a millisecond of room.
    age_us: u32,
    /// The oldest first, not closer than [`Pairing::spacing_us`] except for the last.
    samples: [Latch; KEPT],
    count: usize,
    /// Two samples about the beams of the telegram that began last, and its start byte.
    now: Option<(Latch, Latch, u64)>,
}

impl Pairing {
    /// For a scanner so set up. Has seen nothing.
    #[must_use]
    pub const fn new(settings: &Settings) -> Self {
        let turns = if settings.interlaced { 1 } else { settings.variant.turns() as u32 };
        Self {
            period_us: settings.period_us(),
            age_us: (2 * turns - 1) * (MIRROR_TURN_US as u32 / 4) + 500,
            samples: [Latch { turn_rad: 0.0, time_us: 0 }; KEPT],
            count: 0,
            now: None,
        }
    }

    /// The tilt stood so. Samples come in the order of their times; an earlier one makes all before it forgotten.
    pub fn sample(&mut self, latch: Latch) {
        let spacing_us = self.spacing_us();
        match self.kept() {
            [.., last] if latch.time_us < last.time_us => self.count = 0,
            [.., before, last] if last.time_us - before.time_us < spacing_us => self.count -= 1,
            [last] if latch.time_us == last.time_us => self.count = 0,
            _ => {}
        }
        if self.count == KEPT {
            self.samples.rotate_left(1);
            self.count -= 1;
        }
        if let Some(free) = self.samples.get_mut(self.count) {
            *free = latch;
            self.count += 1;
        }
    }

    /// A start byte came at `start_us`, by the clock of the samples; a sample taken on that occasion comes before this. If
    /// what began there was no telegram, the next call takes its place.
    pub fn start(&mut self, start_us: u64) {
        self.now = self.about(start_us.saturating_sub(u64::from(self.age_us))).map(|(a, b)| (a, b, start_us));
    }

    /// The telegram that began at the last `start` is complete: the turn angles of its beams. `None` if they do not
    /// lie between two samples, or these are more than two and a half telegrams apart.
    ///
    /// The shorter way round is taken between two samples, so the tilt must turn by less than half a turn from one to the
    /// next.
    pub fn row(&mut self, sweep: Sweep) -> Option<RowTurn> {
        let (before, after, start_us) = self.now.take()?;
        let time_us = after.time_us - before.time_us;
        let rate_rad_per_us = shorter_way(after.turn_rad - before.turn_rad) / time_us as f32;
        let after_age_us = after.time_us.wrapping_sub(start_us) as i64 as f32;
        let age_us = sweep.mean_age_us();
        let turn_rad = after.turn_rad - rate_rad_per_us * (after_age_us + age_us);
        Some(RowTurn { turn_rad, rate_rad_per_us, age_us, sweep })
    }

    /// Two samples that tell how the tilt moved at this time.
    fn about(&self, time_us: u64) -> Option<(Latch, Latch)> {
        let kept = self.kept();
        let at = kept.iter().position(|sample| sample.time_us >= time_us)?;
        let (earlier, &[after, ..]) = kept.split_at_checked(at)? else { return None };
        let spacing_us = self.spacing_us();
        let before = *earlier.iter().rev().find(|sample| after.time_us - sample.time_us >= spacing_us)?;
        let near = after.time_us - before.time_us <= u64::from(self.period_us) * 5 / 2;
        near.then_some((before, after))
    }

    /// Rate over the last samples, radians a second; `None` if they do not tell.
    pub(crate) fn rate_rad_per_s(&self) -> Option<f32> {
        let (before, after) = self.about(self.kept().last()?.time_us)?;
        Some(shorter_way(after.turn_rad - before.turn_rad) / (1e-6 * (after.time_us - before.time_us) as f32))
    }

    fn kept(&self) -> &[Latch] {
        self.samples.get(..self.count).unwrap_or(&[])
    }

    /// A rate is taken over this time at least: three quarters of a telegram's, so that one sample per telegram serves.
    pub(crate) fn spacing_us(&self) -> u64 {
        u64::from(self.period_us) * 3 / 4
    }
}

/// Turn angles of one row.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RowTurn {
    turn_rad: f32,
    rate_rad_per_us: f32,
    age_us: f32,
    sweep: Sweep,
}

impl RowTurn {
    /// Turn angle of the row: the mean over its beams, radians.
    #[must_use]
    pub fn turn_rad(&self) -> f32 {
        self.turn_rad
    }

    /// Speed of the tilt, radians a second.
    #[must_use]
    pub fn rate_rad_per_s(&self) -> f32 {
        self.rate_rad_per_us * 1e6
    }

    /// By how much the turn angle of this column differs from [`RowTurn::turn_rad`], because the tilt moved on during the
    /// mirror's sweep and between merged mirror turns. Radians; the mean over the row is 0.
    #[must_use]
    pub fn drift_rad(&self, column: u16) -> f32 {
        self.rate_rad_per_us * (self.age_us - self.sweep.age_us(column))
    }

    /// Turn angle of this column: that of the row plus the drift, radians.
    #[must_use]
    pub fn beam_turn_rad(&self, column: u16) -> f32 {
        self.turn_rad + self.drift_rad(column)
    }
}

/// The same turn within -pi to pi, for differences of at most a few turns.
pub(crate) fn shorter_way(mut turn_rad: f32) -> f32 {
    turn_rad %= TAU;
    if turn_rad > PI {
        turn_rad -= TAU;
    } else if turn_rad < -PI {
        turn_rad += TAU;
    }
    turn_rad
}
