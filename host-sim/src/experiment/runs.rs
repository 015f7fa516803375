//! Every method on every scene at every noise.

use crate::experiment::counts::Counts;
use crate::experiment::method::{METHODS, MIN_PIXELS, NOISES_MM, SIZE, TOLERANCES};
use crate::experiment::scans::scan;
use crate::hoover::Overlaps;
use crate::office::Set;
use crate::parallel::in_parallel;
use crate::segmentation::Segmentation;

/// One method on one scan.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Which of [`METHODS`].
    pub method: usize,
    /// Noise of the scan, millimetres.
    pub noise_mm: u32,
    /// Number of the scene.
    pub scene: u32,
    /// Pixels with a return.
    pub returns: usize,
    /// Those of them that are in a segment of [`MIN_PIXELS`] or more.
    pub in_segments: usize,
    /// The counts at each of [`TOLERANCES`].
    pub at: Vec<Counts>,
}

/// Every method on every scene at every noise, on all cores; by method, then noise, then scene.
pub fn runs(set: Set, scenes: u32, step_done: impl Fn() + Sync) -> Vec<Run> {
    let scans: Vec<(u32, u32)> = NOISES_MM.iter().flat_map(|&mm| (0..scenes).map(move |scene| (mm, scene))).collect();
    let runs = in_parallel(scans.len(), |i| {
        let (noise_mm, scene) = scans[i];
        let (scan, truth, geometry) = scan(set, scene, SIZE, f64::from(noise_mm) / 1e3);
        let runs = METHODS.iter().enumerate().map(|(method, m)| {
            let config = (m.config)(noise_mm as f32 / 1e3);
            let done = Segmentation::of(&scan, &geometry, config, None, || {});
            let numbers = done.expect("a simulated scan fits").numbers(MIN_PIXELS);
            let labels: Vec<u16> = numbers.iter().map(|&n| n as u16).collect();
            let overlaps = Overlaps::new(&truth, &labels, MIN_PIXELS as usize).expect("one size");
            let at = TOLERANCES.map(|percent| {
                let found = overlaps.at(f64::from(percent) / 100.0);
                Counts::from(found.expect("a tolerance in (0.5, 1]"))
            });
            let returns = scan.range_m.iter().filter(|&&m| m > 0.0).count();
            let in_segments = labels.iter().filter(|&&label| label > 0).count();
            Run { method, noise_mm, scene, returns, in_segments, at: at.collect() }
        });
        let runs: Vec<Run> = runs.collect();
        step_done();
        runs
    });
    let mut runs = runs.concat();
    runs.sort_by_key(|run| (run.method, run.noise_mm, run.scene));
    runs
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn runs_are_ordered_and_count_all_scenes() {
        let done = AtomicUsize::new(0);
        let runs = runs(Set::Validation, 2, || {
            done.fetch_add(1, Ordering::Relaxed);
        });
        let keys: Vec<_> = runs.iter().map(|run| (run.method, run.noise_mm, run.scene)).collect();
        assert_eq!(done.into_inner(), NOISES_MM.len() * 2);
        assert_eq!(keys.len(), METHODS.len() * NOISES_MM.len() * 2);
        assert!(keys.is_sorted_by(|a, b| a < b), "{keys:?}");
        for run in &runs {
            assert!(run.in_segments <= run.returns && run.at.len() == 50, "{run:?}");
            assert!(run.at.iter().all(|c| c.correct + c.over_segmented + c.missed <= c.truth_regions), "{run:?}");
        }
    }
}
