//! The overview of a segmented scan: one picture in the manner of the paper's Figs. 3 to 5, up
//! being up and left being left whatever the order in which the scanner delivers its rows.

use scanseg_core::COUNTS_PER_RAD;

use crate::picture::{BLACK, Picture, Rgb, bearing_colour, edge_colour, label_colour, range_colour, sheet};
use scanseg_formats::{Geometry, Kind, RangeImage, TurnAxis};

/// Sheets are about as wide as this, pixels.
const SHEET_WIDTH: usize = 2100;

/// Where there is no return, in the panels of edges and segments.
pub(crate) const NO_RETURN: Rgb = [190, 205, 225];

/// What the panels show; every image has the scan's pixels, row by row in scan order.
#[derive(Clone, Copy, Debug)]
pub struct Images<'a> {
    /// Bearing angles along rows, in counts; 0 where there is none.
    pub bearing_rows: &'a [u16],
    /// Bearing angles along columns, in counts; 0 where there is none.
    pub bearing_columns: &'a [u16],
    /// What led to the segments, by titles: edges of several kinds, or where lines end.
    pub edges: &'a [(&'a str, &'a [bool])],
    /// Pixels with a return that are in no segment because they are edges.
    pub closed_edges: &'a [bool],
    /// Segment numbers; 0 for none.
    pub numbers: &'a [u32],
}

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

    /// Returns the picture of `colour(i)` for pixel `i = row * columns + column` of the scan.
    pub(crate) fn picture(&self, rows: usize, columns: usize, colour: impl Fn(usize) -> Rgb) -> Picture {
        let (height, width) = if self.transpose { (columns, rows) } else { (rows, columns) };
        Picture::from_fn(width, height, |x, y| {
            let x = if self.mirror { width - 1 - x } else { x };
            let y = if self.flip { height - 1 - y } else { y };
            colour(if self.transpose { x * columns + y } else { y * columns + x })
        })
    }
}

/// Draws the overview. The images must have the scan's size.
pub fn overview(scan: &RangeImage, geometry: &Geometry, images: &Images<'_>) -> Picture {
    let view = View::of(geometry, scan.rows, scan.columns);
    let (near_m, far_m) = usual_ranges_m(scan);
    let bearing = |counts: &[u16], i: usize| match counts[i] {
        0 => bearing_colour(f32::NAN),
        count => bearing_colour(f32::from(count) / COUNTS_PER_RAD),
    };
    let edge = |edges: &[bool], i: usize| if scan.range_m[i] == 0.0 { NO_RETURN } else { edge_colour(edges[i]) };
    let segment = |i: usize| match images.numbers[i] {
        _ if images.closed_edges[i] => BLACK,
        _ if scan.range_m[i] == 0.0 => NO_RETURN,
        number => label_colour(number),
    };
    let range_title = range_title(near_m, far_m);
    let picture = |colour: &dyn Fn(usize) -> Rgb| view.picture(scan.rows, scan.columns, colour);
    let mut panels = vec![
        (range_title.as_str(), picture(&|i| range_colour(scan.range_m[i], near_m, far_m))),
        ("Segments (edges black)", picture(&segment)),
        ("Bearing angle along rows", picture(&|i| bearing(images.bearing_rows, i))),
        ("Bearing angle along columns", picture(&|i| bearing(images.bearing_columns, i))),
    ];
    panels.extend(images.edges.iter().map(|(title, edges)| (*title, picture(&|i| edge(edges, i)))));
    let across = if panels[0].1.width() > SHEET_WIDTH / 2 { 1 } else { 2 };
    let fit = |(title, panel)| (title, fitted(panel, SHEET_WIDTH / across));
    sheet(&panels.into_iter().map(fit).collect::<Vec<_>>(), across)
}

