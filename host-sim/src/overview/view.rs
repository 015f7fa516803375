//! How a scan is turned for people to look at, and how large it is shown.

use scanseg_formats::{Geometry, Kind, TurnAxis};

use crate::picture::{Picture, Rgb};

/// How a scan is turned for people to look at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct View {
    /// Rows of the scan become columns of the picture.
    pub transpose: bool,
    /// After that: the first picture row is put last.
    pub flip: bool,
    /// After that: the first picture column is put last.
    pub mirror: bool,
}

impl View {
    /// Returns the view in which up (positive z) is up and left (positive y) is left. The geometry
    /// must fit the image.
    pub fn of(geometry: &Geometry, rows: usize, columns: usize) -> View {
        let transpose = matches!(geometry.kind, Kind::Nodding { turn_axis: TurnAxis::Z, .. });
        let (height, width) = if transpose { (columns, rows) } else { (rows, columns) };
        let direction = |y, x| if transpose { geometry.direction(x, y) } else { geometry.direction(y, x) };
        let flip = direction(0, width / 2)[2] < direction(height - 1, width / 2)[2];
        // Seen from above, beams that go round to the left turn with x towards y.
        let turn = |x| {
            let (a, b) = (direction(height / 2, x), direction(height / 2, x + 1));
            a[0] * b[1] - a[1] * b[0]
        };
        let mirror = (0..width - 1).map(turn).sum::<f64>() > 0.0;
        View { transpose, flip, mirror }
    }
}

/// A side is not made shorter than this, pixels, for the sake of the other.
const SHORT_SIDE: usize = 128;

/// Pixels of a scan as pixels of a picture: turned by a view, and enlarged or reduced.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Frame {
    view: View,
    rows: usize,
    columns: usize,
    /// Of the picture, pixels.
    pub width: usize,
    /// Of the picture, pixels.
    pub height: usize,
}

impl Frame {
    /// Returns a frame of the scan's own size.
    pub fn of(view: View, rows: usize, columns: usize) -> Frame {
        let (height, width) = if view.transpose { (columns, rows) } else { (rows, columns) };
        Frame { view, rows, columns, width, height }
    }

    /// Returns the frame some whole factor larger, up to 8, or smaller, with both sides within
    /// `limit`. A side that is much shorter than the other is not made as small, or is made larger,
    /// so that scans of few rows can be seen.
    pub fn within(self, limit: usize) -> Frame {
        let (width, height) = (self.width.max(1), self.height.max(1));
        let times = (limit / width).min(limit / height).clamp(1, 8);
        let parts = width.max(height).div_ceil(limit);
        let side = |pixels: usize| {
            let even = if parts > 1 { pixels.div_ceil(parts) } else { pixels * times };
            let least = SHORT_SIDE.min(limit);
            let seen = pixels * (least / pixels).clamp(1, 8);
            even.max(seen.min(least))
        };
        Frame { width: side(width), height: side(height), ..self }
    }

    /// Returns which pixel of the scan, `row * columns + column`, is shown at a place.
    pub fn pixel(&self, x: usize, y: usize) -> usize {
        let (high, wide) = if self.view.transpose { (self.columns, self.rows) } else { (self.rows, self.columns) };
        // the middle of the shown pixel lies in the pixel taken
        let from = |to: usize, new: usize, old: usize| (2 * to + 1) * old / (2 * new);
        let (x, y) = (from(x, self.width, wide), from(y, self.height, high));
        let x = if self.view.mirror { wide - 1 - x } else { x };
        let y = if self.view.flip { high - 1 - y } else { y };
        if self.view.transpose { x * self.columns + y } else { y * self.columns + x }
    }

