//! The noise that the default finds in the scan itself, and which noise counts.

use scanseg_core::{ColumnTurns, PlaneConfig, PlaneSegmenter, live_labels};
use scanseg_core::{Ranging, RowBeams, Segmenter, TurnAxis};
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Record, Rig, Room, Scan};

const COLUMNS: usize = 96;
/// Second differences reach over 8 columns to either side: 6 of a chunk of 32 columns count.
const FINE_RAD: f32 = 0.002;
/// They reach over 2 columns: 10 of a chunk count.
const COARSE_RAD: f32 = 0.0175;

/// A normal number of mean 0 and variance 1, the same for the same arguments.
fn normal(row: usize, column: usize) -> f64 {
    let [u, v] = [5, 6].map(|seed| uniform(seed, row, column));
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

fn rig(step_rad: f32) -> Rig {
    let start_rad = -0.5 * step_rad * COLUMNS as f32;
    Rig::Nodding { angles: Angles::Even { start_rad, step_rad }, axis: TurnAxis::Y }
}

/// A wall straight ahead at one distance in the first rows and at another in the others, with noise of
/// this standard deviation at a range.
fn walls(rig: Rig, rows: [usize; 2], distances_m: [f64; 2], noise_m: impl Fn(f64) -> f64) -> Scan {
    let turn_rad = (0..rows[0] + rows[1]).map(|row| 1e-4 * row as f32).collect();
    let mut scan = Scan::of(COLUMNS, turn_rad, rig, |[x, ..]| 1.0 / x);
    for (row, column) in scan.size().pixels() {
        let range_m = &mut scan.range_m[row * COLUMNS + column];
        let exact_m = f64::from(*range_m) * distances_m[usize::from(row >= rows[0])];
        *range_m = (exact_m + noise_m(exact_m) * normal(row, column)) as f32;
    }
    scan
}

/// What the segmenter says of the noise at some ranges after a scan that goes on: what counts, and
/// what is measured.
fn told<const N: usize>(scan: &Scan, ranging: Ranging, ranges_m: [f32; N]) -> [(f32, Option<f32>); N] {
    told_by(scan, ColumnTurns::NONE, ranging, ranges_m)
}

/// The same of rows whose columns are turned each by itself.
fn told_by<const N: usize>(
    scan: &Scan,
    column_turns: ColumnTurns,
    ranging: Ranging,
    ranges_m: [f32; N],
) -> [(f32, Option<f32>); N] {
    let config = PlaneConfig::new(ranging);
    let mut room = Room::new(scan.columns, config, live_labels(scan.columns));
    let mut segmenter = PlaneSegmenter::new(config, scan.beams(), scan.columns, room.memory()).unwrap();
    let mut record = Record::default();
    for (row, &turn_rad) in scan.turn_rad.iter().enumerate() {
        let beams = RowBeams::from(turn_rad).with_column_turns(column_turns);
        segmenter.push_row(scan.row_m(row), beams, &mut record).unwrap();
    }
    ranges_m.map(|range_m| (segmenter.range_noise_m(range_m), segmenter.measured_noise_m(range_m)))
}

/// Whatever is stated, the measured noise is right to a quarter: in each class of ranges, of fine
/// columns and coarse ones, and of a camera.
#[test]
fn measured_noise_is_right_to_a_quarter() {
    let camera = Rig::Pinhole { fx_px: 60.0, fy_px: 60.0, cx_px: 48.0, cy_px: 5.0 };
    for (rig, stated_m) in [(rig(FINE_RAD), 0.005), (rig(COARSE_RAD), 0.0), (rig(-COARSE_RAD), 0.02), (camera, 0.0)] {
        for (distance_m, noise_m) in [(1.3, 0.004), (2.6, 0.01), (5.5, 0.03), (11.0, 0.01)] {
            let scan = walls(rig.clone(), [60, 0], [distance_m, 0.0], |_| noise_m);
            let [(_, measured_m)] = told(&scan, Ranging::new(stated_m), [distance_m as f32]);
            let over = f64::from(measured_m.expect("measured")) / noise_m;
            println!("{distance_m} m, {noise_m} m, {stated_m} stated: {over:.3}");
            assert!((0.75..1.25).contains(&over), "{distance_m} m, {noise_m} m, {stated_m} stated: {over}");
        }
    }
}

/// Columns of a tilt that moves steadily lie on a slant through the row: a wall beside the scanner, the
/// same at every turn, tells its noise as ever.
#[test]
fn columns_that_are_turned_steadily() {
    let angles = Angles::Even { start_rad: 0.8, step_rad: COARSE_RAD };
    let rig = Rig::Nodding { angles, axis: TurnAxis::Y };
    let mut scan = Scan::of(COLUMNS, vec![0.0; 60], rig, |[_, y, _]| 3.0 / y);
    for (row, column) in scan.size().pixels() {
        scan.range_m[row * COLUMNS + column] += (0.01 * normal(row, column)) as f32;
    }
    for step_rad in [0.0, 2e-4, -1e-3] {
        let turns = ColumnTurns { step_rad, ..ColumnTurns::NONE };
        let [(_, measured_m)] = told_by(&scan, turns, Ranging::new(0.01), [3.0]);
        let over = measured_m.expect("measured") / 0.01;
        assert!((0.75..1.25).contains(&over), "{step_rad}: {over}");
    }
}

/// Forty second differences are enough, and as many count of a chunk as are said above; without the
/// pixel in the middle there is none.
#[test]
fn forty_second_differences() {
    for (step_rad, of_row) in [(FINE_RAD, 18), (COARSE_RAD, 30)] {
        let enough = 40usize.div_ceil(of_row);
        for rows in 0..4 {
            let scan = walls(rig(step_rad), [rows, 0], [3.0, 0.0], |_| 0.01);
            let [(_, measured_m)] = told(&scan, Ranging::new(0.01), [3.0]);
            assert_eq!(measured_m.is_some(), rows >= enough, "{rows} rows of {of_row}");
        }
    }
    let mut scan = walls(rig(FINE_RAD), [60, 0], [3.0, 0.0], |_| 0.01);
    let in_the_middle = |column: usize| (8..24).contains(&(column % 32)) && (column % 32 - 8).is_multiple_of(3);
    for (i, range_m) in scan.range_m.iter_mut().enumerate().filter(|(i, _)| in_the_middle(i % COLUMNS)) {
        *range_m = if i % 2 == 0 { 0.0 } else { f32::NAN };
    }
    assert_eq!(told(&scan, Ranging::new(0.01), [1.0, 3.0]).map(|(_, measured_m)| measured_m), [None, None]);
}

/// What is stated counts before anything is measured: noise that is the same everywhere or grows, steps
/// that are the same everywhere or grow, alone and together.
#[test]
fn stated_noise() {
    for terms in 0..32u32 {
        let [a, b, c, s, t] =
            [0, 1, 2, 3, 4].map(|i| f64::from(terms >> i & 1) * [0.003, 0.002, 0.0015, 0.02, 0.01][i]);
        let ranging = Ranging::new(a as f32).with_growing_noise(b as f32, c as f32).with_steps(s as f32, t as f32);
        let ranges_m = [0.5, 2.0, 7.0];
        let nothing = walls(rig(COARSE_RAD), [0, 0], [1.0, 1.0], |_| 0.0);
        for ((counted_m, _), r) in told(&nothing, ranging, ranges_m).into_iter().zip(ranges_m.map(f64::from)) {
            let expected_m = (a + b * r + c * r * r).hypot((s + t * r * r) / 12f64.sqrt()).hypot(0.0015);
            assert!((f64::from(counted_m) / expected_m - 1.0).abs() < 1e-5, "{ranging:?} {r} m: {counted_m}");
        }
    }
}

/// The larger of stated and measured counts, but for what is hardly more than stated, and no more than
/// six times what is stated. Where nothing is stated there is no most.
#[test]
fn the_larger_counts() {
    let counts = |true_m: f64, stated_m: f32| {
        let scan = walls(rig(COARSE_RAD), [60, 0], [3.0, 0.0], |_| true_m);
        told(&scan, Ranging::new(stated_m), [3.0])[0].0
    };
    let least_m = 0.0015f32;
    for (true_m, stated_m) in [(0.002, 0.01), (0.01, 0.01), (0.012, 0.01), (0.0, 0.0)] {
        assert!((counts(true_m, stated_m) - stated_m.hypot(least_m)).abs() < 1e-6, "{true_m} {stated_m}");
    }
    for (true_m, stated_m) in [(0.02, 0.01), (0.03, 0.01), (0.05, 0.0), (0.3, 0.0)] {
        let over = counts(true_m, stated_m) / true_m as f32;
        assert!((0.75..1.1).contains(&over), "{true_m} {stated_m}: {over}");
    }
    let most_m = 6.0 * 0.9f32.sqrt() * 0.01f32.hypot(least_m);
    assert!((counts(0.2, 0.01) - most_m).abs() < 1e-5, "{}", counts(0.2, 0.01));
}

/// What comes later weighs more: noise that changes is followed in the end.
#[test]
fn later_noise_weighs_more() {
    let quiet = walls(rig(COARSE_RAD), [600, 0], [3.0, 0.0], |_| 0.004);
    let mut scan = walls(rig(COARSE_RAD), [4600, 0], [3.0, 0.0], |_| 0.02);
    scan.range_m[..600 * COLUMNS].copy_from_slice(&quiet.range_m);
    let [(_, Some(measured_m))] = told(&scan, Ranging::new(0.0), [3.0]) else { panic!("not measured") };
    assert!((0.012..0.022).contains(&measured_m), "{measured_m}");
}

/// Noise that grows with the square of the range is found to, beyond the farthest wall as well, up to
/// 12 m. At the nearest wall both parts count, the constant one and what grows.
#[test]
fn noise_that_grows() {
    let noise_m = |range_m: f64| 0.003 * range_m * range_m;
    let scan = walls(rig(0.006), [100, 100], [1.5, 6.0], noise_m);
    let ranges_m = [1.5, 6.0, 9.0, 12.0, 20.0];
    let counted_m = told(&scan, Ranging::new(0.0), ranges_m).map(|(counted_m, _)| f64::from(counted_m));
    for (counted_m, range_m) in counted_m.into_iter().zip(ranges_m) {
        let over = counted_m / noise_m(f64::from(range_m).min(12.0));
        println!("{range_m} m: {over:.3}");
        let most = if range_m > 2.0 { 1.25 } else { 1.5 };
        assert!((0.75..most).contains(&over), "{range_m} m: {over}");
    }
}

/// Noise of which a little more is measured near by than far away is not taken to grow: at 12 m it is that of
/// 6 m. Nor does it fall: what is measured far away counts near by, where surfaces may be rough.
#[test]
fn noise_that_does_not_grow() {
    for (near_m, far_m) in [(0.006, 0.005), (0.03, 0.005)] {
        let noise_m = |range_m: f64| if range_m < 3.0 { near_m } else { far_m };
        let scan = walls(rig(0.006), [100, 100], [1.0, 6.0], noise_m);
        for (counted_m, _) in told(&scan, Ranging::new(0.0), [1.0, 6.0, 12.0, 20.0]) {
            println!("{near_m} m, then {far_m} m: {counted_m:.4}");
            assert!((0.75..1.1).contains(&(f64::from(counted_m) / far_m)), "{near_m} m, then {far_m} m: {counted_m}");
        }
    }
}

/// Ranges in coarse steps: most second differences are 0, and yet the noise is about that of rounding,
/// not 0.
#[test]
fn coarse_steps() {
    for step_m in [0.01, 0.03] {
        let mut scan = walls(rig(COARSE_RAD), [120, 0], [3.0, 0.0], |_| 0.1 * step_m);
        for range_m in &mut scan.range_m {
            *range_m = ((f64::from(*range_m) / step_m).round() * step_m) as f32;
        }
        let [(counted_m, _)] = told(&scan, Ranging::new(0.0), [3.0]);
        let over = f64::from(counted_m) / (step_m / 12f64.sqrt());
        println!("{step_m} m: {over:.3}");
        assert!((0.7..1.5).contains(&over), "{step_m} m: {over}");
    }
}
