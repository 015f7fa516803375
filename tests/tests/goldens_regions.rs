//! Small scans and their regions as pictures: `#` is a pixel on no line, a letter a label, a blank
//! no return.

use scanseg_core::{Join, Label, Pixel, Ranging, RegionConfig, TurnAxis, live_labels};
use scanseg_tests::art::Picture;
use scanseg_tests::scenes::scanner;
use scanseg_tests::stream::{Angles, Event, Record, Rig, Scan, class};

const CONFIG: RegionConfig = RegionConfig::paper().with_ranging(Ranging::new(0.0));

fn record(scan: &Scan) -> Record {
    let record = scan.record(CONFIG, live_labels(scan.columns));
    record.assert_order_of_regions(scan.turn_rad.len());
    record
}

/// Labels after all joins.
fn labels(scan: &Scan) -> Picture {
    let record = record(scan);
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    Picture::labels(scan.columns, &classes, &record.labels())
}

/// Labels as they were given out, before later joins.
fn given_out(scan: &Scan) -> Picture {
    let pixels = record(scan).pixels();
    let label = |&pixel: &Pixel| if let Pixel::Segment(Label(label)) = pixel { label } else { 0 };
    let classes: Vec<_> = pixels.iter().map(|&pixel| class(pixel)).collect();
    Picture::labels(scan.columns, &classes, &pixels.iter().map(label).collect::<Vec<_>>())
}

/// Where lines begin.
fn breaks(scan: &Scan) -> Picture {
    Picture::bits(scan.columns, &record(scan).edges(scan.columns))
}

fn joins(scan: &Scan) -> Vec<Join> {
    let join = |event| if let Event::Join(join) = event { Some(join) } else { None };
    record(scan).events.into_iter().filter_map(join).collect()
}

/// The corner of the walls x = 2 and y = 2, at 45 deg between columns 3 and 4: both of these turn,
/// and every pixel is kept.
#[test]
fn corner() {
    let scan = scanner(5, 9, 45.5, |[x, y, _]| (2.0 / x).min(2.0 / y));
    assert_eq!(breaks(&scan), Picture::parse(&"|#...#....|\n".repeat(5)));
    assert_eq!(labels(&scan), Picture::parse(&"|aaaabbbbb|\n".repeat(5)));
}

/// A corner right in column 4: its pixel goes with the line to its left.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn corner_at_a_pixel() {
    let scan = scanner(5, 9, 45.0, |[x, y, _]| (2.0 / x).min(2.0 / y));
    assert_eq!(labels(&scan), Picture::parse(&"|aaaaabbbb|\n".repeat(5)));
}

/// The wall x = 3, and 1 m before it another one that ends to the left, at column 4.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn step() {
    let scan = scanner(5, 10, 0.0, |[x, y, _]| if y < 0.0 { 2.0 / x } else { 3.0 / x });
    assert_eq!(breaks(&scan), Picture::parse(&"|#....#....|\n".repeat(5)));
    assert_eq!(labels(&scan), Picture::parse(&"|aaaaabbbbb|\n".repeat(5)));
}

/// A slat of two pixels, and one of one pixel, before a wall: two pixels that both turn are on no
/// line, and neither is a single one.
#[test]
fn slats() {
    let scan = scanner(3, 14, 0.0, |[x, y, _]| {
        let column = (y / x).atan().to_degrees() + 6.5;
        if (3.5..5.5).contains(&column) || (9.5..10.5).contains(&column) { 2.0 / x } else { 3.0 / x }
    });
    assert_eq!(labels(&scan), Picture::parse(&"|aaaa##bbbb#ccc|\n".repeat(3)));
}

/// A wall and before it a board that hangs from above: what is to its left and to its right is one
/// only from the row on in which one line is in both planes.
#[test]
fn join_of_a_u() {
    let board = |[x, y, z]: [f64; 3]| y.abs() < 0.05 * x && z < -0.5f64.to_radians().sin();
    let scan = scanner(7, 11, 0.0, |at| if board(at) { 2.0 / at[0] } else { 3.0 / at[0] });
    let art = "
        |aaabbbbbccc|
        |aaabbbbbccc|
        |aaabbbbbccc|
        |aaaaaaaaaaa|
        |aaaaaaaaaaa|
        |aaaaaaaaaaa|
        |aaaaaaaaaaa|";
    assert_eq!(given_out(&scan), Picture::parse(art));
    assert_eq!(joins(&scan), [Join { from: Label(3), into: Label(1) }]);
}

