//! What looks wrong, though the program works with it. All warnings are here and in `noise.rs`, in
//! one style: the file, what is wrong with it, and what may be meant.

use scanseg_core::{AnyConfig, Approach, Ranging};
use scanseg_formats::{Angles, Geometry, Kind};
use scanseg_sim::segmentation::{FoundNoise, Segmentation, enough_labels};

use crate::command::input::Input;
use crate::command::noise;

/// Of the counts so many per cent, when they lie outside of the limits, look like a mistake.
const SUSPICIOUS_PERCENT: usize = 90;
/// No scanner's usual range is nearer.
const NEAR_M: f32 = 0.05;
/// Beams within this of the turning axis hardly turn.
const BESIDE_AXIS_DEG: f64 = 10.0;
/// More than the sweep of an image covers, with a column to spare.
const TURN_DEG: f64 = 361.0;
/// Steps back of this part of a usual step are the encoder's noise.
const JITTER: f64 = 0.25;

/// Returns what looks wrong with a scan before it is segmented.
pub fn of_scan(input: &Input, config: &AnyConfig<'_>, stated: bool) -> Vec<String> {
    let name = &input.name;
    let mut warnings: Vec<_> = ranges(input, &config.ranging()).into_iter().collect();
    warnings.extend(of_geometry(name, &input.geometry, input.ranges.rows, input.ranges.columns));
    warnings.extend(no_noise(name, config, stated));
    warnings
}

/// Returns what looks wrong with a scan that has been segmented with a table of `max_labels` areas.
pub fn of_result(
    name: &str,
    config: &AnyConfig<'_>,
    stated: bool,
    max_labels: Option<usize>,
    segmentation: &Segmentation,
) -> Vec<String> {
    let mut warnings: Vec<_> = noise::suspicion(name, config, stated, segmentation.noise).into_iter().collect();
    let Segmentation { unlabelled, columns, noise, .. } = *segmentation;
    if let Some(FoundNoise { counted_m, measured_m: None, .. }) = noise
        && !stated
    {
        warnings.push(assumed(name, counted_m));
    }
    warnings.extend(stretched_beams(name, segmentation.beam_stretch));
    warnings.extend(unlabelled_pixels(name, unlabelled, enough_labels(config.approach(), columns), max_labels));
    warnings
}

/// Returns what to say where walls tell that the beam angles are off in scale.
fn stretched_beams(name: &str, share: f32) -> Option<String> {
    let (percent, factor) = (100.0 * share.abs(), 1.0 + share);
    let how = if share > 0.0 { "farther apart" } else { "nearer to each other" };
    (share != 0.0).then(|| {
        format!(
            "{name}: walls of several directions are bent as if beams lay {percent:.1} % {how} than beam_deg says, and are \
             taken so: check it (times {factor:.3} from its middle on would be right)"
        )
    })
}

/// Returns what to say of pixels that got no label.
pub fn unlabelled_pixels(name: &str, unlabelled: u32, enough: usize, max_labels: Option<usize>) -> Option<String> {
    let advice = match max_labels {
        Some(given) if given < enough => format!("leave out --max-labels {given}, or take {enough}"),
        _ => "no larger table is of use to these columns".to_string(),
    };
    (unlabelled > 0)
        .then(|| format!("{name}: {unlabelled} pixels got no label, the table of live labels was full: {advice}"))
}

/// Returns what to say where the approach takes a noise that nobody stated.
pub fn no_noise(name: &str, config: &AnyConfig<'_>, stated: bool) -> Option<String> {
    // by planes the noise is measured
    (!stated && config.approach() != Approach::Plane).then(|| assumed(name, config.ranging().range_noise_m))
}

fn assumed(name: &str, noise_m: f32) -> String {
    let mm = 1e3 * noise_m;
    format!(
        "{name}: no noise is stated, {mm:.1} mm are assumed: range_noise_m, --range-noise-m or --sensor states that of the \
         scanner"
    )
}

