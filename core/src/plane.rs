//! Moments of the points of an area, and the plane through them: the features that the paper wants for SLAM.
//!
//! The moments are whole numbers in units of [`POINT_UNIT_M`]: exact, so that it does not matter in which order points,
//! runs and areas are added, and a plane far away loses nothing to cancellation.

use crate::beam::POINT_UNIT_M;
use crate::bits::CHUNK;

/// Number of points and sums of their coordinates and of the products of those.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Moments {
    /// Number of points.
    pub points: u32,
    /// Sums of x, y, z.
    pub first: [i64; 3],
    /// Sums of xx, yy, zz, xy, xz, yz.
    pub second: [i64; 6],
}

impl Moments {
    /// Adds the points `from..to` of a chunk.
    #[inline(always)]
    pub(crate) fn add_points(&mut self, points: &[[i32; CHUNK]; 3], from: usize, to: usize) {
        let [x, y, z] = points;
        let (Some(x), Some(y), Some(z)) = (x.get(from..to), y.get(from..to), z.get(from..to)) else { return };
        self.points += x.len() as u32;
        for ((&x, &y), &z) in x.iter().zip(y).zip(z) {
            let (x, y, z) = (i64::from(x), i64::from(y), i64::from(z));
            self.first[0] += x;
            self.first[1] += y;
            self.first[2] += z;
            self.second[0] += x * x;
            self.second[1] += y * y;
            self.second[2] += z * z;
            self.second[3] += x * y;
            self.second[4] += x * z;
            self.second[5] += y * z;
        }
    }

    /// [`Moments::merge`] for sums that cannot overflow.
    #[inline]
    pub(crate) fn merge_exact(&mut self, other: &Moments) {
        self.points += other.points;
        for (a, b) in self.first.iter_mut().zip(other.first) {
            *a = a.wrapping_add(b);
        }
        for (a, b) in self.second.iter_mut().zip(other.second) {
            *a = a.wrapping_add(b);
        }
    }

    /// The moments of both sets of points together. Saturates; see [`Moments::is_exact`].
    pub fn merge(&mut self, other: &Moments) {
        self.points = self.points.saturating_add(other.points);
        for (a, b) in self.first.iter_mut().zip(other.first) {
            *a = a.saturating_add(b).clamp(-FIRST_MAX, FIRST_MAX);
        }
        for (a, b) in self.second.iter_mut().zip(other.second) {
            *a = a.saturating_add(b);
        }
    }

    /// False once a sum did not fit its 64 (second moments) or 48 (first) bits: not before 2 million points at
    /// [`MAX_RANGE_M`](crate::MAX_RANGE_M), 600 million at 30 m.
    pub fn is_exact(&self) -> bool {
        self.points != u32::MAX
            && self.first.iter().all(|a| a.abs() < FIRST_MAX)
            && self.second.iter().all(|&a| a != i64::MAX && a != i64::MIN)
    }

    /// Mean of the points, metres; `None` without points.
    pub fn centroid_m(&self) -> Option<[f32; 3]> {
        let n = self.points;
        (n > 0).then(|| self.first.map(|sum| (sum as f64 / f64::from(n) * f64::from(POINT_UNIT_M)) as f32))
    }

    /// The plane that fits the points best, by total least squares. `None` for fewer than four points, for points that
    /// lie on a line to within the resolution of [`POINT_UNIT_M`], and where the moments are not exact.
    ///
    /// Cost: an eigen decomposition in f64, some 2000 operations. On a microcontroller without double precision ask only
    /// for the segments that matter.
    pub fn plane(&self) -> Option<Plane> {
        if self.points < 4 || !self.is_exact() {
            return None;
        }
        let n = f64::from(self.points);
        let unit = f64::from(POINT_UNIT_M);
        let mean = self.first.map(|sum| sum as f64 / n);
        let [xx, yy, zz, xy, xz, yz] = self.second.map(|sum| sum as f64);
        let [x, y, z] = mean;
        let about = |sum: f64, a: f64, b: f64| (sum - n * a * b) * unit * unit;
        let scatter = [
            [about(xx, x, x), about(xy, x, y), about(xz, x, z)],
            [about(xy, x, y), about(yy, y, y), about(yz, y, z)],
            [about(xz, x, z), about(yz, y, z), about(zz, z, z)],
        ];
        let (values, vectors) = symmetric_eigen(scatter);
        let mut order = [0, 1, 2];
        order.sort_unstable_by(|&i, &j| values[i].total_cmp(&values[j]));
        let [i0, i1, i2] = order;
        if values[i1] <= n * unit * unit {
            return None;
        }
        let centroid = mean.map(|c| c * unit);
        let mut normal = vectors[i0];
        let mut distance = -dot(normal, centroid);
        if distance < 0.0 {
            normal = normal.map(|c| -c);
            distance = -distance;
        }
        let squares = values[i0].max(0.0);
        let variance = squares / (n - 3.0);
        // the normal tilts towards the in-plane axes independently of each other and of the offset at the centroid
        let mut covariance = [[0.0; 4]; 4];
        for i in [i1, i2] {
            let (axis, tilt) = (vectors[i], variance / values[i]);
            let lever = dot(axis, centroid);
            let tangent = [axis[0], axis[1], axis[2], -lever];
            for (row, &a) in covariance.iter_mut().zip(&tangent) {
                for (c, &b) in row.iter_mut().zip(&tangent) {
                    *c += tilt * a * b;
                }
            }
        }
        covariance[3][3] += variance / n;
        Some(Plane {
            normal: normal.map(|c| c as f32),
            distance_m: distance as f32,
            rms_m: libm::sqrt(squares / n) as f32,
            covariance: covariance.map(|row| row.map(|c| c as f32)),
        })
    }
}

