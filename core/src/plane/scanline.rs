//! A row as it was pushed, and where its points are.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::dot;
use crate::config::Ranging;
use crate::row::bits::{CHUNK, load};
use crate::row::fan::{Fan, Frame};

/// A row of ranges and the beams along which they were measured.
pub(crate) struct Scanline<'a> {
    pub ranging: &'a Ranging,
    pub fan: &'a Fan<'a>,
    pub frame: Frame,
    pub ranges_m: &'a [f32],
    pub wraps: bool,
}

impl Scanline<'_> {
    /// A plane p . m = 1 in this row: p . m = r (a cos + b sin + k), and by r d cos more for each
    /// radian that the row turns.
    pub fn along(&self, m: [f32; 3]) -> [f32; 4] {
        let ([ax, ay, az], [x, y, z]) = (self.fan.axis(), self.frame.p);
        let turned = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        [self.frame.p, self.frame.q, self.frame.r, turned].map(|along| dot(along, m))
    }

    /// One over the range at which the beam of a column meets a plane.
    pub fn inverse_m(&self, column: usize, m: [f32; 3]) -> f32 {
        let [a, b, k, _] = self.along(m);
        let (mut cos, mut sin) = ([0.0; CHUNK], [0.0; CHUNK]);
        self.fan.row_lanes(&self.frame, column / CHUNK * CHUNK, &mut cos, &mut sin);
        a * cos[column % CHUNK] + b * sin[column % CHUNK] + k
    }

    /// The chunk that starts at column `from`.
    #[inline]
    pub fn lanes(&self, from: usize, lanes: &mut Lanes) {
        lanes.range_m = load(self.ranges_m, from, &mut [0.0; CHUNK]).map(|range_m| self.ranging.clean(range_m));
        self.fan.row_lanes(&self.frame, from, &mut lanes.cos, &mut lanes.sin);
    }
}

/// One chunk of a row.
pub(crate) struct Lanes {
    /// Of the beams within their row; see [`Fan::row_lanes`].
    pub cos: [f32; CHUNK],
    pub sin: [f32; CHUNK],
    /// 0 for no return, and outside of the image.
    pub range_m: [f32; CHUNK],
}

impl Lanes {
    pub const EMPTY: Lanes = Lanes { cos: [0.0; CHUNK], sin: [0.0; CHUNK], range_m: [0.0; CHUNK] };
}
