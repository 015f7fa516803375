//! What the encoder did not say: the turn of a row beyond what was reported, from the planes that
//! the row goes on with.
//!
//! A row that was turned further than reported is off on every floor, ceiling and front wall at
//! once, and on each by the same angle; on side walls it does not show. The angle is found from the
//! weighted median over a quarter of the pixels, then by least squares over those that agree with
//! it. It must explain much of the row's error to be believed. Once a tenth of the rows, and three,
//! were off, surfaces are allowed to be uneven by as much.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane::noise::RowNoise;
use crate::plane::rules::{Rules, TURN_STRIDE};
use crate::plane::scanline::{Lanes, Scanline};
use crate::plane::surface::{FULL, Surfaces};
use crate::row::bits::CHUNK;
use crate::row::within::{at, part_mut, put, swap};

/// Scratch for so many columns, in numbers.
pub(crate) const fn scratch_len(columns: usize) -> usize {
    2 * columns.div_ceil(TURN_STRIDE)
}

/// What is known of the turn angles of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowTurns {
    /// Rows that could tell, rows that were off, and the sum of the squares of the latter.
    told: u32,
    off: u32,
    squares_rad2: f32,
}

impl RowTurns {
    /// Variance of the turn angle, rad^2.
    pub fn variance_rad2(&self) -> f32 {
        // two rows more, so that the first ones do not speak for all
        let rows = self.told + 2;
        if self.off >= 3 && 10 * self.off >= rows { self.squares_rad2 / rows as f32 } else { 0.0 }
    }

    /// The noise of a row. `scratch` has [`scratch_len`] elements.
    pub fn of_row(
        &mut self,
        line: &Scanline,
        above: &[u16],
        surfaces: &Surfaces,
        range_m2: f32,
        scratch: &mut [f32],
    ) -> RowNoise {
        let turn_rad = self.turn(line, above, surfaces, range_m2, scratch).unwrap_or(0.0);
        RowNoise { range_m2, turn_rad, turn_rad2: 0.25 * self.variance_rad2() }
    }

    fn turn(
        &mut self,
        line: &Scanline,
        above: &[u16],
        surfaces: &Surfaces,
        range_m2: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        if line.fan.axis() == [0.0; 3] {
            return None;
        }
        let samples = scratch.as_chunks_mut::<2>().0;
        let (count, weights) = sample(line, above, surfaces, range_m2, samples);
        if count < 3 {
            return None;
        }
        self.told += 1;
        let turn_rad = estimate(part_mut(samples, 0..count), weights, range_m2, surfaces.rules)?;
        self.off += 1;
        self.squares_rad2 += turn_rad * turn_rad;
        Some(turn_rad)
    }
}

/// Range errors of the pixels whose planes tell the turn, metres, and how each changes with it,
/// metres per radian. Returns how many there are, and the sum of their absolute slopes.
fn sample(
    line: &Scanline,
    above: &[u16],
    surfaces: &Surfaces,
    range_m2: f32,
    samples: &mut [[f32; 2]],
) -> (usize, f32) {
    let &Rules { turn_rad: expected_rad, turn_points, turn_rows, .. } = surfaces.rules;
    let (mut count, mut weights) = (0, 0.0);
    let mut known = (FULL, None);
    let mut lanes = Lanes::EMPTY;
    for from in (0..above.len()).step_by(CHUNK) {
        line.lanes(from, &mut lanes);
        for i in (0..CHUNK.min(above.len() - from)).step_by(TURN_STRIDE) {
            let (slot, i) = (at(above, from + i), i % CHUNK);
            if slot != known.0 {
                let plane = surfaces.plane(slot).filter(|_| {
                    let (rows, points) = surfaces.size(slot);
                    rows >= turn_rows && points >= turn_points
                });
                known = (slot, plane.map(|plane| line.along(plane)));
            }
            let (range_m, Some([a, b, k, turned])) = (lanes.range_m[i], known.1) else { continue };
            let error = range_m * (range_m * (lanes.cos[i] * a + lanes.sin[i] * b + k) - 1.0);
            let slope = range_m * range_m * lanes.cos[i] * turned;
            let tells = slope * slope * (expected_rad * expected_rad) >= range_m2;
            if range_m > 0.0 && tells && error.abs() <= slope.abs() * (2.0 * expected_rad) {
                put(samples, count, [error, slope]);
                count += 1;
                weights += slope.abs();
            }
        }
    }
    (count, weights)
}