/// Returns what to say if nearly all counts are dropped for lying outside of the limits, or are
/// nearer than any scanner measures, as they do when the unit is wrong.
fn ranges(input: &Input, ranging: &Ranging) -> Option<String> {
    let Ranging { min_range_m, max_range_m, .. } = *ranging;
    let (name, counts, unit_m) = (&input.name, input.counts, input.geometry.unit_m);
    let is_inside = |range_m: &&f32| (min_range_m..=max_range_m).contains(*range_m);
    let inside = input.ranges.range_m.iter().filter(is_inside).count();
    let near = input.ranges.range_m.iter().filter(is_inside).filter(|range_m| **range_m < NEAR_M).count();
    let outside = counts.saturating_sub(inside);
    let nearly_all = |count: usize| 100 * count >= SUSPICIOUS_PERCENT * counts && count > 0;
    if nearly_all(outside) {
        let least_m = input.geometry.min_range_m.unwrap_or(0.0).max(min_range_m.into());
        let most_m = input.geometry.max_range_m.unwrap_or(f64::INFINITY).min(max_range_m.into());
        return Some(format!(
            "{name}: {outside} of {counts} counts lie outside of {least_m:.2} m to {most_m:.0} m and are no return: \
             is unit_m = {unit_m} right?"
        ));
    }
    nearly_all(near)
        .then(|| format!("{name}: {near} of {counts} counts are nearer than {NEAR_M} m: is unit_m = {unit_m} right?"))
}

/// Returns what looks wrong with the beams of an image.
pub fn of_geometry(name: &str, geometry: &Geometry, rows: usize, columns: usize) -> Vec<String> {
    let list = |angles: &Angles, count| (0..count).map(|i| angles.at(i)).collect::<Vec<_>>();
    let mut warnings = vec![];
    if rows == 1 {
        warnings.push("one row has no plane".to_string());
    }
    if let Some([(row_key, row_angles), (column_key, column_angles)]) = geometry.angles() {
        let (of_rows, of_columns) = (list(row_angles, rows), list(column_angles, columns));
        warnings.extend(sweep(row_key, "row", row_angles, &of_rows));
        warnings.extend(sweep(column_key, "column", column_angles, &of_columns));
        if let Kind::Nodding { .. } = geometry.kind {
            warnings.extend(axis(&of_columns));
        }
    }
    warnings.into_iter().map(|what| format!("{name}: {what}")).collect()
}

