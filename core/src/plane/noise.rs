//! What the noise of a row is, and what an uneven turn adds to it.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::moments::{Moments, POINT_UNIT_M};
use crate::plane::fit::Fit;
use crate::plane::rules::Rules;

/// Turn of a row beyond what was reported, and the noise of its pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowNoise {
    pub range_m2: f32,
    pub turn_rad: f32,
    /// Variance of the turn that is left after its correction.
    pub turn_rad2: f32,
}

/// The noise of areas.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise {
    /// Variance of a range, m^2.
    pub range_m2: f64,
    /// Variance of the turn angle of a row, rad^2, and the axis of the turn.
    pub turn_rad2: f64,
    pub axis: [f32; 3],
}

impl Noise {
    /// Squared error of the range that the turn angle explains, in units of the noise, for the mean
    /// of points on a plane.
    pub fn wobble(&self, plane: &Fit, points: &Moments, rules: &Rules) -> f64 {
        if self.turn_rad2 == 0.0 {
            return 0.0;
        }
        let unit = f64::from(POINT_UNIT_M);
        let centre = points.first.map(|sum| sum as f64 / f64::from(points.points));
        let [ax, ay, az] = self.axis.map(f64::from);
        let [x, y, z] = centre;
        let moved = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        let slope: f64 = (0..3).map(|i| moved[i] * plane.m[i]).sum();
        let range_square = (x * x + y * y + z * z) * unit * unit;
        (rules.wobble * slope * slope * range_square * self.turn_rad2 / self.range_m2).min(rules.most_wobble)
    }
}
