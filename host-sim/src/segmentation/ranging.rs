//! What a geometry file says of the errors of a scanner, for the core.

use scanseg_core::Ranging;
use scanseg_formats::Noise;

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
