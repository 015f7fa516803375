//! What the `scanseg` command warns of: said on stderr, in one style, with advice that works.

use std::fs;
use std::path::Path;

use scanseg_formats::{GreyImage, RangeImage};
use scanseg_sim::office::{Scene, Sensor, Set, Trouble};

use crate::program::{folder, scanseg, succeeds};

/// Writes a small simulated scan. Returns its geometry file.
fn scan(folder: &Path) -> String {
    let sensor = Sensor { range_noise_m: 0.01, ..Sensor::nodding(50, 91) };
    let scan = Scene::numbered(Set::Tuning, 0).scan(&sensor, 0).unwrap();
    let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
    let geometry = scan.geometry.to_toml();
    fs::write(folder.join("geometry.toml"), &geometry).unwrap();
    geometry
}

/// Runs a command that succeeds. Returns its warnings, each of one line and in the one style.
fn warnings(folder: &Path, arguments: &str) -> Vec<String> {
    let output = scanseg(folder, arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success(), "{arguments}: {stderr}");
    let warning = |line: &str| line.strip_prefix("scanseg: warning: ").unwrap_or_else(|| panic!("{line}")).to_string();
    stderr.lines().map(warning).collect()
}

const SEGMENT: &str = "segment scan.pgm --geometry geometry.toml --out out";

#[test]
fn a_full_table_is_said_and_the_advice_mends_it() {
    let folder = folder("full-table");
    scan(&folder);
    for (approach, enough) in [("plane", 182), ("edge", 46), ("region", 46)] {
        let said = warnings(&folder, &format!("{SEGMENT} --approach {approach} --max-labels 2"));
        let advice = format!("full: leave out --max-labels 2, or take {enough}");
        // with so few areas the noise is not what it is
        let said: Vec<_> = said.iter().filter(|line| line.contains(" pixels got no label, ")).collect();
        assert!(said.len() == 1 && said[0].ends_with(&advice), "{said:?}");
        for advised in [String::new(), format!("--max-labels {enough}")] {
            let said = warnings(&folder, &format!("{SEGMENT} --approach {approach} {advised}"));
            assert!(!said.iter().any(|line| line.contains("label")), "{said:?}");
        }
    }
    for command in ["rig --scans 1 --max-labels 2 --save c.txt", "replay c.txt --max-labels 2"] {
        let output = scanseg(&folder, command);
        let [told, said] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
        assert!(told.contains(" pixels without a label: the table of live labels was full\n"), "{told}");
        assert!(said.contains(" got no label") && said.ends_with("leave out --max-labels 2, or take 362\n"), "{said}");
    }
}

#[test]
fn noise_that_is_assumed_is_said() {
    let folder = folder("assumed-noise");
    let geometry = scan(&folder).replace("range_noise_m = 0.01\n", "");
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    let says = ": no noise is stated, 10.0 mm are assumed: range_noise_m, --range-noise-m or --sensor states that of the \
         scanner";
    for command in [SEGMENT, "bench scan.pgm --geometry geometry.toml --repeat 1"] {
        assert_eq!(warnings(&folder, &format!("{command} --approach edge")), [format!("scan.pgm{says}")]);
        assert_eq!(warnings(&folder, &format!("{command} --approach region")), [format!("scan.pgm{says}")]);
        assert_eq!(warnings(&folder, command), [""; 0], "it is measured");
    }
    for command in ["rig --scans 1 --approach region --save c.txt", "replay c.txt --approach region"] {
        let name = if command.starts_with("rig") { "rig" } else { "c.txt" };
        assert_eq!(warnings(&folder, command), [format!("{name}{says}")]);
        succeeds(&folder, &format!("{command} --sensor sick-lms200"));
    }
    // too few pixels to measure anything
    fs::write(
        folder.join("scan.pgm"),
        GreyImage { rows: 2, columns: 3, max_value: 65535, values: vec![2000; 6] }.to_pgm(),
    )
    .unwrap();
    let said = warnings(&folder, SEGMENT);
    assert!(said.iter().any(|line| line.starts_with("scan.pgm: no noise is stated, ")), "{said:?}");
}

#[test]
fn beams_that_look_wrong_are_said() {
    let folder = folder("wrong-beams");
    let geometry = scan(&folder);
    let turn = geometry.lines().find(|line| line.starts_with("turn_deg")).unwrap();
    let list = |deg: &dyn Fn(usize) -> f64| format!("turn_deg = {:?}", (0..50).map(deg).collect::<Vec<_>>());
    for (lines, says) in [
        (list(&|row| (row ^ 1) as f64), "scan.pgm: turn_deg turns back at row 1 "),
        (list(&|row| 20.0 * row as f64), "scan.pgm: turn_deg covers 980.0 deg, more than one turn"),
        (list(&|row| row as f64), ""),
    ] {
        fs::write(folder.join("geometry.toml"), geometry.replace(turn, &lines)).unwrap();
        for command in [SEGMENT, "bench scan.pgm --geometry geometry.toml --repeat 1"] {
            let said = warnings(&folder, command);
            // what the noise makes of a wrong turn is another matter
            let said: Vec<_> = said.iter().filter(|line| line.contains("turn_deg")).collect();
            assert_eq!(said.len(), usize::from(!says.is_empty()), "{said:?}");
            assert!(said.iter().all(|line| line.starts_with(says)), "{said:?}");
        }
    }
    let image = GreyImage { rows: 1, columns: 91, max_value: 65535, values: vec![2000; 91] };
    fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    assert!(warnings(&folder, SEGMENT).contains(&"scan.pgm: one row has no plane".to_string()));
}