/// Two walls that lean to either side of a line, which is the last row: it is in the planes of
/// both, which are of the same size, and the left one gets it. The two are no one plane.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn equal_regions() {
    let last_deg = 2f64;
    let foot_m = 3.0 * last_deg.to_radians().tan();
    // x = 3 + lean (z - foot): the upper end of the left wall is nearer, that of the right one
    // farther away
    let scan = scanner(5, 12, 0.0, |[x, y, z]| {
        let lean = if y < 0.0 { 1.0 } else { -1.0 };
        (3.0 - lean * foot_m) / (x - lean * z)
    });
    let art = "
        |aaaaaabbbbbb|
        |aaaaaabbbbbb|
        |aaaaaabbbbbb|
        |aaaaaabbbbbb|
        |aaaaaaaaaaaa|";
    assert_eq!(given_out(&scan), Picture::parse(art));
    assert_eq!(joins(&scan), []);
}

/// A wall of nine pixels beside a line of eleven that is 0.1 m before it: the next row of the wall
/// could go on with both, and goes on with what has a plane.
#[test]
fn planes_before_lines() {
    let mut scan = scanner(4, 14, 0.0, |[x, _, _]| 3.0 / x);
    for row in 0..2 {
        scan.range_m[row * 14 + 3..][..11].fill(0.0);
    }
    let line = scanner(4, 14, 0.0, |[x, _, _]| 2.9 / x);
    scan.range_m[2 * 14 + 3..][..11].copy_from_slice(&line.range_m[2 * 14 + 3..][..11]);
    let art = "
        |aaa           |
        |aaa           |
        |aaabbbbbbbbbbb|
        |aaaaaaaaaaaaaa|";
    assert_eq!(given_out(&scan), Picture::parse(art));
    assert_eq!(joins(&scan), []);
    // without the wall above, it goes on with the line
    scan.range_m[..2 * 14 + 3].fill(0.0);
    scan.range_m[2 * 14..][..3].fill(0.0);
    let art = "
        |              |
        |              |
        |   aaaaaaaaaaa|
        |aaaaaaaaaaaaaa|";
    assert_eq!(given_out(&scan), Picture::parse(art));
}

/// A region whose last line ends where the next one does is over before that one begins: one label
/// at a time is enough.
#[test]
fn room_for_one_region() {
    let mut scan = scanner(6, 2, 0.0, |[x, _, _]| 3.0 / x);
    for row in [1, 3, 5] {
        scan.range_m[row * 2..][..2].fill(1.0);
    }
    let record = scan.record(CONFIG, 1);
    record.assert_order_of_regions(6);
    assert_eq!(record.unlabelled(2), [0; 6]);
    assert_eq!(record.segments().len(), 6);
}

/// Two pieces of one plane to either side of a pillar touch nowhere: two regions.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn coplanar_pieces() {
    let scan = scanner(4, 11, 0.0, |[x, y, _]| if y.abs() < 0.05 * x { 2.0 / x } else { 3.0 / x });
    assert_eq!(labels(&scan), Picture::parse(&"|aaabbbbbccc|\n".repeat(4)));
    assert_eq!(joins(&scan), []);
}

/// A window in a wall: no return, and no gap in the wall.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn hole_without_a_return() {
    let mut scan = scanner(6, 9, 0.0, |[x, _, _]| 3.0 / x);
    for (row, column) in (2..4).flat_map(|row| (3..7).map(move |column| (row, column))) {
        scan.range_m[row * 9 + column] = f32::INFINITY;
    }
    let art = "
        |aaaaaaaaa|
        |aaaaaaaaa|
        |aaa    aa|
        |aaa    aa|
        |aaaaaaaaa|
        |aaaaaaaaa|";
    assert_eq!(labels(&scan), Picture::parse(art));
}

