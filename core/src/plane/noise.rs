//! The variance of a range: of what was stated and what the scan itself tells, the larger.

use crate::config::Ranging;

/// Standard deviation of what is rounded to steps of 1: 1 / sqrt(12).
const ROUNDING: f32 = 0.288_675_13;

/// Square of the range beyond which measured noise is not taken to grow, m^2: that of the farthest
/// class of ranges in which it is measured.
const MOST_MEASURED_M2: f32 = 144.0;

/// The variance of a range r: the square of `sd` on 1, r, r^2 plus that of `step` on 1, r^2 plus
/// `least_m2`; at least `measured` on 1, r^4.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Variance {
    sd: [f32; 3],
    step: [f32; 2],
    least_m2: f32,
    measured: [f32; 2],
}

impl Variance {
    /// What is stated of the ranges, and a least standard deviation, metres.
    pub fn stated(ranging: &Ranging, least_m: f32) -> Variance {
        Variance {
            sd: [ranging.range_noise_m, ranging.range_noise_per_m, ranging.range_noise_per_m2],
            step: [ranging.range_step_m, ranging.range_step_per_m2].map(|step| step * ROUNDING),
            least_m2: least_m * least_m,
            measured: [0.0; 2],
        }
    }

    /// The same, and at least so much: a constant, and what is multiplied by r^4.
    pub fn with_measured(self, measured: [f32; 2]) -> Variance {
        Variance { measured, ..self }
    }

    /// Of a range, m^2.
    #[inline(always)]
    pub fn at(&self, range_m: f32) -> f32 {
        let [a, b, c] = self.sd;
        let [s, t] = self.step;
        let [constant, grown] = self.measured;
        let square = range_m * range_m;
        let (sd, step) = (a + range_m * (b + range_m * c), s + square * t);
        let stated = sd * sd + step * step + self.least_m2;
        let measured_at = if square < MOST_MEASURED_M2 { square } else { MOST_MEASURED_M2 };
        let measured = constant + grown * measured_at * measured_at;
        if measured > stated { measured } else { stated }
    }
}