/// A segment of one row has the plane of measurement for its plane, or none: that is said where planes
/// are listed.
#[test]
fn planes_that_are_not_to_be_relied_on_are_said() {
    let folder = folder("weak-planes");
    scan(&folder);
    let told = |values: Vec<u16>, options: &str| {
        let image = GreyImage { rows: 50, columns: 91, max_value: 65535, values };
        fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
        succeeds(&folder, &format!("{SEGMENT} --min-pixels 10 {options}"))
    };
    let one_row: Vec<u16> = (0..50 * 91).map(|i| if i / 91 == 7 { 3000 } else { 0 }).collect();
    let said = told(one_row.clone(), "--approach region");
    let line = said.lines().find(|line| line.starts_with("planes of ")).unwrap();
    assert!(line.ends_with(" lie in one row") && !line.contains("none"), "{said}");
    let said = told(one_row, "");
    let line = said.lines().find(|line| line.starts_with("planes of ")).unwrap();
    assert!(line.ends_with(" have none"), "{said}");
    assert!(!told(vec![0; 50 * 91], "").contains("planes of "));
}

/// Beams that lie 2 % farther apart than the geometry says are found by the walls, and said once.
#[test]
fn beams_that_are_off_in_scale_are_said() {
    let folder = folder("beam-scale");
    let sensor = Sensor { range_noise_m: 0.005, ..Sensor::nodding(200, 361) };
    let scene = Scene::numbered(Set::Tuning, 0);
    for (scale, said) in [(1.0, ""), (1.02, " farther apart than beam_deg says"), (0.98, " nearer to each other than ")]
    {
        let scan = scene.troubled_scan(&sensor, Trouble::BearingScale(scale), 0).unwrap();
        let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
        fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
        fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
        let lines = warnings(&folder, SEGMENT);
        let found: Vec<_> = lines.iter().filter(|line| line.contains("beam_deg")).collect();
        assert_eq!(found.len(), usize::from(!said.is_empty()), "{scale}: {lines:?}");
        assert!(found.iter().all(|line| line.contains(said)), "{scale}: {lines:?}");
    }
}

/// The examples of the documentation fit their images as they are, and nothing looks wrong with their
/// beams.
#[test]
fn examples_of_the_documentation_can_be_copied() {
    let folder = folder("copied-examples");
    let page = include_str!("../../docs/scan-format.md");
    let examples: Vec<_> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    for (text, (rows, columns)) in examples.iter().zip([(200, 361), (480, 640), (16, 1800)]) {
        let image = GreyImage { rows, columns, max_value: 65535, values: vec![2000; rows * columns] };
        fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
        fs::write(folder.join("geometry.toml"), text).unwrap();
        let said = warnings(&folder, SEGMENT);
        assert!(said.iter().all(|line| line.contains("a noise of ")), "{said:?}");
    }
    assert_eq!(examples.len(), 3);
}

/// Who makes a mistake in the geometry file is shown the page that describes it, and so is who asks
/// for help.
#[test]
fn the_page_is_named_where_it_is_needed() {
    let folder = folder("page");
    let geometry = scan(&folder);
    let says = |arguments: &str| {
        let output = scanseg(&folder, arguments);
        String::from_utf8([output.stdout, output.stderr].concat()).unwrap().contains("docs/scan-format.md")
    };
    for help in ["--help", "segment --help", "bench --help", "replay --help", "rig --help"] {
        assert!(says(help), "{help}");
    }
    fs::write(folder.join("raw.bin"), [0; 100]).unwrap();
    let turn = geometry.lines().find(|line| line.starts_with("turn_deg")).unwrap();
    for wrong in
        [geometry.replace("unit_m", "unit"), geometry.replace(turn, "turn_deg = [1, 2]"), "no TOML".to_string()]
    {
        fs::write(folder.join("geometry.toml"), &wrong).unwrap();
        for command in
            [SEGMENT, "bench scan.pgm --geometry geometry.toml", "rig --scan scan.pgm --geometry geometry.toml"]
        {
            assert!(says(command), "{command} of {wrong}");
        }
    }
    assert!(says("replay raw.bin --geometry geometry.toml --range-bits 13"));
    assert!(!says("segment absent.pgm --geometry geometry.toml --out out"));
}
