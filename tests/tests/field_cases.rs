//! The plane segmenter on small scans from the field, where they are. Each test says what is right.

use scanseg_core::{PlaneConfig, Ranging, Segment};
use scanseg_formats::{Geometry, GreyImage, RangeImage};
use scanseg_sim::segmentation::{Segmentation, ranging};
use scanseg_tests::checks::planes::assert_lines;
use scanseg_tests::stream::{Angles, Rig, Scan};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file of a case, if it is there.
fn case(file: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/cases")).join(file);
    if path.exists() {
        return Some(path);
    }
    // not by `println`, which shows nothing of a test that passes
    _ = writeln!(io::stderr(), "skipped: {file} is not there");
    None
}

/// An image of a case with its geometry.
fn read(folder: &str, image: &str, geometry: &str) -> Option<(RangeImage, Geometry)> {
    let geometry = Geometry::read(case(&format!("{folder}/{geometry}"))?).unwrap();
    let image = GreyImage::read(case(&format!("{folder}/{image}"))?).unwrap();
    Some((RangeImage::from_grey(&image, &geometry).unwrap(), geometry))
}

/// What is found, with the noise that the geometry file states.
fn found((image, geometry): &(RangeImage, Geometry)) -> Segmentation {
    let noise_m = geometry.range_noise_m.unwrap_or(0.0) as f32;
    let config = PlaneConfig::new(ranging(noise_m, &geometry.noise));
    Segmentation::of(image, geometry, config, None, || {}).unwrap()
}

/// Asserts that a segment lies on a plane.
fn assert_plane(segment: &Segment, normal: [f32; 3], distance_m: f32, off_deg: f32, off_m: f32) {
    let plane = segment.plane().unwrap();
    let cos: f32 = plane.normal.iter().zip(normal).map(|(a, b)| a * b).sum();
    let off = cos.clamp(-1.0, 1.0).acos().to_degrees();
    assert!(off < off_deg && (plane.distance_m - distance_m).abs() < off_m, "{segment:?} {plane:?}");
}

/// One wall seen to +-75 deg is one segment.
#[test]
fn wide_wall() {
    let Some(scan) = read("01-wide-wall", "wall.pgm", "wall.toml") else { return };
    let found = found(&scan);
    assert_eq!(found.segments[0].pixels() as usize, scan.0.range_m.len());
    assert_plane(&found.segments[0], [0.0, -1.0, 0.0], 6.0, 0.2, 0.005);
}

/// The ground and the four walls of a street, by rings that look up to 4.2 deg beside one another.
#[test]
fn rings_beside_one_another() {
    let Some((image, mut geometry)) = read("06-azimuth-offset-per-row", "delivered.pgm", "vlp32c.toml") else { return };
    let truth = read("06-azimuth-offset-per-row", "delivered.truth.pgm", "vlp32c.toml").unwrap();
    let truth: Vec<_> = truth.0.range_m.iter().map(|m| (m / 0.002).round() as u32).collect();
    let offsets = std::fs::read_to_string(case("06-azimuth-offset-per-row/azimuth_offset_deg.txt").unwrap()).unwrap();
    let listed = offsets.split_whitespace().map(|deg| deg.parse().unwrap()).collect();
    geometry.beside.row_offset_deg = Some(scanseg_formats::Angles::Listed(listed));
    let found = found(&(image, geometry));
    let mut overlaps = std::collections::BTreeMap::new();
    for (&surface, &label) in truth.iter().zip(&found.labels).filter(|(surface, _)| **surface > 0) {
        *overlaps.entry((surface, label)).or_insert(0) += 1;
    }
    let of = |surface: u32| overlaps.range((surface, 0)..(surface + 1, 0)).map(|(_, count)| *count);
    let shares: Vec<f64> =
        (1..=5).map(|s| f64::from(of(s).max().unwrap_or(0)) / f64::from(of(s).sum::<i32>())).collect();
    assert!(shares.iter().all(|share| *share >= 0.95), "{shares:?}");
}

