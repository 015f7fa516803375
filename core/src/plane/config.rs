//! Settings of the default.

use crate::area::live_labels;
use crate::config::Ranging;
use crate::error::ConfigError;
use crate::memory::Sizes;
use crate::plane::rules::Rules;
use crate::plane::surface::{MARKS_LEN, PLANE_LEN};
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
    /// The tuned numbers of the method. They are no settings: [`Rules::TUNED`] serves every
    /// scanner. Others are for measuring what each is worth.
    pub rules: &'static Rules,
}

impl PlaneConfig {
    /// The default method for these ranges.
    #[must_use]
    pub const fn new(ranging: Ranging) -> PlaneConfig {
        PlaneConfig { ranging, rules: &Rules::TUNED }
    }

    /// The same with other [`PlaneConfig::ranging`].
    #[must_use]
    pub const fn with_ranging(self, ranging: Ranging) -> Self {
        Self { ranging, ..self }
    }

    /// The same with other [`PlaneConfig::rules`].
    #[must_use]
    pub const fn with_rules(self, rules: &'static Rules) -> Self {
        Self { rules, ..self }
    }

    /// The memory that images of `columns` columns need.
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        let areas = live_labels(columns);
        Sizes {
            numbers: PLANE_LEN * areas + scratch_len(columns),
            // slots of two rows, cuts of a row; marks of the areas
            halves: 3 * columns + MARKS_LEN * areas,
            words: BIT_ROWS * words(columns),
            areas,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.ranging.check()
    }
}

/// Packed rows that the segmenter keeps: returns, pixels that follow no plane, and two rows of
/// scratch.
pub(crate) const BIT_ROWS: usize = 4;
