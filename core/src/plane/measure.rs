//! The noise as the scan itself tells it: how large second differences of 1 / r along a row are.
//! They are 0 on any plane.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane::noise::Variance;
use crate::plane::rules::Rules;
use crate::plane::scanline::{Lanes, Scanline};
use crate::row::bits::CHUNK;

/// Ranges are told apart in so many classes: up to 2 m, 4 m, 8 m, and beyond.
const CLASSES: usize = 4;
/// The range that stands for each class, metres.
const MIDDLE_M: [f32; CLASSES] = [1.5, 3.0, 6.0, 12.0];
/// Second differences are counted by the binary exponent of their square, in units of what was
/// stated: from 2^-8 on so many exponents.
const STEPS: usize = 24;
/// The biased exponent of 2^-8.
const FIRST_STEP: usize = 119;
/// The biased exponent of 1 m and 2 m.
const FIRST_CLASS: usize = 127;
/// Second differences of a class that are kept; then all counts are halved, so that later ones
/// weigh more.
const MOST: u16 = 4096;
/// A class with fewer second differences tells nothing.
const FEWEST: u16 = 40;
/// Second differences reach over this angle, a degree, to either side where columns are finer:
/// errors of neighbours may be alike.
const REACH_RAD: f32 = 0.0185;
/// Columns that a second difference may reach to either side, the farthest first.
const REACHES: [usize; 4] = [8, 4, 3, 2];
/// Of a chunk every so many second differences count.
const STRIDE: usize = 3;

/// Second differences so far, by class and size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    counts: [[u16; STEPS]; CLASSES],
    totals: [u16; CLASSES],
}

impl Measured {
    pub const NONE: Measured = Measured { counts: [[0; STEPS]; CLASSES], totals: [0; CLASSES] };

    /// Takes second differences of a row whose `variance` is the stated one.
    pub fn look_at(&mut self, row: &Scanline, number: usize) {
        // of so many chunks, as a power of 2, one is looked at: fewer when much is known
        let shift = match self.all() {
            0..500 => 0,
            500..2000 => 2,
            _ => 4,
        };
        let mut lanes = Lanes::EMPTY;
        let mut from = (number & ((1 << shift) - 1)) * CHUNK;
        while from < row.ranges_m.len() {
            row.lanes(from, &mut lanes);
            self.look_at_chunk(row, &lanes);
            from += CHUNK << shift;
        }
    }

    fn look_at_chunk(&mut self, row: &Scanline, lanes: &Lanes) {
        let (c, s) = (&lanes.cos, &lanes.sin);
        let sine = |to: usize, from: usize| s[to] * c[from] - c[to] * s[from];
        let step = sine(1, 0).abs();
        let ahead = REACHES.into_iter().find(|&n| n as f32 * step < REACH_RAD).unwrap_or(2);
        let inverse = lanes.range_m.map(|r| if r > 0.0 { 1.0 / r } else { 0.0 });
        let mut squares = [-1.0f32; CHUNK];
        for i in ahead..CHUNK - ahead {
            let (l, r) = ((i - ahead) % CHUNK, (i + ahead) % CHUNK);
            let (alpha, beta, gamma) = (sine(r, i), sine(i, l), sine(r, l));
            let d = inverse[l] * alpha + inverse[r] * beta - inverse[i] * gamma;
            let range_m = lanes.range_m[i];
            let square_m2 = range_m * range_m;
            let expected = row.variance.at(range_m) * (alpha * alpha + beta * beta + gamma * gamma);
            let all = (lanes.range_m[l] > 0.0) & (lanes.range_m[r] > 0.0) & (range_m > 0.0);
            squares[i] = if all { d * d * square_m2 * square_m2 / expected } else { -1.0 };
        }
        for (square, range_m) in squares.iter().zip(lanes.range_m).skip(ahead).step_by(STRIDE) {
            if *square >= 0.0 {
                self.add(*square, range_m);
            }
        }
    }

    /// Takes the square of a second difference, in units of what was stated, at a range.
    fn add(&mut self, square: f32, range_m: f32) {
        let exponent = |x: f32| (x.to_bits() >> 23) as usize;
        let class = exponent(range_m).saturating_sub(FIRST_CLASS).min(CLASSES - 1);
        let step = exponent(square).saturating_sub(FIRST_STEP).min(STEPS - 1);
        if self.totals[class] >= MOST {
            self.counts[class] = self.counts[class].map(|n| n / 2);
            self.totals[class] = self.counts[class].iter().sum();
        }
        self.counts[class][step] += 1;
        self.totals[class] += 1;
    }

    fn all(&self) -> u32 {
        self.totals.iter().map(|&n| u32::from(n)).sum()
    }

    /// The variance of a class in units of what was stated: normal errors have the quantile
    /// [`Rules::noise_share`] at [`Rules::noise_square`].
    fn factor(&self, class: usize, rules: &Rules) -> Option<f32> {
        let total = self.totals[class % CLASSES];
        if total < FEWEST {
            return None;
        }
        let wanted = rules.noise_share * f32::from(total);
        let mut below = 0.0;
        for (step, &n) in self.counts[class % CLASSES].iter().enumerate() {
            let n = f32::from(n);
            if below + n >= wanted {
                // squares are spread like their roots within the step
                let low = f32::from_bits(((FIRST_STEP + step) as u32) << 23);
                let root = 1.0 + (wanted - below) / n * 0.414_213_56;
                return Some(low * root * root / rules.noise_square);
            }
            below += n;
        }
        None
    }

    /// The variance that counts: the larger of stated and measured.
    pub fn variance(&self, stated: &Variance, rules: &Rules) -> Variance {
        let all = self.all();
        let squares: [Option<f32>; CLASSES] = core::array::from_fn(|class| {
            // a class of few pixels may be an exception
            if 16 * u32::from(self.totals[class]) < all {
                return None;
            }
            let factor = self.factor(class, rules)?;
            if factor < rules.noise_trust {
                return Some(0.0);
            }
            let factor = if factor < rules.noise_most { factor } else { rules.noise_most };
            Some(factor * stated.at(MIDDLE_M[class % CLASSES]) * rules.noise_less)
        });
        let Some(least) = squares.iter().flatten().copied().reduce(|a, b| if b < a { b } else { a }) else {
            return *stated;
        };
        let mut grown = 0.0;
        for (square, r) in squares.iter().zip(MIDDLE_M) {
            let more = (square.unwrap_or(0.0) - least) / (r * r * r * r);
            grown = if more > grown { more } else { grown };
        }
        stated.with_measured([least, grown])
    }
}
