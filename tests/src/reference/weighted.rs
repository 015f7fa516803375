//! The default's measurement model, of whole images: planes by weighted least squares of range errors.
//!
//! A beam u meets a plane at range r where u . m = 1 / r. A range error of one standard deviation moves 1 / r by
//! sigma / r^2, so that the squares of (u . m - 1 / r) r^2 / sigma are chi-square at any incidence.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};
use scanseg_core::Ranging;

/// Surfaces seen at less than 4 deg are taken for seen at 4 deg: squared tangent of the incidence.
const MOST_TAN_SQUARE: f64 = 200.0;

/// A return: where its beam points, a unit vector, and its range, metres.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs)]
pub struct Return {
    pub beam: Vector3<f64>,
    pub range_m: f64,
}

/// What is known of returns: what is stated, and least standard deviations of a range, metres, and of the direction of a
/// beam, radians.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs)]
pub struct Noise {
    pub ranging: Ranging,
    pub least_m: f64,
    pub least_rad: f64,
}

/// A plane found by least squares.
#[derive(Clone, Debug)]
pub struct Fit {
    /// m, 1 / metres.
    pub m: Vector3<f64>,
    /// The inverse of its covariance.
    pub information: Matrix3<f64>,
    /// Sum of the weights of its returns.
    pub weight: f64,
    /// Weighted mean of their beams.
    pub beam: Vector3<f64>,
    /// Chi-square of its returns.
    pub squares: f64,
}

impl Noise {
    /// The variance of a return on the plane m, m^2: of its range, and of its beam's direction where the plane is seen at
    /// an angle.
    fn variance_m2(&self, m: Vector3<f64>, beam: Vector3<f64>) -> f64 {
        let Ranging { range_noise_m, range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2, .. } =
            self.ranging;
        let [a, b, c] = [range_noise_m, range_noise_per_m, range_noise_per_m2].map(f64::from);
        let [s, t] = [range_step_m, range_step_per_m2].map(|step| f64::from(step) / 12f64.sqrt());
        let r = 1.0 / beam.dot(&m);
        let of_range_m2 = (a + b * r + c * r * r).powi(2) + (s + t * r * r).powi(2) + self.least_m * self.least_m;
        // the incidence has the cosine 1 / (r |m|)
        let tan_square = (r * r * m.norm_squared() - 1.0).clamp(0.0, MOST_TAN_SQUARE);
        let beam_rad = f64::from(self.ranging.beam_noise_rad).max(self.least_rad);
        let flat_m = f64::from(self.ranging.flatness_m);
        of_range_m2 + r * r * tan_square * beam_rad * beam_rad + flat_m * flat_m * (1.0 + tan_square)
    }

    /// The plane of some returns; `None` if they hardly have one: if it is not known to a tenth of |m|.
    pub fn fit(&self, returns: &[Return]) -> Option<Fit> {
        let mut m = Vector3::zeros();
        let mut fitted = None;
        for step in 0..5 {
            let (mut information, mut right) = (Matrix3::zeros(), Vector3::zeros());
            let (mut weight, mut beam, mut squares) = (0.0, Vector3::zeros(), 0.0);
            for &Return { beam: u, range_m } in returns {
                // the range error, linear in m; to begin with about the range itself, all alike
                let q = if step == 0 { 1.0 / range_m } else { u.dot(&m) };
                // a beam that passes its plane by tells nothing
                if q * range_m <= 0.05 {
                    continue;
                }
                let error = if step == 0 { q } else { q * (1.0 - range_m * q) };
                let variance_m2 = if step == 0 { 1.0 } else { self.variance_m2(m, u) };
                let one = 1.0 / (q.powi(4) * variance_m2);
                information += one * u * u.transpose();
                right += one * error * u;
                weight += one;
                beam += one * u;
                squares += one * error * error;
            }
            let eigenvalues = SymmetricEigen::new(information).eigenvalues;
            if eigenvalues.min() <= 1e-13 * eigenvalues.max() {
                return None;
            }
            m += information.cholesky()?.solve(&right);
            fitted = Some((Fit { m, information, weight, beam: beam / weight, squares }, eigenvalues.min()));
        }
        fitted.filter(|(_, least)| least * m.norm_squared() >= 100.0).map(|(fit, _)| fit)
    }
}
