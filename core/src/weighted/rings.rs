//! What the offsets of rings do to a plane, and to how well it is known.
//!
//! The offset of a ring is found from the planes above it and taken off its ranges, so that planes agree with
//! one another. Planes would so stand on the first rings alone, whose own offsets nobody took off. So each
//! ring then moves them by what it makes of them as it was measured: they come to stand on all rings, and
//! what these are off by on average is in their covariance.

use crate::arithmetic::{dot, plus};
use crate::weighted::fitted::Fitted;
use crate::weighted::sums::Sums;

/// Newer rings weigh more, in proportion to how many came before: the first ones are known least. With
/// 1 planes of rings 3 mm off are 0.6 to 1.0 mm off instead of 0.4 to 0.7, with 0 up to 5 mm.
const NEWER: f32 = 2.0;

/// Of an average of rings, of which the newer ones weigh more, the variance is so much more, and a few
/// rings far off more yet. Rings of 3 mm: mean squared errors of 3.2 to 4.6 instead of 4.3 to 5.1 with 1.
const UNEQUAL: f32 = 1.5;

impl Fitted {
    /// Moves the plane by what a row that it has just taken makes of it, of whose ranges an offset was taken off.
    /// `rows`: those of the oldest plane that told it. The squares are those without offsets.
    pub(crate) fn move_on(&mut self, row: &Sums, offset_m: f32, rows: f32) {
        let part = NEWER * self.sums.w / (rows * row.w);
        let part = if part < 1.0 { part } else { 1.0 };
        // 1 / r is less by q^2 for each metre, and q changes along the row
        let q = dot(row.c, self.m);
        let by = plus(self.m, -0.5 * q / dot(row.c, row.c), row.c);
        let mut errors = row.change(plus([0.0; 3], -2.0 * q * offset_m * part, by));
        errors.squares = 0.0;
        self.extend(&Sums { c: row.c, ..Sums::default() }, &errors);
    }

    /// The same, known no better than so many rings let it be, of offsets of this variance, m^2: they are
    /// farther on average, which shifts it and tilts it along the row, or farther from row to row, which
    /// tilts it across.
    pub(crate) fn known_by_rings(&self, variance_m2: f32, rings: f32) -> Fitted {
        if variance_m2.to_bits() == 0 {
            return *self;
        }
        let Sums { c, s: [_, _, zz, ..], .. } = self.sums;
        let q = dot(c, self.m);
        let per = q / dot(c, c);
        let variance = UNEQUAL * variance_m2 / rings * q * q;
        let along = plus(self.m, -per, c);
        let across = plus([0.0, 0.0, q], -c[2] * per, c);
        // rings of one elevation tell nothing across
        let spread = zz / self.sums.w + 1e-12;
        // neither changes what is known at the mean beam
        let mut sums = self.sums.without(along, 4.0 * variance).without(across, variance / spread);
        sums.w /= 1.0 + variance * q * q * sums.w;
        Fitted { sums, ..*self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::weighted::fitted::tests::{Point, exact, sums};
    use std::vec::Vec;

    const M: [f32; 3] = [0.25, 0.02, 0.01];
    const RINGS: usize = 12;

    /// A ring of a wall at 4 m, whose ranges are all so much too large.
    fn ring(ring: usize, offset_m: f64) -> Vec<Point> {
        let up = 0.02 * ring as f64 - 0.1;
        let point = |i: i32| {
            let across = 0.01 * f64::from(i);
            let u = [across.cos() * up.cos(), across.sin() * up.cos(), up.sin()];
            let range_m = 1.0 / (0..3).map(|k| u[k] * f64::from(M[k])).sum::<f64>() + offset_m;
            (u, 1.0 / range_m, (range_m * range_m / 0.005).powi(2))
        };
        (-20..20).map(point).collect()
    }

    /// The wall as its rings tell it that are not off.
    fn wall(rings: usize) -> Fitted {
        let mut fitted: Option<Fitted> = None;
        for ring in (0..rings).map(|i| ring(i, 0.0)) {
            let (sums, errors) = sums(&ring, fitted.map_or(M, |fitted| fitted.m));
            match &mut fitted {
                Some(fitted) => fitted.extend(&sums, &errors),
                None => fitted = Some(Fitted::first(sums, M, &errors)),
            }
        }
        fitted.unwrap()
    }

    fn off(m: [f32; 3], from: [f64; 3]) -> f64 {
        (0..3).map(|i| (f64::from(m[i]) - from[i]).powi(2)).sum::<f64>().sqrt()
    }

    /// A ring whose offset was taken off moves the plane as if it had not been: to least squares of all rings
    /// as they were measured, where these are few. Where another plane has 100 rings, to a fiftieth of what a
    /// ring makes of it alone.
    #[test]
    fn a_ring_moves_the_plane_as_measured() {
        let offset_m = 0.01;
        let before = wall(RINGS - 1);
        let moved = |rows: f32| {
            let mut fitted = before;
            let (sums, errors) = sums(&ring(RINGS - 1, 0.0), fitted.m);
            fitted.extend(&sums, &errors);
            fitted.move_on(&sums, offset_m as f32, rows);
            fitted
        };
        let mut points: Vec<Point> = (0..RINGS - 1).flat_map(|i| ring(i, 0.0)).collect();
        points.extend(ring(RINGS - 1, offset_m));
        let (measured, right) = (exact(&points).0, M.map(f64::from));
        let by = off(measured.map(|m| m as f32), right);
        let few = moved(12.0);
        assert!(off(few.m, measured) < 0.03 * by, "{few:?} {measured:?}");
        assert!(few.squares < 0.1, "{few:?}");
        let ratio = off(moved(100.0 * 12.0).m, right) / by;
        assert!((0.018..0.022).contains(&ratio), "{ratio}");
    }

    /// Offsets of 10 mm, of 12 rings: the wall in the middle is known to 10 mm sqrt(1.5 / 12), where without
    /// them it would be to 0.2 mm, and its tilt across to that over the height that rings have.
    #[test]
    fn a_plane_is_known_as_well_as_its_rings() {
        let wall = wall(RINGS);
        let variances = |fitted: &Fitted| {
            let covariance = fitted.plane(480).unwrap().covariance;
            let at = fitted.centroid_m();
            let v = [at[0], at[1], at[2], 1.0];
            let here: f32 = (0..4).flat_map(|i| (0..4).map(move |j| v[i] * v[j] * covariance[i][j])).sum();
            [here, covariance[2][2], covariance[1][1]]
        };
        let offs = wall.known_by_rings(1e-4, RINGS as f32);
        let [here, across, along] = variances(&offs);
        let [here0, across0, along0] = variances(&wall);
        assert!(here0 < 1e-7 && across0 < 1e-6 && along0 < 1e-6, "{here0} {across0} {along0}");
        let expected = 1.5e-4 / 12.0;
        assert!((0.9..1.05).contains(&(here / expected)), "{here}");
        let height_m2 = (4.0f32 * 0.02).powi(2) * (144.0 - 1.0) / 12.0;
        assert!((0.9..1.1).contains(&(across * height_m2 / expected)), "{across}");
        assert!(along < 0.2 * across, "{along}");
        assert_eq!(offs.m, wall.m);
        assert!(off(offs.sums.c, wall.sums.c.map(f64::from)) < 1e-6, "{offs:?}");
        assert_eq!(wall.known_by_rings(0.0, 12.0), wall);
        // rings of one elevation are a plane that is not known across, and numbers
        assert!(self::wall(1).known_by_rings(1e-4, 1.0).numbers().iter().all(|number| number.is_finite()));
    }
}
