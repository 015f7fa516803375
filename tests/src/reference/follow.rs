//! Which pixels of a row go on with the planes of the row above, and what the row's turn is beyond
//! what was reported.

use super::doubt::Doubt;
use nalgebra::{Matrix3, Vector3};

/// Squared error, in units of the noise, from which on a pixel lies on no plane.
const OFF: f64 = 10.0;
/// Squared error that is none at all: the plane is not there.
const FAR: f64 = 1e6;
/// Price of a pixel that has left all planes, and of leaving.
const LEFT: f64 = 2.5;
const LEAVE: f64 = 12.0;
/// Variance of the direction of a beam, rad^2, and the largest squared tangent of the incidence.
const BEAM_RAD2: f64 = 1.2e-7;
const MAX_TAN_SQUARE: f64 = 200.0;
/// Most that the turn adds to the variance of a range, in units of the noise.
const MOST: f64 = 9.0;

/// Standard deviation of a turn; twice as much is believed.
const EXPECTED_RAD: f64 = 2.0 * std::f64::consts::PI / 180.0;
/// What a turn must explain, in all and per pixel, and the most that one pixel counts.
const GAIN: f64 = 8.0;
const GAIN_PER_PIXEL: f64 = 0.5;
const TURN_OFF: f64 = 9.0;

/// A row of the image.
pub struct Row {
    /// Directions of the beams.
    pub directions: Vec<Vector3<f64>>,
    /// Ranges, metres.
    pub ranges_m: Vec<Option<f64>>,
    /// What the rows turn about; 0 for nothing.
    pub axis: Vector3<f64>,
    /// The last column neighbours the first.
    pub wraps: bool,
    /// Variance of a range, m^2.
    pub range_m2: f64,
}

impl Row {
    /// Error of a range on a plane p . m = 1 with the row turned by an angle, and by how much it
    /// grows per radian.
    fn error_m(&self, column: usize, m: &Vector3<f64>, turn_rad: f64) -> Option<[f64; 3]> {
        let range_m = self.ranges_m[column]?;
        let moved = self.axis.cross(&self.directions[column]);
        let product = range_m * (self.directions[column] + moved * turn_rad).dot(m);
        Some([range_m * (product - 1.0), range_m * range_m * moved.dot(m), product])
    }
}

/// For each column what it goes on with, by the number of an area. `above` are the areas of the row
/// above, `plane` the planes of those that have one, and how far it moves at a point p if one of
/// its points is rounded to the other side: at most by the root of p A p, as p . m. `turn_rad2` is
/// the variance of the turn that is left.
pub fn follow(
    row: &Row,
    above: &[Option<usize>],
    plane: impl Fn(usize) -> Option<(Vector3<f64>, Matrix3<f64>)>,
    (turn_rad, turn_rad2): (f64, f64),
    doubt: &mut Doubt,
) -> Vec<Option<usize>> {
    let columns = above.len();
    let (mut prices, mut best) = (vec![None; columns], vec![None; columns]);
    for column in 0..columns {
        let Some(range_m) = row.ranges_m[column] else { continue };
        let beside = [column.checked_sub(1).or(row.wraps.then_some(columns - 1)), Some(column), Some(column + 1)];
        // squared error, area, and by how much the square may be off
        let mut tried: Vec<(f64, usize, f64)> = Vec::new();
        for neighbour in beside.into_iter().flatten() {
            let neighbour = if neighbour == columns && row.wraps { 0 } else { neighbour };
            let Some(area) = above.get(neighbour).copied().flatten() else { continue };
            let Some((m, rounding)) = plane(area) else { continue };
            let [error_m, slope, product] = row.error_m(column, &m, turn_rad).unwrap();
            let tan_square = (range_m * range_m * m.norm_squared() - 1.0).clamp(0.0, MAX_TAN_SQUARE);
            let turned = (slope * slope * turn_rad2).min(MOST * row.range_m2);
            let variance = row.range_m2 + turned + range_m * range_m * tan_square * BEAM_RAD2;
            let square = error_m * error_m / variance;
            let point = row.directions[column] * range_m;
            let off = range_m * (rounding * point).dot(&point).sqrt() / variance.sqrt();
            let margin = (2.0 * square.sqrt() + off) * off;
            let there = doubt.above(product, 0.05, 1e-4) && !doubt.above(square, FAR, 0.01 * FAR);
            if there && !tried.iter().any(|&(_, known, _)| known == area) {
                tried.push((square, area, margin));
            }
        }
        tried.sort_by(|a, b| a.0.total_cmp(&b.0));
        if let [(first, _, margin), (second, _, other), ..] = tried[..]
            && first < OFF
        {
            doubt.above(second, first, 0.02 * first.sqrt() + 1e-4 + margin + other);
        }
        // without a plane to go on with, the pixel leaves
        prices[column] = Some(tried.first().map_or(f64::INFINITY, |first| first.0.min(OFF)));
        best[column] = tried.first().filter(|first| !doubt.above(first.0, OFF, 0.1)).map(|first| first.1);
    }
    // least price of the columns so far, on a plane and off them all
    let mut least = vec![[0.0, LEAVE]];
    for price in &prices {
        let [on, left] = least[least.len() - 1];
        let [price_on, price_left] = price.map_or([0.0, 0.0], |price| [price, LEFT]);
        least.push([price_on.min(FAR) + on.min(left), price_left + left.min(on + LEAVE)]);
    }
    let margin = 0.2;
    let [on, left] = least[columns];
    let mut has_left = doubt.above(on, left, margin);
    for column in (0..columns).rev() {
        if has_left {
            best[column] = None;
        }
        // what is before the first return does not matter
        if !prices[..column].iter().any(Option::is_some) {
            break;
        }
        let [on, left] = least[column];
        has_left = if has_left { !doubt.above(left, on + LEAVE, margin) } else { doubt.above(on, left, margin) };
    }
    best
}

