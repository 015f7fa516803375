//! Pictures: what is drawn where, and that colours tell apart what they should.

use std::f32::consts::PI;

use scanseg_sim::picture::*;

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

/// How dark a part of a picture is: pixels that are all black.
fn ink(picture: &Picture, left: usize, top: usize, right: usize, bottom: usize) -> f64 {
    let pixels = (top..bottom).flat_map(|y| (left..right).map(move |x| (x, y)));
    pixels.filter_map(|(x, y)| picture.get(x, y)).map(|rgb| 1.0 - brightness(rgb) / 255.0).sum()
}

#[test]
fn text_stands_on_its_line_at_its_anchor() {
    let style = TextStyle::new(20.0, BLACK);
    let drawn = |style, place| {
        let mut picture = Picture::new(100, 100, WHITE);
        picture.text(place, style, "FL");
        picture
    };
    // F and L: their stems are left, an arm is above, a foot below
    let start = drawn(style, (30.0, 50.0));
    let width = text_width(20.0, "FL").round() as usize;
    assert!((20..25).contains(&width), "{width}");
    let all = ink(&start, 0, 0, 100, 100);
    assert!((ink(&start, 30, 34, 30 + width, 51) - all).abs() < 0.5, "all of it is above the line, right of the place");
    let (letter_f, letter_l) = (text_width(20.0, "F").round() as usize, 30 + width);
    assert!(ink(&start, 30, 34, 30 + letter_f, 42) > ink(&start, 30, 43, 30 + letter_f, 51));
    assert!(ink(&start, 30 + letter_f, 42, letter_l, 51) > ink(&start, 30 + letter_f, 34, letter_l, 42));

    let at = |anchor| drawn(TextStyle { anchor, ..style }, (50.0, 50.0));
    assert!(ink(&at(Anchor::End), 50, 0, 100, 100) < 0.5 && ink(&at(Anchor::Start), 0, 0, 50, 100) < 0.5);
    let (left, right) = (ink(&at(Anchor::Middle), 0, 0, 50, 100), ink(&at(Anchor::Middle), 50, 0, 100, 100));
    assert!(left > 0.3 * all && right > 0.3 * all, "{left} {right}");
    // reads upwards: the line of the text is upright, letters are left of it
    let upright = drawn(TextStyle { upright: true, ..style }, (50.0, 50.0));
    assert!((ink(&upright, 34, 50 - width, 51, 51) - all).abs() < 1.0);

    // twice as large is four times the ink, and white seams do not darken
    let large = drawn(TextStyle::new(40.0, BLACK), (30.0, 50.0));
    assert!((ink(&large, 0, 0, 100, 100) / all - 4.0).abs() < 0.1);
    let seam = TextStyle { halo: Some(WHITE), ..style };
    assert_eq!(drawn(seam, (30.0, 50.0)), start);
    // what has no room is cut, and a character that the font does not have is a box
    assert!(ink(&drawn(style, (-5.0, 3.0)), 0, 0, 100, 100) > 0.0);
    assert!(text_width(20.0, "\u{10ffff}") > 5.0);
    assert_eq!(text_width(20.0, ""), 0.0);
}

#[test]
fn lines_are_as_wide_as_asked_and_dashed() {
    let mut picture = Picture::new(40, 20, WHITE);
    picture.line(&[(0.0, 5.0), (40.0, 5.0)], 2.0, &[], BLACK);
    picture.line(&[(0.0, 15.0), (40.0, 15.0)], 2.0, &[6.0, 4.0], RED);
    let rows = drawn(&picture, BLACK);
    assert_eq!(rows.iter().filter(|row| row.contains(&"#".repeat(40))).count(), 2);
    assert_eq!(drawn(&picture, RED)[15], "######....".repeat(4));
    let mut dot = Picture::new(20, 20, WHITE);
    dot.dot((10.0, 10.0), 5.0, BLACK);
    let area = ink(&dot, 0, 0, 20, 20) / (f64::from(PI) * 25.0);
    // curves are drawn as pieces of lines
    assert!((area - 1.0).abs() < 0.05, "{area}");
    assert_eq!((dot.get(10, 10), dot.get(4, 10), dot.get(15, 15)), (Some(BLACK), Some(WHITE), Some(WHITE)));
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

/// Colours as CIE Lab, to which distances are about even, after what an eye makes of them: rows of
/// linear red, green, blue.
fn seen(rgb: Rgb, eye: &[[f64; 3]; 3]) -> [f64; 3] {
    let linear = rgb.map(|c| (f64::from(c) / 255.0).powf(2.2));
    let times = |matrix: &[[f64; 3]; 3], v: [f64; 3]| matrix.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2]);
    let xyz = [[0.434, 0.376, 0.190], [0.213, 0.715, 0.072], [0.018, 0.109, 0.873]];
    let [x, y, z] = times(&xyz, times(eye, linear).map(|c| c.clamp(0.0, 1.0))).map(f64::cbrt);
    [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
}

/// Red-blind, green-blind and blue-blind (Machado et al. 2009).
#[test]
fn the_colour_blind_can_tell_labels_apart() {
    let normal = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    let red = [[0.152, 1.053, -0.205], [0.115, 0.786, 0.099], [-0.004, -0.048, 1.052]];
    let green = [[0.367, 0.861, -0.228], [0.280, 0.673, 0.047], [-0.012, 0.043, 0.969]];
    let blue = [[1.256, -0.077, -0.179], [-0.078, 0.931, 0.148], [0.005, 0.691, 0.304]];
    for (eye, least) in [(normal, 15.0), (red, 12.0), (green, 12.0), (blue, 8.0)] {
        for (a, b) in (0..20).flat_map(|a| (a + 1..=20).map(move |b| (a, b))) {
            let [first, second] = [a, b].map(|label| seen(label_colour(label), &eye));
            let apart = first.iter().zip(second).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
            assert!(apart > least, "{a} is like {b} to {eye:?}: {apart}");
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
    let panel = |title: &str, width, height, grey| (title.to_string(), Picture::new(width, height, [grey; 3]));
    let panels = [panel("a", 200, 10, 50), panel("title", 5, 30, 51), panel("", 1, 1, 52)];
    let picture = sheet(&panels, 2);
    // Cells of 200 + 12 by 18 + 30 + 12.
    assert_eq!((picture.width(), picture.height()), (12 + 2 * 212, 12 + 2 * 60));
    for (x, y, grey) in [(12, 30, 50), (211, 39, 50), (224, 30, 51), (228, 59, 51), (12, 90, 52)] {
        assert_eq!(picture.get(x, y), Some([grey; 3]), "{x}, {y}");
    }
    for (x, y) in [(11, 30), (212, 39), (12, 40), (13, 90)] {
        assert_eq!(picture.get(x, y), Some(WHITE), "{x}, {y}");
    }
    let written = |left, right| ink(&picture, left, 12, right, 30) > 3.0;
    assert!(written(12, 22) && !written(24, 224) && written(224, 260));
    // a title that is longer than its panel has room
    let long = "a title that is longer than its panel";
    let cell = sheet(&[panel(long, 5, 5, 50)], 1);
    assert_eq!(cell.width(), 24 + text_width(13.0, long).ceil() as usize);

    assert_eq!(sheet(&panels, 0), sheet(&panels, 1));
    assert_eq!(sheet(&panels, 99), sheet(&panels, 3));
    assert_eq!(sheet(&[], 2).get(0, 0), Some(WHITE));
}
