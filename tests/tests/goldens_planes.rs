//! Small scans and their planes as pictures: `#` is a return in no area, a letter a label, a blank
//! no return.

use scanseg_core::{Join, Label, Pixel, PlaneConfig, Ranging, live_labels};
use scanseg_tests::art::{Picture, canonical};
use scanseg_tests::scenes::{scanner, uniform};
use scanseg_tests::stream::{Angles, Event, Record, Rig, Scan, class};
use std::f32::consts::TAU;

const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.0));
const NOISE: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));

fn record(scan: &Scan, config: &PlaneConfig, areas: usize) -> Record {
    let record = scan.record(*config, areas);
    record.assert_order_of_planes(scan.turn_rad.len());
    record
}

/// Labels after all joins, in the order in which they appear.
fn labels_with(scan: &Scan, config: &PlaneConfig, areas: usize) -> Picture {
    let record = record(scan, config, areas);
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    Picture::labels(scan.columns, &classes, &canonical(&record.labels()))
}

fn labels(scan: &Scan, config: &PlaneConfig) -> Picture {
    labels_with(scan, config, live_labels(scan.columns))
}

/// Labels as they were given out, before later joins.
fn given_out(scan: &Scan, config: &PlaneConfig) -> Picture {
    let pixels = record(scan, config, live_labels(scan.columns)).pixels();
    let label = |&pixel: &Pixel| if let Pixel::Segment(Label(label)) = pixel { label } else { 0 };
    let classes: Vec<_> = pixels.iter().map(|&pixel| class(pixel)).collect();
    Picture::labels(scan.columns, &classes, &pixels.iter().map(label).collect::<Vec<_>>())
}

/// The joins, each with the number of times that its two labels were reported before.
fn joins(scan: &Scan, config: &PlaneConfig, areas: usize) -> Vec<(Join, [usize; 2])> {
    let (mut reported, mut joins) = (Vec::new(), Vec::new());
    for event in record(scan, config, areas).events {
        match event {
            Event::Segment(segment) => reported.push(segment.label),
            Event::Join(join) => {
                let times = |label| reported.iter().filter(|&&known| known == label).count();
                joins.push((join, [times(join.from), times(join.into)]));
            }
            _ => {}
        }
    }
    joins
}

/// With noise of so many metres, one standard deviation.
fn noisy(mut scan: Scan, sigma_m: f64, seed: u64) -> Scan {
    for (i, range_m) in scan.range_m.iter_mut().enumerate() {
        let gauss = (0..12).map(|k| uniform(seed, i, k)).sum::<f64>() - 6.0;
        *range_m += (sigma_m * gauss) as f32;
    }
    scan
}

/// A wall with noise of 10 mm is one piece, to the pixel, whatever the noise: an error of 3.5
/// standard deviations is no reason to leave a plane.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn wall_in_noise() {
    for seed in 0..20 {
        let scan = noisy(scanner(30, 40, 10.0, |[x, _, _]| 4.0 / x), 0.01, seed);
        let found = labels(&scan, &NOISE);
        let largest = found.pixels.iter().filter(|&&pixel| pixel == 'a').count();
        assert!(largest >= 1190, "{found}");
    }
}

/// The corner of the walls x = 2 and y = 2, at 45 deg between columns 3 and 4.
#[test]
fn corner() {
    let scan = scanner(5, 9, 45.5, |[x, y, _]| (2.0 / x).min(2.0 / y));
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&"|aaaabbbbb|\n".repeat(5)));
}

/// A floor 1 m below the scanner and a wall 3 m away, which meet at -18.4 deg, between rows 5 and
/// 6.
#[test]
fn floor_and_wall() {
    let scan = floor_and_wall_of(7, 2.0, 0.0);
    let art = "|aaaaaaa|\n".repeat(6) + &"|bbbbbbb|\n".repeat(4);
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&art));
}

