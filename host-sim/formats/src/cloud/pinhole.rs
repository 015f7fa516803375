//! Points as a pinhole camera sees them.

use crate::cloud::fit::Deviation;
use crate::geometry::{Depth, Kind};

/// Returns whether the points lie as a camera sees them, more or less: one in front of the other
/// columns to the right, rows downward. `forward` turns a point to x forward, y left, z up.
pub(crate) fn looks(points: &[[f32; 3]], columns: usize, forward: impl Fn([f32; 3]) -> [f32; 3]) -> bool {
    let rows = points.len() / columns;
    let Some([across, down]) = lines(points, columns, forward) else { return false };
    let ordered = across.slope > 0.0 && down.slope > 0.0;
    let within = |line: &Line, count: usize| line.spread < 0.05 * line.slope.abs() * count as f64;
    ordered && within(&across, columns) && within(&down, rows)
}

/// Returns the camera that fits points best, x forward, y left, z up, and how they deviate from it; none
/// of points that are not in front of one.
pub(crate) fn fit(points: &[[f32; 3]], columns: usize) -> Option<(Deviation, Kind)> {
    let [across, down] = lines(points, columns, |point| point)?;
    let mut deviation = Deviation::default();
    for (row, column, right, low) in seen(points, columns, |point| point) {
        deviation.add(across.off(column, right) / across.slope, down.off(row, low) / down.slope);
    }
    let (fx_px, fy_px) = (1.0 / across.slope, 1.0 / down.slope);
    let (cx_px, cy_px) = (-across.start * fx_px, -down.start * fy_px);
    let kind = Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, depth: Depth::Range };
    Some((deviation, kind))
}

/// Row, column, and where the point lies at a distance of 1: to the right, and down.
fn seen(
    points: &[[f32; 3]],
    columns: usize,
    forward: impl Fn([f32; 3]) -> [f32; 3],
) -> impl Iterator<Item = (f64, f64, f64, f64)> {
    points.iter().enumerate().filter(|(_, point)| **point != [0.0; 3]).map(move |(i, point)| {
        let [forward, left, up] = forward(*point).map(f64::from);
        ((i / columns) as f64, (i % columns) as f64, -left / forward, -up / forward)
    })
}

/// A straight line over the columns, or over the rows.
struct Line {
    start: f64,
    slope: f64,
    /// Root mean square of what lies off it.
    spread: f64,
}

impl Line {
    fn off(&self, place: f64, value: f64) -> f64 {
        value - (self.start + self.slope * place)
    }
}

/// Returns the lines on which the points of columns and of rows lie; none if not all points lie in
/// front, or if they lie in one column or row.
fn lines(points: &[[f32; 3]], columns: usize, forward: impl Fn([f32; 3]) -> [f32; 3]) -> Option<[Line; 2]> {
    if points.iter().any(|point| *point != [0.0; 3] && forward(*point)[0] <= 0.0) {
        return None;
    }
    let mut across = Fit::default();
    let mut down = Fit::default();
    for (row, column, right, low) in seen(points, columns, forward) {
        across.add(column, right);
        down.add(row, low);
    }
    Some([across.line()?, down.line()?])
}

/// Sums of a straight line by least squares.
#[derive(Default)]
struct Fit {
    count: f64,
    sums: [f64; 2],
    products: [f64; 3],
}

impl Fit {
    fn add(&mut self, x: f64, y: f64) {
        self.count += 1.0;
        self.sums = [self.sums[0] + x, self.sums[1] + y];
        let [xx, xy, yy] = self.products;
        self.products = [xx + x * x, xy + x * y, yy + y * y];
    }

    fn line(&self) -> Option<Line> {
        let [x, y] = self.sums.map(|sum| sum / self.count);
        let [xx, xy, yy] = self.products.map(|product| product / self.count);
        let (xx, xy, yy) = (xx - x * x, xy - x * y, yy - y * y);
        let slope = xy / xx;
        let spread = (yy - slope * xy).max(0.0).sqrt();
        (xx > 0.1 && slope.is_finite() && slope.abs() > 1e-6).then_some(Line { start: y - slope * x, slope, spread })
    }
}
