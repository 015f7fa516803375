//! The noise as the scan itself tells it: how large second differences of 1 / r along a row are.
//! They are 0 on any plane.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{below, lone_sqrt};
use crate::plane::alike::Alike;
use crate::plane::noise::Variance;
use crate::plane::rules::{LEAN, Rules};
use crate::plane::scanline::Scanline;
use crate::row::bits::{CHUNK, VECTORS};
use crate::row::fan::Lanes;

/// Ranges are told apart in so many classes: up to 2 m, 4 m, 8 m, and beyond.
const CLASSES: usize = 4;
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
/// Fourth power of 0.1 m: noise is not taken to grow from a range of 0.
const NEAREST_M4: f32 = 1e-4;
/// A class with fewer second differences tells nothing.
const FEWEST: u16 = 40;
/// Second differences reach over this angle, a degree, to either side where columns are finer:
/// errors of neighbours may be alike.
const REACH_RAD: f32 = 0.0185;
/// Columns that a second difference may reach to either side, the farthest first.
const REACHES: [usize; 4] = [8, 4, 3, 2];
/// Ranges come in coarse steps if one of so many second differences is about 0 at least, and one of
/// so many is not,
const STEPPED: u16 = 4;
/// if there are none of so many sizes between them,
const STEP_GAP: usize = 4;
/// if those that are not are mostly of so many sizes,
const STEP_SIZES: usize = 6;
/// and of so many in all.
const FEWEST_STEPPED: u16 = 200;
/// Of a chunk every so many second differences count.
const STRIDE: usize = 3;
/// Square of the range beyond which measured noise is not taken to grow, m^2.
const MOST_MEASURED_M2: f32 = 144.0;
/// Squares of second differences across edges are so many binary exponents above that of the noise, or more.
const EDGE_STEPS: usize = 3;

/// The biased exponent of a number that is not negative.
fn exponent(x: f32) -> usize {
    (x.to_bits() >> 23) as usize
}

fn sign(x: f32) -> i32 {
    if x.is_sign_positive() { 1 } else { -1 }
}

fn class_of(range_m: f32) -> usize {
    exponent(range_m).saturating_sub(FIRST_CLASS).min(CLASSES - 1)
}

/// Second differences so far, by class and size.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    counts: [[u16; STEPS]; CLASSES],
    totals: [u16; CLASSES],
    /// Mean range of each class, metres.
    means_m: [f32; CLASSES],
    alike: Alike,
}

impl Measured {
    pub const NONE: Measured =
        Measured { counts: [[0; STEPS]; CLASSES], totals: [0; CLASSES], means_m: [0.0; CLASSES], alike: Alike::NONE };

