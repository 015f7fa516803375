//! A range image with its geometry, as the command line names them.

use std::path::Path;

use scanseg_formats::{Geometry, GreyImage, RangeImage};

use crate::command::output::Failure;

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
}
