//! A range image, and the traces through it.

/// The shape of an image. Images are stored row by row: pixel (row, column) is at `row * columns +
/// column`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size {
    /// Number of rows; 0 is an empty image.
    pub rows: usize,
    /// Number of columns; 0 is an empty image.
    pub columns: usize,
    /// The first column is the right neighbour of the last one, in every stage. Taken literally for
    /// few columns: in an image of one column a pixel is its own left and right neighbour.
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

    /// The pixel `down` rows below and `right` columns to the right of one inside of the image;
    /// `None` outside of the image.
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
    /// One range along the beam for each pixel, metres. Anything may stand here; see
    /// [`Image::range`].
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

    /// The range of pixel (row, column), metres, or `None` where there is no return: not finite, or
    /// outside of the closed interval from `min_range_m` to `max_range_m`.
    pub fn range(&self, (row, column): (usize, usize)) -> Option<f32> {
        let range_m = self.range_m[self.size.index(row, column)];
        (range_m.is_finite() && range_m >= self.min_range_m && range_m <= self.max_range_m).then_some(range_m)
    }
}

/// The direction of a trace: a pixel minus the previous one on its trace. In a stream of rows the
/// previous pixel has come already: `rows > 0`, or `rows == 0` and `columns > 0`. (0, 0) has no
/// bearing angles.
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
