//! A range image with its geometry, as the command line names them.

use std::path::Path;

use scanseg_formats::{Geometry, GeometryError, GreyImage, RangeImage};

use crate::command::output::Failure;

/// What describes the geometry file.
const PAGE: &str = "see docs/scan-format.md";

/// Reads a geometry file. What is wrong with it comes with the page that describes it.
pub fn read_geometry(path: &Path) -> Result<Geometry, Failure> {
    Geometry::read(path).map_err(|e| if e.cause.is::<GeometryError>() { with_page(&e) } else { e.into() })
}

/// Returns what is wrong with a geometry, with the page that describes it.
pub fn with_page(e: &impl ToString) -> Failure {
    format!("{} ({PAGE})", e.to_string()).into()
}

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
        let parsed = read_geometry(geometry)?;
        let ranges = RangeImage::from_grey(&counts, &parsed)
            .map_err(|e| with_page(&format!("{}: does not fit {}: {e}", geometry.display(), image.display())))?;
        let is_distance = |count: &&u16| **count != 0 && !parsed.no_return.contains(*count);
        let counts = counts.values.iter().filter(is_distance).count();
        Ok(Input { name: image.display().to_string(), geometry: parsed, ranges, counts })
    }
}
