//! The pictures that the `scanseg` command writes.

use std::fs;
use std::path::PathBuf;

use scanseg_formats::{Angles, Kind};
use scanseg_sim::office::Sensor;
use scanseg_sim::picture::label_colour;

use crate::outputs::{office_scan, points};
use crate::program::{folder, succeeds};

/// Left is left and up is up as the scanner sees them, whatever the order of its columns and rows.
#[test]
fn pictures_are_not_mirrored() {
    let mirrored = |mut sensor: Sensor| {
        if let Kind::Nodding { beam_deg: Angles::Even { start_deg, step_deg }, .. } = &mut sensor.kind {
            (*start_deg, *step_deg) = (-*start_deg, -*step_deg);
        }
        sensor
    };
    for (name, sensor) in [
        ("nodding", Sensor::nodding(50, 91)),
        ("nodding-mirrored", mirrored(Sensor::nodding(50, 91))),
        ("spinning", Sensor::spinning(64, 256)),
        ("pinhole", Sensor::pinhole(60, 80)),
    ] {
        let folder = folder(&format!("mirror-{name}"));
        office_scan(&folder, &sensor);
        succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out out --range-noise-m 0.005");
        let points = points(folder.join("out/points.ply"));
        let (width, _, rgb) = picture(folder.join("out/segments.png"));
        let mut seen = vec![];
        for label in 1..=6 {
            let of: Vec<_> = points.iter().filter(|p| p.label == label).collect();
            let bearings: Vec<f32> = of.iter().map(|p| p.xyz_m[1].atan2(p.xyz_m[0])).collect();
            let (low, high) = bearings.iter().fold((f32::MAX, f32::MIN), |(l, h), b| (l.min(*b), h.max(*b)));
            // not what goes round behind the scanner
            if of.is_empty() || high - low > 3.0 {
                continue;
            }
            let mean = |values: &mut dyn Iterator<Item = f32>| values.sum::<f32>() / of.len() as f32;
            let bearing = mean(&mut bearings.iter().copied());
            let height = mean(&mut of.iter().map(|p| p.xyz_m[2] / p.xyz_m[0].hypot(p.xyz_m[1])));
            let drawn: Vec<_> = (0..rgb.len()).filter(|&i| rgb[i] == label_colour(label)).collect();
            let place = |of: fn(usize, usize) -> usize| {
                drawn.iter().map(|&i| of(i, width)).sum::<usize>() as f32 / drawn.len() as f32
            };
            seen.push((bearing, height, place(|i, width| i % width), place(|i, width| i / width)));
        }
        let mut pairs = 0;
        for (a, b) in seen.iter().flat_map(|a| seen.iter().map(move |b| (a, b))) {
            if a.0 - b.0 > 0.4 {
                assert!(a.2 < b.2, "{name}: {a:?} is left of {b:?}");
                pairs += 1;
            }
            if a.1 - b.1 > 0.4 {
                assert!(a.3 < b.3, "{name}: {a:?} is above {b:?}");
                pairs += 1;
            }
        }
        assert!(pairs >= 2, "{name}: {seen:?}");
    }
}

/// Width, height and pixels of a colour PNG.
fn picture(path: PathBuf) -> (usize, usize, Vec<[u8; 3]>) {
    let mut reader = png::Decoder::new(std::io::BufReader::new(fs::File::open(path).unwrap())).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let (pixels, rest) = bytes.as_chunks();
    assert!(rest.is_empty());
    (info.width as usize, info.height as usize, pixels.to_vec())
}

/// Every panel shows something, and what is said is of the approach.
#[test]
fn pictures_and_words_fit_the_approach() {
    let folder = folder("approaches");
    for (approach, panels, words) in [("plane", 4, ""), ("edge", 8, "on edges"), ("region", 4, "on no line")] {
        let told = succeeds(&folder, &format!("demo --out {approach} --approach {approach}"));
        assert_eq!(told.contains("edge"), approach == "edge", "{told}");
        assert!(told.contains(words), "{told}");
        assert_eq!(folder.join(approach).join("edges.png").exists(), approach != "plane");
        let (width, height, rgb) = picture(folder.join(approach).join("overview.png"));
        let rows = panels / 2;
        for panel in 0..panels {
            let (left, top) = (panel % 2 * width / 2 + 20, panel / 2 * height / rows + 50);
            let inside =
                (top..top + height / rows - 80).flat_map(|y| (left..left + width / 2 - 60).map(move |x| (x, y)));
            let mut colours: Vec<_> =
                inside.map(|(x, y)| rgb[y * width + x]).filter(|c| *c != [190, 205, 225]).collect();
            colours.sort_unstable();
            colours.dedup();
            assert!(colours.len() >= 2, "{approach}: panel {panel} shows nothing");
        }
    }
}
