//! Made-up results for tests.

use scanseg_core::TurnAxis;
use scanseg_formats::{Angles, Geometry, Kind, RangeImage};

use crate::experiment::cost::Cost;
use crate::experiment::counts::Counts;
use crate::experiment::method::{EDGE, REGION, TOLERANCES};
use crate::experiment::results::Results;
use crate::experiment::rim::Rim;
use crate::experiment::runs::Run;
use crate::experiment::sample::{BearingError, Sample};
use crate::office::Set;

/// Results over two scenes of 20 truth regions and levels of noise of 0 and 5 mm.
/// `correct[method][noise]` are the correct detections in each scene at T below 0.6; every further
/// 0.1 takes one. Over- and under-segmentation: one instance in scene 0. Cost: 10 instructions
/// for edge-based, 30 for region-based.
pub fn made_up(correct: [[usize; 2]; 2]) -> Results {
    let mut runs = vec![];
    for (method, by_noise) in correct.iter().enumerate() {
        for (&noise_mm, &correct) in [0, 5].iter().zip(by_noise) {
            for scene in 0..2 {
                let counts = |percent: u32| {
                    let correct = correct.saturating_sub(percent as usize / 10 - 5);
                    let (over_segmented, under_segmented) = (usize::from(scene == 0), usize::from(scene == 0));
                    let missed = 20 - correct - over_segmented - 2 * under_segmented;
                    let segments = 3 + correct + 2 * over_segmented + under_segmented;
                    let truth_regions = 20;
                    Counts { truth_regions, segments, correct, over_segmented, under_segmented, missed, noise: 3 }
                };
                let at = TOLERANCES.map(counts).collect();
                runs.push(Run { method, noise_mm, scene, returns: 1000, in_segments: 750, at });
            }
        }
    }
    let costs = (0..2).flat_map(|method| {
        let cost = move |n: usize| Cost { method, rows: n, columns: 100, instructions_per_point: [10.0, 30.0][method] };
        [100, 1000, 10_000].map(cost)
    });
    let even = Angles::Even { start_deg: 0.0, step_deg: 1.0 };
    let geometry = Geometry::of(Kind::Nodding { beam_deg: even.clone(), turn_deg: even, turn_axis: TurnAxis::Y });
    let sample = Sample {
        scene: 0,
        scan: RangeImage { rows: 2, columns: 3, range_m: vec![1.0, 2.0, 3.0, 4.0, 5.0, 0.0] },
        geometry,
        truth: vec![1, 1, 2, 2, 2, 0],
        numbers: vec![vec![vec![1, 1, 0, 2, 2, 0]; 2]; 2],
        bearings: [0, 5].map(|mm| BearingError { noise_mm: mm, median_deg: 8.5, beyond_roof_percent: 21.0 }).into(),
    };
    Results {
        set: Set::Tuning,
        scenes: 2,
        methods: vec![EDGE, REGION],
        noises_mm: vec![0, 5],
        runs,
        sample,
        rims: vec![Rim { width_px: 1, correct_percent: 61.0 }],
        costs: costs.collect(),
    }
}
