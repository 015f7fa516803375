//! The noise of the ranges of a scan: stated, measured, and what counted.

use scanseg_core::{AnySegmenter, Ranging};

/// The noise of ranges at the median range of a scan, as the plane approach knew it at the end of
/// the scan. Standard deviations in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoundNoise {
    /// The median of the ranges.
    pub range_m: f32,
    /// What counted: stated or measured, the larger.
    pub counted_m: f32,
    /// What the scan alone tells; none if it has too few returns.
    pub measured_m: Option<f32>,
    /// Pixels along rows and columns whose errors counted as one:
    /// [`scanseg_core::PlaneSegmenter::noise_correlation_px`].
    pub correlation_px: f32,
}

impl FoundNoise {
    /// Returns the noise of a scan whose rows have all been pushed.
    pub(super) fn of(segmenter: &AnySegmenter<'_>, range_m: &[f32], ranging: &Ranging) -> Option<FoundNoise> {
        let AnySegmenter::Plane(segmenter) = segmenter else { return None };
        let limits = ranging.min_range_m..=ranging.max_range_m;
        let mut returns: Vec<f32> = range_m.iter().copied().filter(|range_m| limits.contains(range_m)).collect();
        if returns.is_empty() {
            return None;
        }
        let middle = returns.len() / 2;
        let range_m = *returns.select_nth_unstable_by(middle, f32::total_cmp).1;
        let (counted_m, measured_m) = (segmenter.range_noise_m(range_m), segmenter.measured_noise_m(range_m));
        let correlation_px = segmenter.noise_correlation_px();
        Some(FoundNoise { range_m, counted_m, measured_m, correlation_px })
    }
}

/// Returns the standard deviation that is stated of a range, rounding to steps counted in, metres.
pub fn stated_noise_m(ranging: &Ranging, range_m: f32) -> f32 {
    let sd_m = ranging.range_noise_m + range_m * (ranging.range_noise_per_m + range_m * ranging.range_noise_per_m2);
    let step_m = ranging.range_step_m + range_m * range_m * ranging.range_step_per_m2;
    (sd_m * sd_m + step_m * step_m / 12.0).sqrt()
}
