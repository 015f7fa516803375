//! Whether points lie on one plane, as far as the noise of their ranges tells.
//!
//! A plane that does not hold the scanner is p . m = 1 with a vector m. At a point p measured along a beam at range r the
//! surface is expected at r / (p . m), so that r (p . m - 1) is the error of the range, to first order, whatever the
//! incidence. Least squares of p . m - 1 need nothing but the [`Moments`] of the points, and give the squares that remain
//! without another look at the points; times the mean r^2 they are squared ranges, which the noise predicts.

use crate::beam::POINT_UNIT_M;
use crate::plane::Moments;

/// The plane p . m = 1 through points, in units of [`POINT_UNIT_M`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fit {
    pub m: [f64; 3],
    /// Sum of (p . m - 1)^2 over its points.
    pub squares: f64,
}

/// Keeps the equations of points on a line solvable: the plane that leans least is then taken.
const RIDGE: f64 = 1e-9;

impl Fit {
    /// `None` for fewer than three points, and where the moments are not exact. About 80 operations in f64.
    pub fn of(moments: &Moments) -> Option<Fit> {
        if moments.points < 3 || !moments.is_exact() {
            return None;
        }
        let [xx, yy, zz, xy, xz, yz] = moments.second.map(|sum| sum as f64);
        let v = moments.first.map(|sum| sum as f64);
        let ridge = (xx + yy + zz) * RIDGE;
        let (xx, yy, zz) = (xx + ridge, yy + ridge, zz + ridge);
        let (c0, c1, c2) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - yy * xz);
        let det = xx * c0 + xy * c1 + xz * c2;
        if det <= 0.0 {
            return None;
        }
        let (d1, d2, e2) = (xx * zz - xz * xz, xy * xz - xx * yz, xx * yy - xy * xy);
        let m = [
            (c0 * v[0] + c1 * v[1] + c2 * v[2]) / det,
            (c1 * v[0] + d1 * v[1] + d2 * v[2]) / det,
            (c2 * v[0] + d2 * v[1] + e2 * v[2]) / det,
        ];
        Some(Fit { m, squares: (f64::from(moments.points) - dot(m, v)).max(0.0) })
    }

    /// Sum of (p . m - 1)^2 over other points.
    pub fn squares_of(&self, other: &Moments) -> f64 {
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

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
