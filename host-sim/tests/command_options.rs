//! Options of the `scanseg` command, and what it says of those and of files that it cannot use.

use std::fs;

use scanseg_formats::GreyImage;
use serde_json::Value;

use crate::outputs::{json, small_scan};
use crate::program::{fails, folder, scanseg, succeeds};

#[test]
fn every_option_of_the_configuration_is_used() {
    let folder = folder("options");
    small_scan(&folder);
    let options = "--preset paper --range-noise-m 0.02 --min-range-m 1.5 --max-range-m 4 --roof-angle-deg 45 \
         --step-angle-deg 3 --traces row*3,2x-2,antidiagonal --closing square";
    succeeds(&folder, &format!("segment scan.pgm --geometry geometry.toml --out out {options}"));
    let configuration = json(folder.join("out/segments.json"))["header"]["configuration"].clone();
    let expected = r#"{"approach":"edge","closing":"square","line_angle_deg":3.0,"max_range_m":4.0,"min_range_m":1.5,
        "plane_distance_m":0.005,"range_noise_m":0.02,"roof_angle_deg":45.0,
        "step_angle_deg":3.0,"traces":["0x3","2x-2","1x-1"]}"#;
    let read = |mut configuration: Value| {
        // rounded: 3 degrees in radians are not 3 degrees any more
        configuration["line_angle_deg"] = configuration["line_angle_deg"].as_f64().map(f64::round).into();
        configuration["plane_distance_m"] =
            configuration["plane_distance_m"].as_f64().map(|m| (1e3 * m).round() / 1e3).into();
        configuration
    };
    assert_eq!(read(configuration), serde_json::from_str::<Value>(expected).unwrap());
    fails(
        &folder,
        "segment scan.pgm --geometry geometry.toml --out o --approach plane --traces row",
        &["--approach edge"],
    );

    // each of them changes the segments
    let labels = |options: &str| {
        let command = format!("segment scan.pgm --geometry geometry.toml --out out --min-pixels 1 {options}");
        // a noise of 0.1 m is warned of
        assert!(scanseg(&folder, &command).status.success(), "{command}");
        (
            GreyImage::read(folder.join("out/labels.png")).unwrap(),
            json(folder.join("out/segments.json"))["header"].clone(),
        )
    };
    let each_shows = |approach: &str, options: &[&str]| {
        let (plain, _) = labels(approach);
        for option in options {
            let (changed, header) = labels(&format!("{approach} {option}"));
            assert_ne!(changed, plain, "{option}");
            assert_eq!(header["unlabelled_pixels"] != 0, *option == "--max-labels 2", "{option}");
        }
    };
    each_shows(
        "",
        &["--range-noise-m 0.1", "--min-range-m 1.5", "--max-range-m 2", "--max-labels 2", "--preset paper"],
    );
    each_shows(
        "--preset paper",
        &[
            "--min-range-m 1.5",
            "--max-range-m 2",
            "--roof-angle-deg 3",
            "--step-angle-deg 30",
            "--traces row",
            "--closing square",
            "--max-labels 2",
            "--approach region",
        ],
    );
    each_shows(
        "--approach region",
        &[
            "--range-noise-m 0.1",
            "--min-range-m 1.5",
            "--max-range-m 2",
            "--line-angle-deg 60",
            "--plane-distance-m 0.2",
            "--max-labels 2",
        ],
    );

    // the geometry file's values hold where there is no option
    let geometry = fs::read_to_string(folder.join("geometry.toml")).unwrap();
    let limited = format!("range_noise_m = 0.003\nmin_range_m = 1.25\nmax_range_m = 900.0\n{geometry}");
    fs::write(folder.join("geometry.toml"), limited).unwrap();
    let configuration = labels("").1["configuration"].clone();
    let values = ["range_noise_m", "min_range_m", "max_range_m"].map(|key| configuration[key].as_f64().unwrap());
    assert!((values[0] - 0.003).abs() < 1e-9 && values[1..] == [1.25, 500.0], "{values:?}");
    assert_eq!(labels("--min-range-m 2").1["configuration"]["min_range_m"], 2.0);
}

