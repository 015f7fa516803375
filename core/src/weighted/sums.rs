//! Weighted sums of what lies on a plane, in single precision.
//!
//! A plane that does not hold the scanner is u . m = 1 / r for the beam u that meets it at range r.
//! With sigma the noise of r, the sum of ((u . m - 1 / r) r^2 / sigma)^2 is chi-square. Its least
//! squares need the weights r^4 / sigma^2, their sum W, the weighted mean c of the beams and their
//! scatter S about it: (S + W c c') m = right side. The scatter is about the area's own mean, and
//! planes are found as differences from planes: nothing cancels, and single precision is enough.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{dot, less, lone_sqrt, plus};

/// Weights and beams.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub(crate) struct Sums {
    /// Sum of the weights, less what errors that all pixels of a row share take of it.
    pub w: f32,
    /// Sum of the weights.
    pub all: f32,
    /// Weighted mean of the beams.
    pub c: [f32; 3],
    /// Weighted scatter of the beams about the mean: xx, yy, zz, xy, xz, yz.
    pub s: [f32; 6],
}

/// Errors against a plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Errors {
    /// Sum of the weighted errors.
    pub sum: f32,
    /// Sum of the weighted errors times the beams less their mean.
    pub along: [f32; 3],
    /// Sum of their weighted squares.
    pub squares: f32,
}

impl Sums {
    /// The sums of both.
    pub fn and(&self, other: &Sums) -> Sums {
        let w = self.w + other.w;
        let share = other.w / w;
        let d = less(other.c, self.c);
        let k = self.w * share;
        let [x, y, z] = d;
        let products = [x * x, y * y, z * z, x * y, x * z, y * z];
        let s = core::array::from_fn(|i| self.s[i] + other.s[i] + k * products[i]);
        Sums { w, all: self.all + other.all, c: plus(self.c, share, d), s }
    }

    /// The sums of points whose errors all change by g . u for each unit of something that nobody knows but for
    /// its variance: it is left out of what they tell.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn without(&self, g: [f32; 3], variance: f32) -> Sums {
        let along = self.scatter(g);
        let at_mean = dot(self.c, g);
        let spread = variance * dot(g, along);
        let spread = 1.0 + if spread > 0.0 { spread } else { 0.0 };
        let share = variance / spread;
        let w = self.w * spread / (spread + variance * self.w * at_mean * at_mean);
        let [x, y, z] = along;
        let products = [x * x, y * y, z * z, x * y, x * z, y * z];
        let s = core::array::from_fn(|i| self.s[i] - share * products[i]);
        Sums { w, all: self.all, c: plus(self.c, -share * at_mean, along), s }
    }

    #[cfg_attr(not(all(target_os = "none", target_abi = "eabi")), inline(always))]
    #[cfg_attr(all(target_os = "none", target_abi = "eabi"), inline(never))]
    fn scatter(&self, v: [f32; 3]) -> [f32; 3] {
        let [xx, yy, zz, xy, xz, yz] = self.s;
        let [x, y, z] = v;
        [xx * x + xy * y + xz * z, xy * x + yy * y + yz * z, xz * x + yz * y + zz * z]
    }

    /// The errors that points on a plane have against one that differs from it by d. Called where floats are
    /// software.
    #[cfg_attr(all(target_os = "none", target_abi = "eabi"), inline(never))]
    pub fn change(&self, d: [f32; 3]) -> Errors {
        let along = self.scatter(d);
        let at_mean = dot(self.c, d);
        let sum = self.w * at_mean;
        Errors { sum, along, squares: dot(d, along) + sum * at_mean }
    }

    /// The equations, ready to be solved. `prior` is added to the weight of either slope.
    pub fn factor(&self, prior: f32) -> Factor {
        let [x, y, z] = self.c;
        let [ax, ay, az] = [x.abs(), y.abs(), z.abs()];
        // the axis nearest to the mean beam is solved for last
        let last = if ax >= ay && ax >= az {
            0
        } else if ay >= az {
            1
        } else {
            2
        };
        let [xx, yy, zz, xy, xz, yz] = self.s;
        // i, j, k; ii, jj, kk, ij, ik, jk
        let (ci, cj, ck, [ii, jj, kk, ij, ik, jk]) = match last {
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
        Factor { last, a: [ai, aj], inverse, l: [l10, l20, l21], d: [d0, d1, d2] }
    }
}

/// The equations of [`Sums`], solved but for the right side: slopes along two axes, and the height
/// at the mean beam.
pub(crate) struct Factor {
    /// The axis nearest to the mean beam.
    last: usize,
    a: [f32; 2],
    inverse: f32,
    l: [f32; 3],
    d: [f32; 3],
}

impl Factor {
    /// The change of the plane for errors about the same mean, and the squares that it saves. Called on a
    /// microcontroller: 0.3 KB less.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn solve(&self, errors: &Errors) -> ([f32; 3], f32) {
        let (own, saved) = self.forth(errors);
        (self.back(own), saved)
    }

    /// The first half of solving: to the factors' own axes; and the squares that it saves.
    #[inline(always)]
    fn forth(&self, errors: &Errors) -> ([f32; 3], f32) {
        let [x, y, z] = errors.along;
        let (gi, gj, gk) = match self.last {
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
        ([p * self.d[0], q * self.d[1], r * self.d[2]], saved)
    }

    /// The second half of solving: from the factors' own axes back to x, y, z.
    #[inline(always)]
    fn back(&self, [p, q, h]: [f32; 3]) -> [f32; 3] {
        let [ai, aj] = self.a;
        let [l10, l20, l21] = self.l;
        let mj = q - l21 * h;
        let mi = p - l10 * mj - l20 * h;
        let mk = h * self.inverse - ai * mi - aj * mj;
        match self.last {
            0 => [mk, mi, mj],
            1 => [mj, mk, mi],
            _ => [mi, mj, mk],
        }
    }

    /// Three vectors v whose products v v' add up to the covariance of the plane.
    pub fn deviations(&self) -> [[f32; 3]; 3] {
        let [p, q, h] = self.d.map(lone_sqrt);
        [self.back([p, 0.0, 0.0]), self.back([0.0, q, 0.0]), self.back([0.0, 0.0, h])]
    }

    /// The variance of u . m for a beam u; `v` is u less the mean.
    pub fn variance(&self, v: [f32; 3]) -> f32 {
        self.forth(&Errors { sum: 1.0, along: v, squares: 0.0 }).1
    }
}
