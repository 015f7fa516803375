//! Weighted sums of what lies on a plane, and the plane.
//!
//! A plane that does not hold the scanner is u . m = 1 / r for the beam u that meets it at range r. With sigma the noise of
//! r, sum of ((u . m - 1 / r) r^2 / sigma)^2 is chi-square. Its least squares need the weights r^4 / sigma^2, their sum W,
//! the weighted mean c of the beams and their scatter S about it: (S + W c c') m = right side. The scatter is about the
//! area's own mean, so that single precision does; planes are found as differences from planes, so that nothing cancels.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane_fit::Plane;

/// Weights and beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Sums {
    /// Sum of the weights.
    pub w: f32,
    /// Weighted mean of the beams.
    pub c: [f32; 3],
    /// Scatter: xx, yy, zz, xy, xz, yz.
    pub s: [f32; 6],
}

/// Errors against a plane: sum of weighted errors, of them times the beams about the mean, of their squares.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Errors {
    /// Sum.
    pub sum: f32,
    /// Times beams less the mean.
    pub along: [f32; 3],
    /// Squares.
    pub squares: f32,
}

#[inline(always)]
pub(crate) fn dot(a: [f32; 3], b: [f32; 3]) -> f32 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(crate) fn less(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(crate) fn plus(a: [f32; 3], k: f32, b: [f32; 3]) -> [f32; 3] {
    [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
}

impl Sums {
    /// Of both.
    pub fn and(&self, other: &Sums) -> Sums {
        let w = self.w + other.w;
        let share = other.w / w;
        let d = less(other.c, self.c);
        let k = self.w * share;
        let [x, y, z] = d;
        let [a, b] = [&self.s, &other.s];
        let s = [
            a[0] + b[0] + k * x * x,
            a[1] + b[1] + k * y * y,
            a[2] + b[2] + k * z * z,
            a[3] + b[3] + k * x * y,
            a[4] + b[4] + k * x * z,
            a[5] + b[5] + k * y * z,
        ];
        Sums { w, c: plus(self.c, share, d), s }
    }

    #[inline(always)]
    fn scatter(&self, v: [f32; 3]) -> [f32; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.s;
        let [x, y, z] = v;
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    }

    /// What a change d of the plane makes of the errors: all weighted, squares last.
    pub fn change(&self, d: [f32; 3]) -> Errors {
        let along = self.scatter(d);
        let at_mean = dot(self.c, d);
        let sum = self.w * at_mean;
        Errors { sum, along, squares: dot(d, along) + sum * at_mean }
    }

    /// The equations, ready to be solved. `prior` is added to the weight of either slope.
    pub(crate) fn factor(&self, prior: f32) -> Factor {
        let [x, y, z] = self.c;
        let [ax, ay, az] = [x.abs(), y.abs(), z.abs()];
        // the axis nearest to the mean beam is solved for last
        let k = if ax >= ay && ax >= az {
            0
        } else if ay >= az {
            1
        } else {
            2
        };
        let [xx, yy, zz, xy, xz, yz] = self.s;
        // i, j, k; ii, jj, kk, ij, ik, jk
        let (ci, cj, ck, [ii, jj, kk, ij, ik, jk]) = match k {
            0 => (y, z, x, [yy, zz, xx, yz, xy, xz]),
            1 => (z, x, y, [zz, xx, yy, xz, yz, xy]),
            _ => (x, y, z, [xx, yy, zz, xy, xz, yz]),
        };
        let inverse = 1.0 / ck;
        let (ai, aj) = (ci * inverse, cj * inverse);
        let ridge = prior + 3e-7 * (ii + jj + kk);
        let nii = ii - 2.0 * ai * ik + ai * ai * kk + ridge;
        let njj = jj - 2.0 * aj * jk + aj * aj * kk + ridge;
        let nij = ij - aj * ik - ai * jk + ai * aj * kk;
        let (nih, njh) = ((ik - ai * kk) * inverse, (jk - aj * kk) * inverse);
        let nhh = self.w + kk * inverse * inverse;
        let or = |x: f32, least: f32| if x > least { x } else { least };
        let d0 = 1.0 / or(nii, ridge);
        let (l10, l20) = (nij * d0, nih * d0);
        let d1 = 1.0 / or(njj - l10 * nij, ridge);
        let q = njh - l20 * nij;
        let l21 = q * d1;
        let d2 = 1.0 / or(nhh - l20 * nih - l21 * q, 0.1 * self.w);
        Factor { k, a: [ai, aj], inverse, l: [l10, l20, l21], d: [d0, d1, d2] }
    }
}

/// The equations of [`Sums`], solved but for the right side.
pub(crate) struct Factor {
    k: usize,
    a: [f32; 2],
    inverse: f32,
    l: [f32; 3],
    d: [f32; 3],
}

impl Factor {
    /// The change of the plane for errors about the same mean; with it the squares that it saves.
    pub fn solve(&self, errors: &Errors) -> ([f32; 3], f32) {
        let [x, y, z] = errors.along;
        let (gi, gj, gk) = match self.k {
            0 => (y, z, x),
            1 => (z, x, y),
            _ => (x, y, z),
        };
        let [ai, aj] = self.a;
        let [l10, l20, l21] = self.l;
        let p = gi - ai * gk;
        let q = gj - aj * gk - l10 * p;
        let r = errors.sum + gk * self.inverse - l20 * p - l21 * q;
        let saved = p * p * self.d[0] + q * q * self.d[1] + r * r * self.d[2];
        let h = r * self.d[2];
        let mj = q * self.d[1] - l21 * h;
        let mi = p * self.d[0] - l10 * mj - l20 * h;
        let mk = h * self.inverse - ai * mi - aj * mj;
        let m = match self.k {
            0 => [mk, mi, mj],
            1 => [mj, mk, mi],
            _ => [mi, mj, mk],
        };
        (m, saved)
    }

    /// Variance of u . m for a beam u, `v` being u less the mean.
    pub fn variance(&self, v: [f32; 3]) -> f32 {
        self.solve(&Errors { sum: 1.0, along: v, squares: 0.0 }).1
    }
}

/// A plane with what it was found from.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub struct Fitted {
    /// What lies on it.
    pub sums: Sums,
    /// The plane u . m = 1 / r.
    pub m: [f32; 3],
    /// Chi-square.
    pub squares: f32,
}

impl Fitted {
    /// Prior weight of the slopes: a plane at range 1 / q is tilted by a tangent of so much.
    #[inline(always)]
    fn prior(q: f32, tan: f32) -> f32 {
        let slope = q * tan;
        1.0 / (slope * slope + 1e-12)
    }

    /// Of a line or other first points, errors against the plane m.
    pub fn first(sums: Sums, m: [f32; 3], errors: &Errors) -> Fitted {
        let (d, saved) = sums.factor(Self::prior(dot(sums.c, m), 3.0)).solve(errors);
        let squares = errors.squares - saved;
        Fitted { sums, m: plus(m, 1.0, d), squares: if squares > 0.0 { squares } else { 0.0 } }
    }

    /// More points; errors against this plane, about their own mean.
    pub fn extend(&mut self, more: &Sums, errors: &Errors) {
        let sums = self.sums.and(more);
        let along = plus(errors.along, errors.sum, less(more.c, sums.c));
        let factor = sums.factor(Self::prior(dot(sums.c, self.m), 10.0));
        let (d, saved) = factor.solve(&Errors { along, ..*errors });
        self.m = plus(self.m, 1.0, d);
        let added = errors.squares - saved;
        self.squares += if added > 0.0 { added } else { 0.0 };
        self.sums = sums;
    }

    /// With another one whose plane may be off by a multiple of `by`: that multiple, the common plane in the place of the
    /// other one, and the squares that it adds.
    pub fn with_off(&self, other: &Fitted, by: [f32; 3]) -> (f32, Fitted, f32) {
        let at = |k: f32| Fitted { m: plus(other.m, k, by), ..*other };
        let added = |k: f32| {
            let (_, a, b) = self.with(&at(k));
            a + b
        };
        // a parabola
        let step = 0.01;
        let (less, middle, more) = (added(-step), added(0.0), added(step));
        let bent = less + more - 2.0 * middle;
        let k = if bent > 0.0 { 0.5 * step * (less - more) / bent } else { 0.0 };
        let (common, a, b) = self.with(&at(k));
        (k, Fitted { m: plus(common.m, -k, by), ..common }, a + b)
    }

    /// With another one: the common plane, and the squares that it adds to each.
    pub fn with(&self, other: &Fitted) -> (Fitted, f32, f32) {
        let (one, two) = if self.sums.w >= other.sums.w { (self, other) } else { (other, self) };
        let sums = one.sums.and(&two.sums);
        let d = less(two.m, one.m);
        let mut errors = two.sums.change(d);
        errors.along = plus(errors.along, errors.sum, less(two.sums.c, sums.c));
        let factor = sums.factor(Self::prior(dot(sums.c, one.m), 10.0));
        let (step, _) = factor.solve(&errors);
        let (a, b) = (one.sums.change(step).squares, two.sums.change(less(d, step)).squares);
        let fitted = Fitted { sums, m: plus(one.m, 1.0, step), squares: one.squares + two.squares + a + b };
        if self.sums.w >= other.sums.w { (fitted, a, b) } else { (fitted, b, a) }
    }
}

impl Fitted {
    /// All its numbers: weight, mean beam, scatter, plane, chi-square.
    #[must_use]
    pub fn numbers(&self) -> [f32; 14] {
        let Fitted { sums: Sums { w, c, s }, m, squares } = *self;
        [w, c[0], c[1], c[2], s[0], s[1], s[2], s[3], s[4], s[5], m[0], m[1], m[2], squares]
    }

    /// From [`Fitted::numbers`].
    #[must_use]
    pub fn of_numbers(n: &[f32; 14]) -> Fitted {
        let sums = Sums { w: n[0], c: [n[1], n[2], n[3]], s: [n[4], n[5], n[6], n[7], n[8], n[9]] };
        Fitted { sums, m: [n[10], n[11], n[12]], squares: n[13] }
    }

    /// Mean of its points on the plane, metres.
    #[must_use]
    pub fn centroid_m(&self) -> [f32; 3] {
        let q = dot(self.sums.c, self.m);
        let range_m = if q > 0.0 { 1.0 / q } else { 0.0 };
        self.sums.c.map(|c| c * range_m)
    }

    /// The plane of `points` points: that of least squares of the range errors, with the covariance
    /// that their noise gives it, or their residuals where these are larger. `None` for fewer than
    /// four points.
    #[must_use]
    pub fn plane(&self, points: u32) -> Option<Plane> {
        let size = libm::sqrtf(dot(self.m, self.m));
        if size <= 0.0 || points < 4 {
            return None;
        }
        let n = points as f32;
        let distance_m = 1.0 / size;
        let normal = self.m.map(|m| -m * distance_m);
        // a mean weight is q^-4 / variance; across the plane an error of the range is less by the
        // cosine of the incidence
        let mean = self.sums.w / n;
        let q = dot(self.sums.c, self.m);
        let sd = if mean > 0.0 { 1.0 / (libm::sqrtf(mean) * q * q) } else { 0.0 };
        let rms_m = libm::sqrtf(self.squares / n) * sd * q * distance_m;
        let factor = self.sums.factor(0.0);
        let scale = if self.squares > n - 3.0 { self.squares / (n - 3.0) } else { 1.0 };
        // how normal and distance change with m
        let change = |d: [f32; 3]| -> [f32; 4] {
            let along = dot(normal, d);
            let [x, y, z] = plus(d, -along, normal).map(|c| -c * distance_m);
            [x, y, z, along * distance_m * distance_m]
        };
        let unit = |i: usize| -> [f32; 3] { core::array::from_fn(|j| if i == j { 1.0 } else { 0.0 }) };
        let inverse = [0, 1, 2].map(|i| factor.solve(&Errors { along: unit(i), ..Errors::default() }).0);
        let half = inverse.map(change);
        let covariance = core::array::from_fn(|i| {
            let column = [half[0][i], half[1][i], half[2][i]];
            change(column).map(|c| c * scale)
        });
        Some(Plane { normal, distance_m, rms_m, covariance })
    }
}
