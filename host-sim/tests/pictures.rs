//! Pictures: what is drawn where, and that colours tell apart what they should.

mod recorded;

use std::f32::consts::PI;
use std::fs;
use std::path::Path;

use scanseg_formats::{Geometry, GreyImage, RangeImage};
use scanseg_sim::picture::*;

use recorded::recorded;

const RED: Rgb = [255, 0, 0];

/// The pixels of a colour as rows of `#` and `.`.
fn drawn(picture: &Picture, colour: Rgb) -> Vec<String> {
    let row = |y| (0..picture.width()).map(|x| if picture.get(x, y) == Some(colour) { '#' } else { '.' }).collect();
    (0..picture.height()).map(row).collect()
}

#[test]
fn drawing_stops_at_the_border() {
    let mut picture = Picture::new(4, 3, WHITE);
    picture.put(1, 0, RED);
    picture.put(4, 0, RED);
    picture.put(0, 3, RED);
    picture.rect(2, 1, 9, usize::MAX, RED);
    assert_eq!(drawn(&picture, RED), [".#..", "..##", "..##"]);
    assert_eq!((picture.get(4, 0), picture.get(0, 3)), (None, None));

    let mut larger = Picture::new(5, 4, WHITE);
    larger.blit(2, 2, &picture);
    larger.blit(5, 9, &picture);
    assert_eq!(drawn(&larger, RED), [".....", ".....", "...#.", "....#"]);
    assert_eq!(Picture::new(0, 0, RED), Picture::new(1, 1, RED));
}

#[test]
fn text_is_upright_and_scales() {
    let mut picture = Picture::new(8, 8, WHITE);
    picture.text(0, 0, 1, BLACK, "F");
    let letter = ["#######.", ".##...#.", ".##.#...", ".####...", ".##.#...", ".##.....", "####....", "........"];
    assert_eq!(drawn(&picture, BLACK), letter);

    let mut large = Picture::new(35, 17, WHITE);
    large.text(3, 1, 2, BLACK, "lF and what has no room");
    let mut pair = Picture::new(16, 8, WHITE);
    pair.text(0, 0, 1, BLACK, "l");
    pair.text(8, 0, 1, BLACK, "F");
    let mut expected = Picture::new(35, 17, WHITE);
    expected.blit(3, 1, &pair.scaled(32, 16));
    assert_eq!(large, expected);

    let mut other = Picture::new(8, 8, WHITE);
    other.text(0, 0, 1, BLACK, "\u{b0}");
    let mut question = Picture::new(8, 8, WHITE);
    question.text(0, 0, 1, BLACK, "?");
    assert_eq!(other, question);
}

#[test]
fn scaling_takes_the_nearest_pixel() {
    let picture = Picture::from_fn(3, 2, |x, y| [x as u8, y as u8, 0]);
    let large = picture.scaled(6, 6);
    for (x, y) in (0..36).map(|i| (i % 6, i / 6)) {
        assert_eq!(large.get(x, y), Some([x as u8 / 2, y as u8 / 3, 0]));
    }
    assert_eq!(large.scaled(3, 2), picture);
    assert_eq!(picture.scaled(1, 1).get(0, 0), Some([1, 1, 0]));
}

#[test]
fn a_png_has_the_pixels() {
    let picture = Picture::from_fn(5, 3, |x, y| [x as u8, y as u8, 200]);
    let bytes = picture.to_png();
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
    let mut data = [0; 45];
    let info = reader.next_frame(&mut data).unwrap();
    assert_eq!((info.width, info.height, info.color_type), (5, 3, png::ColorType::Rgb));
    assert_eq!(data[3 * 14..], [4, 2, 200]);
    assert_eq!(data[3 * 5..3 * 6], [0, 1, 200]);
}

fn brightness([r, g, b]: Rgb) -> f64 {
    0.2126 * f64::from(r) + 0.7152 * f64::from(g) + 0.0722 * f64::from(b)
}

#[test]
fn ranges_darken_with_distance() {
    let colours: Vec<_> = (0..=90).map(|i| range_colour(1.0 + i as f32 / 10.0, 1.0, 10.0)).collect();
    for pair in colours.windows(2) {
        assert!(brightness(pair[1]) < brightness(pair[0]), "{pair:?}");
    }
    assert_eq!(range_colour(0.1, 1.0, 10.0), colours[0]);
    assert_eq!(range_colour(99.0, 1.0, 10.0), colours[90]);
    for none in [0.0, -1.0, f32::NAN, f32::INFINITY] {
        assert_eq!(range_colour(none, 1.0, 10.0), BLACK);
    }
    assert!(!colours.contains(&BLACK));
    for (near_m, far_m) in [(1.0, 1.0), (2.0, 1.0), (f32::NAN, 1.0)] {
        assert_ne!(range_colour(1.0, near_m, far_m), BLACK);
    }
}