/// What is known of the turns of a scan.
#[derive(Default)]
pub struct Turns {
    told: f64,
    off: f64,
    squares_rad2: f64,
}

impl Turns {
    /// Variance of the turn of a row, rad^2: none before three rows and a tenth of them were off.
    pub fn variance_rad2(&self) -> f64 {
        let rows = self.told + 2.0;
        if self.off >= 3.0 && 10.0 * self.off >= rows { self.squares_rad2 / rows } else { 0.0 }
    }

    /// The turn of a row beyond what was reported. `plane` gives the planes of areas that have 4
    /// rows and 50 points.
    pub fn of_row(
        &mut self,
        row: &Row,
        above: &[Option<usize>],
        plane: impl Fn(usize) -> Option<Vector3<f64>>,
        doubt: &mut Doubt,
    ) -> f64 {
        if row.axis == Vector3::zeros() {
            return 0.0;
        }
        let mut samples = Vec::new();
        for column in (0..above.len()).step_by(4) {
            let Some(m) = above[column].and_then(&plane) else { continue };
            let Some([error_m, slope, _]) = row.error_m(column, &m, 0.0) else { continue };
            let tells = doubt.above(slope * slope * EXPECTED_RAD * EXPECTED_RAD, row.range_m2, 1e-3 * row.range_m2);
            if tells && !doubt.above(error_m.abs(), slope.abs() * 2.0 * EXPECTED_RAD, 1e-4) {
                samples.push((-error_m / slope, slope.abs()));
            }
        }
        if samples.len() < 3 {
            return 0.0;
        }
        self.told += 1.0;
        samples.sort_by(|a, b| a.0.total_cmp(&b.0));
        let half: f64 = samples.iter().map(|sample| sample.1).sum::<f64>() / 2.0;
        let mut sum = 0.0;
        let above_half = |sample: &&(f64, f64)| {
            sum += sample.1;
            sum >= half
        };
        let median_rad = samples.iter().find(above_half).unwrap().0;
        // a sample (t, s) with the row turned by x is off by s (x - t)
        let off = |sample: &(f64, f64), x: f64| (sample.1 * (x - sample.0)).powi(2) / row.range_m2;
        let (mut products, mut weights) = (0.0, row.range_m2 / (EXPECTED_RAD * EXPECTED_RAD));
        for sample in &samples {
            if !doubt.above(off(sample, median_rad), TURN_OFF, 0.05) {
                products += sample.0 * sample.1 * sample.1;
                weights += sample.1 * sample.1;
            }
        }
        let turn_rad = products / weights;
        let gain: f64 =
            samples.iter().map(|sample| off(sample, 0.0).min(TURN_OFF) - off(sample, turn_rad).min(TURN_OFF)).sum();
        let least = GAIN.max(GAIN_PER_PIXEL * samples.len() as f64);
        let margin = 0.02 * least;
        if !doubt.above(gain, least, margin) || doubt.above(turn_rad.abs(), 2.0 * EXPECTED_RAD, 1e-4) {
            return 0.0;
        }
        self.off += 1.0;
        self.squares_rad2 += turn_rad * turn_rad;
        turn_rad
    }
}