/// A floor 1 m below the scanner and a wall 3 m away in 6 rows up to -19 deg and 4 rows after that.
fn floor_and_wall_of(columns: usize, step_deg: f32, yaw_deg: f64) -> Scan {
    let rig = scanner(1, columns, 0.0, |_| 0.0).rig;
    let turn_rad = (0..10).map(|row| (-19.0 + step_deg * (row as f32 - 5.0)).to_radians()).collect();
    let (sin, cos) = yaw_deg.to_radians().sin_cos();
    let range_m = |[x, y, z]: [f64; 3]| (3.0 / (x * cos + y * sin)).min(if z < 0.0 { -1.0 / z } else { f64::INFINITY });
    Scan::of(columns, turn_rad, rig, range_m)
}

/// What the correction of the turn cannot tell: a wall that is square to the scanner, and of which
/// a whole row comes at once, from a floor whose rows are turned farther than they say, by up to 4
/// deg. A floor of 50 points is believed so far. A wall that stands at 10 deg is told apart, but
/// for its row in the corner.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn square_wall_that_looks_like_a_turn() {
    let square = labels(&floor_and_wall_of(15, 2.0, 0.0), &CONFIG);
    let lost = square.pixels.chunks(15).skip(6).filter(|row| row.contains(&'a')).count();
    assert!(lost <= 2, "{square}");
    let scan = floor_and_wall_of(41, 2.0, 10.0);
    let oblique = labels(&scan, &CONFIG);
    let rows: Vec<_> = oblique.pixels.chunks(41).skip(7).collect();
    assert!(rows.iter().all(|row| !row.contains(&'a')), "{oblique}");
}

/// A step of 5 cm between two walls that face the scanner, in noise of 2 mm.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn step_of_5_cm() {
    let scan = scanner(8, 20, 0.0, |[x, y, _]| if y < 0.0 { 2.0 / x } else { 2.05 / x });
    let config = PlaneConfig::new(Ranging::new(0.002));
    for seed in 0..20 {
        let found = labels(&noisy(scan.clone(), 0.002, seed), &config);
        assert_eq!(found, Picture::parse(&"|aaaaaaaaaabbbbbbbbbb|\n".repeat(8)));
    }
}

/// A board before a wall, over its whole width for some rows: the wall comes back as another area,
/// and joins the one that was reported, once it is large enough.
#[test]
fn wall_behind_a_board() {
    let scan = scanner(15, 9, 0.0, |[x, _, z]| if z.abs() < 0.05 { 2.0 / x } else { 3.0 / x });
    let art = "|aaaaaaaaa|\n".repeat(5) + &"|bbbbbbbbb|\n".repeat(5) + &"|aaaaaaaaa|\n".repeat(5);
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&art));
    if cfg!(miri) {
        return; // the same again
    }
    let art = "|aaaaaaaaa|\n".repeat(5)
        + &"|bbbbbbbbb|\n".repeat(5)
        + &"|ccccccccc|\n".repeat(2)
        + &"|aaaaaaaaa|\n".repeat(3);
    assert_eq!(given_out(&scan, &CONFIG), Picture::parse(&art));
    assert_eq!(joins(&scan, &CONFIG, live_labels(9)), [(Join { from: Label(3), into: Label(1) }, [0, 1])]);
    // reported after 5 rows, and at the end with all 10
    let reports: Vec<_> = record(&scan, &CONFIG, live_labels(9))
        .events
        .into_iter()
        .filter_map(|event| if let Event::Segment(segment) = event { Some(segment) } else { None })
        .map(|segment| (segment.label.0, segment.pixels(), segment.first_row, segment.last_row))
        .collect();
    assert_eq!(reports, [(1, 45, 0, 4), (2, 45, 5, 9), (1, 90, 0, 14)]);
}

/// With room for two areas only, the wall that has ended is forgotten when it comes back: it is
/// another one. With room for three it is not.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn forgotten_wall() {
    let scan = scanner(15, 9, 0.0, |[x, _, z]| if z.abs() < 0.05 { 2.0 / x } else { 3.0 / x });
    let art = "|aaaaaaaaa|\n".repeat(5) + &"|bbbbbbbbb|\n".repeat(5) + &"|ccccccccc|\n".repeat(5);
    assert_eq!(labels_with(&scan, &CONFIG, 2), Picture::parse(&art));
    assert_eq!(joins(&scan, &CONFIG, 2), []);
    let art = "|aaaaaaaaa|\n".repeat(5) + &"|bbbbbbbbb|\n".repeat(5) + &"|aaaaaaaaa|\n".repeat(5);
    assert_eq!(labels_with(&scan, &CONFIG, 3), Picture::parse(&art));
}