    /// Returns the picture of `colour(i)` for pixel i of the scan.
    pub fn picture(&self, colour: impl Fn(usize) -> Rgb) -> Picture {
        Picture::from_fn(self.width, self.height, |x, y| colour(self.pixel(x, y)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_formats::{Angles, Depth, Noise};

    fn view(kind: Kind) -> (bool, bool, bool) {
        let none = None;
        let geometry = Geometry {
            unit_m: 0.001,
            no_return: vec![],
            min_range_m: none,
            max_range_m: none,
            range_noise_m: none,
            noise: Noise::NONE,
            kind,
        };
        let View { transpose, flip, mirror } = View::of(&geometry, 20, 30);
        (transpose, flip, mirror)
    }

    fn even(start: f64, step: f64) -> Angles {
        Angles::Even { start_deg: start, step_deg: step }
    }

    #[test]
    fn up_is_up_and_left_is_left() {
        let nodding = |beam_deg, turn_deg, turn_axis| view(Kind::Nodding { beam_deg, turn_deg, turn_axis });
        // from the right to the left, from below to above
        assert_eq!(nodding(even(-75.0, 5.0), even(-20.0, 2.0), TurnAxis::Y), (false, true, true));
        assert_eq!(nodding(even(75.0, -5.0), even(20.0, -2.0), TurnAxis::Y), (false, false, false));
        // panning to the left, beams from below to above
        assert_eq!(nodding(even(-75.0, 5.0), even(10.0, 2.0), TurnAxis::Z), (true, true, true));
        assert_eq!(nodding(even(75.0, -5.0), even(10.0, -2.0), TurnAxis::Z), (true, false, false));
        let spinning = |azimuth_deg, elevation_deg| view(Kind::Spinning { azimuth_deg, elevation_deg, wraps: true });
        assert_eq!(spinning(even(0.0, 12.0), even(-10.0, 1.0)), (false, true, true));
        assert_eq!(spinning(even(180.0, -12.0), even(10.0, -1.0)), (false, false, false));
        let pinhole = |fx, fy| view(Kind::Pinhole { fx_px: fx, fy_px: fy, cx_px: 15.0, cy_px: 10.0, depth: Depth::Z });
        assert_eq!(pinhole(30.0, 30.0), (false, false, false));
        assert_eq!(pinhole(-30.0, -30.0), (false, true, true));
    }

    #[test]
    fn the_picture_is_turned_as_the_view_says() {
        let numbered = |transpose, flip, mirror| {
            let frame = Frame::of(View { transpose, flip, mirror }, 2, 3);
            let row = |y| (0..frame.width).map(move |x| frame.pixel(x, y));
            (frame.width, (0..frame.height).flat_map(row).collect::<Vec<_>>())
        };
        assert_eq!(numbered(false, false, false), (3, vec![0, 1, 2, 3, 4, 5]));
        assert_eq!(numbered(false, true, false), (3, vec![3, 4, 5, 0, 1, 2]));
        assert_eq!(numbered(false, false, true), (3, vec![2, 1, 0, 5, 4, 3]));
        assert_eq!(numbered(true, false, false), (2, vec![0, 3, 1, 4, 2, 5]));
        assert_eq!(numbered(true, true, true), (2, vec![5, 2, 4, 1, 3, 0]));
    }

    #[test]
    fn pictures_are_as_large_as_they_may_be() {
        let upright = View { transpose: false, flip: false, mirror: false };
        let size = |rows, columns, limit| {
            let frame = Frame::of(upright, rows, columns).within(limit);
            (frame.width, frame.height)
        };
        assert_eq!(
            [size(200, 361, 1050), size(480, 640, 1050), size(9, 20, 1050)],
            [(722, 400), (640, 480), (160, 72)]
        );
        assert_eq!([size(128, 1024, 2100), size(2000, 4000, 2100)], [(2048, 256), (2000, 1000)]);
        // few rows
        assert_eq!([size(16, 1800, 2100), size(100, 8192, 2100)], [(1800, 128), (2048, 100)]);
        // whatever the size of the scan
        assert_eq!([size(65_535, 1, 2100), size(30_000, 181, 2100)], [(8, 2048), (128, 2000)]);
        assert_eq!(size(65_535, 16_384, 2100), (512, 2048));
        let frame = Frame { width: 6, height: 4, ..Frame::of(upright, 2, 3) };
        let rows: Vec<Vec<usize>> = (0..4).map(|y| (0..6).map(|x| frame.pixel(x, y)).collect()).collect();
        assert_eq!(
            [&rows[0], &rows[1], &rows[2]],
            [&vec![0, 0, 1, 1, 2, 2], &vec![0, 0, 1, 1, 2, 2], &vec![3, 3, 4, 4, 5, 5]]
        );
    }
}
