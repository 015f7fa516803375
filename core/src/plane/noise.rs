//! The variance of a range: of what was stated and what the scan itself tells, the larger.

use crate::arithmetic::below;
use crate::config::Ranging;
use crate::plane::rules::Rules;

/// Standard deviation of what is rounded to steps of 1: 1 / sqrt(12).
const ROUNDING: f32 = 0.288_675_13;

/// The variance of a range r: the square of `sd` on 1, r, r^2 plus that of `step` on 1, r^2 plus
/// `least_m2`; at least `measured` on 1, r^4, and on that of the range whose square is the third number beyond it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variance {
    sd: [f32; 3],
    step: [f32; 2],
    least_m2: f32,
    measured: [f32; 3],
    /// What is stated where it is the same at all ranges, as it mostly is.
    stated_m2: Option<f32>,
    /// The variance where it is the same at all ranges.
    constant_m2: Option<f32>,
}

impl Variance {
    /// What is stated of the ranges, and a least standard deviation, metres.
    pub fn stated(ranging: &Ranging, least_m: f32) -> Variance {
        let sd = [ranging.range_noise_m, ranging.range_noise_per_m, ranging.range_noise_per_m2];
        let step = [ranging.range_step_m, ranging.range_step_per_m2].map(|step| step * ROUNDING);
        let mut stated = Variance { sd, step, least_m2: least_m * least_m, ..Variance::default() };
        if sd[1] == 0.0 && sd[2] == 0.0 && step[1] == 0.0 {
            stated.stated_m2 = Some(stated.stated_at(0.0));
        }
        stated.with_measured([0.0; 3])
    }

    /// Whether anything is stated but the least.
    pub fn is_stated(&self) -> bool {
        self.sd != [0.0; 3] || self.step != [0.0; 2]
    }

    /// The same, and at least so much: a constant, and what is multiplied by r^4, up to a square of r.
    pub fn with_measured(self, measured: [f32; 3]) -> Variance {
        let [least_m2, grown, _] = measured;
        let larger = |stated_m2| if below(stated_m2, least_m2) { least_m2 } else { stated_m2 };
        let constant_m2 = self.stated_m2.filter(|_| grown == 0.0).map(larger);
        Variance { measured, constant_m2, ..self }
    }

    /// What is stated of a range, m^2.
    #[inline(always)]
    fn stated_at(&self, range_m: f32) -> f32 {
        let [a, b, c] = self.sd;
        let [s, t] = self.step;
        let (sd, step) = (a + range_m * (b + range_m * c), s + range_m * range_m * t);
        sd * sd + step * step + self.least_m2
    }

    /// [`Variance::at`] where not every pixel asks for it: called on a microcontroller, it is there once.
    #[cfg_attr(not(target_os = "none"), inline)]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn lone_at(&self, range_m: f32) -> f32 {
        self.at(range_m)
    }

    /// Of a range, m^2.
    #[inline(always)]
    pub fn at(&self, range_m: f32) -> f32 {
        if let Some(constant_m2) = self.constant_m2 {
            return constant_m2;
        }
        let [constant, grown, to_m2] = self.measured;
        let square = range_m * range_m;
        let stated = self.stated_m2.unwrap_or_else(|| self.stated_at(range_m));
        let measured_at = if below(square, to_m2) { square } else { to_m2 };
        let measured = constant + grown * measured_at * measured_at;
        if below(stated, measured) { measured } else { stated }
    }
}

/// What a surface that is seen at an angle adds to the variance of a range: the direction of the
/// beam, and what the surface is not flat by.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spread {
    beam_rad2: f32,
    flat_m2: f32,
    most_tan_square: f32,
}

impl Spread {
    /// What is stated, and the least and most that the rules give.
    pub fn new(ranging: &Ranging, rules: &Rules) -> Spread {
        let least = rules.least_beam_rad;
        let beam_rad = if ranging.beam_noise_rad > least { ranging.beam_noise_rad } else { least };
        Spread {
            beam_rad2: beam_rad * beam_rad,
            flat_m2: ranging.flatness_m * ranging.flatness_m,
            most_tan_square: rules.max_tan_square,
        }
    }

    /// The squared tangent of the incidence that counts.
    #[inline(always)]
    pub fn tan_square(&self, tan_square: f32) -> f32 {
        let positive = if below(0.0, tan_square) { tan_square } else { 0.0 };
        if below(positive, self.most_tan_square) { positive } else { self.most_tan_square }
    }

    /// At a range squared and a squared tangent of the incidence, m^2.
    #[inline(always)]
    pub fn at(&self, range_m2: f32, tan_square: f32) -> f32 {
        range_m2 * tan_square * self.beam_rad2 + self.flat_m2 * (1.0 + tan_square)
    }
}
