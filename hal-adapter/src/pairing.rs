//! The turn angle of each beam.
//!
//! The scanner sends no time. The times of the beams follow from the time of the telegram's start
//! byte and from the way the scanner works. Its mirror turns 75 times a second. In one turn it
//! measures a beam every degree, from right to left. It starts to send when the last beam has been
//! measured. A complete scan line in steps of 0.5 degree merges two mirror turns (even columns the
//! first, odd columns the second), one in steps of 0.25 degree four. At 0.5 rad/s a tilt moves by
//! 0.38 degree between two mirror turns, so neighbouring columns of one telegram can differ by most
//! of a step.
//!
//! The tilt is sampled as the telegrams come. Two samples give its rate, and the rate gives the
//! turn angle of every beam.
//!
//! The error, simulated: a floor 1 m below a scanner that tilts at 0.5 rad/s, seen up to 6 m away,
//! with an encoder of 14 bits. Distance of the points from the floor, root mean square:
//!
//! | | latched angle | [`RowTurn::turn_rad`] | [`RowTurn::beam_turn_rad`] |
//! |---|---|---|---|
//! | complete scan lines, 0.5 degree | 10.1 mm | 5.6 mm | 0.21 mm |
//! | interlaced, 0.5 degree | 3.0 mm | 1.1 mm | 0.20 mm |
//!
//! `cargo test -p scanseg-virtual-rig --test all pairing -- --nocapture` prints these figures and
//! asserts them.

use core::f32::consts::{PI, TAU};

use scanseg_core::{ColumnTurns, RowBeams};

use crate::latch::Latch;
use crate::lms2xx::{ScanLine, Settings, Variant};

/// Time of one turn of the mirror, microseconds.
pub const MIRROR_TURN_US: f32 = 1e6 / 75.0;

/// How long before the start byte of a telegram each of its beams was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BeamAges {
    /// Bearing of the first column from the right edge of the field of view, and step between
    /// columns, quarter degrees.
    first_quarter: u16,
    step_quarters: u16,
    /// Field of view, quarter degrees.
    view_quarters: u16,
    /// Mirror turns merged in the telegram (1, 2 or 4) less one. With this mask, the number of a
    /// column in the complete scan line gives its mirror turn.
    turn_mask: u16,
    first_column: u16,
    columns: u16,
}

impl BeamAges {
    /// Returns the ages of the beams of a scan line of a scanner that is set to `variant`.
    #[must_use]
    pub fn of(line: &ScanLine<'_>, variant: Variant) -> Self {
        let (first_quarter, turns) = match line.partial_quarter() {
            Some(quarter) => (u16::from(quarter), 1),
            None => (0, variant.mirror_turns()),
        };
        Self {
            first_quarter,
            step_quarters: 4 / turns,
            view_quarters: 4 * variant.view_deg(),
            turn_mask: turns - 1,
            first_column: line.first_column(),
            columns: line.columns(),
        }
    }

    /// Returns the number of columns in the telegram.
    #[must_use]
    pub fn columns(&self) -> u16 {
        self.columns
    }

    /// Returns the age of this column of the telegram at the start byte, microseconds. Columns
    /// beyond the last are extrapolated.
    #[must_use]
    pub fn age_us(&self, column: u16) -> f32 {
        let column = column.saturating_add(self.first_column);
        let turns_after = f32::from(self.turn_mask - (column & self.turn_mask));
        let quarter = f32::from(self.first_quarter) + f32::from(column) * f32::from(self.step_quarters);
        (turns_after + (f32::from(self.view_quarters) - quarter) / 1440.0) * MIRROR_TURN_US
    }

    /// Returns the mean of [`BeamAges::age_us`] over the columns of the telegram.
    #[must_use]
    pub fn mean_age_us(&self) -> f32 {
        // sums in whole quarter degrees of the mirror's turn
        let [first, columns, turns] = [self.first_column, self.columns, self.turn_mask + 1].map(i32::from);
        let quarters = columns * i32::from(self.first_quarter)
            + i32::from(self.step_quarters) * (columns * (2 * first + columns - 1) / 2);
        // number of columns of a mirror turn before a column; the first column is of turn 0
        let of_turn = |turn: i32, column: i32| (column + turns - 1 - turn).checked_div(turns).unwrap_or(0);
        let turns_after: i32 =
            (0..turns).map(|turn| (turns - 1 - turn) * (of_turn(turn, first + columns) - of_turn(turn, first))).sum();
        let sum = turns_after * 1440 + columns * i32::from(self.view_quarters) - quarters;
        sum as f32 / (1440.0 * columns.max(1) as f32) * MIRROR_TURN_US
    }
}

