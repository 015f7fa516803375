//! The plane segmenter on recorded scans, where they are: `cargo test -p scanseg-tests recorded --
//! --nocapture` prints the figures.

use scanseg_core::{PlaneConfig, Ranging, Segment};
use scanseg_formats::{Geometry, GreyImage, RangeImage};
use scanseg_sim::hoover;
use scanseg_sim::segmentation::Segmentation;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// A file of the recorded scans, if it is there.
fn recorded(file: &str) -> Option<PathBuf> {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")).join(file);
    if path.exists() {
        return Some(path);
    }
    // not by `println`, which shows nothing of a test that passes
    _ = writeln!(io::stderr(), "skipped: {file} is not there");
    None
}

/// What the plane segmenter finds in a scan beside its geometry file; also as labels, 0 for none.
/// At least `least_share` of the returns are in segments of 100 pixels and more.
fn segment(set: &str, image: &str, geometry: &str, least_share: f64) -> Option<(Segmentation, Vec<u16>)> {
    segment_with(set, image, geometry, least_share, |geometry| Ranging::new(geometry.range_noise_m.unwrap() as f32))
}

/// The same with other noise than the file states.
fn segment_with(
    set: &str,
    image: &str,
    geometry: &str,
    least_share: f64,
    ranging: impl Fn(&Geometry) -> Ranging,
) -> Option<(Segmentation, Vec<u16>)> {
    let (image, geometry) = (recorded(&format!("{set}/{image}"))?, recorded(&format!("{set}/{geometry}"))?);
    let geometry = Geometry::read(geometry).unwrap();
    let scan = RangeImage::from_grey(&GreyImage::read(image).unwrap(), &geometry).unwrap();
    let config = PlaneConfig::new(ranging(&geometry));
    let found = Segmentation::of(&scan, &geometry, config, None, || {}).unwrap();
    assert_eq!(found.unlabelled, 0, "{set}");
    let returns = scan.range_m.iter().filter(|&&range_m| range_m > 0.0).count();
    let share = |pixels: u32| pixels as f64 / returns as f64;
    let in_segments = found.of_pixels(100).iter().map(Segment::pixels).sum();
    println!(
        "{set}: {} segments of 100 pixels with {:.3} of the returns; the ten largest hold {:.3}",
        found.of_pixels(100).len(),
        share(in_segments),
        share(found.segments.iter().take(10).map(Segment::pixels).sum())
    );
    assert!(share(in_segments) > least_share, "{set}");
    let labels = found.numbers(1).iter().map(|&number| number.min(65535) as u16).collect();
    Some((found, labels))
}

/// Mean over the planes of 3000 pixels and more of the best intersection over union with a segment.
/// Pixels on no plane do not count.
fn mean_overlap(planes: &[u16], labels: &[u16]) -> f64 {
    let (mut areas, mut sizes, mut shared) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    for (&plane, &label) in planes.iter().zip(labels).filter(|&(&plane, _)| plane != 0) {
        *areas.entry(plane).or_insert(0u32) += 1;
        if label != 0 {
            *sizes.entry(label).or_insert(0u32) += 1;
            *shared.entry((plane, label)).or_insert(0u32) += 1;
        }
    }
    areas.retain(|_, area| *area >= 3000);
    let best = areas.iter().map(|(&plane, &area)| {
        let of_plane = shared.range((plane, 0)..=(plane, u16::MAX));
        let overlaps = of_plane.map(|(&(_, label), &both)| f64::from(both) / f64::from(area + sizes[&label] - both));
        overlaps.fold(0.0, f64::max)
    });
    let best: Vec<f64> = best.collect();
    println!("overlaps {best:.2?}");
    best.iter().sum::<f64>() / best.len() as f64
}

/// The paper's own scanner, with the seams of its servo.
#[test]
fn corridor() {
    for scan in ["scan000", "scan001"] {
        let set = "tilting-sick-corridor";
        let Some(planes) = recorded(&format!("{set}/{scan}.planes.pgm")) else { return };
        let Some((_, labels)) = segment(set, &format!("{scan}.range_mm.pgm"), "geometry.toml", 0.8) else { return };
        let mean = mean_overlap(&GreyImage::read(planes).unwrap().values, &labels);
        println!("{scan}: mean overlap {mean:.3}");
        assert!(mean > 0.70, "{scan}: {mean}");
    }
}

/// Simulated, with its truth.
#[test]
fn synpeb() {
    let Some(truth) = recorded("synpeb/test_100.gt_labels.pgm") else { return };
    let Some((_, labels)) = segment("synpeb", "test_100.range_100um.pgm", "test_100.geometry.toml", 0.9) else {
        return;
    };
    // lower numbers are to be ignored
    let truth: Vec<u16> =
        GreyImage::read(truth).unwrap().values.iter().map(|&id| if id < 10 { 0 } else { id }).collect();
    let found = hoover::evaluate(&truth, &labels, 0.8, 30).unwrap();
    println!("{} of {} correct", found.correct, found.truth_regions);
    assert!(found.correct >= 8 && found.truth_regions == 10);
}

/// Two large planes at right angles that both hold a good part of the scan.
fn assert_room(found: &Segmentation, min_pixels: u32) {
    let planes: Vec<_> = found.of_pixels(min_pixels).iter().filter_map(Segment::plane).collect();
    for (segment, plane) in found.segments.iter().zip(&planes) {
        println!("{} pixels: normal {:.2?}, rms {:.4} m", segment.pixels(), plane.normal, plane.rms_m);
    }
    let across = |a: [f32; 3], b: [f32; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>().abs() < 0.1;
    assert!(planes.iter().any(|one| planes.iter().any(|other| across(one.normal, other.normal))));
}

#[test]
fn office_room() {
    if let Some((found, _)) = segment("office-room-scan", "room_scan1.range_mm.pgm", "geometry.toml", 0.7) {
        assert_room(&found, 2500);
        assert!(found.of_pixels(500).len() < 40, "{}", found.of_pixels(500).len());
    }
}

#[test]
fn street() {
    if let Some((found, _)) = segment("ouster-os0", "range.pgm", "geometry.toml", 0.3) {
        assert_room(&found, 3000);
    }
}

/// At 5 m its depths come in steps of 70 mm, and errors are alike over several pixels. The walls are whole where
/// that is stated, and nearly so where it is not: 4 mm is the wrong constant of the geometry file.
#[test]
fn kinect() {
    for (name, ranging, most) in
        [("preset", Ranging::KINECT_V1, 50), ("unsaid", Ranging::new(0.0), 80), ("4 mm", Ranging::new(0.004), 120)]
    {
        let set = ("office1-kinect", "office1.depth_mm.pgm", "geometry.toml");
        let Some((found, _)) = segment_with(set.0, set.1, set.2, 0.95, |_| ranging) else { return };
        let [large, all] = [3000, 100].map(|pixels| found.of_pixels(pixels));
        println!("{name}: {} segments of 3000 pixels", large.len());
        assert!(large.len() >= 10 && all.len() < most, "{name}: {} and {}", large.len(), all.len());
        assert!(large.iter().filter_map(Segment::plane).all(|plane| plane.rms_m < 0.08), "{name}");
        let of_walls: u32 = large.iter().map(Segment::pixels).sum();
        assert!(of_walls > 200_000, "{name}: {of_walls}");
    }
}
