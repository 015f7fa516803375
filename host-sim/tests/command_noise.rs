//! The noise of the ranges as the `scanseg` command takes it: stated, measured, by the name of the
//! sensor.

use std::fs;
use std::path::Path;

use scanseg_formats::RangeImage;
use scanseg_sim::office::{Scene, Sensor, Set, SimulatedScan, Trouble};

use crate::program::{fails, folder, scanseg};

/// Writes a simulated scan with 5 mm of noise, `scan.pgm`. Returns its geometry file without a word
/// about noise.
fn scan(folder: &Path) -> String {
    let sensor = Sensor { range_noise_m: 0.005, ..Sensor::nodding(100, 361) };
    image_of(folder, Scene::numbered(Set::Tuning, 1).scan(&sensor, 0).unwrap())
}

/// The same of any scan.
fn image_of(folder: &Path, scan: SimulatedScan) -> String {
    let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
    let lines = scan.geometry.to_toml();
    lines
        .lines()
        .filter(|line| !line.contains("noise") && !line.contains("range_step"))
        .map(|line| format!("{line}\n"))
        .collect()
}

/// Returns what `segment` says of the noise, and what it warns of.
fn said(folder: &Path, geometry: &str, options: &str) -> (String, String) {
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    let output = scanseg(folder, &format!("segment scan.pgm --geometry geometry.toml --out out {options}"));
    let [told, warned] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    assert!(output.status.success(), "{warned}");
    (told.lines().find(|line| line.starts_with("noise: ")).unwrap().to_string(), warned)
}

/// The number before ` mm`.
fn first_mm(line: &str) -> f64 {
    let (before, _) = line.split_once(" mm").unwrap();
    before.rsplit(' ').next().unwrap().parse().unwrap()
}

#[test]
fn noise_that_is_not_stated_is_measured() {
    let folder = folder("noise-measured");
    let geometry = scan(&folder);
    let (line, warned) = said(&folder, &geometry, "");
    assert!(line.contains(" mm measured at ") && line.ends_with("; none was stated"), "{line}");
    assert!((4.0..6.5).contains(&first_mm(&line)), "{line}");
    assert_eq!(warned, "");
    for approach in ["edge", "region"] {
        let (line, warned) = said(&folder, &geometry, &format!("--approach {approach}"));
        assert_eq!(line, "noise: 10.0 mm assumed; none was stated");
        let says = "scanseg: warning: scan.pgm: no noise is stated, 10.0 mm are assumed: ";
        assert!(warned.starts_with(says) && warned.lines().count() == 1, "{warned}");
    }
}

#[test]
fn stated_noise_that_does_not_fit_is_warned_of() {
    let folder = folder("noise-stated");
    let geometry = scan(&folder);
    for (stated, says, warns) in [
        ("range_noise_m = 0.005\n", "as stated", false),
        ("range_noise_m = 0.003\n", " mm ", false),
        ("range_noise_m = 0.012\n", "as stated", false),
        ("range_noise_m = 0.0005\n", "measured at", true),
        ("range_noise_m = 0.05\n", "as stated", true),
        ("range_noise_per_m2 = 0.005\n", "as stated", true),
    ] {
        let (line, warned) = said(&folder, &format!("{stated}{geometry}"), "");
        assert!(line.contains(says), "{stated}: {line}");
        assert_eq!(warned.lines().count(), usize::from(warns), "{stated}: {warned}");
        if warns {
            assert!(warned.starts_with("scanseg: warning: scan.pgm: a noise of "), "{warned}");
            // much less than what is stated is only bounded
            let most = if warned.contains("at most") { 15.0 } else { 6.5 };
            assert!((4.0..most).contains(&first_mm(warned.rsplit(", ").next().unwrap())), "{warned}");
        }
    }
    let (line, warned) = said(&folder, &geometry, "--range-noise-m 0.05");
    assert!(line.starts_with("noise: 50.") && warned.contains("a noise of 50.0 mm is stated"), "{line} {warned}");
}

#[test]
fn pixels_that_err_alike_are_told() {
    let folder = folder("noise-alike");
    let trouble = Trouble::DisparitySteps { step_per_m: 1e-6, noise_per_m: 0.001, alike_px: 5 };
    let scan = Scene::numbered(Set::Tuning, 1).troubled_scan(&Sensor::pinhole(60, 640), trouble, 0).unwrap();
    let geometry = image_of(&folder, scan);
    let (line, _) = said(&folder, &geometry, "");
    assert!(line.ends_with("; none was stated; 4 pixels err alike"), "{line}");
    let (line, _) = said(&folder, &format!("noise_correlation_px = 5\nrange_noise_per_m2 = 0.001\n{geometry}"), "");
    assert!(line.ends_with(", as stated"), "{line}");
}

#[test]
fn the_sensor_may_be_named() {
    let folder = folder("noise-sensor");
    let geometry = scan(&folder);
    let (line, warned) = said(&folder, &format!("sensor = \"sick-lms200\"\n{geometry}"), "");
    assert!(line.ends_with("as stated") && (5.0..5.5).contains(&first_mm(&line)), "{line}");
    assert_eq!(warned, "");
    // the option stands for the file
    let with_option = said(&folder, &format!("range_noise_m = 0.1\n{geometry}"), "--sensor sick-lms200");
    assert_eq!(with_option, (line, warned));
    let (line, _) = said(&folder, &geometry, "--sensor sick-lms200 --range-noise-m 0.01");
    assert!(line.starts_with("noise: 10."), "{line}");
    let (line, _) = said(&folder, &geometry, "--sensor kinect-v1 --approach edge");
    assert_eq!(line, "noise: 12.8 mm stated");
    let unknown = "segment scan.pgm --geometry geometry.toml --out new --sensor sick";
    fails(&folder, unknown, &["--sensor", "sick-lms200, kinect-v1, ", "ld06"]);
}
