//! The experiment of the paper (section 5, Figs. 6 to 9): every method on every scene of a set of simulated offices, at
//! several levels of noise, counted by the classes of Hoover et al.; and what a method costs as scans grow.
//!
//! ```no_run
//! use scanseg_sim::experiment::{Results, report};
//! use scanseg_sim::office::{SCENES, Set};
//!
//! let results = Results::of(Set::Tuning, SCENES, || {});
//! for (name, bytes) in report::files(&results) {
//!     std::fs::write(name, bytes)?;
//! }
//! # Ok::<(), std::io::Error>(())
//! ```
//!
//! All but the cost is the same on every platform and at every run.

pub mod chart;
pub mod claims;
pub mod cost;
pub mod figures;
pub mod report;
pub mod rim;
pub mod sample;
pub mod tables;

use std::iter::Sum;
use std::num::NonZero;
use std::ops::RangeInclusive;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use scanseg_core::Config;

use crate::format::{Geometry, RangeImage};
use crate::hoover::Overlaps;
use crate::office::{Scene, Sensor, Set};
use crate::segmentation::{Approach, Segmentation};
use cost::Cost;
use rim::Rim;
use sample::Sample;

/// A way to segment, as it appears in the figures.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// In the figures and tables.
    pub name: &'static str,
    /// Which segmenter.
    pub approach: Approach,
    /// Its settings for a scanner of this noise, metres (one standard deviation of a range).
    pub config: fn(range_noise_m: f32) -> Config<'static>,
}

/// Name of the paper's edge-based method.
pub const EDGE: &str = "edge-based";

/// Name of the paper's region-based method.
pub const REGION: &str = "region-based";

/// Name of the default.
pub const DEFAULT: &str = "default";

/// The methods compared; one more is one entry more.
pub const METHODS: &[Method] = &[
    Method { name: DEFAULT, approach: Approach::Plane, config: Config::new },
    Method { name: EDGE, approach: Approach::Edge, config: paper },
    Method { name: REGION, approach: Approach::Region, config: paper },
];

/// The paper's settings. A scan without noise still is a scan of 1 mm to them: some range change has to be too small to
/// be a step.
fn paper(range_noise_m: f32) -> Config<'static> {
    Config { range_noise_m: range_noise_m.max(0.001), ..Config::paper() }
}

/// Levels of range noise, one standard deviation, millimetres.
pub const NOISES_MM: [u32; 3] = [0, 5, 10];

/// Tolerances T, in percent.
pub const TOLERANCES: RangeInclusive<u32> = 51..=100;

/// Truth regions and segments of fewer pixels are left out.
pub const MIN_PIXELS: u32 = 30;

/// Rows and columns of the scans: the paper's scanner, 0.5 degrees apart.
pub const SIZE: (usize, usize) = (200, 361);

/// The classes of Hoover et al. at one tolerance, as counts (see [`crate::hoover::Hoover`]); of one scan, or of many
/// added up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Truth regions considered.
    pub truth_regions: usize,
    /// Segments considered.
    pub segments: usize,
    /// Correct detections.
    pub correct: usize,
    /// Truth regions over-segmented.
    pub over_segmented: usize,
    /// Segments that under-segment.
    pub under_segmented: usize,
    /// Truth regions missed.
    pub missed: usize,
    /// Segments that are noise.
    pub noise: usize,
}

impl Counts {
    /// A count in percent of the truth regions; 0 if there are none.
    pub fn percent(&self, count: usize) -> f64 {
        100.0 * count as f64 / self.truth_regions.max(1) as f64
    }
}

impl Sum for Counts {
    fn sum<I: Iterator<Item = Counts>>(counts: I) -> Counts {
        counts.fold(Counts::default(), |a, b| Counts {
            truth_regions: a.truth_regions + b.truth_regions,
            segments: a.segments + b.segments,
            correct: a.correct + b.correct,
            over_segmented: a.over_segmented + b.over_segmented,
            under_segmented: a.under_segmented + b.under_segmented,
            missed: a.missed + b.missed,
            noise: a.noise + b.noise,
        })
    }
}

/// One method on one scan.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// Which of [`Results::methods`].
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

/// All that the experiment finds.
#[derive(Clone, Debug)]
pub struct Results {
    /// The set of scenes.
    pub set: Set,
    /// How many of its scenes, from 0 on.
    pub scenes: u32,
    /// Names of the methods.
    pub methods: Vec<&'static str>,
    /// Levels of noise, millimetres, rising.
    pub noises_mm: Vec<u32>,
    /// By method, then noise, then scene.
    pub runs: Vec<Run>,
    /// The scene of Fig. 6.
    pub sample: Sample,
    /// What a rim of edges alone would cost, at the tolerance of [`claims::COMPARED_AT`].
    pub rims: Vec<Rim>,
    /// By method, then size.
    pub costs: Vec<Cost>,
}

impl Results {
    /// Runs [`METHODS`] on the first `scenes` scenes of a set at [`NOISES_MM`], on all cores, then takes the times on
    /// one. `step_done` is called [`Results::steps`] times, from several threads.
    pub fn of(set: Set, scenes: u32, step_done: impl Fn() + Sync) -> Results {
        let runs = runs(set, scenes, &step_done);
        let sample = Sample::of(set);
        let rims = rim::rims(set, scenes, claims::COMPARED_AT);
        let costs = cost::costs(set, step_done);
        let methods = METHODS.iter().map(|method| method.name).collect();
        Results { set, scenes, methods, noises_mm: NOISES_MM.to_vec(), runs, sample, rims, costs }
    }