/// One pixel off by 3 standard deviations stays in its wall; one that is far off leaves alone, and
/// takes nothing with it. Eight are a surface where they last.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn outliers() {
    let mut scan = scanner(8, 14, 0.0, |[x, _, _]| 3.0 / x);
    // of the noise of at least 1.5 mm
    scan.range_m[3 * 14 + 6] += 0.0045;
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&"|aaaaaaaaaaaaaa|\n".repeat(8)));
    scan.range_m[3 * 14 + 6] += 0.5;
    let alone = "|aaaaaaaaaaaaaa|\n".repeat(3) + "|aaaaaabaaaaaaa|\n" + &"|aaaaaaaaaaaaaa|\n".repeat(4);
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&alone));
    let mut scan = scanner(8, 18, 0.0, |[x, _, _]| 3.0 / x);
    for row in 3..6 {
        scan.range_m[row * 18..][5..13].fill(2.0);
    }
    let art = "
        |aaaaaaaaaaaaaaaaaa|
        |aaaaaaaaaaaaaaaaaa|
        |aaaaaaaaaaaaaaaaaa|
        |aaaaabbbbbbbbaaaaa|
        |aaaaabbbbbbbbaaaaa|
        |aaaaabbbbbbbbaaaaa|
        |aaaaaaaaaaaaaaaaaa|
        |aaaaaaaaaaaaaaaaaa|";
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(art));
}

/// Lines begin areas in their first row, also of a single pixel, and go across missing pixels.
#[test]
fn first_row() {
    let mut scan = scanner(1, 12, 0.0, |[x, _, _]| 3.0 / x);
    for column in [2, 5, 7, 11] {
        scan.range_m[column] = 0.0;
    }
    assert_eq!(labels(&scan, &CONFIG), Picture::parse("|aa aa a aaa |"));
    // labels are given from left to right run by run, and within a run from right to left
    let scan = scanner(1, 9, 45.5, |[x, y, _]| (2.0 / x).min(2.0 / y));
    assert_eq!(given_out(&scan, &CONFIG), Picture::parse("|bbbbaaaaa|"));
}

/// A line may belong to one of the first eight areas that it touches: in the second row, where none has
/// a plane yet, to the wall at the end of eight pieces, but not of nine.
#[test]
fn eighth_area_above_a_line() {
    let wall_behind = |boards: usize| {
        let mut scan = scanner(4, 32, 0.0, |[x, _, _]| 4.0 / x);
        for (column, range_m) in scan.range_m.iter_mut().enumerate().take(3 * boards) {
            *range_m *= if (column / 3).is_multiple_of(2) { 0.25 } else { 0.45 };
        }
        labels(&scan, &CONFIG)
    };
    let seven = "|aaabbbcccdddeeefffggghhhhhhhhhhh|\n".to_owned() + &"|hhhhhhhhhhhhhhhhhhhhhhhhhhhhhhhh|\n".repeat(3);
    assert_eq!(wall_behind(7), Picture::parse(&seven));
    if cfg!(miri) {
        return; // the same again
    }
    let eight = "|aaabbbcccdddeeefffggghhhiiiiiiii|\n".to_owned() + &"|jjjjjjjjjjjjjjjjjjjjjjjjjjjjjjjj|\n".repeat(3);
    assert_eq!(wall_behind(8), Picture::parse(&eight));
}

/// A fold of 20 deg between two walls, in noise of 2 mm: two surfaces, within a pixel or two.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn small_fold() {
    let config = PlaneConfig::new(Ranging::new(0.002));
    let (sin, cos) = 20f64.to_radians().sin_cos();
    // x = 3 to the right, and to the left a wall through (3, 0) that comes nearer
    let scan = scanner(16, 40, 0.0, |[x, y, _]| if y < 0.0 { 3.0 / x } else { 3.0 * cos / (x * cos + y * sin) });
    for seed in 0..20 {
        let found = labels(&noisy(scan.clone(), 0.002, seed), &config);
        let count = |from: usize, to: usize, label: char| {
            found.pixels.chunks(40).flat_map(|row| &row[from..to]).filter(|&&pixel| pixel == label).count()
        };
        assert!(count(0, 17, 'a') >= 16 * 16 && count(23, 40, 'b') >= 16 * 16, "{found}");
    }
}

