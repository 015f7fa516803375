//! Settings of the default.

use crate::config::Ranging;
use crate::error::ConfigError;
use crate::memory::Sizes;
use crate::plane::rules::Rules;
use crate::plane::tried::tried_len;
use crate::plane::turn::scratch_len;
use crate::row::bits::words;

/// Settings of [`PlaneSegmenter`](crate::PlaneSegmenter): what is known of the ranges, and whether rows
/// go round.
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
    /// Whether a scan is a full turn, whose last row neighbours its first one: the firings of a
    /// spinning lidar, row by row, without end. Finish the scan with each turn: surfaces that it cuts
    /// are joined, and every segment is complete at most one turn after its last pixel. Takes two
    /// bytes more per column, and room in the table of areas for those of the first row.
    pub round: bool,
    /// The tuned numbers of the method. They are no settings: [`Rules::TUNED`] serves every
    /// scanner. Others are for measuring what each is worth.
    pub rules: &'static Rules,
}

impl PlaneConfig {
    /// The default method for these ranges.
    #[must_use]
    pub const fn new(ranging: Ranging) -> PlaneConfig {
        PlaneConfig { ranging, round: false, rules: &Rules::TUNED }
    }

    /// The same with other [`PlaneConfig::ranging`].
    #[must_use]
    pub const fn with_ranging(self, ranging: Ranging) -> Self {
        Self { ranging, ..self }
    }

    /// The same for scans that are full turns: [`PlaneConfig::round`].
    #[must_use]
    pub const fn with_full_turns(self) -> Self {
        Self { round: true, ..self }
    }

    /// The same with other [`PlaneConfig::rules`].
    #[must_use]
    pub const fn with_rules(self, rules: &'static Rules) -> Self {
        Self { rules, ..self }
    }

    /// The memory that images of `columns` columns need on a microcontroller: a table of areas for
    /// any indoor scan. Noise alone can have more, up to twice the columns:
    /// [`PlaneConfig::sizes_with`].
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        self.sizes_with(columns, columns * 2 / 3 + 1)
    }

    /// The memory that images of `columns` columns need with a table of so many areas. Twice the
    /// columns are enough for any image.
    #[must_use]
    pub const fn sizes_with(&self, columns: usize, areas: usize) -> Sizes {
        Sizes {
            numbers: scratch_len(columns),
            // slots of two rows, cuts of a row, and slots of the first row
            halves: if self.round { 4 * columns } else { 3 * columns },
            words: BIT_ROWS * words(columns) + tried_len(columns),
            areas,
        }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.ranging.check()
    }
}

/// Packed rows that the segmenter keeps: rows without a return above each pixel as a number of two
/// bits, returns, pixels that follow no plane, and two rows of scratch.
pub(crate) const BIT_ROWS: usize = 6;
