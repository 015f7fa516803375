//! The plane of weighted sums as it is reported: with its covariance.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::dot;
use crate::arithmetic::{lone_sqrt, plus};
use crate::plane_fit::Plane;
use crate::weighted::fitted::Fitted;

/// Standard deviation of each component of m that rounding leaves, of the size of m: sixteen times
/// the rounding of single precision.
const ROUNDING: f32 = 1e-6;

/// Largest variance of the normal of a plane that is reported, rad^2. The normal is unknown beyond.
const MOST_TILT_RAD2: f32 = 1.0;

impl Fitted {
    /// Where the weighted mean of the beams meets the plane, metres: the middle of the points as
    /// the scanner sees them. Far points weigh more, as they do in the plane. 0 where there is no
    /// such point.
    #[must_use]
    pub fn centroid_m(&self) -> [f32; 3] {
        let q = dot(self.sums.c, self.m);
        let range_m = if q > 0.0 { 1.0 / q } else { 0.0 };
        self.sums.c.map(|c| c * range_m)
    }

    /// The plane of `pixels` points. `None` for fewer than four, for points in one line whose plane
    /// may be tilted any way, and for numbers that are no plane. The root of the mean square is that
    /// of the weighted range errors, seen across the plane at the middle of the points; at its nearest
    /// point where [`Fitted::centroid_m`] has none.
    ///
    /// The covariance is that of the noise which the ranges were taken to have: what is stated in
    /// [`Ranging`](crate::Ranging) or was measured, whichever is larger, and the turn of the rows.
    /// Where the residuals are larger than that noise it is scaled up to them. To its diagonal is
    /// added what rounding leaves: 1e-6 rad of the normal and 1e-6 of the distance, one standard
    /// deviation.
    ///
    /// Cost: some 300 operations in single precision.
    #[must_use]
    pub fn plane(&self, pixels: u32) -> Option<Plane> {
        let size = lone_sqrt(dot(self.m, self.m));
        if pixels < 4 || size <= 0.0 {
            return None;
        }
        let n = pixels as f32;
        let distance_m = 1.0 / size;
        let normal = self.m.map(|m| -m * distance_m);
        // a mean weight is 1 / (variance q^4); across the plane a range error is less by the cosine
        // of the incidence
        let q = dot(self.sums.c, self.m);
        let q = if q > 0.0 { q } else { size };
        let rms_m = lone_sqrt(self.squares / self.sums.all) * distance_m / q;
        let scale = self.squares / (n - 3.0);
        let sd = if scale > 1.0 { lone_sqrt(scale) } else { 1.0 };
        let noise = self.sums.factor(0.0).deviations().map(|v| v.map(|c| c * sd));
        let rounding = [0, 1, 2].map(|i| core::array::from_fn(|j| if i == j { ROUNDING * size } else { 0.0 }));
        let mut covariance = [[0.0; 4]; 4];
        for v in noise.into_iter().chain(rounding) {
            // how normal and distance change with m
            let along = dot(normal, v);
            let [x, y, z] = plus(v, -along, normal).map(|c| -c * distance_m);
            let change = [x, y, z, along * distance_m * distance_m];
            for (row, a) in covariance.iter_mut().zip(change) {
                for (sum, b) in row.iter_mut().zip(change) {
                    *sum += a * b;
                }
            }
        }
        let tilt_rad2 = covariance[0][0] + covariance[1][1] + covariance[2][2];
        let known = tilt_rad2 <= MOST_TILT_RAD2 && covariance[3][3].is_finite() && rms_m.is_finite();
        known.then_some(Plane { normal, distance_m, rms_m, covariance })
    }
}
