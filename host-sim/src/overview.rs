//! The overview of a segmented scan: one picture in the manner of the paper's Figs. 3 to 5, up being up and left being
//! left whatever the order in which the scanner delivers its rows.

use scanseg_core::COUNTS_PER_RAD;

use crate::format::{Geometry, Kind, RangeImage, TurnAxis};
use crate::picture::{BLACK, Picture, Rgb, WHITE, bearing_colour, edge_colour, label_colour, range_colour, sheet};

/// Sheets are about as wide as this, pixels.
const SHEET_WIDTH: usize = 2000;

/// What the panels show; every image has the scan's pixels, row by row in scan order.
#[derive(Clone, Copy, Debug)]
pub struct Images<'a> {
    /// Bearing angles along rows, in counts; 0 where there is none.
    pub bearing_rows: &'a [u16],
    /// Bearing angles along columns, in counts; 0 where there is none.
    pub bearing_columns: &'a [u16],
    /// Edges in the bearing angles along rows alone.
    pub edges_rows: &'a [bool],
    /// Edges in the bearing angles along columns alone.
    pub edges_columns: &'a [bool],
    /// Edges of all traces that the segmentation used.
    pub edges: &'a [bool],
    /// These after the closing, where there is a return.
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
    /// The view in which up (positive z) is up and left (positive y) is left. The geometry must fit the image.
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

    /// The picture of `colour(i)` for pixel `i = row * columns + column` of the scan.
    fn picture(&self, rows: usize, columns: usize, colour: impl Fn(usize) -> Rgb) -> Picture {
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
    let segment = |i: usize| match images.numbers[i] {
        _ if images.closed_edges[i] => BLACK,
        _ if scan.range_m[i] == 0.0 => WHITE,
        number => label_colour(number),
    };
    let range_title = format!("Range: {near_m:.1} m yellow, {far_m:.1} m blue");
    let picture = |colour: &dyn Fn(usize) -> Rgb| view.picture(scan.rows, scan.columns, colour);
    let panels = [
        (range_title.as_str(), picture(&|i| range_colour(scan.range_m[i], near_m, far_m))),
        ("Segments (edges black)", picture(&segment)),
        ("Bearing angle along rows", picture(&|i| bearing(images.bearing_rows, i))),
        ("Bearing angle along columns", picture(&|i| bearing(images.bearing_columns, i))),
        ("Edges along rows", picture(&|i| edge_colour(images.edges_rows[i]))),
        ("Edges along columns", picture(&|i| edge_colour(images.edges_columns[i]))),
        ("Edges of all traces", picture(&|i| edge_colour(images.edges[i]))),
        ("Edges after closing", picture(&|i| edge_colour(images.closed_edges[i]))),
    ];
    let across = if panels[0].1.width() > SHEET_WIDTH / 2 { 1 } else { 2 };
    sheet(&panels.map(|(title, panel)| (title, fitted(panel, SHEET_WIDTH / across))), across)
}

/// A picture some whole factor larger or smaller, to a width of `width` and less, or to twice that at most.
fn fitted(picture: Picture, width: usize) -> Picture {
    let (w, h) = (picture.width(), picture.height());
    let times = (width / w).clamp(1, 8);
    let parts = w.div_ceil(2 * width);
    if times * parts == 1 { picture } else { picture.scaled(w * times / parts, h * times / parts) }
}

/// The ranges that 2 % of the returns are nearer, farther than; 0 and 1 m where there is none.
fn usual_ranges_m(scan: &RangeImage) -> (f32, f32) {
    let mut ranges_m: Vec<f32> = scan.range_m.iter().copied().filter(|&m| m > 0.0).collect();
    ranges_m.sort_by(f32::total_cmp);
    let at =
        |percent: usize| ranges_m.get((ranges_m.len() * percent / 100).min(ranges_m.len().wrapping_sub(1))).copied();
    (at(2).unwrap_or(0.0), at(98).unwrap_or(1.0))
}
