//! What the errors of a scanner are: as stated, and as the scan itself tells.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::config::within;
use crate::error::ConfigError;
use crate::plane::rules::Rules;

/// What the noise is beyond the constant [`Ranging::range_noise_m`](crate::Ranging), each a
/// standard deviation, 0 for none. The standard deviation of a range r is the constant +
/// `per_m` r + `per_m2` r^2.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct NoiseModel {
    /// Metres per metre of range.
    pub per_m: f32,
    /// Metres per square metre of range: depth from disparities.
    pub per_m2: f32,
    /// Step between neighbouring counts, metres.
    pub step_m: f32,
    /// And per square metre of range.
    pub step_per_m2: f32,
    /// Pixels over which errors are alike, along rows and columns; 1 where each has its own.
    pub correlation_px: f32,
    /// Of the direction of a beam within its row, radians.
    pub beam_rad: f32,
    /// Of the turn angle of a row, radians.
    pub turn_rad: f32,
    /// Of surfaces across their plane, metres.
    pub flatness_m: f32,
}

impl NoiseModel {
    /// Nothing beyond the constant.
    pub const NONE: NoiseModel = NoiseModel {
        per_m: 0.0,
        per_m2: 0.0,
        step_m: 0.0,
        step_per_m2: 0.0,
        correlation_px: 1.0,
        beam_rad: 0.0,
        turn_rad: 0.0,
        flatness_m: 0.0,
    };

    /// The same, growing with range.
    #[must_use]
    pub const fn with_growth(self, per_m: f32, per_m2: f32) -> Self {
        Self { per_m, per_m2, ..self }
    }

    /// The same with steps between neighbouring counts.
    #[must_use]
    pub const fn with_steps(self, step_m: f32, step_per_m2: f32) -> Self {
        Self { step_m, step_per_m2, ..self }
    }

    /// The same with errors that are alike over so many pixels.
    #[must_use]
    pub const fn with_correlation_px(self, correlation_px: f32) -> Self {
        Self { correlation_px, ..self }
    }

    /// The same with other angles of beams and of rows.
    #[must_use]
    pub const fn with_angles(self, beam_rad: f32, turn_rad: f32) -> Self {
        Self { beam_rad, turn_rad, ..self }
    }

    /// The same with surfaces that are flat to this.
    #[must_use]
    pub const fn with_flatness_m(self, flatness_m: f32) -> Self {
        Self { flatness_m, ..self }
    }

    pub(crate) fn check(&self) -> Result<(), ConfigError> {
        for (field, value, most) in [
            ("per_m", self.per_m, 1.0),
            ("per_m2", self.per_m2, 1.0),
            ("step_m", self.step_m, 10.0),
            ("step_per_m2", self.step_per_m2, 1.0),
            ("beam_rad", self.beam_rad, 1.0),
            ("turn_rad", self.turn_rad, 1.0),
            ("flatness_m", self.flatness_m, 10.0),
        ] {
            within(field, value, (0.0..=most).contains(&value))?;
        }
        within("correlation_px", self.correlation_px, (1.0..=64.0).contains(&self.correlation_px))
    }
}

/// The variance of a range, ready for use: of r the square of `[a, b, c]` on 1, r, r^2 plus that of `[s, 0, t]`.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variance {
    pub sd: [f32; 3],
    pub step: [f32; 2],
    pub least_m2: f32,
    /// What was measured: a constant, and what is to be multiplied by r^4.
    pub measured: [f32; 2],
}

impl Variance {
    pub fn new(range_m: f32, model: &NoiseModel, least_m: f32) -> Variance {
        let step = 0.288_675_13; // 1 / sqrt(12)
        Variance {
            sd: [range_m, model.per_m, model.per_m2],
            step: [model.step_m * step, model.step_per_m2 * step],
            least_m2: least_m * least_m,
            measured: [0.0; 2],
        }
    }