    /// Takes second differences of a row whose `variance` is the stated one.
    pub fn look_at(&mut self, row: &Scanline, number: usize, rules: &Rules) {
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
            self.look_at_chunk(row, &lanes, rules);
            from += CHUNK << shift;
        }
    }

    fn look_at_chunk(&mut self, row: &Scanline, lanes: &Lanes, rules: &Rules) {
        let (c, s) = (&lanes.cos, &lanes.sin);
        let sine = |to: usize, from: usize| s[to] * c[from] - c[to] * s[from];
        // free beams without a return may point anywhere
        let both = |i: &usize| lanes.range_m[*i] > 0.0 && lanes.range_m[*i + 1] > 0.0;
        let first = if row.fan.is_free() { (0..CHUNK - 1).find(both).unwrap_or(0) } else { 0 };
        let step = sine((first + 1) % CHUNK, first % CHUNK).abs();
        let ahead = REACHES.into_iter().find(|&n| n as f32 * step < REACH_RAD).unwrap_or(2);
        let inverse = lanes.range_m.map(|r| if r > 0.0 { 1.0 / r } else { 0.0 });
        // in units of the variance, less than 0 where a return is missing; and the second difference
        let square_at = |i: usize| {
            let (l, r) = ((i - ahead) % CHUNK, (i + ahead) % CHUNK);
            let (alpha, beta, gamma) = (sine(r, i), sine(i, l), sine(r, l));
            let d = inverse[l] * alpha + inverse[r] * beta - inverse[i] * gamma;
            let range_m = lanes.range_m[i];
            let square_m2 = range_m * range_m;
            // how the line leans across the row is not known
            let beside = lanes.beside[l] * alpha + lanes.beside[r] * beta - lanes.beside[i] * gamma;
            let lean_m = LEAN * range_m * beside;
            let expected =
                row.variance.lone_at(range_m) * (alpha * alpha + beta * beta + gamma * gamma) + lean_m * lean_m;
            let all = (lanes.range_m[l] > 0.0) & (lanes.range_m[r] > 0.0) & (range_m > 0.0);
            (if all { d * d * square_m2 * square_m2 / expected } else { -1.0 }, d)
        };
        let (mut squares, mut differences) = ([0.0f32; CHUNK], [0.0f32; CHUNK]);
        if VECTORS {
            for i in (ahead..CHUNK - ahead).map(|i| i % CHUNK) {
                (squares[i], differences[i]) = square_at(i);
            }
        }
        // smaller squares are rounding, larger ones are across an edge
        let mut edge = 0;
        if ahead == REACHES[0] && self.alike.is_open() {
            let factor = self.factor(class_of(lanes.range_m[CHUNK / 2]), rules);
            edge = exponent(factor.unwrap_or(0.0)) + EDGE_STEPS;
        }
        let mut signs = [0; 3];
        for i in (ahead..CHUNK - ahead).step_by(STRIDE).map(|i| i % CHUNK) {
            let (square, difference) = if VECTORS { (squares[i], differences[i]) } else { square_at(i) };
            if square >= 0.0 {
                self.add(square, lanes.range_m[i]);
            }
            if edge > 0 {
                let noise = (FIRST_STEP..edge).contains(&exponent(square));
                signs = [signs[1], signs[2], if noise { sign(difference) } else { 0 }];
                self.alike.look_at(signs);
            }
        }
    }

    /// Pixels along a row, and down a column, that err alike: those stated, or more.
    pub fn alike_px(&self, stated_px: f32) -> f32 {
        self.alike.pixels(stated_px)
    }

    /// Takes the square of a second difference, in units of what was stated, at a range.
    fn add(&mut self, square: f32, range_m: f32) {
        let class = class_of(range_m);
        let step = exponent(square).saturating_sub(FIRST_STEP).min(STEPS - 1);
        if self.totals[class] >= MOST {
            self.halve(class);
        }
        self.counts[class][step] += 1;
        self.totals[class] += 1;
        self.means_m[class] += (range_m - self.means_m[class]) / f32::from(self.totals[class]);
    }

    /// Halves all counts of a class, so that later ones weigh more. Apart: in the loop over pixels it takes 0.3 KB more.
    #[cold]
    #[inline(never)]
    fn halve(&mut self, class: usize) {
        self.totals[class] = 0;
        for count in &mut self.counts[class] {
            *count /= 2;
            self.totals[class] += *count;
        }
    }

    fn all(&self) -> u32 {
        self.totals.iter().map(|&n| u32::from(n)).sum()
    }

    /// The variance of a class in units of what was stated: normal errors have the quantile
    /// [`Rules::noise_share`] at [`Rules::noise_square`].
    #[inline(never)] // in an image once, not for each class
    fn factor(&self, class: usize, rules: &Rules) -> Option<f32> {
        let total = self.totals[class % CLASSES];
        if total < FEWEST {
            return None;
        }
        // a step in one of three ranges is a sixth of its square in units of their variance, which
        // is a twelfth of it
        let zeros = f32::from(self.zeros(class % CLASSES));
        let (share, normal) = if zeros > 0.0 { (0.5, 2.0) } else { (rules.noise_share, rules.noise_square) };
        let wanted = zeros + share * (f32::from(total) - zeros);
        let mut below = 0.0;
        for (step, &n) in self.counts[class % CLASSES].iter().enumerate() {
            let n = f32::from(n);
            if below + n >= wanted {
                // squares are spread like their roots within the step
                let low = f32::from_bits(((FIRST_STEP + step) as u32) << 23);
                let root = 1.0 + (wanted - below) / n * 0.414_213_56;
                return Some(low * root * root / normal);
            }
            below += n;
        }
        None
    }

    /// Second differences of a class that are about 0 because its ranges come in coarse steps: those
    /// below a gap, where there are none. 0 where they come in fine ones.
    fn zeros(&self, class: usize) -> u16 {
        let (total, counts) = (self.totals[class], &self.counts[class]);
        let (mut below, mut empty) = (0, 0);
        for (step, &n) in counts.iter().enumerate() {
            if n > total / 64 {
                if empty >= STEP_GAP && below > 0 {
                    let above = total - below;
                    let one_step: u16 = counts.iter().skip(step).take(STEP_SIZES).sum();
                    let coarse = below >= total / STEPPED && above >= total / STEPPED && one_step >= above - above / 4;
                    return if coarse && total >= FEWEST_STEPPED { below } else { 0 };
                }
                empty = 0;
            } else {
                empty += 1;
            }
            below += n;
        }
        0
    }

    /// The variance that the scan alone tells at a range, m^2; none where it has told too little.
    pub fn alone(&self, range_m: f32, stated: &Variance, rules: &Rules) -> Option<f32> {
        Some(self.factor(class_of(range_m), rules)? * stated.lone_at(range_m))
    }

    /// The variance of a class that counts, at most `most` times the stated one, m^2; 0 where that is trusted, none where too
    /// little was measured.
    fn square(&self, class: usize, stated: &Variance, most: f32, rules: &Rules) -> Option<f32> {
        // a class of few pixels may be an exception
        if 16 * u32::from(self.totals[class]) < self.all() {
            return None;
        }
        let factor = lesser(self.factor(class, rules)?, most);
        let counts = !below(factor, rules.noise_trust);
        Some(if counts { factor * stated.lone_at(self.means_m[class]) * rules.noise_less } else { 0.0 })
    }

    /// The variance that counts: the larger of stated and measured.
    ///
    /// Classes tell that it grows if they are farther than all that tell hardly more than the least. Otherwise 5.1 mm at 0.8 m
    /// beside 4.8 mm at 3 m would be 108 mm at 6 m.
    pub fn variance(&self, stated: &Variance, rules: &Rules) -> Variance {
        let most = if stated.is_stated() { rules.noise_most } else { f32::MAX };
        let (mut squares, mut least_m2) = ([None; CLASSES], f32::INFINITY);
        for (class, known) in squares.iter_mut().enumerate() {
            *known = self.square(class, stated, most, rules);
            least_m2 = known.map_or(least_m2, |square_m2| lesser(least_m2, square_m2));
        }
        if least_m2 == f32::INFINITY {
            return *stated;
        }
        let (mut grown, mut to_m2) = (0.0, 0.0);
        for ((square_m2, &r), &total) in squares.into_iter().zip(&self.means_m).zip(&self.totals) {
            let Some(square_m2) = square_m2 else { continue };
            let more = (square_m2 - least_m2) / (r * r * r * r + NEAREST_M4);
            if below(rules.noise_trust * least_m2, square_m2) {
                if below(grown, more) {
                    grown = more;
                    // nowhere beyond what is believed
                    let most_m4 = (most * stated.lone_at(r) - least_m2) / more;
                    to_m2 = lone_sqrt(lesser(most_m4, MOST_MEASURED_M2 * MOST_MEASURED_M2));
                }
            } else if total >= FEWEST_STEPPED {
                // in fewer, coarse steps are not found: they look as if there were no noise
                grown = 0.0;
            }
        }
        stated.with_measured([least_m2, grown, to_m2])
    }
}

fn lesser(a: f32, b: f32) -> f32 {
    if below(a, b) { a } else { b }
}
