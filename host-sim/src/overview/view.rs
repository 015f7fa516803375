//! How a scan is turned for people to look at, and how large it is shown.

use scanseg_formats::{Geometry, Kind, TurnAxis};

use crate::picture::{BLACK, Picture, Rgb};

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
    /// must fit the image. Where pixels may have any beams, rows become columns if z changes more
    /// along rows than along columns.
    pub fn of(geometry: &Geometry, rows: usize, columns: usize) -> View {
        let across = match geometry.kind {
            Kind::Nodding { turn_axis, .. } => turn_axis == TurnAxis::Z,
            Kind::Spinning { .. } | Kind::Pinhole { .. } => false,
            Kind::Free { .. } => {
                let climb = |pixels: Vec<[f64; 3]>| pixels.windows(2).map(|p| (p[1][2] - p[0][2]).abs()).sum::<f64>();
                let along = some(rows).map(|row| climb(beams(geometry, (0..columns).map(|c| (row, c)))));
                let down = some(columns).map(|column| climb(beams(geometry, (0..rows).map(|r| (r, column)))));
                along.sum::<f64>() * rows as f64 > down.sum::<f64>() * columns as f64
            }
        };
        let (height, width) = if across { (columns, rows) } else { (rows, columns) };
        let pixel = |y, x| if across { (x, y) } else { (y, x) };
        let rises = |x| {
            let column = beams(geometry, (0..height).map(|y| pixel(y, x)));
            column.first().zip(column.last()).map_or(0.0, |(first, last)| last[2] - first[2])
        };
        // Seen from above, beams that go round to the left turn with x towards y.
        let turns = |y| {
            let row = beams(geometry, (0..width).map(|x| pixel(y, x)));
            row.windows(2).map(|pair| pair[0][0] * pair[1][1] - pair[0][1] * pair[1][0]).sum::<f64>()
        };
        let flip = some(width).map(rises).sum::<f64>() > 0.0;
        let mirror = some(height).map(turns).sum::<f64>() > 0.0;
        View { transpose: across, flip, mirror }
    }
}

/// Returns some of so many rows or columns, evenly apart.
fn some(count: usize) -> impl Iterator<Item = usize> {
    const MOST: usize = 16;
    (0..count.min(MOST)).map(move |i| (2 * i + 1) * count / (2 * count.min(MOST)))
}

/// Returns the beams of pixels, where they have one.
fn beams(geometry: &Geometry, pixels: impl Iterator<Item = (usize, usize)>) -> Vec<[f64; 3]> {
    let directions = pixels.map(|(row, column)| geometry.direction(row, column));
    directions.filter(|d| (0.9..1.1).contains(&d.iter().map(|x| x * x).sum::<f64>())).collect()
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

    /// Returns `of(i)` for the pixel i of the scan that each pixel of the picture shows, row by row. What
    /// shows the same pixel beside or below it is copied.
    pub fn shown<T: Copy>(&self, of: impl Fn(usize) -> T) -> Vec<T> {
        let (high, wide) = if self.view.transpose { (self.columns, self.rows) } else { (self.rows, self.columns) };
        // the middle of the shown pixel lies in the pixel taken
        let from = |to: usize, new: usize, old: usize| (2 * to + 1) * old / (2 * new);
        let (down, across) = if self.view.transpose { (1, self.columns) } else { (self.columns, 1) };
        let place = |to: usize, new: usize, old: usize, turned: bool| {
            let from = from(to, new, old);
            if turned { old - 1 - from } else { from }
        };
        let columns: Vec<usize> =
            (0..self.width).map(|x| across * place(x, self.width, wide, self.view.mirror)).collect();
        let rows = (0..self.height).map(|y| down * place(y, self.height, high, self.view.flip));
        let (mut shown, mut above) = (Vec::with_capacity(self.width * self.height), None);
        for row in rows {
            if above.replace(row) == Some(row) {
                shown.extend_from_within(shown.len() - self.width..);
                continue;
            }
            let Some(&first) = columns.first() else { break };
            let mut before = (first, of(row + first));
            shown.extend(columns.iter().map(|&column| {
                if column != before.0 {
                    before = (column, of(row + column));
                }
                before.1
            }));
        }
        shown
    }

    /// Returns the picture of `colour(i)` for pixel i of the scan.
    pub fn picture(&self, colour: impl Fn(usize) -> Rgb) -> Picture {
        match self.shown(colour) {
            shown if shown.is_empty() => Picture::new(self.width, self.height, BLACK),
            shown => Picture::of_pixels(self.width, shown),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_formats::{Angles, Depth};
    use std::cell::Cell;

    fn view(kind: Kind) -> (bool, bool, bool) {
        let geometry = Geometry::of(kind);
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

    /// Beams pixel by pixel are seen as the same beams by a formula, missing ones too.
    #[test]
    fn any_beams_are_turned_like_others() {
        let spinning = |azimuth: (f64, f64), elevation: (f64, f64)| {
            let (azimuth_deg, elevation_deg) = (even(azimuth.0, azimuth.1), even(elevation.0, elevation.1));
            Geometry::of(Kind::Spinning { azimuth_deg, elevation_deg, wraps: false })
        };
        for (azimuth, elevation) in [((60.0, -4.0), (10.0, -1.0)), ((-60.0, 4.0), (-10.0, 1.0))] {
            let by_formula = spinning(azimuth, elevation);
            let of = |i: usize, row: usize, column: usize| match i % 7 {
                0 => [f32::NAN; 3],
                1 => [0.0; 3],
                _ => by_formula.direction(row, column).map(|x| x as f32),
            };
            let upright = (0..600).map(|i| of(i, i / 30, i % 30)).collect();
            let lying = (0..600).map(|i| of(i, i % 20, i / 20)).collect();
            let free = |directions, columns| Geometry::of(Kind::Free { directions, columns, wraps: false });
            let expected = View::of(&by_formula, 20, 30);
            assert_eq!(View::of(&free(upright, 30), 20, 30), expected);
            assert_eq!(View::of(&free(lying, 20), 30, 20), View { transpose: true, ..expected });
        }
    }

    #[test]
    fn the_picture_is_turned_as_the_view_says() {
        let numbered = |transpose, flip, mirror| {
            let frame = Frame::of(View { transpose, flip, mirror }, 2, 3);
            (frame.width, frame.shown(|i| i))
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
        // each pixel of the scan is asked for once
        let asked = Cell::new(0);
        frame.shown(|_| asked.set(asked.get() + 1));
        assert_eq!(asked.get(), 6);
        assert_eq!(frame.shown(|i| i), [0, 0, 1, 1, 2, 2, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 5, 5, 3, 3, 4, 4, 5, 5]);
    }
}
