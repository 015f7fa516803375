//! The span of ranges that a picture shows.

use scanseg_formats::RangeImage;

use crate::picture::Rgb;

/// Where there is no return.
pub(crate) const NO_RETURN: Rgb = [190, 205, 225];

/// Returns the title of a picture of ranges.
pub(crate) fn range_title(near_m: f32, far_m: f32) -> String {
    format!("Range: {near_m:.1} m yellow, {far_m:.1} m blue")
}

/// Returns the ranges that 2 % of the returns are nearer, farther than; 0 and 1 m where there is
/// none.
pub fn usual_ranges_m(scan: &RangeImage) -> (f32, f32) {
    let mut ranges_m: Vec<f32> = scan.range_m.iter().copied().filter(|&m| m > 0.0).collect();
    if ranges_m.is_empty() {
        return (0.0, 1.0);
    }
    let mut at = |percent: usize| {
        let place = (ranges_m.len() * percent / 100).min(ranges_m.len() - 1);
        *ranges_m.select_nth_unstable_by(place, f32::total_cmp).1
    };
    (at(2), at(98))
}
