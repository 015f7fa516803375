//! What the encoder did not say: the turn of a row beyond what was reported, from the planes that the row goes on with.
//!
//! A row that was turned further than reported is off on every floor, ceiling and front wall at once, and on each by the
//! same angle; on side walls it does not show. The angle is found from the weighted median over a quarter of the pixels,
//! then by least squares over those that agree with it. It must explain much of the row's error to be believed. Once a tenth
//! of the rows, and three, were off, surfaces are allowed to be uneven by as much.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::row::bits::CHUNK;

use crate::plane::areas::{Areas, FULL};
use crate::plane::row::{Lanes, RowView};
use crate::row::slots::NONE;
use crate::row::within::{at, part_mut, put, swap};
use crate::sums::dot;

/// Every so many pixels are looked at, some 90 to 180 in all.
const fn stride(columns: usize) -> usize {
    if columns < 512 { 8 } else { columns / 64 }
}

/// Scratch for so many columns, in numbers.
pub(crate) const fn scratch_len(columns: usize) -> usize {
    3 * columns.div_ceil(stride(columns))
}

/// Planes that are told apart.
const PLANES: usize = 8;

/// Squared error, in units of the noise, beyond which a pixel is on another surface.
const OFF: f32 = 9.0;

/// Planes with fewer points or rows may themselves be wrong.
const POINTS: u32 = 50;
const ROWS: u16 = 4;

/// What is known of the turn angles of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turns {
    /// Rows that could tell, rows that were off, and the sum of the squares of the latter.
    told: u32,
    off: u32,
    squares_rad2: f32,
    /// Turn of the last row, and what was more than reported.
    last: [f32; 2],
}

impl Turns {
    /// Variance of the turn angle, rad^2.
    pub fn variance_rad2(&self) -> f32 {
        // two rows more, so that the first ones do not speak for all
        let rows = self.told + 2;
        if self.off >= 3 && 10 * self.off >= rows { self.squares_rad2 / rows as f32 } else { 0.0 }
    }

    /// A turn that was not reported showed afterwards.
    pub fn learn(&mut self, turn_rad: f32) {
        self.off += 1;
        self.squares_rad2 += turn_rad * turn_rad;
    }

    /// What is off in a row on several planes at once: its turn beyond what was reported, radians; of a spinning scanner
    /// all its ranges, metres. `scratch` has [`scratch_len`] elements.
    pub fn of_row(
        &mut self,
        line: &RowView,
        above: &[u16],
        surfaces: &Areas,
        stated: f32,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        let found = self.find(line, above, surfaces, stated, turn_rad, scratch);
        self.last = [turn_rad, found.unwrap_or(0.0)];
        found
    }

    /// Whether a turn that one plane alone tells can be one of the encoder: the scanner went on by it. (A wall that begins
    /// where the floor ends looks as if it had stopped.)
    fn alone(&self, by: f32, turn_rad: f32, rules: &crate::plane::rules::Rules) -> bool {
        let step = turn_rad - self.last[0];
        let went = step + by - self.last[1];
        let share = went / step;
        step != 0.0 && share > rules.turn_alone[0] && share < rules.turn_alone[1]
    }