/// A floor and a wall square to the scanner, both exact, are two segments.
#[test]
fn square_wall() {
    let Some(scan) = read("02-square-wall", "floorwall.pgm", "floorwall.toml") else { return };
    let found = found(&scan);
    let [floor, wall] = found.of_pixels(3) else { panic!("{:?}", found.segments) };
    // the first row of the wall is 11 mm from where the floor goes on, with 10 mm of noise stated
    assert!((11..=12).contains(&floor.last_row), "{floor:?}");
    assert_eq!([floor.first_row, wall.first_row, wall.last_row], [0, floor.last_row + 1, 19]);
    assert_eq!(floor.pixels() + wall.pixels(), 20 * 31);
    assert_plane(floor, [0.0, 0.0, 1.0], 1.0, 0.2, 0.005);
    assert_plane(wall, [-1.0, 0.0, 0.0], 4.0, 0.1, 0.002);
    for segment in [floor, wall] {
        assert!(segment.plane().unwrap().rms_m < 0.002, "{segment:?}");
    }
}

/// The best intersection over union of each region of the truth with a segment.
fn overlaps(truth: &[u16], found: &Segmentation, regions: u16) -> Vec<f64> {
    let labels = found.numbers(1);
    let overlap = |region: u16, label: u32| {
        let pixels = truth.iter().zip(&labels).filter(|&(&a, &b)| a == region || (a != 0 && b == label));
        let both = truth.iter().zip(&labels).filter(|&(&a, &b)| a == region && b == label).count();
        both as f64 / pixels.count() as f64
    };
    let best = |region| {
        let mut shared: Vec<_> =
            truth.iter().zip(&labels).filter(|&(&a, &b)| a == region && b != 0).map(|(_, &b)| b).collect();
        shared.sort();
        let most = shared.chunk_by(|a, b| a == b).max_by_key(|same| same.len()).map_or(0, |same| same[0]);
        overlap(region, most)
    };
    (1..=regions).map(best).collect()
}

/// A depth camera whose noise grows with the square of the depth, and whose depths come in steps
/// that do: floor, wall, and the top and front of a box 6 cm high are found in one run.
#[test]
fn noise_grows() {
    let Some((image, mut geometry)) = read("03-noise-grows", "kinect.pgm", "kinect_0.01.toml") else { return };
    let truth = GreyImage::read(case("03-noise-grows/truth.pgm").unwrap()).unwrap().values;
    geometry.range_noise_m = None;
    geometry.noise.range_noise_per_m2 = 0.0025;
    geometry.noise.range_step_per_m2 = 0.0031;
    let overlaps = overlaps(&truth, &found(&(image, geometry)), 4);
    println!("{overlaps:.2?}");
    assert!(overlaps.iter().all(|&overlap| overlap >= 0.85), "{overlaps:.2?}");
}

/// The table of areas has room for tree tops.
#[test]
fn tree_tops() {
    let Some(scan) = read("09-label-table-full", "canopy.pgm", "canopy.toml") else { return };
    assert_eq!(found(&scan).unlabelled, 0);
}

/// Three pixels of one line across a step from 500 m to 2 m are one line, whatever digits single
/// precision has: the line is steep, and one of its points far away.
#[test]
fn digits_across_a_step() {
    let mut same = 0;
    for step in 0..200 {
        let step_rad = (5.0 + 0.1 * step as f32).to_radians();
        let rig = Rig::Nodding { angles: Angles::Even { start_rad: 0.0, step_rad }, axis: scanseg_core::TurnAxis::Y };
        let along = |inverse_m: f32, turns: f32| {
            1.0 / (0.002 * (turns * step_rad).cos() + inverse_m * (turns * step_rad).sin())
        };
        let range_m = vec![500.0, along(0.9, 1.0), along(0.9, 2.0), 2.5, along(0.3, 4.0), along(0.3, 5.0)];
        let scan = Scan { columns: 6, range_m, turn_rad: vec![0.0], rig };
        let ranging = Ranging::new(0.002).with_limits(0.05, 500.0);
        same += usize::from(assert_lines(&scan, &PlaneConfig::new(ranging)));
    }
    assert_eq!(same, 200);
}
