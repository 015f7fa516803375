//! Lines of one row: the partition whose squared range errors, in units of the noise, and prices
//! are least in sum. All partitions are tried.
//!
//! On a line of a row u . m = 1 / r. A range error of one standard deviation moves 1 / r by sigma /
//! r^2, so that the squares of (u . m - 1 / r) r^2 / sigma are chi-square.

use super::Image;
use super::beams::Beams;
use nalgebra::{DMatrix, DVector, Vector3};
use scanseg_core::Ranging;

/// Price of a line, and of a pixel in a line of its own.
pub const LINE: f64 = 14.0;
const LONE: f64 = 10.0;
/// Pixels without a return that a line may go across.
const GAP: usize = 3;
/// Least standard deviation of a range, metres.
const LEAST_M: f64 = 0.0015;

/// The returns of a row.
pub struct RowOfLines {
    columns: Vec<usize>,
    beams: Vec<Vector3<f64>>,
    ranges_m: Vec<f64>,
    sigmas_m: Vec<f64>,
}

impl RowOfLines {
    /// Of the first row of an image.
    pub fn new(image: &Image, beams: &Beams, ranging: &Ranging) -> RowOfLines {
        let columns: Vec<_> = (0..image.size.columns).filter(|&c| image.range((0, c)).is_some()).collect();
        let ranges_m: Vec<_> = columns.iter().map(|&c| f64::from(image.range((0, c)).unwrap())).collect();
        let noise_m = f64::from(ranging.range_noise_m);
        RowOfLines {
            beams: columns.iter().map(|&c| beams.direction((0, c))).collect(),
            sigmas_m: ranges_m.iter().map(|_| noise_m.hypot(LEAST_M)).collect(),
            columns,
            ranges_m,
        }
    }

    /// Chi-square of a line through some returns.
    fn squares(&self, from: usize, to: usize) -> f64 {
        if to - from < 3 {
            return 0.0;
        }
        // u = cos along + sin across, within the row
        let (first, last) = (self.beams[from], self.beams[to - 1]);
        let along = (first + last).normalize();
        let across = (last - first).normalize();
        let weight = |i: usize| self.ranges_m[i] * self.ranges_m[i] / self.sigmas_m[i];
        let matrix = DMatrix::from_fn(to - from, 2, |i, j| {
            let axis = if j == 0 { along } else { across };
            axis.dot(&self.beams[from + i]) * weight(from + i)
        });
        let right = DVector::from_fn(to - from, |i, _| weight(from + i) / self.ranges_m[from + i]);
        let best = matrix.clone().svd(true, true).solve(&right, 1e-14).unwrap();
        (matrix * best - right).norm_squared()
    }

    fn price_of_line(&self, from: usize, to: usize) -> f64 {
        if to - from == 1 { LONE } else { LINE + self.squares(from, to) }
    }

    /// Whether a line may go on from a return to the next one.
    fn goes_on(&self, i: usize) -> bool {
        self.columns[i + 1] - self.columns[i] <= GAP + 1
    }

    /// The least price of all partitions.
    pub fn least(&self) -> f64 {
        let mut least = vec![0.0];
        for to in 1..=self.columns.len() {
            let mut best = f64::INFINITY;
            for from in (0..to).rev() {
                best = best.min(least[from] + self.price_of_line(from, to));
                if from > 0 && !self.goes_on(from - 1) {
                    break;
                }
            }
            least.push(best);
        }
        *least.last().unwrap()
    }

    /// The price of the lines that these labels, one per pixel of the row, make.
    pub fn price(&self, labels: &[u32]) -> f64 {
        let labels: Vec<_> = self.columns.iter().map(|&c| labels[c]).collect();
        let (mut price, mut from) = (0.0, 0);
        for same in labels.chunk_by(|a, b| a == b) {
            price += self.price_of_line(from, from + same.len());
            from += same.len();
        }
        price
    }
}