    fn find(
        &mut self,
        line: &RowView,
        above: &[u16],
        surfaces: &Areas,
        stated: f32,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        let rules = surfaces.rules;
        let turns = line.fan.axis() != [0.0; 3];
        if !turns && !line.fan.spins() {
            return None;
        }
        let expected = if turns { rules.turn_expected_rad } else { rules.ring_expected_m };
        let samples = scratch.as_chunks_mut::<3>().0;
        let (mut count, mut weights) = (0, 0.0);
        let mut known = (FULL, None);
        let mut lanes = Lanes::EMPTY;
        let stride = stride(above.len());
        let mut at_chunk = usize::MAX;
        for column in (0..above.len()).step_by(stride) {
            {
                let (slot, i) = (at(above, column), column % CHUNK);
                if slot >= FULL {
                    continue;
                }
                if slot != known.0 {
                    let plane = surfaces.plane(slot).filter(|_| {
                        let (rows, points) = surfaces.size(slot);
                        rows >= ROWS && points >= POINTS
                    });
                    known = (slot, plane.map(|plane| line.along(plane)));
                }
                if known.1.is_none() {
                    continue;
                }
                if at_chunk != column / CHUNK {
                    at_chunk = column / CHUNK;
                    line.lanes(at_chunk * CHUNK, &mut lanes);
                }
                let (range_m, Some([a, b, k, turned])) = (lanes.range_m[i], known.1) else { continue };
                if range_m == 0.0 {
                    continue;
                }
                let inverse = 1.0 / libm::sqrtf(line.variance.at(range_m));
                let error = inverse * range_m * (range_m * (lanes.cos[i] * a + lanes.sin[i] * b + k) - 1.0);
                let slope = inverse * if turns { range_m * range_m * lanes.cos[i] * turned } else { -1.0 };
                let tells = slope * slope * expected * expected >= 1.0;
                if tells && error.abs() <= slope.abs() * (2.0 * expected) {
                    put(samples, count, [error, slope, f32::from(slot)]);
                    count += 1;
                    weights += slope.abs();
                }
            }
        }
        if count < 3 {
            return None;
        }
        self.told += 1;
        let samples = part_mut(samples, 0..count);
        // most rows are where they are said to be
        let (mut products, mut squares, mut far) = (0.0, 1.0, 0);
        for [error, slope, _] in samples.iter() {
            if error * error < OFF {
                products += error * slope;
                squares += slope * slope;
            } else {
                far += 1;
            }
        }
        if products * products < rules.turn_gain * squares && 10 * far < count {
            return None;
        }
        let median =
            weighted_median(samples, |[error, slope, _]| -error / slope, |[_, slope, _]| slope.abs(), 0.5 * weights);
        let off = |sample: &[f32; 3], by: f32| {
            let rest = sample[0] + by * sample[1];
            rest * rest
        };
        let (mut products, mut squares) = (0.0, 1.0 / (expected * expected));
        for sample in samples.iter().filter(|sample| off(sample, median) < OFF) {
            products -= sample[0] * sample[1];
            squares += sample[1] * sample[1];
        }
        let by = products / squares;
        // what it explains, plane by plane
        let mut planes = [(0.0f32, NONE); PLANES];
        let mut gain = 0.0;
        for sample in samples.iter() {
            let more = off(sample, 0.0).min(OFF) - off(sample, by).min(OFF);
            gain += more;
            let slot = sample[2] as u16;
            if let Some(known) = planes.iter_mut().find(|plane| plane.1 == slot || plane.1 == NONE) {
                *known = (known.0 + more, slot);
            }
        }
        let best = planes.iter().fold((0.0, NONE), |best, plane| if plane.0 > best.0 { *plane } else { best });
        let reference = surfaces.get(best.1).fitted.m;
        let square = |m: [f32; 3]| dot(m, m);
        let other = planes.iter().any(|&(gain, slot)| {
            let m = surfaces.get(slot).fitted.m;
            let cos = dot(m, reference);
            slot != NONE && gain > rules.turn_other && cos * cos < rules.turn_cos_square * square(m) * square(reference)
        });
        let believed = gain > rules.turn_gain
            && gain > rules.turn_gain_per_pixel * count as f32
            && by.abs() < 2.0 * expected
            && (other
                || self.alone(by, turn_rad, rules)
                || by * by <= 9.0 * (stated * stated + if turns { self.variance_rad2() } else { 0.0 }));
        #[cfg(feature = "trace")]
        std::eprintln!(
            "row {} off {:.4} gain {gain:.0} count {count} other {other} believed {believed} {planes:?}",
            surfaces.row,
            by
        );
        if !believed {
            return None;
        }
        if turns {
            self.off += 1;
            self.squares_rad2 += by * by;
        }
        Some(by)
    }
}

/// Rounds after which the median is good enough: some seven are needed for a hundred samples.
const ROUNDS: usize = 32;

/// The least key for which the weights of the keys up to it reach `half`. Leaves the samples in another order.
fn weighted_median(
    samples: &mut [[f32; 3]],
    key: impl Fn([f32; 3]) -> f32,
    weight: impl Fn([f32; 3]) -> f32,
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
