//! All stages together, on scenes worked out by hand.

use super::beams::TurnAxis;
use super::closing::Element;
use super::*;
use crate::art::Picture;
use nalgebra::Vector3;

/// 10 degrees of bearing angle; steps within 3 degrees and 0.3 m.
fn settings(element: Element) -> Settings {
    let traces = vec![Trace::HORIZONTAL, Trace::VERTICAL];
    Settings { traces, roof_eighths: 1820, step_counts: 1092, step_range_m: 0.3, element }
}

/// The image of a scene that gives the range along a direction.
fn scan(size: Size, beams: &Beams, range_m: impl Fn(Vector3<f64>) -> f64) -> Image {
    Image::new(size, size.pixels().map(|pixel| range_m(beams.direction(pixel)) as f32).collect())
}

fn degrees(start: f64, count: usize) -> Vec<f64> {
    (0..count).map(|index| (start + index as f64).to_radians()).collect()
}

/// The corner of the walls x = 2 and y = 2, seen in 5 rows about the horizontal at 1 degree steps.
/// Horizontal bearing angles 46.5, 45.5, 89.5, 133.5, 132.5 about it: the 3 pixels with a neighbour
/// more than 10 degrees off are edges. Vertical ones stay near 90 degrees.
#[test]
fn corner() {
    let size = Size { rows: 5, columns: 9, wraps: false };
    let beams = Beams::Nodding { beam_rad: degrees(41.5, 9), turn_rad: degrees(-2.0, 5), axis: TurnAxis::Y };
    let image = scan(size, &beams, |d| f64::min(2.0 / d.x, 2.0 / d.y));
    let found = segment(&image, &beams, &settings(Element::Plus));
    let edges = Picture::parse(
        "
        |...###...|
        |...###...|
        |...###...|
        |...###...|
        |...###...|",
    );
    assert_eq!(Picture::bits(9, &found.edges), edges);
    let labels = Picture::parse(
        "
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|
        |aaa###bbb|",
    );
    assert_eq!(Picture::labels(9, &found.classes, &found.labels), labels);
    for (area, normal) in found.areas.iter().zip([-Vector3::x(), -Vector3::y()]) {
        let plane = area.plane.as_ref().unwrap();
        assert_eq!(area.pixels, 15);
        assert!((plane.normal - normal).norm() < 1e-5, "{:?}", plane.normal);
        assert!((plane.distance_m - 2.0).abs() < 1e-5, "{}", plane.distance_m);
    }
}

/// A box 1 m in front of the wall x = 3, seen by a camera, and a window beside it without a return.
///
/// Steps are found at the later pixel of a pair: the first one of the box and the first one after
/// it, along rows and columns. The bearing angle is near 180 and 0 degrees there and near 90
/// elsewhere, so that Sobel finds the pixels on both sides of a step and, with half of a corner's
/// weights on 90 degrees, those diagonal to it. The pixels beside the window compare with
/// themselves there. Closing fills the inner corners of the box.
#[test]
fn box_and_window() {
    let scene = Picture::parse(
        "
        |.................|
        |.................|
        |.................|
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |....oooooooo..   |
        |.................|
        |.................|
        |.................|
        |.................|",
    );
    let size = scene.size(false);
    let beams = Beams::Pinhole { fx: 100.0, fy: 100.0, cx: 8.0, cy: 7.0 };
    let range = |(pixel, scene): ((usize, usize), &char)| match scene {
        'o' => (2.0 / beams.direction(pixel).x) as f32,
        ' ' => 0.0,
        _ => (3.0 / beams.direction(pixel).x) as f32,
    };
    let image = Image::new(size, size.pixels().zip(&scene.pixels).map(range).collect());
    let found = segment(&image, &beams, &settings(Element::Plus));
    let edges = Picture::parse(
        "
        |.................|
        |.................|
        |...###########...|
        |...###########...|
        |...###########...|
        |...###.....###...|
        |...###.....###...|
        |...###.....###...|
        |...###.....###...|
        |...###.....###...|
        |...###########...|
        |...###########...|
        |...##########....|
        |.................|
        |.................|",
    );
    assert_eq!(Picture::bits(17, &found.edges), edges);
    let labels = Picture::parse(
        "
        |aaaaaaaaaaaaaaaaa|
        |aaaaaaaaaaaaaaaaa|
        |aaa###########aaa|
        |aaa###########   |
        |aaa###########   |
        |aaa####bbb####   |
        |aaa###bbbbb###   |
        |aaa###bbbbb###   |
        |aaa###bbbbb###   |
        |aaa####bbb####   |
        |aaa###########   |
        |aaa###########aaa|
        |aaa##########aaaa|
        |aaaaaaaaaaaaaaaaa|
        |aaaaaaaaaaaaaaaaa|",
    );
    assert_eq!(Picture::labels(17, &found.classes, &found.labels), labels);
    for (area, distance_m) in found.areas.iter().zip([3.0, 2.0]) {
        let plane = area.plane.as_ref().unwrap();
        assert!((plane.normal + Vector3::x()).norm() < 1e-5, "{:?}", plane.normal);
        assert!((plane.distance_m - distance_m).abs() < 1e-5, "{}", plane.distance_m);
    }
}