    /// Of range r.
    #[inline(always)]
    pub fn at(&self, r: f32) -> f32 {
        let [a, b, c] = self.sd;
        let (sd, step) = (a + r * (b + r * c), self.step[0] + r * r * self.step[1]);
        let stated = sd * sd + step * step + self.least_m2;
        let square = r * r;
        let measured = self.measured[0] + self.measured[1] * square * square;
        if measured > stated { measured } else { stated }
    }
}

/// Ranges are told apart in so many classes: up to 2 m, 4 m, 8 m, and beyond.
const CLASSES: usize = 4;
/// Sizes of second differences are, in so many steps of a factor of sqrt(2).
const STEPS: usize = 24;

/// The noise as the scan itself tells it: how large second differences of 1 / r along a row are, which no plane changes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured {
    counts: [[u16; STEPS]; CLASSES],
    totals: [u16; CLASSES],
}

impl Measured {
    pub const NONE: Measured = Measured { counts: [[0; STEPS]; CLASSES], totals: [0; CLASSES] };

    /// A second difference in units of its standard deviation by the variance as stated, at range r.
    #[inline]
    pub fn add(&mut self, ratio_square: f32, range_m: f32) {
        let class = ((range_m.to_bits() >> 23) as usize).clamp(127, 130) - 127;
        // of squares: a factor of 2 for each exponent; from 2^-8 on
        let step = ((ratio_square.to_bits() >> 23) as usize).clamp(119, 119 + STEPS - 1) - 119;
        let (class, step) = (class % CLASSES, step % STEPS);
        if self.totals[class] >= 4096 {
            self.counts[class] = self.counts[class].map(|n| n / 2);
            self.totals[class] = self.counts[class].iter().sum();
        }
        self.counts[class][step] += 1;
        self.totals[class] += 1;
    }

    /// Of so many chunks one is looked at: fewer when much is known.
    pub fn every(&self) -> usize {
        let all: u32 = self.totals.iter().map(|&n| u32::from(n)).sum();
        if all < 500 {
            1
        } else if all < 2000 {
            4
        } else {
            16
        }
    }

    /// Factor of the variance in a class: of normal errors the quantile `share` is at `square` standard deviations squared.
    pub fn factor(&self, class: usize, share: f32, square: f32) -> Option<f32> {
        let total = f32::from(self.totals[class % CLASSES]);
        if total < 40.0 {
            return None;
        }
        let wanted = share * total;
        let mut below = 0.0;
        for (step, &n) in self.counts[class % CLASSES].iter().enumerate() {
            let n = f32::from(n);
            if below + n >= wanted {
                // squares are spread like their roots within the step
                let part = (wanted - below) / n;
                let low = f32::from_bits(((119 + step) as u32) << 23);
                let root = 1.0 + part * 0.414_213_56;
                return Some(low * root * root / square);
            }
            below += n;
        }
        None
    }

    /// The variance that counts: the larger of stated and measured.
    pub fn variance(&self, stated: &Variance, rules: &Rules) -> Variance {
        let mut variance = *stated;
        let (mut least, mut grown) = (f32::MAX, 0.0f32);
        let middle = [1.5f32, 3.0, 6.0, 12.0];
        let all: u32 = self.totals.iter().map(|&n| u32::from(n)).sum();
        let squares: [f32; CLASSES] = core::array::from_fn(|class| {
            if 16 * u32::from(self.totals[class]) < all {
                return -1.0;
            }
            let Some(factor) = self.factor(class, rules.noise_share, rules.noise_square) else { return -1.0 };
            if factor < rules.noise_trust {
                return 0.0;
            }
            let factor = if factor < rules.noise_most { factor } else { rules.noise_most };
            factor * stated.at(middle[class % CLASSES]) * rules.noise_less
        });
        for square in squares.iter().filter(|square| **square >= 0.0) {
            least = if *square < least { *square } else { least };
        }
        if least == f32::MAX {
            return variance;
        }
        for (square, r) in squares.iter().zip(middle) {
            let more = (square - least) / (r * r * r * r);
            grown = if more > grown { more } else { grown };
        }
        variance.measured = [least, grown];
        variance
    }
}
