//! The most that a method can reach whose edge pixels belong to no region.

use crate::experiment::method::{MIN_PIXELS, SIZE};
use crate::experiment::scans::scan;
use crate::hoover::evaluate;
use crate::office::Set;
use crate::parallel::in_parallel;

/// Truth regions that would be correct if each were found whole but for a rim.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rim {
    /// Pixels lost along every border with another region.
    pub width_px: usize,
    /// Correct detections, percent of the truth regions.
    pub correct_percent: f64,
}

/// Rims of one and of two pixels in the first `scenes` scenes of a set, at a tolerance of
/// [`crate::experiment::TOLERANCES`].
pub fn rims(set: Set, scenes: u32, tolerance_percent: u32) -> Vec<Rim> {
    let rim = |width_px| {
        let counts = in_parallel(scenes as usize, |number| {
            let (ranges, truth, _) = scan(set, number as u32, SIZE, 0.0);
            let labels = without_rim(&truth, ranges.columns, width_px);
            let tolerance = f64::from(tolerance_percent) / 100.0;
            let found = evaluate(&truth, &labels, tolerance, MIN_PIXELS as usize).expect("one size");
            (found.correct, found.truth_regions)
        });
        let [correct, regions] = [counts.iter().map(|c| c.0).sum::<usize>(), counts.iter().map(|c| c.1).sum()];
        Rim { width_px, correct_percent: 100.0 * correct as f64 / regions.max(1) as f64 }
    };
    vec![rim(1), rim(2)]
}

/// Returns the regions without those of their pixels that have another region (not 0) within
/// `width` pixels, diagonally too.
fn without_rim(truth: &[u16], columns: usize, width: usize) -> Vec<u16> {
    let rows = truth.len() / columns;
    let near = |at: usize, end: usize| at.saturating_sub(width)..(at + width + 1).min(end);
    let kept = |i: usize| {
        let mut around = near(i / columns, rows).flat_map(|r| near(i % columns, columns).map(move |c| r * columns + c));
        around.all(|j| truth[j] == truth[i] || truth[j] == 0)
    };
    (0..truth.len()).map(|i| if kept(i) { truth[i] } else { 0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rims_run_along_borders_between_regions() {
        let truth = [
            [1, 1, 1, 1, 2, 2], //
            [1, 1, 1, 1, 2, 2],
            [1, 1, 1, 1, 0, 0],
            [1, 1, 1, 1, 0, 0],
        ];
        let one = [[1, 1, 1, 0, 0, 2], [1, 1, 1, 0, 0, 2], [1, 1, 1, 0, 0, 0], [1, 1, 1, 1, 0, 0]];
        let two = [[1, 1, 0, 0, 0, 0], [1, 1, 0, 0, 0, 0], [1, 1, 0, 0, 0, 0], [1, 1, 0, 0, 0, 0]];
        assert_eq!(without_rim(truth.as_flattened(), 6, 1), one.as_flattened());
        assert_eq!(without_rim(truth.as_flattened(), 6, 2), two.as_flattened());
    }

    #[test]
    fn a_wider_rim_costs_more() {
        let rims = rims(Set::Tuning, 3, 80);
        assert!(100.0 > rims[0].correct_percent && rims[0].correct_percent > rims[1].correct_percent, "{rims:?}");
    }
}
