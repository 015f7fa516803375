//! Settings of the edge-based approach.

use super::Trace;
use super::closing::Element;

/// Thresholds. Angles are counts of pi / 65535 rad, as in [`count`](super::bearing::count).
#[derive(Clone, Debug)]
pub struct Settings {
    /// The traces along which bearing angles are taken; the paper's are horizontal and vertical.
    pub traces: Vec<Trace>,
    /// A roof edge where Sobel's |gx| + |gy| reaches this, in eighths, see
    /// [`roof_edges`](super::edges::roof_edges). Its sums have a weight of 4: for a turn of the
    /// bearing angle by a number of counts this is half of that number.
    pub roof_eighths: u32,
    /// A step edge where the bearing angle is this near to 0 or pi, see
    /// [`step_edges`](super::edges::step_edges).
    pub step_counts: u32,
    /// And the range changes by more than this, metres.
    pub step_range_m: f32,
    /// Structuring element of the closing.
    pub element: Element,
}