    /// How many steps an experiment has, for a progress bar.
    pub fn steps(scenes: u32) -> usize {
        scenes as usize * NOISES_MM.len() + cost::STEPS
    }

    /// Index of a method by its name.
    pub fn method(&self, name: &str) -> Option<usize> {
        self.methods.iter().position(|method| *method == name)
    }

    /// The runs of a method at a level of noise.
    pub fn of_method(&self, method: usize, noise_mm: u32) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| (run.method, run.noise_mm) == (method, noise_mm))
    }

    /// The counts of all scenes together. The tolerance is one of [`TOLERANCES`].
    pub fn counts(&self, method: usize, noise_mm: u32, tolerance_percent: u32) -> Counts {
        let at = (tolerance_percent - TOLERANCES.start()) as usize;
        self.of_method(method, noise_mm).map(|run| run.at[at]).sum()
    }

    /// The part of all returns that is in no segment, percent.
    pub fn left_out_percent(&self, method: usize, noise_mm: u32) -> f64 {
        let sum = |of: fn(&Run) -> usize| self.of_method(method, noise_mm).map(of).sum::<usize>() as f64;
        100.0 * (1.0 - sum(|run| run.in_segments) / sum(|run| run.returns).max(1.0))
    }
}

/// Every method on every scene at every noise, on all cores; by method, then noise, then scene.
pub fn runs(set: Set, scenes: u32, step_done: impl Fn() + Sync) -> Vec<Run> {
    let scans: Vec<(u32, u32)> = NOISES_MM.iter().flat_map(|&mm| (0..scenes).map(move |scene| (mm, scene))).collect();
    let runs = in_parallel(scans.len(), |i| {
        let (noise_mm, scene) = scans[i];
        let (scan, truth, geometry) = scan(set, scene, SIZE, f64::from(noise_mm) / 1e3);
        let runs = METHODS.iter().enumerate().map(|(method, m)| {
            let config = (m.config)(noise_mm as f32 / 1e3);
            let done = Segmentation::of(&scan, &geometry, m.approach, &config, None, || {});
            let numbers = done.expect("a simulated scan fits").numbers(MIN_PIXELS);
            let labels: Vec<u16> = numbers.iter().map(|&n| n as u16).collect();
            let overlaps = Overlaps::new(&truth, &labels, MIN_PIXELS as usize).expect("one size");
            let at = TOLERANCES.map(|percent| {
                let h = overlaps.at(f64::from(percent) / 100.0).expect("a tolerance in (0.5, 1]");
                Counts {
                    truth_regions: h.truth_regions,
                    segments: h.segments,
                    correct: h.correct,
                    over_segmented: h.over_segmented,
                    under_segmented: h.under_segmented,
                    missed: h.missed,
                    noise: h.noise,
                }
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

/// A scan of a scene by the paper's scanner in some resolution, with its truth. The errors are those of seed 0, as in
/// `scanseg office`.
fn scan(set: Set, scene: u32, size: (usize, usize), range_noise_m: f64) -> (RangeImage, Vec<u16>, Geometry) {
    let sensor = Sensor { range_noise_m, ..Sensor::nodding(size.0, size.1) };
    let scan = Scene::numbered(set, scene).scan(&sensor, 0).expect("a good sensor");
    (RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m }, scan.truth, scan.geometry)
}

/// `task(i)` for i from 0 to `count` - 1, on all cores, in order.
fn in_parallel<T: Send>(count: usize, task: impl Fn(usize) -> T + Sync) -> Vec<T> {
    let (next, done) = (AtomicUsize::new(0), Mutex::new(Vec::with_capacity(count)));
    thread::scope(|threads| {
        for _ in 0..thread::available_parallelism().map_or(1, NonZero::get) {
            threads.spawn(|| {
                loop {
                    let i = next.fetch_add(1, Ordering::Relaxed);
                    if i >= count {
                        break;
                    }
                    let result = task(i);
                    done.lock().expect("no task panics").push((i, result));
                }
            });
        }
    });
    let mut done = done.into_inner().expect("no task panics");
    done.sort_by_key(|(i, _)| *i);
    done.into_iter().map(|(_, result)| result).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tasks_come_back_in_order() {
        assert_eq!(in_parallel(500, |i| i * i), (0..500).map(|i| i * i).collect::<Vec<_>>());
        assert_eq!(in_parallel(0, |i| i), []);
    }

    #[test]
    fn runs_are_ordered_and_count_all_scenes() {
        let done = AtomicUsize::new(0);
        let runs = runs(Set::Validation, 2, || {
            done.fetch_add(1, Ordering::Relaxed);
        });
        let keys: Vec<_> = runs.iter().map(|run| (run.method, run.noise_mm, run.scene)).collect();
        assert_eq!(done.into_inner() + cost::STEPS, Results::steps(2));
        assert_eq!(keys.len(), METHODS.len() * NOISES_MM.len() * 2);
        assert!(keys.is_sorted_by(|a, b| a < b), "{keys:?}");
        for run in &runs {
            assert!(run.in_segments <= run.returns && run.at.len() == 50, "{run:?}");
            assert!(run.at.iter().all(|c| c.correct + c.over_segmented + c.missed <= c.truth_regions), "{run:?}");
        }
    }
}
