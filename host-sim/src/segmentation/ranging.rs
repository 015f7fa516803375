//! What a geometry file says of the errors of a scanner, for the core.

use scanseg_core::{Approach, EdgeConfig, MAX_RANGE_M, Ranging};
use scanseg_formats::{Depth, Geometry, Kind, Noise};

use crate::segmentation::noise::stated_noise_m;

/// Edges and regions take the noise that is stated of this range for that of all.
const USUAL_RANGE_M: f32 = 3.0;

/// Returns ranges with this constant noise, metres, and the further errors of a geometry file.
pub fn ranging(range_noise_m: f32, noise: &Noise) -> Ranging {
    let radians = |deg: f64| deg.to_radians() as f32;
    Ranging::new(range_noise_m)
        .with_growing_noise(noise.range_noise_per_m as f32, noise.range_noise_per_m2 as f32)
        .with_steps(noise.range_step_m as f32, noise.range_step_per_m2 as f32)
        .with_correlation_px(noise.noise_correlation_px as f32)
        .with_beam_noise_rad(radians(noise.beam_noise_deg))
        .with_turn_noise_rad(radians(noise.turn_noise_deg))
        .with_flatness_m(noise.flatness_m as f32)
}

/// Returns whether anything is stated of the noise of the ranges.
pub fn states_noise(range_noise_m: f64, noise: &Noise) -> bool {
    let &Noise { range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2, .. } = noise;
    [range_noise_m, range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2].iter().any(|&x| x > 0.0)
}

/// Returns the errors and limits that a scan is segmented with: this constant noise, metres, 0 for
/// none, these further errors, and the limits of its geometry file. By edges and by regions one
/// number must do for the noise; where nothing is stated it is 0.01 m.
pub fn ranging_of(geometry: &Geometry, approach: Approach, range_noise_m: f64, noise: &Noise) -> Ranging {
    let preset = EdgeConfig::paper().ranging;
    // The range image already lacks what is outside of the geometry's limits, which for depths
    // along a camera's axis are no limits of the range.
    let depths = matches!(geometry.kind, Kind::Pinhole { depth: Depth::Z, .. });
    let minimum = |m: f64| if m > 0.0 { m as f32 } else { f32::MIN_POSITIVE };
    let maximum = |m: f64| if depths { MAX_RANGE_M } else { MAX_RANGE_M.min(m as f32) };
    let mut ranging = ranging(range_noise_m as f32, noise);
    if approach != Approach::Plane {
        let stated = states_noise(range_noise_m, noise);
        ranging.range_noise_m = if stated { stated_noise_m(&ranging, USUAL_RANGE_M) } else { preset.range_noise_m };
    }
    ranging.with_limits(
        geometry.min_range_m.map_or(preset.min_range_m, minimum),
        geometry.max_range_m.map_or(preset.max_range_m, maximum),
    )
}
