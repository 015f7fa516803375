//! All that the experiment finds.

use crate::experiment::cost::{self, Cost};
use crate::experiment::counts::Counts;
use crate::experiment::method::{COMPARED_AT, METHODS, NOISES_MM, TOLERANCES};
use crate::experiment::rim::{self, Rim};
use crate::experiment::runs::{Run, runs};
use crate::experiment::sample::Sample;
use crate::office::Set;

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
    /// What a rim of edges alone would cost, at the tolerance of [`COMPARED_AT`].
    pub rims: Vec<Rim>,
    /// By method, then size.
    pub costs: Vec<Cost>,
}

impl Results {
    /// Runs [`METHODS`] on the first `scenes` scenes of a set at [`NOISES_MM`], on all cores.
    /// `step_done` is called [`Results::steps`] times, from several threads.
    pub fn of(set: Set, scenes: u32, step_done: impl Fn() + Sync) -> Results {
        let runs = runs(set, scenes, step_done);
        let sample = Sample::of(set);
        let rims = rim::rims(set, scenes, COMPARED_AT);
        let costs = cost::costs();
        let methods = METHODS.iter().map(|method| method.name).collect();
        Results { set, scenes, methods, noises_mm: NOISES_MM.to_vec(), runs, sample, rims, costs }
    }

    /// Returns how many steps an experiment has, for a progress bar.
    pub fn steps(scenes: u32) -> usize {
        scenes as usize * NOISES_MM.len()
    }

    /// Index of a method by its name.
    pub fn method(&self, name: &str) -> Option<usize> {
        self.methods.iter().position(|method| *method == name)
    }

    /// Returns the runs of a method at a level of noise.
    pub fn of_method(&self, method: usize, noise_mm: u32) -> impl Iterator<Item = &Run> {
        self.runs.iter().filter(move |run| (run.method, run.noise_mm) == (method, noise_mm))
    }

    /// Returns the counts of all scenes together. The tolerance is one of [`TOLERANCES`].
    pub fn counts(&self, method: usize, noise_mm: u32, tolerance_percent: u32) -> Counts {
        let at = (tolerance_percent - TOLERANCES.start()) as usize;
        self.of_method(method, noise_mm).map(|run| run.at[at]).sum()
    }

    /// Returns the part of all returns that is in no segment, percent.
    pub fn left_out_percent(&self, method: usize, noise_mm: u32) -> f64 {
        let sum = |of: fn(&Run) -> usize| self.of_method(method, noise_mm).map(of).sum::<usize>() as f64;
        100.0 * (1.0 - sum(|run| run.in_segments) / sum(|run| run.returns).max(1.0))
    }
}
