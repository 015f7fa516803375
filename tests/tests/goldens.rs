//! Small scans with their edges and labels as pictures: `#` is an edge, a letter a label, a blank
//! no return.

use scanseg_core::{EdgeConfig, Element, Join, Label, Pixel, Ranging, Trace, live_labels};
use scanseg_tests::art::Picture;
use scanseg_tests::scenes::scanner;
use scanseg_tests::stream::{Angles, Event, Record, Rig, Scan, class};
use std::f32::consts::PI;

/// Roofs of 10 deg; steps within 3 deg of the beam, of more than 0.3 m.
const CONFIG: EdgeConfig = EdgeConfig::paper()
    .with_ranging(Ranging::new(0.07))
    .with_roof_angle_rad(10.0 * PI / 180.0)
    .with_step_angle_rad(3.0 * PI / 180.0);

/// Only steps along the row: every edge pixel is the first one after a jump.
const JUMPS: EdgeConfig = CONFIG.with_roof_angle_rad(PI).with_traces(&[Trace::ROW]);

/// The scan whose ranges are drawn: a digit is a range in metres, a blank no return.
fn drawn(art: &str) -> Scan {
    let picture = Picture::parse(art);
    let scan = scanner(picture.rows, picture.columns, 0.0, |_| 0.0);
    Scan { range_m: picture.map(|pixel| pixel.to_digit(10).unwrap_or(0) as f32), ..scan }
}

fn record(scan: &Scan, config: &EdgeConfig) -> Record {
    scan.record(*config, live_labels(scan.columns))
}

fn edges(scan: &Scan, config: &EdgeConfig) -> Picture {
    Picture::bits(scan.columns, &record(scan, config).edges(scan.columns))
}

/// Labels as they were given out, before later joins.
fn given_out(scan: &Scan, config: &EdgeConfig) -> Picture {
    let pixels = record(scan, config).pixels();
    let label = |&pixel: &Pixel| if let Pixel::Segment(Label(label)) = pixel { label } else { 0 };
    let classes: Vec<_> = pixels.iter().map(|&pixel| class(pixel)).collect();
    Picture::labels(scan.columns, &classes, &pixels.iter().map(label).collect::<Vec<_>>())
}

/// Labels after all joins.
fn labels(scan: &Scan, config: &EdgeConfig) -> Picture {
    let record = record(scan, config);
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    Picture::labels(scan.columns, &classes, &record.labels())
}

fn joins(scan: &Scan, config: &EdgeConfig) -> Vec<Join> {
    let join = |event| if let Event::Join(join) = event { Some(join) } else { None };
    record(scan, config).events.into_iter().filter_map(join).collect()
}

/// The corner of the walls x = 2 and y = 2, at 45 deg between columns 3 and 4: the horizontal
/// bearing angle is 44 deg more for the pair across it and 88 deg more from there on, so Sobel
/// marks columns 3 to 5.
#[test]
fn corner() {
    let scan = scanner(5, 9, 45.5, |[x, y, _]| (2.0 / x).min(2.0 / y));
    let art = "
        |...###...|
        |...###...|
        |...###...|
        |...###...|
        |...###...|";
    assert_eq!(edges(&scan, &CONFIG), Picture::parse(art));
    let art = "
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|";
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(art));
}

/// A step: the wall x = 3, and 1 m before it another one that ends to the left, at column 4. Along
/// the row the bearing angle is near 0 at column 5, the first one behind: a step edge; and Sobel
/// marks it and its neighbours.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn step() {
    let scan = scanner(5, 10, 0.0, |[x, y, _]| if y < 0.0 { 2.0 / x } else { 3.0 / x });
    let art = "
        |.....#....|
        |.....#....|
        |.....#....|
        |.....#....|
        |.....#....|";
    assert_eq!(edges(&scan, &JUMPS), Picture::parse(art));
    let art = "
        |....###...|
        |....###...|
        |....###...|
        |....###...|
        |....###...|";
    assert_eq!(edges(&scan, &CONFIG), Picture::parse(art));
    let art = "
        |aaaa###bbb|
        |aaaa###bbb|
        |aaaa###bbb|
        |aaaa###bbb|
        |aaaa###bbb|";
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(art));
}

/// A gap of one pixel in an edge. Closing with the plus leaves it open, and the two sides are one
/// area; the square seals it.
#[test]
fn gap_in_an_edge() {
    let scan = drawn(
        "
        |111555|
        |111555|
        |555555|
        |111555|
        |111555|",
    );
    let art = "
        |...#..|
        |...#..|
        |......|
        |...#..|
        |...#..|";
    assert_eq!(edges(&scan, &JUMPS), Picture::parse(art));
    let art = "
        |aaa#aa|
        |aaa#aa|
        |aaaaaa|
        |aaa#aa|
        |aaa#aa|";
    assert_eq!(labels(&scan, &JUMPS), Picture::parse(art));
    let art = "
        |aaa#bb|
        |aaa#bb|
        |aaa#bb|
        |aaa#bb|
        |aaa#bb|";
    assert_eq!(labels(&scan, &JUMPS.with_closing(Element::Square)), Picture::parse(art));
}

