//! What the encoder did not say: the turn of a row beyond what was reported, from the planes that the row goes on with.
//!
//! A row that was turned further than reported is off on every floor, ceiling and front wall at once, and on each by the
//! same angle; on side walls it does not show. The angle is found from the weighted median over a quarter of the pixels,
//! then by least squares over those that agree with it. It must explain much of the row's error to be believed. Once a tenth
//! of the rows, and three, were off, surfaces are allowed to be uneven by as much.

use crate::bits::CHUNK;
use crate::follow::RowNoise;
use crate::scanline::{Lanes, Scanline};
use crate::surface::{FULL, Surfaces};
use crate::within::{at, part_mut, put};

/// Every fourth pixel is looked at.
const STRIDE: usize = 4;

/// Scratch for so many columns, in numbers.
pub(crate) const fn scratch_len(columns: usize) -> usize {
    2 * columns.div_ceil(STRIDE)
}

/// Standard deviation of the turn that is expected, radians: 2 deg; twice as much is believed.
const EXPECTED_RAD: f32 = 2.0 * core::f32::consts::PI / 180.0;

/// Squared errors, in units of the noise, that the angle must explain: in all, and for each pixel.
const GAIN: f32 = 8.0;
const GAIN_PER_PIXEL: f32 = 0.5;

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
}

impl Turns {
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
        let (mut count, mut weights) = (0, 0.0);
        let mut known = (FULL, None);
        let mut lanes = Lanes::EMPTY;
        for from in (0..above.len()).step_by(CHUNK) {
            line.lanes(from, &mut lanes);
            for i in (0..CHUNK.min(above.len() - from)).step_by(STRIDE) {
                let (slot, i) = (at(above, from + i), i % CHUNK);
                if slot != known.0 {
                    let plane = surfaces.plane(slot).filter(|_| {
                        let (rows, points) = surfaces.size(slot);
                        rows >= ROWS && points >= POINTS
                    });
                    known = (slot, plane.map(|plane| line.along(plane)));
                }
                let (range_m, Some([a, b, k, turned])) = (lanes.range_m[i], known.1) else { continue };
                let error = range_m * (range_m * (lanes.cos[i] * a + lanes.sin[i] * b + k) - 1.0);
                let slope = range_m * range_m * lanes.cos[i] * turned;
                let tells = slope * slope * (EXPECTED_RAD * EXPECTED_RAD) >= range_m2;
                if range_m > 0.0 && tells && error.abs() <= slope.abs() * (2.0 * EXPECTED_RAD) {
                    put(samples, count, [error, slope]);
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
        sort(samples, |[error, slope]| -error / slope);
        let mut sum = 0.0;
        let median = samples.iter().find(|sample| {
            sum += sample[1].abs();
            sum >= 0.5 * weights
        });
        let median_rad = median.map_or(0.0, |sample| -sample[0] / sample[1]);
        let off = |sample: &[f32; 2], turn_rad: f32| {
            let rest = sample[0] + turn_rad * sample[1];
            rest * rest / range_m2
        };
        let (mut products, mut squares) = (0.0, range_m2 / (EXPECTED_RAD * EXPECTED_RAD));
        for sample in samples.iter().filter(|sample| off(sample, median_rad) < OFF) {
            products -= sample[0] * sample[1];
            squares += sample[1] * sample[1];
        }
        let turn_rad = products / squares;
        let gain: f32 = samples.iter().map(|sample| off(sample, 0.0).min(OFF) - off(sample, turn_rad).min(OFF)).sum();
        let believed = gain > GAIN && gain > GAIN_PER_PIXEL * count as f32 && turn_rad.abs() < 2.0 * EXPECTED_RAD;
        if !believed {
            return None;
        }
        self.off += 1;
        self.squares_rad2 += turn_rad * turn_rad;
        Some(turn_rad)
    }
}

/// Sorts by a key, smallest first: a heap, because the sorts of the standard library can panic.
fn sort(samples: &mut [[f32; 2]], key: impl Fn([f32; 2]) -> f32) {
    let sink = |samples: &mut [[f32; 2]], mut place: usize, end: usize| {
        let sample = at(samples, place);
        loop {
            let left = 2 * place + 1;
            if left >= end {
                break;
            }
            let right_is_larger = left + 1 < end && key(at(samples, left)) < key(at(samples, left + 1));
            let child = left + usize::from(right_is_larger);
            if key(sample) >= key(at(samples, child)) {
                break;
            }
            put(samples, place, at(samples, child));
            place = child;
        }
        put(samples, place, sample);
    };
    let count = samples.len();
    for place in (0..count / 2).rev() {
        sink(samples, place, count);
    }
    for end in (1..count).rev() {
        let (largest, last) = (at(samples, 0), at(samples, end));
        put(samples, end, largest);
        put(samples, 0, last);
        sink(samples, 0, end);
    }
}

#[cfg(test)]
mod tests {
    #[test]
    fn sorted() {
        for count in 0..40_u32 {
            let mut samples: std::vec::Vec<_> = (0..count).map(|i| [(i * 17 % 23) as f32, 1.0]).collect();
            let mut expected = samples.clone();
            expected.sort_by(|a, b| a[0].total_cmp(&b[0]));
            super::sort(&mut samples, |[error, _]| error);
            assert_eq!(samples, expected);
        }
    }
}
