//! Settings of the paper's region-based approach.

use core::f32::consts::{FRAC_PI_2, PI};

use crate::area::live_labels;
use crate::config::{Ranging, within};
use crate::error::ConfigError;
use crate::label::frontier_words;
use crate::memory::Sizes;
use crate::region::rows::BIT_ROWS;
use crate::row::bits::words;

/// Settings of [`RegionSegmenter`](crate::RegionSegmenter).
///
/// ```
/// use scanseg_core::{Ranging, RegionConfig};
/// const CONFIG: RegionConfig = RegionConfig::paper().with_ranging(Ranging::new(0.005));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct RegionConfig {
    /// Noise and limits of the ranges. The noise decides how long the chords are that show a turn,
    /// and with `plane_distance_m` how far a line may be from a plane.
    pub ranging: Ranging,
    /// A line of a row ends where the bearing angle turns by at least this much, radians; above 0,
    /// up to pi / 2.
    pub line_angle_rad: f32,
    /// How far from a plane a surface may be for other reasons than the noise, metres; 0 to 1. A
    /// line joins a region whose plane both of its ends are near: within this and 4 standard
    /// deviations.
    pub plane_distance_m: f32,
}

impl RegionConfig {
    /// The paper's method. What the paper leaves open, and what stands here:
    ///
    /// - `line_angle_rad` = 3 deg: a turn of less is that of the azimuth steps on a spinning
    ///   scanner's floor. Of lines that are broken too early nothing is lost, and lines that run on
    ///   around a corner join no region: on the simulated offices 65, 64, 60 and 46 % of the
    ///   surfaces are found with 2, 3, 5 and 10 deg, without noise.
    /// - `plane_distance_m` = 5 mm: walls and desks are flat to that. 3 mm find 60 % of the same
    ///   surfaces, 8 mm 65 %.
    /// - `ranging`: 10 mm of noise, the scanner of the paper (SICK LMS 200) by its data sheet's
    ///   typical figure.
    #[must_use]
    pub const fn paper() -> RegionConfig {
        RegionConfig { ranging: Ranging::new(0.01), line_angle_rad: 3.0 * PI / 180.0, plane_distance_m: 0.005 }
    }

    /// The same with other [`RegionConfig::ranging`].
    #[must_use]
    pub const fn with_ranging(self, ranging: Ranging) -> Self {
        Self { ranging, ..self }
    }

    /// The same with another [`RegionConfig::line_angle_rad`].
    #[must_use]
    pub const fn with_line_angle_rad(self, line_angle_rad: f32) -> Self {
        Self { line_angle_rad, ..self }
    }

    /// The same with another [`RegionConfig::plane_distance_m`].
    #[must_use]
    pub const fn with_plane_distance_m(self, plane_distance_m: f32) -> Self {
        Self { plane_distance_m, ..self }
    }

    /// The memory that images of `columns` columns need.
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        Sizes {
            // x, y and z of a row
            numbers: 3 * columns,
            halves: columns,
            words: BIT_ROWS * words(columns) + frontier_words(columns),
            areas: live_labels(columns),
        }
    }

    /// The memory that images of `columns` columns need with a table of so many areas.
    #[must_use]
    pub const fn sizes_with(&self, columns: usize, areas: usize) -> Sizes {
        Sizes { areas, ..self.sizes(columns) }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        self.ranging.check()?;
        within("line_angle_rad", self.line_angle_rad, self.line_angle_rad > 0.0 && self.line_angle_rad <= FRAC_PI_2)?;
        within("plane_distance_m", self.plane_distance_m, (0.0..=1.0).contains(&self.plane_distance_m))
    }
}
