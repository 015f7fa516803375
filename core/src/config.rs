//! What all approaches are told of the ranges: their noise and their limits.

use crate::error::ConfigError;

/// The largest `max_range_m`, metres. Up to it the moments of a segment stay exact for 2 million
/// points.
pub const MAX_RANGE_M: f32 = 500.0;

/// What is known of the ranges that a scanner measures. Every approach has it in its configuration.
///
/// ```
/// use scanseg_core::Ranging;
/// const RANGING: Ranging = Ranging::new(0.01).with_limits(0.3, 80.0);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Ranging {
    /// a of the standard deviation of a range r, a + b r + c r^2, metres; 0 to 10. The plane
    /// approach measures the noise in the scan too: the larger of stated and measured counts, and
    /// with 0 that measured.
    pub range_noise_m: f32,
    /// b of the standard deviation of a range; 0 to 1.
    pub range_noise_per_m: f32,
    /// c of the standard deviation of a range, 1 / m; 0 to 1. Cameras with a disparity noise of d
    /// pixels at baseline B and focal length f have d / (f B).
    pub range_noise_per_m2: f32,
    /// Step between neighbouring counts of a range, metres; 0 to 10.
    pub range_step_m: f32,
    /// The same, growing with the square of the range, 1 / m; 0 to 1.
    pub range_step_per_m2: f32,
    /// Pixels over which errors of ranges are alike, along rows and columns; 1 to 100. Depth
    /// cameras: 4.
    pub noise_correlation_px: f32,
    /// Standard deviation of the direction of a beam within its row, radians; 0 to 0.1.
    pub beam_noise_rad: f32,
    /// Standard deviation of the turn angle of a row, radians; 0 to 0.1. Nodding scanners only. Rows that
    /// tell it better count for more and more.
    pub turn_noise_rad: f32,
    /// Surfaces are flat to this, one standard deviation across the plane, metres; 0 to 10.
    pub flatness_m: f32,
    /// Nearer ranges count as no return, metres; above 0, up to `max_range_m`.
    pub min_range_m: f32,
    /// Farther ranges count as no return, metres; up to [`MAX_RANGE_M`].
    pub max_range_m: f32,
}

impl Ranging {
    /// Ranges with this standard deviation, metres, 0 to 10. The limits are 0.05 m and 100 m, which
    /// no indoor scanner reaches.
    #[must_use]
    pub const fn new(range_noise_m: f32) -> Ranging {
        Ranging {
            range_noise_m,
            range_noise_per_m: 0.0,
            range_noise_per_m2: 0.0,
            range_step_m: 0.0,
            range_step_per_m2: 0.0,
            noise_correlation_px: 1.0,
            beam_noise_rad: 0.0,
            turn_noise_rad: 0.0,
            flatness_m: 0.0,
            min_range_m: 0.05,
            max_range_m: 100.0,
        }
    }

    /// The same with noise that grows: [`Ranging::range_noise_per_m`] and
    /// [`Ranging::range_noise_per_m2`]. Only the plane approach uses it, as all that follows.
    #[must_use]
    pub const fn with_growing_noise(self, per_m: f32, per_m2: f32) -> Ranging {
        Ranging { range_noise_per_m: per_m, range_noise_per_m2: per_m2, ..self }
    }

    /// The same with steps between counts: [`Ranging::range_step_m`] and
    /// [`Ranging::range_step_per_m2`].
    #[must_use]
    pub const fn with_steps(self, step_m: f32, step_per_m2: f32) -> Ranging {
        Ranging { range_step_m: step_m, range_step_per_m2: step_per_m2, ..self }
    }

    /// The same with another [`Ranging::noise_correlation_px`].
    #[must_use]
    pub const fn with_correlation_px(self, noise_correlation_px: f32) -> Ranging {
        Ranging { noise_correlation_px, ..self }
    }

    /// The same with another [`Ranging::beam_noise_rad`].
    #[must_use]
    pub const fn with_beam_noise_rad(self, beam_noise_rad: f32) -> Ranging {
        Ranging { beam_noise_rad, ..self }
    }

    /// The same with another [`Ranging::turn_noise_rad`].
    #[must_use]
    pub const fn with_turn_noise_rad(self, turn_noise_rad: f32) -> Ranging {
        Ranging { turn_noise_rad, ..self }
    }

    /// The same with another [`Ranging::flatness_m`].
    #[must_use]
    pub const fn with_flatness_m(self, flatness_m: f32) -> Ranging {
        Ranging { flatness_m, ..self }
    }

    /// The same ranges within other limits, metres. What lies outside counts as no return.
    #[must_use]
    pub const fn with_limits(self, min_range_m: f32, max_range_m: f32) -> Ranging {
        Ranging { min_range_m, max_range_m, ..self }
    }

    /// The highest bit says whether a range is no return; the others mean nothing.
    #[inline(always)]
    pub(crate) fn no_return(&self, range_m: f32) -> u32 {
        // the bits of positive numbers are in the order of the numbers, those of NaN and of
        // negative numbers are above them
        let [least, most, range] = [self.min_range_m, self.max_range_m, range_m].map(f32::to_bits);
        let (above, room) = (range.wrapping_sub(least), most.wrapping_sub(least));
        above | room.wrapping_sub(above)
    }

    /// The range of a return, 0 for none.
    #[inline(always)]
    pub(crate) fn clean(&self, range_m: f32) -> f32 {
        if self.no_return(range_m) >> 31 == 0 { range_m } else { 0.0 }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        let Ranging { min_range_m, max_range_m, .. } = *self;
        // no table: of settings that are constant a compiler checks all, and none of it is in an image
        let from_to = |field, value, least: f32, most: f32| within(field, value, (least..=most).contains(&value));
        from_to("range_noise_m", self.range_noise_m, 0.0, 10.0)?;
        from_to("range_noise_per_m", self.range_noise_per_m, 0.0, 1.0)?;
        from_to("range_noise_per_m2", self.range_noise_per_m2, 0.0, 1.0)?;
        from_to("range_step_m", self.range_step_m, 0.0, 10.0)?;
        from_to("range_step_per_m2", self.range_step_per_m2, 0.0, 1.0)?;
        from_to("noise_correlation_px", self.noise_correlation_px, 1.0, 100.0)?;
        from_to("beam_noise_rad", self.beam_noise_rad, 0.0, 0.1)?;
        from_to("turn_noise_rad", self.turn_noise_rad, 0.0, 0.1)?;
        from_to("flatness_m", self.flatness_m, 0.0, 10.0)?;
        within("max_range_m", max_range_m, max_range_m > 0.0 && max_range_m <= MAX_RANGE_M)?;
        within("min_range_m", min_range_m, min_range_m > 0.0 && min_range_m <= max_range_m)
    }
}

/// Refuses the value of a field unless it is `ok`.
pub(crate) fn within(field: &'static str, value: f32, ok: bool) -> Result<(), ConfigError> {
    if ok { Ok(()) } else { Err(ConfigError::Value { field, value }) }
}
