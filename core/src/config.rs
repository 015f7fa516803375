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
    /// Standard deviation of one range, metres; 0 to 10.
    pub range_noise_m: f32,
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
        Ranging { range_noise_m, min_range_m: 0.05, max_range_m: 100.0 }
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
        let Ranging { range_noise_m, min_range_m, max_range_m } = *self;
        within("range_noise_m", range_noise_m, (0.0..=10.0).contains(&range_noise_m))?;
        within("max_range_m", max_range_m, max_range_m > 0.0 && max_range_m <= MAX_RANGE_M)?;
        within("min_range_m", min_range_m, min_range_m > 0.0 && min_range_m <= max_range_m)
    }
}

/// Refuses the value of a field unless it is `ok`.
pub(crate) fn within(field: &'static str, value: f32, ok: bool) -> Result<(), ConfigError> {
    if ok { Ok(()) } else { Err(ConfigError::Value { field, value }) }
}