/// Returns what looks wrong with angles that the scanner swept over.
fn sweep(key: &str, what: &str, angles: &Angles, all_deg: &[f64]) -> Option<String> {
    // a list may go on at 0 after 360
    let steps_deg: Vec<f64> = match angles {
        Angles::Even { step_deg, .. } => vec![*step_deg; all_deg.len().saturating_sub(1)],
        Angles::Listed(_) => {
            all_deg.windows(2).map(|pair| (pair[1] - pair[0] + 180.0).rem_euclid(360.0) - 180.0).collect()
        }
    };
    let covered_deg: f64 = steps_deg.iter().map(|step| step.abs()).sum();
    if steps_deg.is_empty() {
        return None;
    }
    if covered_deg == 0.0 {
        return Some(format!("{key} is {} deg in every {what}: no plane can be told", all_deg[0]));
    }
    let mut sizes: Vec<f64> = steps_deg.iter().map(|step| step.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let jitter_deg = JITTER * sizes[sizes.len() / 2];
    let forward = steps_deg.iter().sum::<f64>().signum();
    let mut back = (1..).zip(&steps_deg).filter(|(_, step)| forward * **step < -jitter_deg);
    if let Some((at, _)) = back.next() {
        let more = match back.count() {
            0 => String::new(),
            more => format!(", and at {more} more"),
        };
        let (before, here) = (all_deg[at - 1], all_deg[at]);
        return Some(format!(
            "{key} turns back at {what} {at} ({here:.2} after {before:.2} deg){more}: are the {what}s in the order of the sweep?"
        ));
    }
    (covered_deg > TURN_DEG).then(|| format!("{key} covers {covered_deg:.1} deg, more than one turn"))
}

/// Returns what looks wrong with where the beams of a nodding scanner are from its turning axis.
fn axis(beams_deg: &[f64]) -> Option<String> {
    let least = beams_deg.iter().copied().fold(f64::INFINITY, f64::min);
    let most = beams_deg.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    if (least >= -1.0 && most > 100.0) || (most <= 1.0 && least < -100.0) {
        return Some(format!(
            "beam_deg runs from {least:.1} to {most:.1} deg: its 0 is the middle of the sweep, the turning axis is at -90 and 90"
        ));
    }
    let from_axis = |deg: f64| (deg.rem_euclid(180.0) - 90.0).abs();
    beams_deg.iter().all(|&deg| from_axis(deg) < BESIDE_AXIS_DEG).then(|| {
        format!("all beams lie within {BESIDE_AXIS_DEG} deg of the turning axis (beam_deg 90): planes are uncertain")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is said of a geometry of 5 rows and 181 columns.
    fn said(lines: &str) -> String {
        let geometry = Geometry::parse(&format!("version = 1\nunit_m = 0.001\n{lines}")).unwrap();
        of_geometry("scan.pgm", &geometry, 5, 181).join("\n")
    }

    fn nodding(turn_deg: &str, beam_deg: &str) -> String {
        said(&format!("kind = 'nodding'\nturn_axis = 'y'\nturn_deg = {turn_deg}\nbeam_deg = {beam_deg}\n"))
    }

    fn spinning(elevation_deg: &str, azimuth_deg: &str) -> String {
        said(&format!("kind = 'spinning'\nelevation_deg = {elevation_deg}\nazimuth_deg = {azimuth_deg}\n"))
    }

    const BEAMS: &str = "{ start = -90, step = 1 }";

    #[test]
    fn turn_angles_out_of_order_are_said() {
        let asks = ": are the rows in the order of the sweep?";
        assert_eq!(nodding("{ start = 50, step = -0.5 }", BEAMS), "");
        assert_eq!(nodding("[1, 2, 3, 4, 5]", BEAMS), "");
        // an encoder that trembles, a list that goes on at 0
        assert_eq!(nodding("[1, 2, 1.9, 4, 5]", BEAMS), "");
        assert_eq!(nodding("[358, 359, 0, 1, 2]", BEAMS), "");
        let said = "scan.pgm: turn_deg turns back at row 2 (1.00 after 2.00 deg)";
        assert_eq!(nodding("[0, 2, 1, 3, 5]", BEAMS), format!("{said}{asks}"));
        let said = "scan.pgm: turn_deg turns back at row 1 (5.00 after 1.00 deg), and at 1 more";
        assert_eq!(nodding("[1, 5, 0, 4, -1]", BEAMS), format!("{said}{asks}"));
        assert_eq!(nodding("[7, 7, 7, 7, 7]", BEAMS), "scan.pgm: turn_deg is 7 deg in every row: no plane can be told");
        let said = "scan.pgm: elevation_deg turns back at row 2 (-13.00 after 1.00 deg), and at 1 more";
        assert_eq!(spinning("[-15, 1, -13, 3, -11]", "{ start = 0, step = -1 }"), format!("{said}{asks}"));
    }

    #[test]
    fn several_turns_are_said() {
        assert_eq!(nodding("{ start = 0, step = 90 }", BEAMS), "");
        let said = "scan.pgm: turn_deg covers 400.0 deg, more than one turn";
        assert_eq!(nodding("[0, 100, 200, 300, 400]", BEAMS), said);
        assert_eq!(spinning("[1, 2, 3, 4, 5]", "{ start = 0, step = -2 }"), "");
        let said = "scan.pgm: azimuth_deg covers 720.0 deg, more than one turn";
        assert_eq!(spinning("[1, 2, 3, 4, 5]", "{ start = 0, step = -4 }"), said);
    }

    #[test]
    fn beams_beside_the_axis_and_single_rows_are_said() {
        let turns = "{ start = 0, step = 1 }";
        let said = nodding(turns, "{ start = 0, step = 1 }");
        assert!(said.starts_with("scan.pgm: beam_deg runs from 0.0 to 180.0 deg: its 0 is the middle"), "{said}");
        assert!(nodding(turns, "{ start = 0, step = -1 }").contains("runs from -180.0 to 0.0 deg"));
        let said = nodding(turns, "{ start = 81, step = 0.1 }");
        assert!(said.contains("within 10 deg of the turning axis"), "{said}");
        assert_eq!(nodding(turns, "{ start = -135, step = 1.5 }"), "", "270 degrees");
        let camera = "version = 1\nunit_m = 1\nkind = 'pinhole'\ndepth = 'z'\nfx = 1\nfy = 1\ncx = 1\ncy = 1\n";
        let camera = Geometry::parse(camera).unwrap();
        assert_eq!(of_geometry("a", &camera, 1, 9), ["a: one row has no plane"]);
        assert_eq!(of_geometry("a", &camera, 2, 9), [""; 0]);
    }

    #[test]
    fn advice_for_a_full_table_works() {
        assert_eq!(unlabelled_pixels("a", 0, 10, Some(2)), None);
        let said = "a: 7 pixels got no label, the table of live labels was full: leave out --max-labels 2, or take 10";
        assert_eq!(unlabelled_pixels("a", 7, 10, Some(2)).unwrap(), said);
        for max_labels in [Some(10), None] {
            assert!(unlabelled_pixels("a", 7, 10, max_labels).unwrap().ends_with("is of use to these columns"));
        }
    }
}
