//! What the `scanseg` command counts: segments, times, classes of detections, scenes with their truth.

use std::fs;
use std::path::PathBuf;

use scanseg_formats::{Geometry, GreyImage, RangeImage};
use serde_json::Value;

use crate::outputs::{json, small_scan};
use crate::program::{fails, folder, succeeds};

#[test]
fn more_segments_than_labels_png_can_number() {
    let folder = folder("many");
    // Returns like the black squares of a chess board: each is an area of its own.
    let (rows, columns) = (370, 370);
    let values = (0..rows * columns).map(|i| if (i / columns + i % columns) % 2 == 0 { 1000 } else { 0 }).collect();
    fs::write(folder.join("scan.pgm"), GreyImage { rows, columns, max_value: 65535, values }.to_pgm()).unwrap();
    let geometry = "version = 1\nunit_m = 0.001\nrange_noise_m = 0.01\nkind = \"pinhole\"\ndepth = \"range\"\nfx = 300.0\nfy = 300.0\n\
         cx = 185.0\ncy = 185.0\n";
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    let arguments = "segment scan.pgm --geometry geometry.toml --out out --preset paper --min-pixels";
    fails(&folder, &format!("{arguments} 1"), &["scan.pgm", "68450", "65535", "larger --min-pixels"]);
    succeeds(&folder, &format!("{arguments} 2"));
    assert_eq!(json(folder.join("out/segments.json"))["header"]["segments_found"], 68450);
    assert!(GreyImage::read(folder.join("out/labels.png")).unwrap().values.iter().all(|&n| n == 0));
}

#[test]
fn bench_counts_what_segment_finds() {
    let folder = folder("bench");
    small_scan(&folder);
    let told = succeeds(&folder, "bench scan.pgm --geometry geometry.toml --repeat 2 --json");
    let timing: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(timing["points"], 50 * 91);
    let [median, min] = ["median_ns_per_point", "min_ns_per_point"].map(|key| timing[key].as_f64().unwrap());
    assert!(0.0 < min && min <= median, "{told}");
    succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out out");
    let header = json(folder.join("out/segments.json"))["header"].clone();
    assert!(timing["segments"].as_u64() > Some(0));
    assert_eq!(timing["segments"], header["segments_listed"]);
    let told = succeeds(&folder, "bench scan.pgm --geometry geometry.toml --repeat 1");
    assert!(told.contains("median_ns_per_point") && told.contains("points 4550"), "{told}");

    let told = succeeds(
        &folder,
        "bench scan.pgm --geometry geometry.toml --repeat 1 --json --approach edge --range-noise-m 0.01",
    );
    let timing: Value = serde_json::from_str(&told).unwrap();
    succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out out --approach edge --range-noise-m 0.01");
    let by_edges = json(folder.join("out/segments.json"))["header"].clone();
    assert_eq!(timing["segments"], by_edges["segments_listed"]);
    assert_ne!(by_edges["edge_pixels"], header["edge_pixels"]);
}

fn write_labels(path: PathBuf, columns: usize, max_value: u16, values: &[u16]) {
    let image = GreyImage { rows: values.len() / columns, columns, max_value, values: values.to_vec() };
    let png = path.extension().is_some_and(|e| e == "png");
    fs::write(path, if png { image.to_png() } else { image.to_pgm() }).unwrap();
}

#[test]
fn evaluate_counts_the_classes_of_hand_made_images() {
    let folder = folder("evaluate");
    // Truth 1 is found whole but for 2 of 10 pixels, 2 in two pieces, 3 and 4 as one, 5 not at all;
    // segment 9 is nowhere.
    let truth = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 0, 0, 0];
    let labels = [1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 2, 2, 3, 3, 7, 7, 7, 7, 7, 7, 0, 0, 0, 9, 9, 9];
    write_labels(folder.join("truth.pgm"), 13, 255, &truth);
    write_labels(folder.join("labels.png"), 13, 65535, &labels);
    let told = succeeds(&folder, "evaluate --truth truth.pgm --labels labels.png --out out");
    let keys = ["correct", "over_segmented", "under_segmented", "missed", "noise", "truth_regions", "segments"];
    let counts = |json: &Value| keys.map(|key| json[key].as_u64().unwrap());
    let hoover = json(folder.join("out/hoover.json"));
    assert_eq!(counts(&hoover), [1, 1, 1, 1, 1, 5, 5]);
    assert_eq!(hoover["tolerance"], 0.8);
    assert!(told.lines().any(|line| line.split_whitespace().eq(["correct", "1"])), "{told}");
    let csv = fs::read_to_string(folder.join("out/hoover.csv")).unwrap();
    let lines: Vec<_> = csv.lines().collect();
    assert_eq!(lines[0], "tolerance,truth_regions,segments,correct,over_segmented,under_segmented,missed,noise");
    assert_eq!((lines.len(), lines[1], lines[30]), (51, "0.51,5,5,1,1,1,1,1", "0.8,5,5,1,1,1,1,1"));
    assert_eq!((lines[31], lines[50]), ("0.81,5,5,0,1,1,2,2", "1,5,5,0,1,1,2,2"));

    succeeds(&folder, "evaluate --truth truth.pgm --labels labels.png --out out --tolerance 0.9 --min-pixels 4");
    assert_eq!(counts(&json(folder.join("out/hoover.json"))), [0, 0, 0, 2, 2, 2, 2]);
    assert_eq!(fs::read_to_string(folder.join("out/hoover.csv")).unwrap().lines().count(), 2);

    let plain = succeeds(&folder, "evaluate --truth truth.pgm --labels truth.pgm --tolerance 1");
    assert!(plain.lines().any(|line| line.split_whitespace().eq(["correct", "5"])), "{plain}");
    write_labels(folder.join("turned.png"), 2, 255, &labels);
    let sizes = ["turned.png", "13 rows x 2 columns", "truth.pgm", "2 rows x 13 columns"];
    fails(&folder, "evaluate --truth truth.pgm --labels turned.png --out new", &sizes);
    fails(&folder, "evaluate --truth truth.pgm --labels labels.png --out new --tolerance 0.5", &["tolerance 0.5"]);
    fails(&folder, "evaluate --truth truth.pgm --labels absent.png --out new", &["absent.png"]);
}

#[test]
fn office_writes_scenes_with_their_truth() {
    let folder = folder("office");
    for (options, name, size) in [
        ("--scene 4", "tuning-04", (200, 361)),
        ("--scene 4 --sensor pinhole --set validation --noise-m 0.01", "validation-04", (240, 320)),
    ] {
        let out = folder.join(name);
        succeeds(&folder, &format!("office --out {name} {options}"));
        assert_eq!(fs::read_dir(&out).unwrap().count(), 4);
        let [scan, truth] = ["", "-truth"].map(|s| GreyImage::read(out.join(format!("{name}{s}.pgm"))).unwrap());
        assert_eq!((scan.rows, scan.columns), size);
        assert_eq!((truth.rows, truth.columns), size);
        let geometry = Geometry::read(out.join("geometry.toml")).unwrap();
        assert_eq!(geometry.range_noise_m.is_some(), name.starts_with("validation"));
        let ranges = RangeImage::from_grey(&scan, &geometry).unwrap();
        assert!(ranges.range_m.iter().zip(&truth.values).all(|(&range_m, &id)| (range_m > 0.0) == (id != 0)));
        assert!(out.join(format!("{name}.png")).exists());
    }
    fails(&folder, "office --out new --scene 1 --noise-m -1", &["range_noise_m"]);
    fails(&folder, "office --out new --set best", &["tuning"]);
}