/// A floor; from row 20 on the scanner is turned 0.5 deg more than it says. The floor stays one
/// piece.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn seam_of_a_servo() {
    let turned_rad =
        |row: usize, seam_deg: f32| (-50.0 + row as f32 + if row < 20 { 0.0 } else { seam_deg }).to_radians();
    let flat = scanner(35, 60, 0.0, |_| 0.0);
    let floor = |seam_deg: f32| {
        let turn_rad: Vec<f32> = (0..35).map(|row| turned_rad(row, seam_deg)).collect();
        let mut scan = Scan::of(60, turn_rad, flat.rig.clone(), |[_, _, z]| 1.0 / -z);
        scan.turn_rad = (0..35).map(|row| turned_rad(row, 0.0)).collect();
        scan
    };
    for seam_deg in [0.5, -0.5] {
        let scan = floor(seam_deg);
        let error_m = scan.row_m(30)[30] - floor(0.0).row_m(30)[30];
        // beyond what the noise would hide
        assert!(error_m.abs() > 0.035, "{error_m}");
        for seed in 0..10 {
            let found = labels(&noisy(scan.clone(), 0.005, seed), &PlaneConfig::new(Ranging::new(0.005)));
            let largest = found.pixels.iter().filter(|&&pixel| pixel == 'a').count();
            assert!(largest >= 2000, "{seam_deg}:\n{found}");
        }
    }
}

/// A window in a wall: no return, and no gap in the wall. Planes go on below up to three missing
/// rows, at once.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn hole_without_a_return() {
    let hole = |rows: std::ops::Range<usize>| {
        let mut scan = scanner(8, 12, 0.0, |[x, _, _]| 3.0 / x);
        for row in rows {
            scan.range_m[row * 12..][3..10].fill(f32::INFINITY);
        }
        scan
    };
    let art = "
        |aaaaaaaaaaaa|
        |aaaaaaaaaaaa|
        |aaa       aa|
        |aaa       aa|
        |aaa       aa|
        |aaaaaaaaaaaa|
        |aaaaaaaaaaaa|
        |aaaaaaaaaaaa|";
    assert_eq!(given_out(&hole(2..5), &CONFIG), Picture::parse(art));
    assert_eq!(joins(&hole(2..5), &CONFIG, live_labels(12)), []);
    let higher = labels(&hole(2..6), &CONFIG);
    assert_eq!(higher.pixels.iter().filter(|&&pixel| pixel == 'a').count(), 12 * 8 - 4 * 7, "{higher}");
}

/// A square room seen by a spinning lidar of 40 columns: the wall across the seam is one by its
/// neighbours, in the second row, if the image wraps. If not, it is one as soon as both of its
/// parts have 20 points.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn wall_across_the_seam() {
    let scan = |wraps| {
        let angles = Angles::Even { start_rad: 2f32.to_radians(), step_rad: TAU / 40.0 };
        let turn_rad = [-2f32, -1.0, 0.0, 1.0, 2.0].map(f32::to_radians).to_vec();
        Scan::of(40, turn_rad, Rig::Spinning { angles, wraps }, |[x, y, _]| 2.0 / x.abs().max(y.abs()))
    };
    let art = "|aaaaabbbbbbbbbbccccccccccddddddddddaaaaa|\n".repeat(5);
    for wraps in [true, false] {
        assert_eq!(labels(&scan(wraps), &CONFIG), Picture::parse(&art));
        let rows: Vec<_> = given_out(&scan(wraps), &CONFIG).pixels.chunks(40).map(|row| row[0] == row[39]).collect();
        let joined = if wraps { 1 } else { 3 };
        assert_eq!(rows, [0, 1, 2, 3, 4].map(|row| row >= joined), "wraps: {wraps}");
    }
}
