//! The scene of Fig. 6, and what noise does to its bearing angles.

use scanseg_core::{COUNTS_PER_RAD, EdgeConfig, Trace};

use crate::experiment::method::{METHODS, MIN_PIXELS, NOISES_MM, SIZE};
use crate::experiment::scans::scan;
use crate::office::Set;
use crate::segmentation::{Segmentation, bearing_image};
use scanseg_formats::{Geometry, RangeImage};

/// The scene of its set.
const SCENE: u32 = 0;

/// One scene, segmented by all methods at all levels of noise.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Number of the scene.
    pub scene: u32,
    /// Its scan without noise.
    pub scan: RangeImage,
    /// Where the beams point.
    pub geometry: Geometry,
    /// Surface ids; 0 for none.
    pub truth: Vec<u16>,
    /// For each method the segment numbers of its pixels at each level of noise; 0 for none.
    pub numbers: Vec<Vec<Vec<u32>>>,
    /// What each level of noise does to the bearing angles.
    pub bearings: Vec<BearingError>,
}

/// Errors of the bearing angles between neighbouring beams of a row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BearingError {
    /// The noise that makes them, millimetres.
    pub noise_mm: u32,
    /// Half of them are smaller, degrees.
    pub median_deg: f64,
    /// How many are as large as the paper's roof edges or larger, percent.
    pub beyond_roof_percent: f64,
}

impl Sample {
    /// Returns the sample of a set.
    pub fn of(set: Set) -> Sample {
        let (ideal, truth, geometry) = scan(set, SCENE, SIZE, 0.0);
        let mut numbers = vec![vec![]; METHODS.len()];
        let mut bearings = vec![];
        for noise_mm in NOISES_MM {
            let (noisy, _, noisy_geometry) = scan(set, SCENE, SIZE, f64::from(noise_mm) / 1e3);
            for (method, numbers) in METHODS.iter().zip(&mut numbers) {
                let config = (method.config)(noise_mm as f32 / 1e3);
                let done = Segmentation::of(&noisy, &noisy_geometry, config, None, || {});
                numbers.push(done.expect("a simulated scan fits").numbers(MIN_PIXELS));
            }
            bearings.push(bearing_error(&ideal, &noisy, &geometry, noise_mm));
        }
        Sample { scene: SCENE, scan: ideal, geometry, truth, numbers, bearings }
    }
}

fn bearing_error(ideal: &RangeImage, noisy: &RangeImage, geometry: &Geometry, noise_mm: u32) -> BearingError {
    let config = EdgeConfig::paper();
    let bearings = |scan| bearing_image(scan, geometry, &config.ranging, Trace::ROW).expect("a simulated scan fits");
    let (ideal, noisy) = (bearings(ideal), bearings(noisy));
    let pairs = ideal.iter().zip(&noisy).filter(|(a, b)| **a > 0 && **b > 0);
    let mut errors_rad: Vec<f32> = pairs.map(|(a, b)| f32::from(a.abs_diff(*b)) / COUNTS_PER_RAD).collect();
    errors_rad.sort_by(f32::total_cmp);
    let beyond = errors_rad.len() - errors_rad.partition_point(|error| *error < config.roof_angle_rad);
    BearingError {
        noise_mm,
        median_deg: errors_rad.get(errors_rad.len() / 2).map_or(0.0, |rad| f64::from(rad.to_degrees())),
        beyond_roof_percent: 100.0 * beyond as f64 / errors_rad.len().max(1) as f64,
    }
}
