//! A plane with the sums that it was found from, and what more points or another plane make of it.

use crate::arithmetic::dot;
use crate::arithmetic::{less, plus};
use crate::weighted::sums::{Errors, Sums};

/// A line of one row is tilted across it by a tangent of so much, one standard deviation.
const LINE_TAN: f32 = 3.0;
/// The same of an area.
const AREA_TAN: f32 = 10.0;

/// A plane with the weighted sums of the points that it was found from, in single precision.
///
/// The plane is that of least squares of the range errors, each in units of its own noise: what the
/// plane approach reports of a segment. Its numbers can be stored and sent; [`Fitted::plane`] makes
/// a [`Plane`](crate::Plane) with its covariance of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Fitted {
    /// What lies on it.
    pub(crate) sums: Sums,
    /// The plane u . m = 1 / r.
    pub(crate) m: [f32; 3],
    /// Chi-square.
    pub(crate) squares: f32,
}

/// What two planes have in common.
pub(crate) struct Common {
    /// The common plane.
    pub fitted: Fitted,
    /// The squares that it adds to the one.
    pub one: f32,
    /// The squares that it adds to the other.
    pub other: f32,
}

/// Weight of either slope that is known beforehand: a plane at range 1 / q is tilted by a tangent
/// of so much.
#[inline(always)]
fn prior(q: f32, tan: f32) -> f32 {
    let slope = q * tan;
    1.0 / (slope * slope + 1e-12)
}

/// u + J u, where J has these rows.
#[inline(never)]
fn moved(rows: &[[f32; 3]; 3], u: [f32; 3]) -> [f32; 3] {
    plus(u, 1.0, rows.map(|row| dot(row, u)))
}

fn positive(x: f32) -> f32 {
    if x > 0.0 { x } else { 0.0 }
}

impl Fitted {
    /// From what [`Fitted::numbers`] gave. Other numbers give senseless planes, or none.
    #[must_use]
    pub fn from_numbers(numbers: [f32; 15]) -> Fitted {
        let [w, all, cx, cy, cz, xx, yy, zz, xy, xz, yz, mx, my, mz, squares] = numbers;
        let sums = Sums { w, all, c: [cx, cy, cz], s: [xx, yy, zz, xy, xz, yz] };
        Fitted { sums, m: [mx, my, mz], squares }
    }

    /// All that it consists of. With the beam u of a point, a unit vector, and its weight r^4 /
    /// sigma^2 of its range r and the standard deviation of that, m^2:
    ///
    /// - 0: the sum of the weights, less what errors that all pixels of a row share take of it, m^2.
    /// - 1: the sum of the weights, m^2.
    /// - 2 to 4: x, y, z of the weighted mean of the beams.
    /// - 5 to 10: xx, yy, zz, xy, xz, yz of the weighted scatter of the beams about it, m^2.
    /// - 11 to 13: x, y, z of the plane m, the points p with p . m = 1; 1 / m.
    /// - 14: the sum of the squared range errors in units of the noise.
    #[must_use]
    pub fn numbers(&self) -> [f32; 15] {
        let Sums { w, all, c: [cx, cy, cz], s: [xx, yy, zz, xy, xz, yz] } = self.sums;
        let [mx, my, mz] = self.m;
        [w, all, cx, cy, cz, xx, yy, zz, xy, xz, yz, mx, my, mz, self.squares]
    }

