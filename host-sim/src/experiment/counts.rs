//! Correct, split, merged and missed regions as counts that add up.

use std::iter::Sum;

use crate::hoover::Hoover;

/// The classes of Hoover et al. at one tolerance, as counts (see [`Hoover`]); of one scan, or of
/// many added up.
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
    /// Returns a count in percent of the truth regions; 0 if there are none.
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

impl From<Hoover> for Counts {
    fn from(found: Hoover) -> Counts {
        Counts {
            truth_regions: found.truth_regions,
            segments: found.segments,
            correct: found.correct,
            over_segmented: found.over_segmented,
            under_segmented: found.under_segmented,
            missed: found.missed,
            noise: found.noise,
        }
    }
}
