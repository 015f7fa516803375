//! The plane through the points of an area, from their sums: the features that the paper wants for
//! SLAM.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{Real, dot};
use crate::moments::{Moments, POINT_UNIT_M};

impl Moments {
    /// The plane that fits the points best, by total least squares. `None` for fewer than four
    /// points, for points that lie on a line to within the resolution of [`POINT_UNIT_M`], and
    /// where the moments are not exact.
    ///
    /// The covariance comes from the residuals. Where these are below [`POINT_UNIT_M`] the rounding
    /// of the points, which they may all share, is added: up to 0.07 mm, one standard deviation.
    ///
    /// Cost: an eigen decomposition in f64, some 2000 operations. On a microcontroller without
    /// double precision ask only for the segments that matter.
    #[must_use]
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
        let [(least, mut normal), across, along] = symmetric_eigen(scatter);
        if across.0 <= n * unit * unit {
            return None;
        }
        let centroid = mean.map(|c| c * unit);
        let mut distance = -dot(normal, centroid);
        if distance < 0.0 {
            normal = normal.map(|c| -c);
            distance = -distance;
        }
        let squares = least.max(0.0);
        // Without noise that spreads the points over several units their rounding is alike, and no
        // residual shows it: a uniform error, less where the residuals come to a unit.
        let rounding = (unit * unit - squares / n).max(0.0) / 12.0;
        let variance = squares / (n - 3.0) + n * rounding;
        // the normal tilts towards the in-plane axes independently of each other and of the offset
        // at the centroid
        let mut covariance = [[0.0; 4]; 4];
        for (value, axis) in [across, along] {
            let tilt = variance / value;
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
    /// Covariance of (normal x, y, z, distance): symmetric, in rad^2, rad m and m^2. Of rank 3,
    /// because the normal stays a unit vector. By edges and regions from the residuals and the
    /// rounding of points: [`Moments::plane`]. By planes from the noise:
    /// [`Fitted::plane`](crate::Fitted::plane).
    pub covariance: [[f32; 4]; 4],
}

/// What the plane of points that are still coming in is judged by, in f32: some 700 operations and
/// no f64, for use on every line of a row. Metres throughout.
///
/// The scatter is taken about a whole-number point next to the centroid, exactly, so that nothing
/// cancels however far away the points are. What f32 then leaves: `squares_m2` to 1e-6 of the
/// largest of them (0.6 mm of a surface with an extent of 1 m to either side), and the normal to
/// the tilts that this allows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct QuickPlane {
    pub centroid_m: [f32; 3],
    /// Mean squared deviations from the centroid along the three principal axes, smallest first:
    /// the mean squared residual, the extent across, the extent along.
    pub squares_m2: [f32; 3],
    /// Unit vector along the smallest deviation; either way.
    pub normal: [f32; 3],
    /// Unit vector along the largest deviation; either way.
    pub along: [f32; 3],
}

impl QuickPlane {
    /// Signed distance of a point from the plane, metres.
    pub fn distance_m(&self, point_m: &[f32; 3]) -> f32 {
        dot(self.normal, core::array::from_fn(|i| point_m[i] - self.centroid_m[i]))
    }
}