    /// The same points seen along other beams: u + J u instead of u, where J has these rows and is small.
    pub(crate) fn seen_along(&self, change: &[[f32; 3]; 3]) -> Fitted {
        let [p, q, r] = *change;
        let [xx, yy, zz, xy, xz, yz] = self.sums.s;
        let [a, b, c] = [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]].map(|u| moved(change, u));
        let [x, y, z] = [[a[0], b[0], c[0]], [a[1], b[1], c[1]], [a[2], b[2], c[2]]].map(|u| moved(change, u));
        let s = [x[0], y[1], z[2], x[1], x[2], y[2]];
        let sums = Sums { c: moved(change, self.sums.c), s, ..self.sums };
        let m = plus(plus(plus(self.m, -self.m[0], p), -self.m[1], q), -self.m[2], r);
        Fitted { sums, m, ..*self }
    }

    /// The same points, each weighing so many times as much.
    pub(crate) fn weighed(&self, by: f32) -> Fitted {
        let Sums { w, all, c, s } = self.sums;
        let sums = Sums { w: by * w, all: by * all, c, s: s.map(|s| by * s) };
        Fitted { sums, squares: by * self.squares, ..*self }
    }

    /// The plane of a line or other first points; their errors are against the plane m.
    pub(crate) fn first(sums: Sums, m: [f32; 3], errors: &Errors) -> Fitted {
        let (d, saved) = sums.factor(prior(dot(sums.c, m), LINE_TAN)).solve(errors);
        Fitted { sums, m: plus(m, 1.0, d), squares: positive(errors.squares - saved) }
    }

    /// Takes more points; their errors are against this plane, about their own mean. Called on a microcontroller.
    #[cfg_attr(not(target_os = "none"), inline(always))]
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn extend(&mut self, more: &Sums, errors: &Errors) {
        let sums = self.sums.and(more);
        let along = plus(errors.along, errors.sum, less(more.c, sums.c));
        let factor = sums.factor(prior(dot(sums.c, self.m), AREA_TAN));
        let (d, saved) = factor.solve(&Errors { along, ..*errors });
        self.m = plus(self.m, 1.0, d);
        self.squares += positive(errors.squares - saved);
        self.sums = sums;
    }

    /// The common plane of this and another one.
    pub(crate) fn with(&self, other: &Fitted) -> Common {
        let first = self.sums.w >= other.sums.w;
        let (one, two) = if first { (self, other) } else { (other, self) };
        let sums = one.sums.and(&two.sums);
        let d = less(two.m, one.m);
        let mut errors = two.sums.change(d);
        errors.along = plus(errors.along, errors.sum, less(two.sums.c, sums.c));
        let factor = sums.factor(prior(dot(sums.c, one.m), AREA_TAN));
        let (step, _) = factor.solve(&errors);
        let (a, b) = (positive(one.sums.change(step).squares), positive(two.sums.change(less(d, step)).squares));
        let fitted = Fitted { sums, m: plus(one.m, 1.0, step), squares: one.squares + two.squares + a + b };
        if first { Common { fitted, one: a, other: b } } else { Common { fitted, one: b, other: a } }
    }

    /// The common plane of this and another one whose plane may be off by a multiple of `by`: that
    /// multiple, the common plane in the place of the other one, and the squares that it adds.
    pub(crate) fn with_off(&self, other: &Fitted, by: [f32; 3]) -> (f32, Fitted, f32) {
        let at = |k: f32| self.with(&Fitted { m: plus(other.m, k, by), ..*other });
        let added = |k: f32| {
            let common = at(k);
            common.one + common.other
        };
        // they are a parabola
        let step = 0.01;
        let (less, middle, more) = (added(-step), added(0.0), added(step));
        let bent = less + more - 2.0 * middle;
        let k = if bent > 0.0 { 0.5 * step * (less - more) / bent } else { 0.0 };
        let common = at(k);
        let fitted = Fitted { m: plus(common.fitted.m, -k, by), ..common.fitted };
        (k, fitted, common.one + common.other)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use std::vec::Vec;

    /// Beam, one over the range, weight.
    pub(crate) type Point = ([f64; 3], f64, f64);

    /// A number from -1 to 1.
    fn uniform(seed: u32, i: u32) -> f64 {
        let mut x = u64::from(seed) << 32 ^ u64::from(i) ^ 0x9e37_79b9_7f4a_7c15;
        for _ in 0..3 {
            x = (x ^ x >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        }
        (x >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Points of a wall at 3 m seen obliquely, with noise of 5 mm; some rows and columns of it.
    fn points(seed: u32, rows: core::ops::Range<u32>) -> Vec<Point> {
        let m = [0.3, 0.12 * uniform(seed, 1 << 20), 0.1];
        let pixels = rows.flat_map(|row| (0..40).map(move |column| (row, column)));
        let point = |(row, column): (u32, u32)| {
            let (a, b) = (0.5 + 0.01 * f64::from(column), 0.2 + 0.01 * f64::from(row));
            let u = [a.cos() * b.cos(), a.sin() * b.cos(), b.sin()];
            let range_m = 1.0 / (u[0] * m[0] + u[1] * m[1] + u[2] * m[2]);
            let noisy_m = range_m + 0.005 * 3f64.sqrt() * uniform(seed, row << 8 | column);
            (u, 1.0 / noisy_m, (noisy_m * noisy_m / 0.005).powi(2))
        };
        pixels.map(point).collect()
    }

    /// Least squares in f64: the plane and chi-square.
    pub(crate) fn exact(points: &[Point]) -> ([f64; 3], f64) {
        let mut a = [[0.0; 4]; 3];
        for &(u, q, w) in points {
            for (i, row) in a.iter_mut().enumerate() {
                for (j, sum) in row.iter_mut().enumerate() {
                    *sum += w * u[i] * if j < 3 { u[j] } else { q };
                }
            }
        }
        for i in 0..3 {
            for k in 0..3 {
                if k != i {
                    let (row, factor) = (a[i], a[k][i] / a[i][i]);
                    a[k] = core::array::from_fn(|j| a[k][j] - factor * row[j]);
                }
            }
        }
        let m = [0, 1, 2].map(|i| a[i][3] / a[i][i]);
        let error = |&(u, q, w): &Point| w * (u[0] * m[0] + u[1] * m[1] + u[2] * m[2] - q).powi(2);
        (m, points.iter().map(error).sum())
    }

    /// Sums of points and their errors against a plane, as the core has them.
    pub(crate) fn sums(points: &[Point], m: [f32; 3]) -> (Sums, Errors) {
        let w: f64 = points.iter().map(|p| p.2).sum();
        let c: [f64; 3] = core::array::from_fn(|i| points.iter().map(|p| p.2 * p.0[i]).sum::<f64>() / w);
        let (mut s, mut sum, mut along, mut squares) = ([0.0; 6], 0.0, [0.0; 3], 0.0);
        for &(u, q, w) in points {
            let d: [f64; 3] = core::array::from_fn(|i| u[i] - c[i]);
            let e = q - (0..3).map(|i| u[i] * f64::from(m[i])).sum::<f64>();
            for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
                s[k] += w * d[i] * d[j];
            }
            (sum, squares) = (sum + w * e, squares + w * e * e);
            along = core::array::from_fn(|i| along[i] + w * e * d[i]);
        }
        let sums = Sums { w: w as f32, all: w as f32, c: c.map(|x| x as f32), s: s.map(|x| x as f32) };
        (sums, Errors { sum: sum as f32, along: along.map(|x| x as f32), squares: squares as f32 })
    }

    fn assert_near(found: &Fitted, points: &[Point]) {
        let (m, squares) = exact(points);
        for (a, b) in found.m.iter().zip(m) {
            assert!((f64::from(*a) - b).abs() < 3e-4 * 0.3, "{found:?} {m:?}");
        }
        assert!((f64::from(found.squares) - squares).abs() < 0.01 * squares + 0.5, "{found:?} {squares}");
    }

    /// Rows added one by one, and two areas joined, are the weighted least squares of all points.
    #[test]
    fn as_weighted_least_squares() {
        for seed in 0..if cfg!(miri) { 1 } else { 50 } {
            let begun = |rows: core::ops::Range<u32>| {
                let row = points(seed, rows.start..rows.start + 1);
                let m = exact(&points(seed, rows.clone())).0.map(|x| x as f32);
                let (first, errors) = sums(&row, m);
                let mut fitted = Fitted::first(first, m, &errors);
                for row in rows.skip(1) {
                    let (more, errors) = sums(&points(seed, row..row + 1), fitted.m);
                    fitted.extend(&more, &errors);
                }
                fitted
            };
            let (upper, lower) = if cfg!(miri) { (0..2, 3..6) } else { (0..12, 15..40) };
            let (one, other) = (begun(upper.clone()), begun(lower.clone()));
            let (upper, lower) = (points(seed, upper), points(seed, lower));
            assert_near(&one, &upper);
            assert_near(&other, &lower);
            let all: Vec<_> = upper.iter().chain(&lower).copied().collect();
            let common = one.with(&other);
            assert_near(&common.fitted, &all);
            let added = exact(&all).1 - exact(&upper).1 - exact(&lower).1;
            assert!((f64::from(common.one + common.other) - added).abs() < 0.05 * added + 0.5, "{added}");
        }
    }
}
