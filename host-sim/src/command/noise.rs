//! What `scanseg segment` says of the noise of the ranges.

use scanseg_core::{AnyConfig, Rules};
use scanseg_sim::segmentation::{FoundNoise, stated_noise_m};

/// The measured noise, over that stated, from which on the two do not fit.
const MORE: f32 = 2.0;
/// The stated noise, over that measured, from which on the two do not fit.
const LESS: f32 = 3.0;
/// Noise that is less than so much of that stated is not told from none.
const FAINT: f32 = 0.25;

/// Returns the noise that was used and where it is from, in one line.
pub fn used(config: &AnyConfig<'_>, stated: bool, found: Option<FoundNoise>) -> String {
    let alike = found.map(|found| found.correlation_px).filter(|&px| px > config.ranging().noise_correlation_px);
    size(config, stated, found) + &alike.map_or_else(String::new, |px| format!("; {px} pixels err alike"))
}

fn size(config: &AnyConfig<'_>, stated: bool, found: Option<FoundNoise>) -> String {
    let Some(found) = found else {
        let mm = 1e3 * config.ranging().range_noise_m;
        let whence = if stated { "stated" } else { "assumed; none was stated" };
        return format!("noise: {mm:.1} mm {whence}");
    };
    let FoundNoise { range_m, counted_m, measured_m, .. } = found;
    let (mm, stated_m) = (1e3 * counted_m, stated_noise_m(&config.ranging(), range_m));
    let measured = counted_m > 1.01 * at_least(stated_m);
    match (stated, measured) {
        (true, true) => format!(
            "noise: {mm:.1} mm measured at {range_m:.1} m, more than the {:.1} mm that were stated",
            1e3 * stated_m
        ),
        (true, false) => format!("noise: {mm:.1} mm at {range_m:.1} m, as stated"),
        (false, _) if measured_m.is_none() => {
            format!("noise: {mm:.1} mm assumed at {range_m:.1} m; none was stated, the scan is too small to measure it")
        }
        (false, true) => format!("noise: {mm:.1} mm measured at {range_m:.1} m; none was stated"),
        (false, false) => format!("noise: {mm:.1} mm, the least, at {range_m:.1} m; none was stated"),
    }
}

/// Returns what to say if the noise that was stated does not fit that measured.
pub fn suspicion(name: &str, config: &AnyConfig<'_>, stated: bool, found: Option<FoundNoise>) -> Option<String> {
    let FoundNoise { range_m, counted_m, measured_m, .. } = found.filter(|_| stated)?;
    let (stated_m, measured_m) = (stated_noise_m(&config.ranging(), range_m), measured_m?);
    let measured = if counted_m > MORE * at_least(stated_m) {
        format!("{:.1} mm", 1e3 * counted_m)
    } else if at_least(stated_m) > LESS * at_least(measured_m) {
        let at_most = if measured_m < FAINT * stated_m { "at most " } else { "" };
        format!("{at_most}{:.1} mm", 1e3 * measured_m)
    } else {
        return None;
    };
    let stated_mm = 1e3 * stated_m;
    Some(format!(
        "{name}: a noise of {stated_mm:.1} mm is stated at {range_m:.1} m, {measured} are measured: is it right?"
    ))
}

/// A standard deviation, and the least that the plane approach takes.
fn at_least(sd_m: f32) -> f32 {
    sd_m.hypot(Rules::TUNED.least_noise_m)
}
