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
    ranges_m.sort_by(f32::total_cmp);
    let at =
        |percent: usize| ranges_m.get((ranges_m.len() * percent / 100).min(ranges_m.len().wrapping_sub(1))).copied();
    (at(2).unwrap_or(0.0), at(98).unwrap_or(1.0))
}
