//! Errors of neighbouring pixels that are alike, as those of depth cameras are.

use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, SegmentSums, Segmenter, TurnAxis, live_labels};
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Record, Rig, Room, Scan};

const ROWS: usize = 60;
const COLUMNS: usize = 160;
/// 0.1 deg: a depth camera.
const FINE_RAD: f32 = 0.0017;
const NOISE_M: f64 = 0.005;

/// A number of mean 0 and variance 1, about normal, the same for the same arguments.
fn error(row: usize, column: usize) -> f64 {
    (0..12).map(|seed| uniform(seed, row, column)).sum::<f64>() - 6.0
}

/// An error of variance 1 that is the mean of those of `size` x `size` pixels.
fn alike(size: usize, row: usize, column: usize) -> f64 {
    let near = (0..size * size).map(|i| error(row + i / size, column + i % size));
    near.sum::<f64>() / size as f64
}

/// What a scanner with columns and rows of this step sees of a surface x = f(y / x) in front of it.
fn scan(step_rad: f32, noise_m: impl Fn(usize, usize) -> f64, x_m: impl Fn(f64) -> f64) -> Scan {
    let angles = Angles::Even { start_rad: -0.5 * step_rad * COLUMNS as f32, step_rad };
    let turn_rad = (0..ROWS).map(|row| step_rad * row as f32).collect();
    let rig = Rig::Nodding { angles, axis: TurnAxis::Y };
    let mut scan = Scan::of(COLUMNS, turn_rad, rig, |[x, y, _]| x_m(y / x) / x);
    for (row, column) in scan.size().pixels() {
        scan.range_m[row * COLUMNS + column] += noise_m(row, column) as f32;
    }
    scan
}

fn wall(step_rad: f32, size: usize) -> Scan {
    scan(step_rad, |row, column| NOISE_M * alike(size, row, column), |_| 3.0)
}

/// The pixels that count as one at the end of a scan.
fn found_px(scan: &Scan, ranging: Ranging) -> f32 {
    let config = PlaneConfig::new(ranging);
    let mut room = Room::new(COLUMNS, config, live_labels(COLUMNS));
    let mut segmenter = PlaneSegmenter::new(config, scan.beams(), COLUMNS, room.memory()).unwrap();
    let mut record = Record::default();
    for (row, &turn_rad) in scan.turn_rad.iter().enumerate() {
        segmenter.push_row(scan.row_m(row), turn_rad, &mut record).unwrap();
    }
    let found_px = segmenter.noise_correlation_px();
    segmenter.finish(&mut record);
    assert_eq!(segmenter.noise_correlation_px(), ranging.noise_correlation_px, "of the next scan");
    found_px
}

/// Shares of the pixels that are in segments of a hundred pixels at least, the largest first.
fn shares(scan: &Scan, ranging: Ranging) -> Vec<f64> {
    let record = scan.record(PlaneConfig::new(ranging), live_labels(COLUMNS));
    let mut pixels: Vec<u32> = record.segments().values().map(|segment| segment.pixels()).collect();
    pixels.sort_unstable_by(|a, b| b.cmp(a));
    pixels.iter().filter(|&&pixels| pixels >= 100).map(|&p| f64::from(p) / (ROWS * COLUMNS) as f64).collect()
}

/// Whatever noise is stated, and where none is: errors of 5 x 5 pixels are found to be alike. White noise
/// is not, nor are 5 pixels where columns are coarser than the errors that are looked for. What is stated to
/// be more stays.
#[test]
fn neighbours_that_err_alike() {
    for stated_m in [0.0, 0.002, 0.005] {
        let ranging = Ranging::new(stated_m);
        let found = [1, 5].map(|size| found_px(&wall(FINE_RAD, size), ranging));
        assert_eq!(found, [1.0, 4.0], "{stated_m} m stated");
        assert_eq!(found_px(&wall(0.0175, 5), ranging), 1.0, "{stated_m} m stated, coarse columns");
    }
    let stated = [2.0, 6.0].map(|px| found_px(&wall(FINE_RAD, 5), Ranging::new(0.0).with_correlation_px(px)));
    assert_eq!(stated, [4.0, 6.0]);
}

/// What is bent differs from a plane to the same side for longer than a few columns: no error that is alike.
#[test]
fn what_is_bent_is_no_noise() {
    let white = |row, column| 0.1 * NOISE_M * error(row, column);
    for waves in [10.0, 20.0, 40.0] {
        let bent = scan(FINE_RAD, white, |y| 3.0 + 0.02 * (waves * y).sin());
        assert_eq!(found_px(&bent, Ranging::new(0.0005)), 1.0, "{waves} waves");
    }
}

/// A wall whose errors are alike is one segment, unsaid and stated.
#[test]
fn one_wall_is_one_segment() {
    let wall = wall(FINE_RAD, 5);
    for ranging in [Ranging::new(0.0), Ranging::new(0.005), Ranging::new(0.005).with_correlation_px(5.0)] {
        let shares = shares(&wall, ranging);
        println!("{ranging:?}: {shares:.3?}");
        assert!(shares.len() == 1 && shares[0] > 0.95, "{ranging:?}: {shares:.3?}");
    }
}

/// Where errors are found to be alike after a few rows, those rows count as the later ones do: all
/// of the wall weighs what it would if that had been stated.
#[test]
fn what_was_seen_before() {
    let wall = wall(FINE_RAD, 5);
    let weight = |ranging| {
        let segments = wall.record(PlaneConfig::new(ranging), live_labels(COLUMNS)).segments();
        let largest = segments.values().max_by_key(|segment| segment.pixels()).unwrap();
        let SegmentSums::Fitted { fitted, .. } = largest.sums else { panic!("{largest:?}") };
        fitted.numbers()[1]
    };
    let found = weight(Ranging::new(0.005)) / weight(Ranging::new(0.005).with_correlation_px(4.0));
    assert!((0.97..1.03).contains(&found), "{found}");
}

/// Two walls side by side that have grown by themselves, one 8 standard deviations behind the other, stay two
/// where they meet: pixels that are alike are fewer measurements, but no worse ones.
#[test]
fn a_step_stays_a_step() {
    let noise_m = |row, column| NOISE_M * alike(4, row, column);
    let mut walls = scan(FINE_RAD, noise_m, |y| if y < 0.0 { 3.0 } else { 3.04 });
    for row in 0..ROWS - 10 {
        walls.range_m[row * COLUMNS..][COLUMNS / 2 - 5..COLUMNS / 2 + 5].fill(0.0);
    }
    for ranging in [Ranging::new(0.0), Ranging::new(0.005), Ranging::new(0.005).with_correlation_px(4.0)] {
        let shares = shares(&walls, ranging);
        println!("{ranging:?}: {shares:.3?}");
        assert!(shares.len() == 2 && shares[1] > 0.45, "{ranging:?}: {shares:.3?}");
    }
}
