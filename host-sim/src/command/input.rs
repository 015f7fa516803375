//! A range image with its geometry, as the command line names them.

use std::path::Path;

use scanseg_core::Ranging;
use scanseg_formats::{Geometry, GreyImage, RangeImage};

use crate::command::output::Failure;

/// Of the counts so many per cent, when they lie outside of the limits, look like a mistake.
const SUSPICIOUS_PERCENT: usize = 90;

/// A range image and its geometry.
pub struct Input {
    /// What messages call it.
    pub name: String,
    pub geometry: Geometry,
    pub ranges: RangeImage,
    /// Pixels for which the image has a count of a distance.
    pub counts: usize,
}

impl Input {
    pub fn read(image: &Path, geometry: &Path) -> Result<Input, Failure> {
        let counts = GreyImage::read(image)?;
        let parsed = Geometry::read(geometry)?;
        let ranges = RangeImage::from_grey(&counts, &parsed)
            .map_err(|e| format!("{}: does not fit {}: {e}", geometry.display(), image.display()))?;
        let is_distance = |count: &&u16| **count != 0 && !parsed.no_return.contains(*count);
        let counts = counts.values.iter().filter(is_distance).count();
        Ok(Input { name: image.display().to_string(), geometry: parsed, ranges, counts })
    }

    /// Returns what to say if nearly all counts are dropped for lying outside of the limits, as
    /// they do when the unit is wrong.
    pub fn suspicion(&self, ranging: &Ranging) -> Option<String> {
        let Ranging { min_range_m, max_range_m, .. } = *ranging;
        let inside =
            self.ranges.range_m.iter().filter(|range_m| (min_range_m..=max_range_m).contains(*range_m)).count();
        let outside = self.counts.saturating_sub(inside);
        (100 * outside >= SUSPICIOUS_PERCENT * self.counts && outside > 0).then(|| {
            let least_m = self.geometry.min_range_m.unwrap_or(0.0).max(min_range_m.into());
            let most_m = self.geometry.max_range_m.unwrap_or(f64::INFINITY).min(max_range_m.into());
            let (name, counts, unit_m) = (&self.name, self.counts, self.geometry.unit_m);
            format!(
                "{name}: {outside} of {counts} counts lie outside of {least_m:.2} m to {most_m:.0} m and are no return: is unit_m = {unit_m} right?"
            )
        })
    }
}
