//! The paper's edge-based segmentation (Harati, Gaechter, Siegwart 2006, sections 3 and 4) of a whole range image at
//! once, in f64. Slow and obvious: it is what the streaming segmenter is compared with, and shares no code with it.
//!
//! The second approach of the paper, line-based region growing, is in [`lines`] and [`regions`].
//!
//! Bearing angles along each trace are kept as [counts](bearing::count); every later stage starts from the count
//! images, so that it can be compared pixel by pixel with an implementation whose bearing angles round differently.
//! Where the paper leaves a rule open, the function that applies it says which was chosen.
//!
//! An image of the wrong length is a mistake in the test that made it: the functions panic on it.

pub mod beams;
pub mod bearing;
pub mod closing;
pub mod edges;
pub mod labels;
pub mod lines;
pub mod planes;
pub mod regions;

use beams::Beams;
use closing::Element;
use labels::Class;
use planes::Area;

/// The shape of an image. Images are stored row by row: pixel (row, column) is at `row * columns + column`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Number of rows; 0 is an empty image.
    pub rows: usize,
    /// Number of columns; 0 is an empty image.
    pub columns: usize,
    /// The first column is the right neighbour of the last one, in every stage. Taken literally for few columns: in
    /// an image of one column a pixel is its own left and right neighbour.
    pub wraps: bool,
}

impl Size {
    /// Where pixel (row, column) is stored.
    pub fn index(self, row: usize, column: usize) -> usize {
        assert!(row < self.rows && column < self.columns, "({row}, {column}) is outside of {self:?}");
        row * self.columns + column
    }

    /// All pixels (row, column) in the order in which they are stored.
    pub fn pixels(self) -> impl Iterator<Item = (usize, usize)> {
        (0..self.rows).flat_map(move |row| (0..self.columns).map(move |column| (row, column)))
    }

    /// The pixel `down` rows below and `right` columns to the right of one inside of the image; `None` outside of the
    /// image.
    pub fn neighbour(self, (row, column): (usize, usize), down: isize, right: isize) -> Option<(usize, usize)> {
        let row = row as isize + down;
        let mut column = column as isize + right;
        if self.wraps {
            column = column.rem_euclid(self.columns as isize);
        }
        let inside = (0..self.rows as isize).contains(&row) && (0..self.columns as isize).contains(&column);
        inside.then_some((row as usize, column as usize))
    }
}

/// A range image.
#[derive(Clone, Debug)]
pub struct Image {
    /// Its shape.
    pub size: Size,
    /// One range along the beam for each pixel, metres. Anything may stand here; see [`Image::range`].
    pub range_m: Vec<f32>,
    /// Returns nearer than this are dropped; above 0, so that a range of 0 is no return.
    pub min_range_m: f32,
    /// Returns farther than this are dropped; infinity keeps all.
    pub max_range_m: f32,
}

impl Image {
    /// An image that drops no return. Panics if there is not one range per pixel.
    pub fn new(size: Size, range_m: Vec<f32>) -> Self {
        assert_eq!(range_m.len(), size.rows * size.columns, "one range per pixel of {size:?}");
        Self { size, range_m, min_range_m: f32::MIN_POSITIVE, max_range_m: f32::INFINITY }
    }

    /// The range of pixel (row, column), metres, or `None` where there is no return: not finite, or outside of
    /// the closed interval from `min_range_m` to `max_range_m`.
    pub fn range(&self, (row, column): (usize, usize)) -> Option<f32> {
        let range_m = self.range_m[self.size.index(row, column)];
        (range_m.is_finite() && range_m >= self.min_range_m && range_m <= self.max_range_m).then_some(range_m)
    }
}

/// The direction of a trace: a pixel minus the previous one on its trace. In a stream of rows the previous pixel has
/// come already: `rows > 0`, or `rows == 0` and `columns > 0`. (0, 0) has no bearing angles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Trace {
    /// Rows down.
    pub rows: usize,
    /// Columns to the right; negative to the left.
    pub columns: isize,
}

impl Trace {
    /// Along a row: the previous pixel is the left neighbour.
    pub const HORIZONTAL: Self = Self { rows: 0, columns: 1 };
    /// Along a column: the previous pixel is the one above.
    pub const VERTICAL: Self = Self { rows: 1, columns: 0 };

    /// The previous pixel; `None` outside of the image.
    pub fn previous(self, size: Size, pixel: (usize, usize)) -> Option<(usize, usize)> {
        size.neighbour(pixel, -(self.rows as isize), -self.columns)
    }
}

/// Thresholds. Angles are counts of pi / 65535 rad, as in [`bearing::count`].
#[derive(Clone, Debug)]
pub struct Settings {
    /// The traces along which bearing angles are taken; the paper's are horizontal and vertical.
    pub traces: Vec<Trace>,
    /// A roof edge where Sobel's |gx| + |gy| reaches this, in eighths, see [`edges::roof_edges`]. Its sums have a weight
    /// of 4: for a turn of the bearing angle by a number of counts this is half of that number.
    pub roof_eighths: u32,
    /// A step edge where the bearing angle is this near to 0 or pi, see [`edges::step_edges`].
    pub step_counts: u32,
    /// And the range changes by more than this, metres.
    pub step_range_m: f32,
    /// Structuring element of the closing.
    pub element: Element,
}

/// What every stage found. All images have the shape of the range image.
#[derive(Clone, Debug)]
pub struct Segmentation {
    /// Bearing angles, one count image for each trace.
    pub counts: Vec<Vec<u16>>,
    /// Roof and step edges of all traces.
    pub edges: Vec<bool>,
    /// The edges after closing.
    pub closed: Vec<bool>,
    /// What each pixel is.
    pub classes: Vec<Class>,
    /// The label of each pixel's area, from 1 in scan order of their first pixels; 0 outside of areas.
    pub labels: Vec<u32>,
    /// The areas, by label.
    pub areas: Vec<Area>,
}

/// Runs all stages. Panics if the image has not one range per pixel or the beams have too few angles.
pub fn segment(image: &Image, beams: &Beams, settings: &Settings) -> Segmentation {
    let counts = settings.traces.iter().map(|&trace| bearing::bearing_counts(image, beams, trace)).collect();
    segment_counts(image, beams, settings, counts)
}

/// Runs the stages after the bearing angles, on given count images: one for each trace, 0 where there is none.
/// Panics as [`segment`] does, and if the count images do not fit.
pub fn segment_counts(image: &Image, beams: &Beams, settings: &Settings, counts: Vec<Vec<u16>>) -> Segmentation {
    let edges = edges::edges(image, settings, &counts);
    let closed = closing::close(image.size, settings.element, &edges);
    let classes = labels::classes(image, &closed);
    let labels = labels::labels(image.size, &classes);
    let areas = planes::areas(image, beams, &labels);
    Segmentation { counts, edges, closed, classes, labels, areas }
}

#[cfg(test)]
mod tests;