#[test]
fn what_cannot_be_used_is_named_in_one_line_and_nothing_is_written() {
    let folder = folder("errors");
    small_scan(&folder);
    let pgm = fs::read(folder.join("scan.pgm")).unwrap();
    fs::write(folder.join("short.pgm"), &pgm[..pgm.len() - 1000]).unwrap();
    fs::write(folder.join("text.pgm"), "not an image").unwrap();
    let png = GreyImage::read(folder.join("scan.pgm")).unwrap().to_png();
    fs::write(folder.join("short.png"), &png[..png.len() / 2]).unwrap();
    let geometry = fs::read_to_string(folder.join("geometry.toml")).unwrap();
    fs::write(folder.join("wrong.toml"), geometry.replace("nodding", "hovering")).unwrap();
    let listed = "version = 1\nunit_m = 0.001\nkind = \"nodding\"\nturn_axis = \"y\"\n\
         beam_deg = { start = 0.0, step = 1.0 }\nturn_deg = [1.0, 2.0, 3.0]\n";
    fs::write(folder.join("listed.toml"), listed).unwrap();
    fs::write(folder.join("steep.toml"), geometry.replace("step = 2.0", "step = 100.0")).unwrap();
    fs::write(folder.join("file"), "").unwrap();

    let with =
        |scan: &str, geometry: &str, rest: &str| format!("segment {scan} --geometry {geometry} --out out {rest}");
    fails(&folder, &with("absent.pgm", "geometry.toml", ""), &["absent.pgm", "No such file"]);
    fails(&folder, &with("scan.pgm", "absent.toml", ""), &["absent.toml", "No such file"]);
    fails(&folder, &with("short.pgm", "geometry.toml", ""), &["short.pgm", "50 x 91"]);
    fails(&folder, &with("short.png", "geometry.toml", ""), &["short.png", "byte"]);
    fails(&folder, &with("text.pgm", "geometry.toml", ""), &["text.pgm"]);
    fails(&folder, &with("geometry.toml", "geometry.toml", ""), &["geometry.toml"]);
    fails(&folder, &with("scan.pgm", "scan.pgm", ""), &["scan.pgm"]);
    fails(&folder, &with("scan.pgm", "wrong.toml", ""), &["wrong.toml", "kind"]);
    fails(&folder, &with("scan.pgm", "listed.toml", ""), &["listed.toml", "scan.pgm", "turn_deg", "3", "50"]);
    fails(&folder, &with("scan.pgm", "steep.toml", ""), &["steep.toml", "beam_deg.step", "90"]);
    for (option, says) in [
        ("--preset best", "paper"),
        ("--frob 1", "--frob"),
        ("--min-pixels 0", "--min-pixels"),
        ("--min-pixels many", "many"),
        ("--range-noise-m -1", "--range-noise-m cannot be -1"),
        ("--range-noise-m nan", "--range-noise-m cannot be NaN"),
        ("--min-range-m 0", "--min-range-m cannot be 0"),
        ("--max-range-m 501", "--max-range-m cannot be 501"),
        ("--roof-angle-deg 0", "--roof-angle-deg cannot be 0"),
        ("--step-angle-deg 91", "--step-angle-deg cannot be 91"),
        ("--traces diagonally", "--traces"),
        ("--traces row*0", "factor of 0"),
        ("--traces column*17", "17 rows"),
        ("--traces 0x0", "0 columns"),
        ("--traces row,row,row,row,row,row,row,row,row", "9 are too many"),
        ("--closing circle", "plus"),
        ("--approach both", "region"),
        ("--line-angle-deg 0", "--line-angle-deg cannot be 0"),
        ("--plane-distance-m -1", "--plane-distance-m cannot be -1"),
        ("--max-labels 0", "--max-labels"),
    ] {
        fails(&folder, &with("scan.pgm", "geometry.toml", option), &[says]);
        if !option.starts_with("--min-pixels") {
            fails(&folder, &format!("bench scan.pgm --geometry geometry.toml {option}"), &[says]);
        }
    }
    fails(&folder, "segment scan.pgm --geometry geometry.toml", &["--out"]);
    fails(&folder, "segment scan.pgm --geometry geometry.toml --out file", &["file"]);
    fails(&folder, "segment scan.pgm --geometry geometry.toml --out file/out", &["file/out"]);
    fails(&folder, "frob", &["frob"]);
    fails(&folder, "bench scan.pgm --geometry geometry.toml --repeat 0", &["--repeat"]);
}

/// A unit that is wrong by 1000 leaves hardly a count within the limits of the program: that is
/// said, and the results are those of an image without returns. A few counts outside are nothing
/// to speak of.
#[test]
fn units_that_leave_no_return_are_said() {
    let folder = folder("units_that_leave_no_return_are_said");
    let counts = |far: usize| (0..128).map(|i| if i < far { 60_000 } else { 2000 + i as u16 }).collect();
    let image = |far| GreyImage { rows: 8, columns: 16, max_value: 65535, values: counts(far) }.to_pgm();
    let geometry = |unit_m: f64, lines: &str| {
        format!(
            "version = 1\nunit_m = {unit_m:?}\n{lines}range_noise_m = 0.01\nkind = \"nodding\"\nturn_axis = \"y\"\n\
             beam_deg = {{ start = -7.5, step = 1.0 }}\nturn_deg = {{ start = -4.0, step = 1.0 }}\n"
        )
    };
    for (unit_m, far, said) in [
        (0.001_f64, 0, ""),
        (1.0, 0, "mm.pgm: 128 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 1 right?"),
        (
            1e-6,
            0,
            "mm.pgm: 128 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 0.000001 right?",
        ),
        (
            0.005,
            120,
            "mm.pgm: 120 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 0.005 right?",
        ),
        (0.005, 20, ""),
        (0.001, 0, ""),
        // without a least range of its own, and with a largest one of 500 m
        (-1e-6, 0, "mm.pgm: 128 of 128 counts are nearer than 0.05 m: is unit_m = 0.000001 right?"),
        (-1.0, 0, "mm.pgm: 128 of 128 counts lie outside of 0.00 m to 500 m and are no return: is unit_m = 1 right?"),
        (-0.001, 0, ""),
    ] {
        let limits = if unit_m < 0.0 { "min_range_m = 0\nmax_range_m = 10000\n" } else { "" };
        fs::write(folder.join("mm.pgm"), image(far)).unwrap();
        fs::write(folder.join("geometry.toml"), geometry(unit_m.abs(), limits)).unwrap();
        for command in
            ["segment mm.pgm --geometry geometry.toml --out out", "bench mm.pgm --geometry geometry.toml --repeat 1"]
        {
            let output = scanseg(&folder, command);
            assert!(output.status.success(), "{command}");
            let expected = if said.is_empty() { String::new() } else { format!("scanseg: warning: {said}\n") };
            assert_eq!(String::from_utf8(output.stderr).unwrap(), expected, "{command} {unit_m}");
        }
    }
}