/// A round room seen by a spinning lidar, with one door post. The wall joins across the seam only
/// if the image wraps.
#[test]
fn round_room() {
    let azimuth_rad = degrees(0.0, 360).into_iter().step_by(30).collect();
    let beams = Beams::Spinning { azimuth_rad, elevation_rad: degrees(-1.0, 3) };
    let mut size = Size { rows: 3, columns: 12, wraps: true };
    let image = |size| {
        let mut image = scan(size, &beams, |d| 3.0 / d.x.hypot(d.y));
        for row in 0..3 {
            image.range_m[row * 12 + 5] = 0.0;
        }
        image
    };
    let found = segment(&image(size), &beams, &settings(Element::Plus));
    assert_eq!(Picture::labels(12, &found.classes, &found.labels), Picture::parse(&"|aaaaa aaaaaa|\n".repeat(3)));
    assert_eq!((found.areas[0].first_column, found.areas[0].last_column), (0, 11));
    size.wraps = false;
    let found = segment(&image(size), &beams, &settings(Element::Plus));
    assert_eq!(Picture::labels(12, &found.classes, &found.labels), Picture::parse(&"|aaaaa bbbbbb|\n".repeat(3)));
}

/// Every size from nothing up, cyclic or not: a wall in one piece.
#[test]
fn all_sizes() {
    let beams = Beams::Pinhole { fx: 100.0, fy: 100.0, cx: 2.0, cy: 2.0 };
    for (rows, columns) in (0..5).flat_map(|rows| (0..5).map(move |columns| (rows, columns))) {
        for wraps in [false, true] {
            for element in [Element::Plus, Element::Square] {
                let size = Size { rows, columns, wraps };
                let found = segment(&scan(size, &beams, |d| 3.0 / d.x), &beams, &settings(element));
                assert_eq!(found.labels, vec![1; rows * columns], "{size:?}");
                let plane = found.areas.first().and_then(|area| area.plane.as_ref());
                assert_eq!(plane.is_some(), rows > 1 && columns > 1, "{size:?}");
            }
        }
    }
}

/// Given counts replace the image's own: the stages after them see nothing else.
#[test]
fn given_counts() {
    let beams = Beams::Pinhole { fx: 100.0, fy: 100.0, cx: 2.0, cy: 2.0 };
    let size = Size { rows: 1, columns: 6, wraps: false };
    let image = scan(size, &beams, |d| 3.0 / d.x);
    // A roof between columns 2 and 3.
    let counts = vec![vec![0, 30000, 30000, 40000, 40000, 40000], vec![0; 6]];
    let found = segment_counts(&image, &beams, &settings(Element::Plus), counts.clone());
    assert_eq!(found.counts, counts);
    assert_eq!(Picture::labels(6, &found.classes, &found.labels), Picture::parse("|aa##bb|"));
}