impl Moments {
    /// The principal axes of the points; `None` without points and where the moments are not exact.
    pub(crate) fn quick_plane(&self) -> Option<QuickPlane> {
        if self.points == 0 || !self.is_exact() {
            return None;
        }
        let n = self.points;
        let per_point = 1.0 / n as f32;
        // any whole numbers near the mean will do: what is left of the first moments is accounted
        // for
        let near = self.first.map(|sum| (sum as f32 * per_point) as i64);
        let left: [i64; 3] = core::array::from_fn(|i| self.first[i].wrapping_sub(near[i].wrapping_mul(i64::from(n))));
        let offset = left.map(|left| left as f32 * per_point);
        // sum of (a - a0)(b - b0) = sum of ab - a0 sum of b - b0 (sum of a - n a0): it fits
        // wherever the sum of ab does
        let about = |second: i64, a: usize, b: usize| {
            let sum =
                second.wrapping_sub(near[a].wrapping_mul(self.first[b])).wrapping_sub(near[b].wrapping_mul(left[a]));
            (sum as f32 * per_point - offset[a] * offset[b]) * (POINT_UNIT_M * POINT_UNIT_M)
        };
        let [xx, yy, zz, xy, xz, yz] = self.second;
        let (xy, xz, yz) = (about(xy, 0, 1), about(xz, 0, 2), about(yz, 1, 2));
        let scatter = [[about(xx, 0, 0), xy, xz], [xy, about(yy, 1, 1), yz], [xz, yz, about(zz, 2, 2)]];
        let axes = symmetric_eigen(scatter);
        let centroid_m = core::array::from_fn(|i| (near[i] as f32 + offset[i]) * POINT_UNIT_M);
        let [(_, normal), _, (_, along)] = axes;
        Some(QuickPlane { centroid_m, squares_m2: axes.map(|(value, _)| value.max(0.0)), normal, along })
    }
}