/// Largest first moment that an area keeps.
const FIRST_MAX: i64 = (1 << 47) - 1;

/// Points within `max_range_m` up to which no sum can overflow.
pub(crate) fn exact_points(max_range_m: f32) -> u32 {
    let units = max_range_m / POINT_UNIT_M + 1.0;
    // a cast from float saturates
    ((i64::MAX as f32 / (units * units)).min(FIRST_MAX as f32 / units) * 0.99) as u32
}

/// A plane: the points p with `normal . p + distance_m = 0`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Plane {
    /// Unit normal towards the scanner.
    pub normal: [f32; 3],
    /// Distance of the plane from the scanner, metres; not negative.
    pub distance_m: f32,
    /// Root of the mean squared distance of the points from the plane, metres.
    pub rms_m: f32,
    /// Covariance of (normal x, y, z, distance), from the residuals: symmetric, in rad^2, rad m and m^2. Of rank 3,
    /// because the normal stays a unit vector.
    pub covariance: [[f32; 4]; 4],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Eigenvalues and unit eigenvectors (one per row of the second result) of a symmetric matrix, by Jacobi rotations.
fn symmetric_eigen(mut m: [[f64; 3]; 3]) -> ([f64; 3], [[f64; 3]; 3]) {
    let mut vectors = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    // converges quadratically: six sweeps are one or two more than ever needed for 3 x 3
    for _ in 0..6 {
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            if m[p][q] == 0.0 {
                continue;
            }
            let theta = (m[q][q] - m[p][p]) / (2.0 * m[p][q]);
            let sign = if theta < 0.0 { -1.0 } else { 1.0 };
            let t = sign / (theta.abs() + libm::sqrt(theta * theta + 1.0));
            let c = 1.0 / libm::sqrt(t * t + 1.0);
            let s = t * c;
            let r = 3 - p - q;
            let (mpr, mqr) = (m[p][r], m[q][r]);
            m[p][p] -= t * m[p][q];
            m[q][q] += t * m[p][q];
            (m[p][q], m[q][p]) = (0.0, 0.0);
            (m[p][r], m[q][r]) = (c * mpr - s * mqr, s * mpr + c * mqr);
            (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
            let (vp, vq) = (vectors[p], vectors[q]);
            for i in 0..3 {
                vectors[p][i] = c * vp[i] - s * vq[i];
                vectors[q][i] = s * vp[i] + c * vq[i];
            }
        }
    }
    ([m[0][0], m[1][1], m[2][2]], vectors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let m = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 6.0]];
        let (values, vectors) = symmetric_eigen(m);
        for i in 0..3 {
            for j in 0..3 {
                let unit = f64::from(u8::from(i == j));
                assert!((dot(vectors[i], vectors[j]) - unit).abs() < 1e-14);
                let rebuilt: f64 = (0..3).map(|k| values[k] * vectors[k][i] * vectors[k][j]).sum();
                assert!((rebuilt - m[i][j]).abs() < 1e-13, "{i}{j}: {rebuilt}");
            }
        }
    }

    #[test]
    fn sums_that_do_not_fit_give_no_plane() {
        let mut a = Moments { points: 10, first: [0; 3], second: [i64::MAX - 1; 6] };
        assert!(a.is_exact());
        a.merge(&a.clone());
        assert!(!a.is_exact());
        assert_eq!(a.plane(), None);
    }
}
