//! What a geometry file says of the errors of a scanner, for the core.

use scanseg_core::{AnyConfig, Approach, EdgeConfig, MAX_RANGE_M, PlaneConfig, Ranging, RegionConfig};
use scanseg_formats::{Depth, Geometry, Kind, Noise, RangeImage};

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

/// Returns what a geometry says of the ranges of a scan, as an approach takes it: the errors that it
/// states, one number of them by edges and by regions, and its limits. What it does not say is as in
/// [`EdgeConfig::paper`], but for the noise by planes: 0, so that the one measured counts.
pub fn ranging_of(geometry: &Geometry, approach: Approach) -> Ranging {
    let preset = EdgeConfig::paper().ranging;
    // The range image already lacks what is outside of the geometry's limits, which for depths
    // along a camera's axis are no limits of the range.
    let depths = matches!(geometry.kind, Kind::Pinhole { depth: Depth::Z, .. });
    let no_minimum = |m: f64| if m > 0.0 { m as f32 } else { f32::MIN_POSITIVE };
    let maximum = |m: f64| if depths { MAX_RANGE_M } else { MAX_RANGE_M.min(m as f32) };
    let mut ranging = ranging(geometry.range_noise_m.unwrap_or(0.0) as f32, &geometry.noise);
    if approach != Approach::Plane {
        // one number must do
        let stated = states_noise(geometry);
        ranging.range_noise_m = if stated { stated_noise_m(&ranging, USUAL_RANGE_M) } else { preset.range_noise_m };
    }
    ranging.with_limits(
        geometry.min_range_m.map_or(preset.min_range_m, no_minimum),
        geometry.max_range_m.map_or(preset.max_range_m, maximum),
    )
}

/// Returns ranges with the limits that are said in place of their own, metres.
pub fn limited(ranging: Ranging, min_range_m: Option<f64>, max_range_m: Option<f64>) -> Ranging {
    let or = |said: Option<f64>, own: f32| said.map_or(own, |m| m as f32);
    ranging.with_limits(or(min_range_m, ranging.min_range_m), or(max_range_m, ranging.max_range_m))
}

/// Returns the usual configuration of an approach; the paper's by edges and by regions.
pub fn usual_config(approach: Approach, ranging: Ranging) -> AnyConfig<'static> {
    match approach {
        Approach::Plane => PlaneConfig::new(ranging).into(),
        Approach::Edge => EdgeConfig::paper().with_ranging(ranging).into(),
        Approach::Region => RegionConfig::paper().with_ranging(ranging).into(),
    }
}

/// Returns whether a geometry states anything of the noise of the ranges.
pub fn states_noise(geometry: &Geometry) -> bool {
    let Noise { range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2, .. } = geometry.noise;
    let range_noise_m = geometry.range_noise_m.unwrap_or(0.0);
    [range_noise_m, range_noise_per_m, range_noise_per_m2, range_step_m, range_step_per_m2].iter().any(|&x| x > 0.0)
}

/// Returns an image without the ranges outside of the limits.
pub fn within_limits(image: &RangeImage, ranging: &Ranging) -> RangeImage {
    let limits = ranging.min_range_m..=ranging.max_range_m;
    let range_m = image.range_m.iter().map(|range_m| if limits.contains(range_m) { *range_m } else { 0.0 });
    RangeImage { rows: image.rows, columns: image.columns, range_m: range_m.collect() }
}