/// Returns a simulated scan as in the paper's Fig. 6: its truth (surface ids, 0 for none) and its
/// depth side by side. The truth must have the scan's size.
pub fn truth_and_depth(scan: &RangeImage, geometry: &Geometry, truth: &[u16]) -> Picture {
    let view = View::of(geometry, scan.rows, scan.columns);
    let (near_m, far_m) = usual_ranges_m(scan);
    let truth = view.picture(scan.rows, scan.columns, |i| match truth[i] {
        0 => NO_RETURN,
        id => label_colour(u32::from(id)),
    });
    let depth = view.picture(scan.rows, scan.columns, |i| range_colour(scan.range_m[i], near_m, far_m));
    let range_title = range_title(near_m, far_m);
    let panels = [("Truth", truth), (range_title.as_str(), depth)];
    sheet(&panels.map(|(title, panel)| (title, fitted(panel, SHEET_WIDTH / 2))), 2)
}

pub(crate) fn range_title(near_m: f32, far_m: f32) -> String {
    format!("Range: {near_m:.1} m yellow, {far_m:.1} m blue")
}

/// Returns a picture some whole factor larger or smaller, to a width of `width` and a height of
/// [`SHEET_WIDTH`] and less, or to twice that at most.
fn fitted(picture: Picture, width: usize) -> Picture {
    let (w, h) = (picture.width(), picture.height());
    let times = (width / w).min(SHEET_WIDTH / h).clamp(1, 8);
    let parts = w.div_ceil(2 * width).max(h.div_ceil(2 * SHEET_WIDTH));
    if times * parts == 1 { picture } else { picture.scaled(w * times / parts, h * times / parts) }
}

/// Returns the ranges that 2 % of the returns are nearer, farther than; 0 and 1 m where there is
/// none.
pub(crate) fn usual_ranges_m(scan: &RangeImage) -> (f32, f32) {
    let mut ranges_m: Vec<f32> = scan.range_m.iter().copied().filter(|&m| m > 0.0).collect();
    ranges_m.sort_by(f32::total_cmp);
    let at =
        |percent: usize| ranges_m.get((ranges_m.len() * percent / 100).min(ranges_m.len().wrapping_sub(1))).copied();
    (at(2).unwrap_or(0.0), at(98).unwrap_or(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_formats::{Angles, Depth};

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

    #[test]
    fn the_picture_is_turned_as_the_view_says() {
        let numbered = |transpose, flip, mirror| {
            let picture = View { transpose, flip, mirror }.picture(2, 3, |i| [i as u8; 3]);
            let row = |y| (0..picture.width()).map(move |x| (x, y)).collect::<Vec<_>>();
            let pixels = (0..picture.height()).flat_map(row).filter_map(|(x, y)| picture.get(x, y)).map(|rgb| rgb[0]);
            (picture.width(), pixels.collect::<Vec<_>>())
        };
        assert_eq!(numbered(false, false, false), (3, vec![0, 1, 2, 3, 4, 5]));
        assert_eq!(numbered(false, true, false), (3, vec![3, 4, 5, 0, 1, 2]));
        assert_eq!(numbered(false, false, true), (3, vec![2, 1, 0, 5, 4, 3]));
        assert_eq!(numbered(true, false, false), (2, vec![0, 3, 1, 4, 2, 5]));
        assert_eq!(numbered(true, true, true), (2, vec![5, 2, 4, 1, 3, 0]));
    }

    #[test]
    fn panels_come_near_the_sheet_width() {
        let width = |w, to| fitted(Picture::new(w, 4, BLACK), to).width();
        assert_eq!([width(361, 1050), width(640, 1050), width(20, 1050)], [722, 640, 160]);
        assert_eq!([width(1024, 2100), width(4000, 2100), width(9000, 2100)], [2048, 4000, 3000]);
        // and no image makes a large sheet
        for (w, h) in [(1, 65_535), (181, 30_000), (16_384, 1), (4096, 4096), (700, 3000), (1, 1)] {
            let picture = fitted(Picture::new(w, h, BLACK), 1050);
            assert!(picture.width() <= 2100 && picture.height() <= 2 * SHEET_WIDTH, "{w} x {h}");
        }
    }
}