/// The number of samples of the tilt that are kept.
const KEPT: usize = 6;

/// Keeps samples of the tilt, and gives its movement while the beams of a telegram were measured.
///
/// Sample the tilt at each start byte or more often, at any times. A telegram needs a sample after
/// its beams and one before them. Samples that are closer than necessary are not all kept.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pairing {
    period_us: u32,
    /// Time from the middle beam of a telegram to its start byte, and half a millisecond of margin.
    age_us: u32,
    /// The oldest first, at least [`Pairing::spacing_us`] apart except for the last.
    samples: [Latch; KEPT],
    count: usize,
    /// Of the telegram that began last: two samples near its beams, and the time of its start byte.
    now: Option<(Latch, Latch, u64)>,
}

impl Pairing {
    /// Returns a pairing without samples, for a scanner with these settings.
    #[must_use]
    pub const fn new(settings: &Settings) -> Self {
        Self::of_rows(settings.period_us(), Self::middle_us(settings))
    }

    /// Returns how old the middle beam of a telegram is at its start byte.
    pub(crate) const fn middle_us(settings: &Settings) -> u32 {
        let turns = if settings.interlaced { 1 } else { settings.variant.mirror_turns() as u32 };
        (2 * turns - 1) * (MIRROR_TURN_US as u32 / 4)
    }

    /// Returns a pairing without samples: of rows that come so often, whose middle beam is so old at
    /// their start byte.
    pub(crate) const fn of_rows(period_us: u32, middle_us: u32) -> Self {
        Self {
            period_us,
            age_us: middle_us.saturating_add(500),
            samples: [Latch { turn_rad: 0.0, time_us: 0 }; KEPT],
            count: 0,
            now: None,
        }
    }

    /// Takes a sample of the tilt. Samples come in the order of their times. A sample earlier than
    /// the last one drops all others.
    pub fn sample(&mut self, latch: Latch) {
        let spacing_us = self.spacing_us();
        match self.kept() {
            [.., last] if latch.time_us < last.time_us => self.count = 0,
            [.., before, last] if last.time_us - before.time_us < spacing_us => self.count -= 1,
            [last] if latch.time_us == last.time_us => self.count = 0,
            _ => {}
        }
        if self.count == KEPT {
            let [_, second, third, fourth, fifth, last] = self.samples;
            self.samples = [second, third, fourth, fifth, last, last];
            self.count -= 1;
        }
        if let Some(free) = self.samples.get_mut(self.count) {
            *free = latch;
            self.count += 1;
        }
    }

    /// Takes the time of a start byte, by the clock of the samples. A sample that is taken at the
    /// start byte comes before this call. If no telegram began there, the next call takes its
    /// place.
    pub fn start(&mut self, start_us: u64) {
        self.now = self.about(start_us.saturating_sub(u64::from(self.age_us))).map(|(a, b)| (a, b, start_us));
    }

    /// Returns the turn angles of the beams of the telegram that began at the last `start`. `None`
    /// if the beams do not lie between two samples, or if these are more than two and a half
    /// telegrams apart.
    ///
    /// The tilt must turn by less than half a turn between two samples: the shorter way round is
    /// taken.
    pub fn row(&mut self, ages: BeamAges) -> Option<RowTurn> {
        let age_us = ages.mean_age_us();
        let (turn_rad, rate_rad_per_us) = self.at_age(age_us)?;
        Some(RowTurn { turn_rad, rate_rad_per_us, age_us, ages })
    }

    /// Returns the turn angle so long before the last `start`, radians, and the rate of the tilt,
    /// radians a microsecond. `None` as [`Pairing::row`].
    pub(crate) fn at_age(&mut self, age_us: f32) -> Option<(f32, f32)> {
        let (before, after, start_us) = self.now.take()?;
        let rate_rad_per_us = shorter_way(after.turn_rad - before.turn_rad) / apart_us(&before, &after);
        let after_age_us = after.time_us.wrapping_sub(start_us) as i64 as f32;
        Some((after.turn_rad - rate_rad_per_us * (after_age_us + age_us), rate_rad_per_us))
    }

