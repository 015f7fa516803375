//! The `scanseg` command on recorded scans, where they are.

use std::fs;
use std::path::PathBuf;

use scanseg_formats::GreyImage;
use serde_json::Value;

use crate::program::{folder, scanseg, succeeds};
use crate::recorded::recorded;

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

#[test]
fn bearing_angles_are_those_of_another_program() {
    let Some(data) = recorded("bearing-angle-reference") else { return };
    let folder = folder("reference");
    // Largest difference allowed: of counts of the other program's file. For the diagonal of the
    // camera 2 instead of 1: its beams are 0.1 deg apart, and what an f32 can tell of a range in
    // metres then makes 1.2 counts by itself.
    for (scan, images) in [("laserscan", &[("horizontal", 1)][..]), ("pinhole", &[("vertical", 1), ("diagonal", 2)])] {
        let path = |name: &str| data.join(format!("{scan}{name}"));
        // the other program knows no seam
        let geometry = fs::read_to_string(path(".geometry.toml")).unwrap().replace("wraps = true", "wraps = false");
        fs::write(folder.join("geometry.toml"), geometry).unwrap();
        let image = path("-depth.png").display().to_string();
        succeeds(&folder, &format!("segment {image} --geometry geometry.toml --out {scan} --min-range-m 1e-6"));
        for (name, allowed) in images {
            let ours = GreyImage::read(folder.join(scan).join(format!("bearing-{name}.png"))).unwrap();
            let theirs = GreyImage::read(path(&format!("-bearing-{name}-ref.png"))).unwrap();
            assert_eq!((ours.rows, ours.columns), (theirs.rows, theirs.columns));
            let scale = 65535.0 / f64::from(theirs.max_value);
            let mut more_than_1 = 0;
            for (i, (&ours, &theirs)) in ours.values.iter().zip(&theirs.values).enumerate() {
                let apart = (f64::from(ours) / scale).round() - f64::from(theirs);
                assert!(apart.abs() <= f64::from(*allowed), "{scan} {name}, pixel {i}: {ours} {theirs}");
                more_than_1 += u32::from(apart.abs() > 1.0);
            }
            assert!(more_than_1 <= 10, "{scan} {name}: {more_than_1} pixels");
        }
    }
}

/// Planes that a person finds in the pictures and that a wrong geometry would bend or break: pixels
/// at least, the normal (to 4 deg) and the distance in metres (to 6 %) of some segment. The
/// baseline of four pixels is for the scanners' noise.
#[test]
fn recorded_scans_are_segmented() {
    type Seen = (f64, [f64; 3], f64);
    let scans: [(&str, &str, &str, &[Seen]); 5] = [
        // a side wall and the floor
        (
            "tilting-sick-corridor",
            "scan000.range_mm.pgm",
            "row*4,column*4",
            &[(5000.0, [0.0, 1.0, 0.0], 0.978), (3000.0, [0.057, 0.0, 0.998], 0.355)],
        ),
        (
            "tilting-sick-corridor",
            "scan001.range_mm.pgm",
            "row*4,column*4",
            &[(5000.0, [0.0, 1.0, 0.0], 0.967), (3000.0, [0.0, 0.0, 1.0], 0.365)],
        ),
        // the ceiling and a wall
        (
            "office-room-scan",
            "room_scan1.range_mm.pgm",
            "row*4,column*4",
            &[(8000.0, [0.0, 0.0, -1.0], 1.660), (2000.0, [0.0, 1.0, 0.0], 1.465)],
        ),
        // facades to either side of the street
        (
            "ouster-os0",
            "range.pgm",
            "row,column",
            &[(800.0, [-0.190, -0.982, 0.0], 8.42), (300.0, [0.190, 0.982, 0.0], 10.9)],
        ),
        // far from the camera its depth comes in steps: slices of a wall parallel to the image
        ("office1-kinect", "office1.depth_mm.pgm", "row,column", &[(2000.0, [-1.0, 0.0, 0.0], 5.05)]),
    ];
    for (set, scan, traces, seen) in scans {
        let Some(data) = recorded(set) else { continue };
        // a region that misses its line in one row goes on as another: half of the pixels will do
        for (approach, share) in [("plane", 1.0), ("edge", 1.0), ("region", 0.5)] {
            let folder = folder(&format!("{scan}-{approach}"));
            let (scan, geometry) = (data.join(scan), data.join("geometry.toml"));
            let traces = if approach == "edge" { format!("--traces {traces}") } else { String::new() };
            let options = format!("--geometry {} --out . {traces} --approach {approach}", geometry.display());
            // that the noise which is stated does not fit may be warned of
            assert!(scanseg(&folder, &format!("segment {} {options}", scan.display())).status.success());
            let file = json(folder.join("segments.json"));
            let header = &file["header"];
            let parts = ["edge_pixels", "segment_pixels", "unlabelled_pixels"].map(|key| header[key].as_u64().unwrap());
            assert_eq!(Some(parts.iter().sum()), header["returns"].as_u64(), "{set}: every return is one of three");
            for (pixels, normal, distance_m) in seen {
                let found = file["segments"].as_array().unwrap().iter().any(|segment| {
                    let number = |value: &Value| value.as_f64().unwrap_or(f64::NAN);
                    let along: f64 = (0..3).map(|i| number(&segment["normal"][i]) * normal[i]).sum();
                    number(&segment["pixels"]) >= share * pixels
                        && along > 4f64.to_radians().cos()
                        // the servo bends the second floor: 0.35 m by the points alone, 0.39 m by their noise
                        && (number(&segment["distance_m"]) / distance_m - 1.0).abs() < 0.08
                });
                assert!(
                    found,
                    "{set}, {approach}: no plane of {pixels} pixels, normal {normal:?}, {distance_m} m away"
                );
            }
        }
    }
}
