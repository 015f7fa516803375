//! Sums over the points of an area: what its plane is computed from.
//!
//! The sums are whole numbers in units of [`POINT_UNIT_M`]. They are exact: the order in which
//! points, runs and areas are added does not matter, and a plane far away loses nothing to
//! cancellation.

use crate::row::bits::CHUNK;

/// Points are kept as whole multiples of this, metres (0.24 mm): sums of them are exact, whatever
/// their order.
pub const POINT_UNIT_M: f32 = 1.0 / 4096.0;

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

    /// Adds points given in units of [`POINT_UNIT_M`].
    pub(crate) fn add_point(&mut self, point: [i32; 3]) {
        let [x, y, z] = point.map(i64::from);
        self.points += 1;
        for (sum, more) in self.first.iter_mut().zip([x, y, z]) {
            *sum += more;
        }
        for (sum, more) in self.second.iter_mut().zip([x * x, y * y, z * z, x * y, x * z, y * z]) {
            *sum += more;
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

    /// False once a sum did not fit its 64 (second moments) or 48 (first) bits: not before 2
    /// million points at [`MAX_RANGE_M`](crate::MAX_RANGE_M), 600 million at 30 m.
    #[must_use]
    pub fn is_exact(&self) -> bool {
        self.points != u32::MAX
            && self.first.iter().all(|a| a.abs() < FIRST_MAX)
            && self.second.iter().all(|&a| a != i64::MAX && a != i64::MIN)
    }

    /// Mean of the points, metres; `None` without points.
    #[must_use]
    pub fn centroid_m(&self) -> Option<[f32; 3]> {
        let n = self.points;
        (n > 0).then(|| self.first.map(|sum| (sum as f64 / f64::from(n) * f64::from(POINT_UNIT_M)) as f32))
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
