//! What the geometry file says of the errors of a scanner beside the constant noise of its ranges.

use crate::limits::{CORRELATION_PX, ERROR_DEG, ERROR_M, ERROR_PER_M, ERROR_PER_M2, Limits};

/// What the values of [`Noise::keys`] may be.
pub(crate) const LIMITS: [&Limits; 8] =
    [&ERROR_PER_M, &ERROR_PER_M2, &ERROR_M, &ERROR_PER_M2, &CORRELATION_PX, &ERROR_DEG, &ERROR_DEG, &ERROR_M];

/// The errors of a scanner, one standard deviation each. [`Noise::NONE`] is what a file says that
/// says nothing of them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Noise {
    /// b of the noise of a range r, a + b r + c r^2; a is
    /// [`Geometry::range_noise_m`](crate::Geometry::range_noise_m).
    pub range_noise_per_m: f64,
    /// c of the noise of a range, 1 / m. Disparity noise of d pixels at baseline B and focal length
    /// f is c = d / (f B).
    pub range_noise_per_m2: f64,
    /// The step between neighbouring counts, metres.
    pub range_step_m: f64,
    /// The same, growing with the square of the range, 1 / m.
    pub range_step_per_m2: f64,
    /// Pixels over which errors of ranges are alike, along rows and columns.
    pub noise_correlation_px: f64,
    /// Of the direction of a beam within its row, degrees.
    pub beam_noise_deg: f64,
    /// Of the turn angle of a row, degrees.
    pub turn_noise_deg: f64,
    /// Surfaces are flat to this across the plane, metres.
    pub flatness_m: f64,
}

impl Default for Noise {
    fn default() -> Noise {
        Noise::NONE
    }
}

impl Noise {
    /// None, and errors of neighbours that are independent.
    pub const NONE: Noise = Noise {
        range_noise_per_m: 0.0,
        range_noise_per_m2: 0.0,
        range_step_m: 0.0,
        range_step_per_m2: 0.0,
        noise_correlation_px: 1.0,
        beam_noise_deg: 0.0,
        turn_noise_deg: 0.0,
        flatness_m: 0.0,
    };

    /// The keys of the geometry file, each with its value.
    pub(crate) fn keys(&mut self) -> [(&'static str, &mut f64); 8] {
        [
            ("range_noise_per_m", &mut self.range_noise_per_m),
            ("range_noise_per_m2", &mut self.range_noise_per_m2),
            ("range_step_m", &mut self.range_step_m),
            ("range_step_per_m2", &mut self.range_step_per_m2),
            ("noise_correlation_px", &mut self.noise_correlation_px),
            ("beam_noise_deg", &mut self.beam_noise_deg),
            ("turn_noise_deg", &mut self.turn_noise_deg),
            ("flatness_m", &mut self.flatness_m),
        ]
    }
}