/// The turn that the samples tell, if it explains enough of their errors to be believed.
fn estimate(samples: &mut [[f32; 2]], weights: f32, range_m2: f32, rules: &Rules) -> Option<f32> {
    let &Rules { turn_rad: expected_rad, turn_off, .. } = rules;
    let median_rad = weighted_median(samples, |[error, slope]| -error / slope, |[_, slope]| slope.abs(), 0.5 * weights);
    let off = |sample: &[f32; 2], turn_rad: f32| {
        let rest = sample[0] + turn_rad * sample[1];
        rest * rest / range_m2
    };
    let (mut products, mut squares) = (0.0, range_m2 / (expected_rad * expected_rad));
    for sample in samples.iter().filter(|sample| off(sample, median_rad) < turn_off) {
        products -= sample[0] * sample[1];
        squares += sample[1] * sample[1];
    }
    let turn_rad = products / squares;
    let gain: f32 =
        samples.iter().map(|sample| off(sample, 0.0).min(turn_off) - off(sample, turn_rad).min(turn_off)).sum();
    let believed = gain > rules.turn_gain
        && gain > rules.turn_gain_per_pixel * samples.len() as f32
        && turn_rad.abs() < 2.0 * expected_rad;
    believed.then_some(turn_rad)
}

/// Rounds after which the median is good enough: some seven are needed for a hundred samples.
const ROUNDS: usize = 32;

/// The least key for which the weights of the keys up to it reach `half`. Leaves the samples in
/// another order.
fn weighted_median(
    samples: &mut [[f32; 2]],
    key: impl Fn([f32; 2]) -> f32,
    weight: impl Fn([f32; 2]) -> f32,
    half: f32,
) -> f32 {
    let (mut low, mut high, mut below, mut pivot) = (0, samples.len(), 0.0, 0.0);
    for _ in 0..ROUNDS {
        if low >= high {
            break;
        }
        pivot = key(at(samples, (low + high) / 2));
        // in three parts: less than the pivot up to `less`, more from `more` on
        let (mut less, mut next, mut more) = (low, low, high);
        let (mut lighter, mut equal) = (0.0, 0.0);
        while next < more {
            let sample = at(samples, next);
            if key(sample) < pivot {
                lighter += weight(sample);
                swap(samples, next, less);
                less += 1;
                next += 1;
            } else if key(sample) > pivot {
                more -= 1;
                swap(samples, next, more);
            } else {
                equal += weight(sample);
                next += 1;
            }
        }
        if below + lighter >= half {
            high = less;
        } else if below + lighter + equal >= half {
            break;
        } else {
            below += lighter + equal;
            low = more;
        }
    }
    pivot
}

#[cfg(test)]
mod tests {
    /// Against sorting, for keys that are all different and ones that are not.
    #[test]
    fn medians() {
        for count in 1..60_u32 {
            for different in [1, 5, 61] {
                let samples: std::vec::Vec<_> =
                    (0..count).map(|i| [(i * 17 % different) as f32, (i * 7 % 11 + 1) as f32]).collect();
                let half = 0.5 * samples.iter().map(|sample| sample[1]).sum::<f32>();
                let mut sorted = samples.clone();
                sorted.sort_by(|a, b| a[0].total_cmp(&b[0]));
                let mut sum = 0.0;
                let expected = sorted.iter().find(|sample| {
                    sum += sample[1];
                    sum >= half
                });
                let median = super::weighted_median(&mut samples.clone(), |[key, _]| key, |[_, weight]| weight, half);
                assert_eq!(Some(median), expected.map(|sample| sample[0]), "{count} {different}");
            }
        }
    }
}