/// Eigenvalues, smallest first, and their unit eigenvectors, of a symmetric matrix, by Jacobi
/// rotations.
fn symmetric_eigen<T: Real>(mut m: [[T; 3]; 3]) -> [(T, [T; 3]); 3] {
    let (zero, one) = (T::default(), T::ONE);
    let mut vectors = [[one, zero, zero], [zero, one, zero], [zero, zero, one]];
    // converges quadratically: six sweeps are one or two more than ever needed for 3 x 3
    for _ in 0..6 {
        let mut done = true;
        for (p, q) in [(0, 1), (0, 2), (1, 2)] {
            // what they are; the compiler then knows that they are indices
            let (p, q) = (p % 3, q % 3);
            let (off, squares) = (m[p][q] * m[p][q], m[p][p] * m[q][q]);
            if off == zero || off <= squares * T::ROUNDING {
                continue;
            }
            done = false;
            let theta = (m[q][q] - m[p][p]) / ((one + one) * m[p][q]);
            let root = (theta * theta + one).sqrt();
            let t = if theta < zero { zero - one / (root - theta) } else { one / (root + theta) };
            let c = one / (t * t + one).sqrt();
            let s = t * c;
            let r = (6 - p - q) % 3;
            let (mpr, mqr) = (m[p][r], m[q][r]);
            m[p][p] = m[p][p] - t * m[p][q];
            m[q][q] = m[q][q] + t * m[p][q];
            (m[p][q], m[q][p]) = (zero, zero);
            (m[p][r], m[q][r]) = (c * mpr - s * mqr, s * mpr + c * mqr);
            (m[r][p], m[r][q]) = (m[p][r], m[q][r]);
            let (vp, vq) = (vectors[p], vectors[q]);
            for i in 0..3 {
                vectors[p][i] = c * vp[i] - s * vq[i];
                vectors[q][i] = s * vp[i] + c * vq[i];
            }
        }
        if done {
            break;
        }
    }
    let mut axes = [(m[0][0], vectors[0]), (m[1][1], vectors[1]), (m[2][2], vectors[2])];
    let mut in_order = |a: usize, b: usize| {
        if axes[b].0 < axes[a].0 {
            axes.swap(a, b);
        }
    };
    in_order(0, 1);
    in_order(1, 2);
    in_order(0, 1);
    axes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eigenvectors_are_orthonormal_and_rebuild_the_matrix() {
        let m = [[4.0, 1.0, -2.0], [1.0, 3.0, 0.5], [-2.0, 0.5, 6.0]];
        let axes = symmetric_eigen(m);
        assert!(axes.is_sorted_by_key(|axis| axis.0));
        for i in 0..3 {
            for j in 0..3 {
                let unit = f64::from(u8::from(i == j));
                assert!((dot(axes[i].1, axes[j].1) - unit).abs() < 1e-14);
                let rebuilt: f64 = axes.map(|(value, vector)| value * vector[i] * vector[j]).iter().sum();
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

    /// Patches of all sizes, distances and noises: the quick plane is the one in f64, to what f32
    /// leaves.
    #[test]
    fn quick_planes_are_planes() {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64 - 0.5
        };
        let patches = if cfg!(miri) { 1 } else { 2000 };
        let mut strips = 0;
        for _ in 0..patches {
            let mut axes = [[0.0; 3]; 3];
            axes[0] = [uniform(), uniform(), uniform()];
            axes[1] = [uniform(), uniform(), uniform()];
            let unit = |a: [f64; 3]| a.map(|c| c / libm::sqrt(dot(a, a)));
            let cross = |a: [f64; 3], b: [f64; 3]| {
                core::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
            };
            axes[2] = unit(cross(axes[0], axes[1]));
            axes[0] = unit(axes[0]);
            axes[1] = cross(axes[2], axes[0]);
            let scale = |low: f64, high: f64, u: f64| low * libm::pow(high / low, u + 0.5);
            let extents = [scale(0.1, 10.0, uniform()), scale(0.02, 5.0, uniform()), scale(1e-4, 0.02, uniform())];
            let centre: [f64; 3] = core::array::from_fn(|_| 60.0 * uniform());
            let mut moments = Moments::default();
            for _ in 0..200 {
                let along = extents.map(|extent| extent * uniform());
                let point: [f64; 3] =
                    core::array::from_fn(|i| centre[i] + (0..3).map(|k| along[k] * axes[k][i]).sum::<f64>());
                moments.add_point(point.map(|c| libm::round(c / f64::from(POINT_UNIT_M)) as i32));
            }
            let (quick, exact) = (moments.quick_plane().unwrap(), moments.plane().unwrap());
            let [least, across, along] = quick.squares_m2;
            assert!(least <= across && across <= along);
            let rounding = 1e-6 * along;
            assert!((least - exact.rms_m * exact.rms_m).abs() <= rounding + 1e-5 * least, "{quick:?} {exact:?}");
            let turned = 1.0 - dot(quick.normal, exact.normal).abs();
            let tilt = rounding / (across - least);
            strips += usize::from(tilt > 1e-3);
            assert!(turned <= 0.5 * tilt * tilt + 1e-6, "{quick:?} {exact:?}");
            assert!(
                (dot(quick.normal, quick.normal) - 1.0).abs() < 1e-5 && dot(quick.normal, quick.along).abs() < 1e-5
            );
            let centroid_m = moments.centroid_m().unwrap();
            for (a, b) in quick.centroid_m.iter().zip(centroid_m) {
                assert!((a - b).abs() <= 1e-6 * b.abs() + 1e-6);
            }
            assert!(quick.distance_m(&quick.centroid_m) == 0.0);
        }
        assert!(strips > 20 || cfg!(miri), "{strips} that f32 has some trouble with");
    }

    #[test]
    fn quick_planes_of_few_points() {
        let mut moments = Moments::default();
        assert_eq!(moments.quick_plane(), None);
        moments.add_point([4096, -8192, 1]);
        let plane = moments.quick_plane().unwrap();
        assert_eq!((plane.centroid_m, plane.squares_m2), ([1.0, -2.0, POINT_UNIT_M], [0.0; 3]));
        moments.add_point([4096, 8192, 1]);
        let plane = moments.quick_plane().unwrap();
        assert_eq!((plane.centroid_m, plane.squares_m2), ([1.0, 0.0, POINT_UNIT_M], [0.0, 0.0, 4.0]));
        assert_eq!(plane.along.map(f32::abs), [0.0, 1.0, 0.0]);
        moments.second[0] = i64::MAX;
        assert_eq!(moments.quick_plane(), None);
    }
}