#[test]
fn near_labels_look_different() {
    let distance = |a: Rgb, b: Rgb| {
        let squares = (0..3).map(|c| (f64::from(a[c]) - f64::from(b[c])).powi(2));
        squares.sum::<f64>().sqrt()
    };
    assert_eq!(label_colour(0), [64, 64, 64]);
    for label in (1..200).chain(u32::MAX - 20..u32::MAX - 10) {
        assert!(distance(label_colour(label), label_colour(0)) > 60.0, "{label} is like none");
        for step in 1..=10 {
            let apart = distance(label_colour(label), label_colour(label + step));
            assert!(apart > 40.0, "{label} is like {}: {apart}", label + step);
        }
    }
}

#[test]
fn bearing_angles_are_grey() {
    for (bearing_rad, grey) in [(0.0, 0), (PI / 2.0, 128), (PI, 255), (-0.1, 0), (4.0, 255)] {
        assert_eq!(bearing_colour(bearing_rad), [grey; 3]);
    }
    assert_eq!(bearing_colour(f32::NAN), [0, 0, 96]);
    assert_eq!((edge_colour(true), edge_colour(false)), (BLACK, WHITE));
}

#[test]
fn a_sheet_holds_every_panel_below_its_title() {
    let panel = |width, height, grey| Picture::new(width, height, [grey; 3]);
    let panels = [("a", panel(20, 10, 50)), ("long title", panel(5, 30, 51)), ("", panel(1, 1, 52))];
    let picture = sheet(&panels, 2);
    // Cells of 80 + 8 by 12 + 30 + 8.
    assert_eq!((picture.width(), picture.height()), (8 + 2 * 88, 8 + 2 * 50));
    for (x, y, grey) in [(8, 20, 50), (27, 29, 50), (96, 20, 51), (100, 49, 51), (8, 70, 52)] {
        assert_eq!(picture.get(x, y), Some([grey; 3]), "{x}, {y}");
    }
    for (x, y) in [(7, 20), (8, 19), (28, 29), (27, 30), (9, 70)] {
        assert_eq!(picture.get(x, y), Some(WHITE), "{x}, {y}");
    }
    let ink = |left: usize, right: usize| (left..right).any(|x| (8..16).any(|y| picture.get(x, y) == Some(BLACK)));
    assert!(ink(8, 16) && !ink(16, 96) && ink(168, 176));

    assert_eq!(sheet(&panels, 0), sheet(&panels, 1));
    assert_eq!(sheet(&panels, 99), sheet(&panels, 3));
    assert_eq!(sheet(&[], 2).get(0, 0), Some(WHITE));
}

#[test]
fn a_recorded_scan_makes_a_sheet() {
    let Some(set) = recorded("tilting-sick-corridor") else { return };
    let geometry = Geometry::read(set.join("geometry.toml")).unwrap();
    let counts = GreyImage::read(set.join("scan000.range_mm.pgm")).unwrap();
    let planes = GreyImage::read(set.join("scan000.planes.pgm")).unwrap();
    let ranges = RangeImage::from_grey(&counts, &geometry).unwrap();
    let (rows, columns) = (ranges.rows, ranges.columns);
    let range = |x, y| ranges.range_m[y * columns + x];
    let panels = [
        ("Range, 0 to 8 m", Picture::from_fn(columns, rows, |x, y| range_colour(range(x, y), 0.0, 8.0))),
        ("Planes", Picture::from_fn(columns, rows, |x, y| label_colour(planes.values[y * columns + x].into()))),
        ("Labels 0 to 59", Picture::from_fn(columns, rows, |x, y| label_colour((x / 36 + y / 38 * 10) as u32))),
        ("0 to pi", Picture::from_fn(columns, rows, |x, _| bearing_colour(x as f32 / 359.0 * PI))),
    ];
    let picture = sheet(&panels, 2);
    assert_eq!((picture.width(), picture.height()), (8 + 2 * 368, 8 + 2 * 254));
    let directory = Path::new(env!("CARGO_TARGET_TMPDIR"));
    fs::write(directory.join("sheet.png"), picture.to_png()).unwrap();
    assert_eq!(picture.get(8 + 180, 28 + 113), Some(range_colour(range(180, 113), 0.0, 8.0)));
}
