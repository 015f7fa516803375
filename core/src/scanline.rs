//! A row as it was pushed, and where its points are.

use crate::beam::{Fan, Frame};
use crate::config::Config;

/// A row of ranges and the beams along which they were measured.
pub(crate) struct Scanline<'a> {
    pub config: &'a Config<'a>,
    pub fan: &'a Fan<'a>,
    pub frame: Frame,
    pub ranges_m: &'a [f32],
    pub wraps: bool,
}

impl Scanline<'_> {
    /// A plane p . m = 1 in this row: p . m = r (a cos + b sin + k), and by d cos more for each radian that the row turns.
    pub fn along(&self, m: [f32; 3]) -> [f32; 4] {
        let dot = |u: [f32; 3]| u[0] * m[0] + u[1] * m[1] + u[2] * m[2];
        let ([ax, ay, az], [x, y, z]) = (self.fan.axis(), self.frame.p);
        let turned = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        [dot(self.frame.p), dot(self.frame.q), dot(self.frame.r), dot(turned)]
    }
}