/// A U: its arms are two areas until its bottom joins them, in the row from which on they have one
/// label.
#[test]
fn join_of_a_u() {
    let scan = drawn(
        "
        |22 222 22|
        |22 222 22|
        |22     22|
        |222222222|
        |222222222|",
    );
    let art = "
        |aa bbb cc|
        |aa bbb cc|
        |aa     cc|
        |aaaaaaaaa|
        |aaaaaaaaa|";
    assert_eq!(given_out(&scan, &JUMPS), Picture::parse(art));
    assert_eq!(joins(&scan, &JUMPS), [Join { from: Label(3), into: Label(1) }]);
    let art = "
        |aa bbb aa|
        |aa bbb aa|
        |aa     aa|
        |aaaaaaaaa|
        |aaaaaaaaa|";
    assert_eq!(labels(&scan, &JUMPS), Picture::parse(art));

    // what happens when: the row of the join comes after it, the segment between the arms once
    // nothing touches it
    let told: Vec<_> = record(&scan, &JUMPS).events.iter().filter_map(tell).collect();
    let expected = ["row 0", "row 1", "2 ends at row 1", "row 2", "3 joins 1", "row 3", "row 4", "1 ends at row 4"];
    assert_eq!(told, expected);
}

fn tell(event: &Event) -> Option<String> {
    match event {
        Event::Edges { .. } => None,
        Event::Row { row, .. } => Some(format!("row {row}")),
        Event::Join(join) => Some(format!("{} joins {}", join.from, join.into)),
        Event::Segment(segment) => Some(format!("{} ends at row {}", segment.label, segment.last_row)),
    }
}

/// The border of the image is no edge, though the first row and column have no bearing angles: a
/// wall in one piece.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn border() {
    let scan = scanner(4, 6, 0.0, |[x, _, _]| 3.0 / x);
    assert_eq!(edges(&scan, &CONFIG), Picture::parse(&"|......|\n".repeat(4)));
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(&"|aaaaaa|\n".repeat(4)));
}

/// A window in a wall: no return, no edge around it, no gap in the wall.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn hole_without_a_return() {
    let mut scan = scanner(6, 9, 0.0, |[x, _, _]| 3.0 / x);
    for (row, column) in (2..4).flat_map(|row| (3..7).map(move |column| (row, column))) {
        scan.range_m[row * 9 + column] = f32::INFINITY;
    }
    assert_eq!(edges(&scan, &CONFIG), Picture::parse(&"|.........|\n".repeat(6)));
    let art = "
        |aaaaaaaaa|
        |aaaaaaaaa|
        |aaa    aa|
        |aaa    aa|
        |aaaaaaaaa|
        |aaaaaaaaa|";
    assert_eq!(labels(&scan, &CONFIG), Picture::parse(art));
}

/// A round room with a pillar, seen by a spinning lidar of 40 columns: across the seam the wall
/// goes on if the image wraps, and only then.
#[test]
fn wall_across_the_seam() {
    let scan = |wraps| {
        let angles = Angles::Even { start_rad: 0.0, step_rad: std::f32::consts::TAU / 40.0 };
        let turn_rad = [-1f32, 0.0, 1.0].map(f32::to_radians).to_vec();
        let wall = |[x, y, _]: [f64; 3]| if (x + 1.0).abs() < 0.1 { 0.0 } else { 3.0 / x.hypot(y) };
        Scan::of(40, turn_rad, Rig::Spinning { angles, wraps }, wall)
    };
    let seam = Join { from: Label(2), into: Label(1) };
    let art = "|aaaaaaaaaaaaaaaaaa     aaaaaaaaaaaaaaaaa|\n".repeat(3);
    assert_eq!(labels(&scan(true), &JUMPS), Picture::parse(&art));
    assert_eq!(joins(&scan(true), &JUMPS), [seam]);
    let segments = record(&scan(true), &JUMPS).segments();
    assert_eq!((segments[&1].first_column, segments[&1].last_column, segments[&1].pixels()), (0, 39, 105));
    if cfg!(miri) {
        return; // the same again
    }
    let art = "|aaaaaaaaaaaaaaaaaa     bbbbbbbbbbbbbbbbb|\n".repeat(3);
    assert_eq!(labels(&scan(false), &JUMPS), Picture::parse(&art));
    assert_eq!(joins(&scan(false), &JUMPS), []);

    // a jump right at the seam: an edge at column 0, which the first pixel of the row can only see
    // across the seam; with 9 deg between columns the line from 5 m to 1 m is at 11 deg to the beam
    let config = JUMPS.with_step_angle_rad(15.0 * PI / 180.0);
    let jump = |wraps| {
        let scan = scan(wraps);
        let range_m = (0..120).map(|i| if i % 40 < 20 { 1.0 } else { 5.0 }).collect();
        edges(&Scan { range_m, ..scan }, &config)
    };
    let art = "|#...................#...................|\n".repeat(3);
    assert_eq!(jump(true), Picture::parse(&art));
    let art = "|....................#...................|\n".repeat(3);
    assert_eq!(jump(false), Picture::parse(&art));
}