/// A floor 1 m below the scanner and a wall 3 m away, which meet at -18 deg: no line turns, but its
/// end points are off the floor's plane.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn floor_and_wall() {
    let mut scan = scanner(6, 7, 0.0, |_| 0.0);
    scan.turn_rad = [-30f32, -26.0, -22.0, -18.0, -14.0, -10.0].map(f32::to_radians).to_vec();
    let range_m = |[x, _, z]: [f64; 3]| (3.0 / x).min(if z < 0.0 { -1.0 / z } else { f64::INFINITY });
    let scan = Scan::of(scan.columns, scan.turn_rad, scan.rig, range_m);
    let art = "
        |aaaaaaa|
        |aaaaaaa|
        |aaaaaaa|
        |bbbbbbb|
        |bbbbbbb|
        |bbbbbbb|";
    assert_eq!(labels(&scan), Picture::parse(art));
}

/// A square room seen by a spinning lidar of 40 columns: the wall across the seam is one if the
/// image wraps, and only then.
#[test]
fn wall_across_the_seam() {
    let scan = |wraps| {
        let start_rad = 2f32.to_radians();
        let angles = Angles::Even { start_rad, step_rad: std::f32::consts::TAU / 40.0 };
        let turn_rad = [-1f32, 0.0, 1.0].map(f32::to_radians).to_vec();
        Scan::of(40, turn_rad, Rig::Spinning { angles, wraps }, |[x, y, _]| 2.0 / x.abs().max(y.abs()))
    };
    let art = "|aaaaabbbbbbbbbbccccccccccddddddddddaaaaa|\n".repeat(3);
    assert_eq!(labels(&scan(true)), Picture::parse(&art));
    if cfg!(miri) {
        return; // the same again
    }
    assert_eq!(joins(&scan(true)), [Join { from: Label(5), into: Label(1) }]);
    let art = "|aaaaabbbbbbbbbbccccccccccddddddddddeeeee|\n".repeat(3);
    assert_eq!(labels(&scan(false)), Picture::parse(&art));
    assert_eq!(joins(&scan(false)), []);

    // right at a corner the seam separates
    let turned = |start_deg: f32| {
        let angles = Angles::Even { start_rad: start_deg.to_radians(), step_rad: std::f32::consts::TAU / 40.0 };
        Scan::of(40, vec![0.0, 0.02], Rig::Spinning { angles, wraps: true }, |[x, y, _]| 2.0 / x.abs().max(y.abs()))
    };
    let art = "|aaaaaaaaaabbbbbbbbbbccccccccccdddddddddd|\n".repeat(2);
    assert_eq!(labels(&turned(47.0)), Picture::parse(&art));
}

/// Nodding about an upright axis and a camera see the same corner.
#[test]
fn other_rigs() {
    let corner = |[x, y, z]: [f64; 3]| (2.0 / x).min(1.0 / (y.abs() + z.abs()).max(1e-9));
    let angles = Angles::Even { start_rad: -0.7, step_rad: 0.1 };
    let turn_rad: Vec<f32> = (0..6).map(|row| 0.6 + 0.06 * row as f32).collect();
    let pan = Scan::of(15, turn_rad, Rig::Nodding { angles, axis: TurnAxis::Z }, |[x, y, _]| (2.0 / x).min(2.0 / y));
    let planes = record(&pan).segments().values().filter_map(|s| s.plane()).collect::<Vec<_>>();
    assert!(planes.iter().any(|plane| plane.normal[0] < -0.999), "{planes:?}");
    let rig = Rig::Pinhole { fx_px: 20.0, fy_px: 20.0, cx_px: 10.3, cy_px: 3.2 };
    let camera = Scan::of(21, vec![0.0; 8], rig, corner);
    let back: Vec<_> = record(&camera).segments().values().filter_map(|s| s.plane()).collect();
    assert!(back.iter().any(|plane| plane.normal[0] < -0.999 && (plane.distance_m - 2.0).abs() < 0.01), "{back:?}");
}
