//! Settings of the default.

use crate::area::live_labels;
use crate::config::Ranging;
use crate::error::ConfigError;
use crate::memory::Sizes;
use crate::plane::areas::tried_pairs;
use crate::plane::noise::NoiseModel;
use crate::plane::rules::Rules;
use crate::plane::turn::scratch_len;
use crate::row::bits::words;

/// Settings of [`PlaneSegmenter`](crate::PlaneSegmenter): nothing but what is known of the ranges.
///
/// ```
/// use scanseg_core::{PlaneConfig, Ranging};
/// const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01)); // ranges with 1 cm of noise
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct PlaneConfig {
    /// Noise and limits of the ranges.
    pub ranging: Ranging,
    /// What the noise is beyond the constant in [`Ranging`].
    pub noise: NoiseModel,
    /// The tuned numbers of the method. They are no settings: [`Rules::TUNED`] serves every
    /// scanner. Others are for measuring what each is worth.
    pub rules: &'static Rules,
}

impl PlaneConfig {
    /// The default method for these ranges.
    #[must_use]
    pub const fn new(ranging: Ranging) -> PlaneConfig {
        PlaneConfig { ranging, noise: NoiseModel::NONE, rules: &Rules::TUNED }
    }

    /// The same with other [`PlaneConfig::ranging`].
    #[must_use]
    pub const fn with_ranging(self, ranging: Ranging) -> Self {
        Self { ranging, ..self }
    }

    /// The same with other [`PlaneConfig::noise`].
    #[must_use]
    pub const fn with_noise(self, noise: NoiseModel) -> Self {
        Self { noise, ..self }
    }

    /// The same with other [`PlaneConfig::rules`].
    #[must_use]
    pub const fn with_rules(self, rules: &'static Rules) -> Self {
        Self { rules, ..self }
    }

    /// The memory that images of `columns` columns need.
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        Sizes {
            numbers: scratch_len(columns),
            // slots of a row, and of what the next one goes on with; cuts of a row
            halves: 3 * columns,
            words: BIT_ROWS * words(columns) + tried_pairs(columns),
            areas: live_labels(columns),
        }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.ranging.check()?;
        self.noise.check()
    }
}

/// Packed rows that the segmenter keeps: ages of what columns carry, returns, pixels that follow no
/// plane, and two rows of scratch.
pub(crate) const BIT_ROWS: usize = 6;
