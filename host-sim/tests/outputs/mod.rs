//! Small scans for the `scanseg` command, and what `segment` writes of them.

use std::fs;
use std::path::{Path, PathBuf};

use scanseg_formats::{Geometry, RangeImage};
use scanseg_sim::office::{Scene, Sensor, Set};
use serde_json::Value;

/// What `segment` writes by planes; by the other approaches edges.png too.
pub const FILES: [&str; 11] = [
    "labels.png",
    "bearing-horizontal.png",
    "bearing-vertical.png",
    "bearing-diagonal.png",
    "bearing-antidiagonal.png",
    "segments.csv",
    "segments.json",
    "overview.png",
    "segments.png",
    "overlay.png",
    "points.ply",
];

/// Writes a small simulated scan, `scan.pgm` and `geometry.toml`.
pub fn small_scan(folder: &Path) -> RangeImage {
    let scan = Scene::numbered(Set::Tuning, 0).scan(&Sensor::nodding(50, 91), 0).unwrap();
    let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
    ranges
}

/// Writes a scan of an office by some sensor.
pub fn office_scan(folder: &Path, sensor: &Sensor) -> (RangeImage, Geometry) {
    let scan = Scene::numbered(Set::Tuning, 4).scan(sensor, 0).unwrap();
    let image = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    let image = image.to_grey(&scan.geometry).unwrap();
    fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
    (RangeImage::from_grey(&image, &scan.geometry).unwrap(), scan.geometry)
}

pub fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// A point of points.ply.
pub struct Point {
    pub xyz_m: [f32; 3],
    pub rgb: [u8; 3],
    pub label: u32,
}

pub fn points(path: PathBuf) -> Vec<Point> {
    let bytes = fs::read(path).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let head = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(head.starts_with("ply\nformat binary_little_endian 1.0\n"), "{head}");
    let count = head.split("element vertex ").nth(1).and_then(|rest| rest.lines().next()).unwrap().parse().unwrap();
    // behind them is the grid
    let points: Vec<Point> = bytes[end..]
        .chunks(19)
        .take(count)
        .map(|point| {
            let word = |i: usize| point[i..i + 4].try_into().unwrap();
            let xyz_m = [0, 4, 8].map(|i| f32::from_le_bytes(word(i)));
            Point { xyz_m, rgb: point[12..15].try_into().unwrap(), label: u32::from_le_bytes(word(15)) }
        })
        .collect();
    points
}
