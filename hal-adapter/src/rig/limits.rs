//! How the tilt of a rig moves.

use scanseg_core::{Beams, Columns, TurnAxis};

use crate::lms2xx::Variant;

/// How the tilt moves within a sweep.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TiltLimits {
    /// Slowest rate, radians a second, above 0. A slower tilt counts as standing, or its encoder as
    /// stuck.
    pub min_rate_rad_per_s: f32,
    /// Fastest rate, radians a second, not below the slowest, and less than half a turn per
    /// telegram. A faster tilt counts as a jump of the encoder. Leave a margin for the encoder's
    /// resolution: with 14 bits a turn, read every 13 ms, the rate has steps of 0.03 rad/s.
    pub max_rate_rad_per_s: f32,
    /// Angle after which a scan is complete, radians, above 0. Half a turn for a scanner that turns
    /// continuously, infinite for one that turns back.
    pub sweep_rad: f32,
    /// Time without a row after which a scan is over, microseconds; at least three telegrams.
    pub pause_us: u32,
}

/// Why a rig is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum RigError {
    /// The rates, radians a second, do not satisfy 0 < slowest <= fastest < half a turn per
    /// telegram.
    Rates {
        /// The slowest.
        min: f32,
        /// The fastest.
        max: f32,
    },
    /// The angle of a sweep, radians, is not above 0.
    Sweep(f32),
    /// The pause is shorter than three telegrams.
    Pause {
        /// Microseconds needed.
        needed_us: u32,
        /// Microseconds given.
        got_us: u32,
    },
    /// The memory for rows is too small.
    Memory {
        /// Numbers needed.
        needed: usize,
        /// Numbers given.
        got: usize,
    },
    /// A number of a [`Mount`](super::Mount) is out of its range.
    Mount {
        /// Which.
        field: &'static str,
        /// The value.
        value: f32,
    },
}

impl core::fmt::Display for RigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Rates { min, max } => write!(f, "the tilt cannot turn at {min} to {max} rad/s"),
            Self::Sweep(sweep_rad) => write!(f, "a sweep cannot be {sweep_rad} rad"),
            Self::Pause { needed_us, got_us } => write!(f, "pause must be {needed_us} us or more, is {got_us}"),
            Self::Memory { needed, got } => write!(f, "rows need memory for {needed} numbers, got {got}"),
            Self::Mount { field, value } => write!(f, "{field} of a mount cannot be {value}"),
        }
    }
}

impl core::error::Error for RigError {}

impl TiltLimits {
    /// Returns whether the tilt can turn at this rate, in either direction.
    pub(super) fn plausible(&self, rate_rad_per_s: f32) -> bool {
        (self.min_rate_rad_per_s..=self.max_rate_rad_per_s).contains(&rate_rad_per_s.abs())
    }

    /// Checks the limits for a scanner whose rows come so often.
    pub(super) fn check(&self, period_us: u32) -> Result<(), RigError> {
        let Self { min_rate_rad_per_s: min, max_rate_rad_per_s: max, sweep_rad, pause_us: got_us } = *self;
        let half_turn_rad_per_s = core::f32::consts::PI * 1e6 / period_us as f32;
        if !(min > 0.0 && min <= max && max < half_turn_rad_per_s) {
            return Err(RigError::Rates { min, max });
        }
        if sweep_rad.is_nan() || sweep_rad <= 0.0 {
            return Err(RigError::Sweep(sweep_rad));
        }
        let needed_us = period_us.saturating_mul(3);
        if got_us < needed_us {
            return Err(RigError::Pause { needed_us, got_us });
        }
        Ok(())
    }
}

/// Returns the beams of an LMS 2xx that tilts. Columns run from right to left, turn angles are
/// positive upwards ([`TurnAxis::Y`]).
#[must_use]
pub const fn beams(variant: Variant) -> Beams<'static> {
    let start_rad = -0.5 * (variant.view_deg() as f32).to_radians();
    let step_rad = (0.01 * variant.step_cdeg() as f32).to_radians();
    Beams::Nodding { columns: Columns::Even { start_rad, step_rad }, axis: TurnAxis::Y }
}