    /// Returns two samples, the second the first one not before this time, if they are near enough
    /// to give the rate.
    fn about(&self, time_us: u64) -> Option<(Latch, Latch)> {
        let kept = self.kept();
        let at = kept.iter().position(|sample| sample.time_us >= time_us)?;
        let (earlier, &[after, ..]) = kept.split_at_checked(at)? else { return None };
        let spacing_us = self.spacing_us();
        let before = *earlier.iter().rev().find(|sample| after.time_us - sample.time_us >= spacing_us)?;
        let near = after.time_us - before.time_us <= u64::from(self.period_us) * 5 / 2;
        near.then_some((before, after))
    }

    /// Returns the rate over the last samples, radians a second; `None` if there are not enough.
    pub(crate) fn rate_rad_per_s(&self) -> Option<f32> {
        let (before, after) = self.about(self.kept().last()?.time_us)?;
        Some(shorter_way(after.turn_rad - before.turn_rad) / (1e-6 * apart_us(&before, &after)))
    }

    fn kept(&self) -> &[Latch] {
        self.samples.get(..self.count).unwrap_or(&[])
    }

    /// Returns the least time over which a rate is taken: three quarters of a telegram's period, so
    /// that one sample per telegram suffices.
    pub(crate) fn spacing_us(&self) -> u64 {
        u64::from(self.period_us) * 3 / 4
    }
}

/// Microseconds between two samples that are near enough to give the rate.
fn apart_us(before: &Latch, after: &Latch) -> f32 {
    (after.time_us - before.time_us) as u32 as f32
}

/// The turn angles of one row.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RowTurn {
    turn_rad: f32,
    rate_rad_per_us: f32,
    age_us: f32,
    ages: BeamAges,
}

impl RowTurn {
    /// Returns the turn angle of the row, radians: the mean over its beams.
    #[must_use]
    pub fn turn_rad(&self) -> f32 {
        self.turn_rad
    }

    /// Returns the rate of the tilt, radians a second.
    #[must_use]
    pub fn rate_rad_per_s(&self) -> f32 {
        self.rate_rad_per_us * 1e6
    }

    /// Returns the difference between the turn angle of this column and [`RowTurn::turn_rad`],
    /// radians. It comes from the movement of the tilt during a mirror turn and between merged
    /// mirror turns. Its mean over the row is 0.
    #[must_use]
    pub fn drift_rad(&self, column: u16) -> f32 {
        self.rate_rad_per_us * (self.age_us - self.ages.age_us(column))
    }

    /// Returns the beams of the row, each at its own turn angle.
    #[must_use]
    pub fn beams(&self) -> RowBeams<'static> {
        let Self { rate_rad_per_us, ages, .. } = *self;
        let set_rad = rate_rad_per_us * MIRROR_TURN_US;
        let step_rad = set_rad * f32::from(ages.step_quarters) / 1440.0;
        let turns = ColumnTurns { step_rad, sets: ages.turn_mask as u8 + 1, set_rad };
        // sets are counted from the first column, which may not be of the first
        let turns = if ages.first_column & ages.turn_mask == 0 { turns } else { ColumnTurns::NONE };
        let turn_rad = if turns == ColumnTurns::NONE { self.turn_rad } else { self.beam_turn_rad(0) };
        RowBeams::from(turn_rad).with_column_turns(turns)
    }

    /// Returns the turn angle of this column, radians: that of the row plus the drift.
    #[must_use]
    pub fn beam_turn_rad(&self, column: u16) -> f32 {
        self.turn_rad + self.drift_rad(column)
    }
}

/// Returns the angle reduced to -pi to pi.
pub(crate) fn shorter_way(mut turn_rad: f32) -> f32 {
    // without the remainder of floats, which takes 650 bytes of flash
    turn_rad -= TAU * (turn_rad / TAU) as i32 as f32;
    if turn_rad > PI {
        turn_rad -= TAU;
    } else if turn_rad < -PI {
        turn_rad += TAU;
    }
    turn_rad
}
