//! Range images: ranges along the beams in metres, from the counts of a grey image and its
//! geometry, and back.
use std::error::Error;
use std::fmt;

use crate::geometry::{Depth, Geometry, Kind};
use crate::geometry_error::GeometryError;
use crate::grey_image::GreyImage;

/// Ranges along the beams, row by row, in the order in which the rows arrive.
#[derive(Clone, Debug, PartialEq)]
pub struct RangeImage {
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// `rows * columns` ranges along the beam, metres; 0.0 where there is none. Row r, column c is
    /// at `r * columns + c`.
    pub range_m: Vec<f32>,
}

impl RangeImage {
    /// Ranges of the counts of an image. The counts 0 and `no_return` become 0.0, and so does a
    /// distance below `min_range_m` or above `max_range_m`; these apply to the distance as the file
    /// stores it (for a pinhole with depth z along the camera's axis), rounded to `f32`. So does a
    /// range too large for `f32`.
    ///
    /// # Errors
    /// If the geometry does not fit the image, see [`Geometry::fits`].
    pub fn from_grey(image: &GreyImage, geometry: &Geometry) -> Result<RangeImage, GeometryError> {
        let count = |count: &u16| if geometry.no_return.contains(count) { 0.0 } else { f64::from(*count) };
        RangeImage::from_distances(image.rows, image.columns, image.values.iter().map(count), geometry)
    }

    /// Ranges of distances in units of the geometry, row by row, one per pixel. The rules are those of
    /// [`RangeImage::from_grey`]. What is not above 0 or not finite is no return.
    ///
    /// # Errors
    /// If the geometry does not fit the image, see [`Geometry::fits`].
    pub fn from_distances(
        rows: usize,
        columns: usize,
        distances: impl Iterator<Item = f64>,
        geometry: &Geometry,
    ) -> Result<RangeImage, GeometryError> {
        geometry.fits(rows, columns)?;
        let range_m = (0..).zip(distances).map(|(i, distance)| geometry.range_m(i / columns, i % columns, distance));
        Ok(RangeImage { rows, columns, range_m: range_m.collect() })
    }

    /// Leaves out ranges outside of the limits of a geometry.
    pub(crate) fn keep_within(&mut self, geometry: &Geometry) {
        let min_m = geometry.min_range_m.unwrap_or(0.0) as f32;
        let max_m = geometry.max_range_m.map_or(f32::MAX, |m| m as f32);
        self.range_m.iter_mut().filter(|m| !(min_m..=max_m).contains(*m)).for_each(|m| *m = 0.0);
    }

    /// Returns the counts of the ranges, to the nearest, in an image of 16 bits. A range that is
    /// not above 0, infinite or not a number is no return, 0. One that rounds to 0 or to a count of
    /// `no_return` reads back as no return, and so does one beyond the limits of the geometry.
    ///
    /// # Errors
    /// If the geometry does not fit the image, or a range needs a count above 65535.
    pub fn to_grey(&self, geometry: &Geometry) -> Result<GreyImage, RangeError> {
        geometry.fits(self.rows, self.columns).map_err(RangeError::Geometry)?;
        let count = |(i, range_m): (usize, &f32)| {
            if !(*range_m > 0.0 && range_m.is_finite()) {
                return Ok(0);
            }
            let (row, column) = (i / self.columns, i % self.columns);
            let stored_m = f64::from(*range_m) / ranges_per_stored(geometry, row, column);
            let count = (stored_m / geometry.unit_m).round();
            if count > 65535.0 {
                let unit_m = geometry.unit_m;
                return Err(RangeError::TooFar { row, column, range_m: *range_m, unit_m });
            }
            Ok(count as u16)
        };
        let values = (0..).zip(&self.range_m).map(count).collect::<Result<_, _>>()?;
        Ok(GreyImage { rows: self.rows, columns: self.columns, max_value: 65535, values })
    }
}

impl Geometry {
    /// Returns the range along the beam of a pixel, metres, of a distance in units of the geometry; 0
    /// where it is no return: not above 0, not finite, or outside of the limits. Listed angles must
    /// have an entry for the pixel, see [`Geometry::fits`].
    pub fn range_m(&self, row: usize, column: usize, distance: f64) -> f32 {
        // As f32 on both sides, so that a count exactly at a limit is within it whatever f64 makes
        // of count * unit.
        let min_m = self.min_range_m.unwrap_or(0.0) as f32;
        let max_m = self.max_range_m.map_or(f32::MAX, |m| m as f32);
        let stored_m = distance * self.unit_m;
        // a distance that is not a number is not above 0
        let measured = distance > 0.0;
        if !measured || !(min_m..=max_m).contains(&(stored_m as f32)) {
            return 0.0;
        }
        let range_m = (stored_m * ranges_per_stored(self, row, column)) as f32;
        if range_m.is_finite() { range_m } else { 0.0 }
    }
}

/// Range along a pixel's beam of a stored distance of 1.
fn ranges_per_stored(geometry: &Geometry, row: usize, column: usize) -> f64 {
    match geometry.kind {
        Kind::Pinhole { depth: Depth::Z, .. } => 1.0 / geometry.direction(row, column)[0],
        _ => 1.0,
    }
}

/// Why ranges cannot be written as counts.
#[derive(Clone, Debug, PartialEq)]
pub enum RangeError {
    /// The geometry does not fit the image.
    Geometry(GeometryError),
    /// A range needs a count above 65535.
    TooFar {
        /// Row of the pixel.
        row: usize,
        /// Column of the pixel.
        column: usize,
        /// Its range, metres.
        range_m: f32,
        /// Metres per count.
        unit_m: f64,
    },
}

impl fmt::Display for RangeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            RangeError::Geometry(e) => e.fmt(f),
            RangeError::TooFar { row, column, range_m, unit_m } => {
                write!(f, "the range {range_m} m of row {row}, column {column} is more than 65535 counts of {unit_m} m")
            }
        }
    }
}

impl Error for RangeError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        match self {
            RangeError::Geometry(e) => Some(e),
            RangeError::TooFar { .. } => None,
        }
    }
}
