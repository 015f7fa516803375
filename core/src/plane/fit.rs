//! Whether points lie on one plane, as far as the noise of their ranges tells.
//!
//! A plane that does not hold the scanner is p . m = 1 with a vector m. At a point p measured along
//! a beam at range r the surface is expected at r / (p . m), so that r (p . m - 1) is the error of
//! the range, to first order, whatever the incidence. Least squares of p . m - 1 need nothing but
//! the [`Moments`] of the points, and give the squares that remain without another look at the
//! points; times the mean r^2 they are squared ranges, which the noise predicts.

use crate::arithmetic::dot;
use crate::moments::{Moments, POINT_UNIT_M};

/// The plane p . m = 1 through points, in units of [`POINT_UNIT_M`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    pub m: [f64; 3],
    /// Sum of (p . m - 1)^2 over its points.
    pub relative_squares: f64,
}

/// Keeps the equations of points on a line solvable: the plane that leans least is then taken.
const RIDGE: f64 = 1e-9;

impl Fit {
    /// `None` for fewer than three points, and where the moments are not exact. About 90 operations
    /// in f64.
    ///
    /// With the scatter S of n points about their centroid c, and w = c / S, the equations (S + n c
    /// c') m = n c give m = n w / (1 + n c . w), and the squares n / (1 + n c . w). To solve them
    /// as they are loses all digits of points that are near each other and far away.
    pub fn of(moments: &Moments) -> Option<Fit> {
        if moments.points < 3 || !moments.is_exact() {
            return None;
        }
        let n = f64::from(moments.points);
        let [xx, yy, zz, xy, xz, yz] = moments.second.map(|sum| sum as f64);
        let v = moments.first.map(|sum| sum as f64);
        let c = v.map(|sum| sum / n);
        let ridge = (xx + yy + zz) * RIDGE;
        let (xx, yy, zz) = (xx - v[0] * c[0] + ridge, yy - v[1] * c[1] + ridge, zz - v[2] * c[2] + ridge);
        let (xy, xz, yz) = (xy - v[0] * c[1], xz - v[0] * c[2], yz - v[1] * c[2]);
        let (c0, c1, c2) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - yy * xz);
        let det = xx * c0 + xy * c1 + xz * c2;
        let (d1, d2, e2) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
        // w times the determinant
        let w =
            [c0 * c[0] + c1 * c[1] + c2 * c[2], c1 * c[0] + d1 * c[1] + d2 * c[2], c2 * c[0] + d2 * c[1] + e2 * c[2]];
        let sum = det + n * dot(c, w);
        if det <= 0.0 || sum <= 0.0 {
            return None;
        }
        Some(Fit { m: w.map(|w| n * w / sum), relative_squares: n * det / sum })
    }

    /// Sum of (p . m - 1)^2 over other points.
    pub fn relative_squares_of(&self, other: &Moments) -> f64 {
        let [xx, yy, zz, xy, xz, yz] = other.second.map(|sum| sum as f64);
        let [x, y, z] = self.m;
        let products = xx * x * x + yy * y * y + zz * z * z + 2.0 * (xy * x * y + xz * x * z + yz * y * z);
        (f64::from(other.points) - 2.0 * dot(self.m, other.first.map(|sum| sum as f64)) + products).max(0.0)
    }

    /// For points in metres.
    pub fn per_metre(&self) -> [f32; 3] {
        self.m.map(|m| (m / f64::from(POINT_UNIT_M)) as f32)
    }
}

/// Mean squared range of points, m^2; at least one point.
pub(crate) fn mean_square_range_m2(moments: &Moments) -> f64 {
    let unit = f64::from(POINT_UNIT_M);
    let [xx, yy, zz, ..] = moments.second.map(|sum| sum as f64);
    (xx + yy + zz) / f64::from(moments.points) * (unit * unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Six points of a wall 5 m away, 0.1 deg apart: the plane through their neighbours a metre
    /// around, and no squares but those of the rounding.
    #[test]
    fn small_and_far() {
        let unit = 1.0 / f64::from(POINT_UNIT_M);
        let at = |column: i32, row: i32| {
            let (y, z) = (0.0087 * f64::from(column), 0.0087 * f64::from(row));
            [5.0 - 0.3 * y + 0.2 * z, y, z].map(|c| libm::round(c * unit) as i32)
        };
        let mut moments = Moments::default();
        for (column, row) in (0..3).flat_map(|column| [(column, 0), (column, 1)]) {
            moments.add_point(at(column, row));
        }
        let fit = Fit::of(&moments).unwrap();
        assert!(
            fit.relative_squares * mean_square_range_m2(&moments) < 6.0 * f64::from(POINT_UNIT_M).powi(2),
            "{fit:?}"
        );
        let near = fit.relative_squares_of(&moments) - fit.relative_squares;
        // but for the ridge
        assert!(near.abs() < 2.0 * 6.0 * RIDGE, "{near}");
        // its first guess of the plane around it
        let [x, y, z] = at(10, 10).map(f64::from);
        let range_error_m = 5.0 * (x * fit.m[0] + y * fit.m[1] + z * fit.m[2] - 1.0);
        assert!(range_error_m.abs() < 0.01, "{range_error_m}");
    }
}
