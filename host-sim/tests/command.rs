//! The `scanseg` command as a process: what it writes, what it prints, how it fails.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use scanseg_formats::{Angles, Geometry, GreyImage, Kind, RangeImage};
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_sim::picture::label_colour;
use serde_json::Value;

use crate::program::{fails, folder, scanseg, succeeds};

/// What `segment` writes by planes; by the other approaches edges.png too.
const FILES: [&str; 11] = [
    "labels.png",
    "bearing-horizontal.png",
    "bearing-vertical.png",
    "bearing-diagonal.png",
    "bearing-antidiagonal.png",
    "segments.csv",
    "segments.json",
    "overview.png",
    "segments.png",
    "overlay.png",
    "points.ply",
];

/// Writes a small simulated scan, `scan.pgm` and `geometry.toml`.
fn small_scan(folder: &Path) -> RangeImage {
    let scan = Scene::numbered(Set::Tuning, 0).scan(&Sensor::nodding(50, 91), 0).unwrap();
    let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
    ranges
}

fn json(path: PathBuf) -> Value {
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

fn write_labels(path: PathBuf, columns: usize, max_value: u16, values: &[u16]) {
    let image = GreyImage { rows: values.len() / columns, columns, max_value, values: values.to_vec() };
    let png = path.extension().is_some_and(|e| e == "png");
    fs::write(path, if png { image.to_png() } else { image.to_pgm() }).unwrap();
}

#[test]
fn segment_writes_images_and_lists_that_agree() {
    let folder = folder("segment");
    let ranges = small_scan(&folder);
    let told = succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out a/b --min-pixels 20");
    let out = folder.join("a/b");
    assert_eq!(fs::read_dir(&out).unwrap().count(), FILES.len());
    for name in &FILES[..5] {
        let image = GreyImage::read(out.join(name)).unwrap();
        assert_eq!((image.rows, image.columns, image.max_value), (50, 91, 65535), "{name}");
    }

    let labels = GreyImage::read(out.join("labels.png")).unwrap().values;
    let mut pixels = BTreeMap::new();
    for (i, &number) in labels.iter().enumerate() {
        if number > 0 {
            *pixels.entry(number).or_insert(0usize) += 1;
            assert!(ranges.range_m[i] > 0.0, "pixel {i} is no area");
        }
    }
    assert!(pixels.len() >= 3, "{pixels:?}");
    assert!(pixels.values().all(|&n| n >= 20));
    assert!(pixels.values().is_sorted_by(|a, b| a >= b), "the largest first: {pixels:?}");

    let csv = fs::read_to_string(out.join("segments.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert!(lines.iter().all(|line| line.len() == 32), "{csv}");
    assert_eq!(lines[0][..2], ["label", "pixels"]);
    let json = json(out.join("segments.json"));
    let segments = json["segments"].as_array().unwrap();
    assert_eq!((lines.len() - 1, segments.len()), (pixels.len(), pixels.len()));
    for ((line, segment), (number, count)) in lines[1..].iter().zip(segments).zip(&pixels) {
        assert_eq!((line[0], line[1]), (number.to_string().as_str(), count.to_string().as_str()));
        for (i, key) in
            ["label", "pixels", "first_row", "last_row", "first_column", "last_column"].into_iter().enumerate()
        {
            assert_eq!(segment[key].to_string(), line[i], "{key}");
        }
        let places: Vec<_> = (0..labels.len()).filter(|&i| labels[i] == *number).map(|i| (i / 91, i % 91)).collect();
        let limits = |of: fn(&(usize, usize)) -> usize| {
            let (low, high) = (places.iter().map(of).min(), places.iter().map(of).max());
            [low, high].map(|place| place.unwrap().to_string())
        };
        assert_eq!([limits(|p| p.0), limits(|p| p.1)].concat(), line[2..6]);
        let float = |value: &Value| value.as_f64().unwrap();
        // one row has no plane
        let Some(normal) = segment["normal"].as_array() else {
            assert_eq!(segment["first_row"], segment["last_row"]);
            continue;
        };
        let normal: Vec<f64> = normal.iter().map(float).collect();
        let centroid: Vec<f64> = segment["centroid_m"].as_array().unwrap().iter().map(float).collect();
        let along: f64 = normal.iter().zip(&centroid).map(|(a, b)| a * b).sum();
        // the plane weighs its points, the centroid does not
        let off_m = (along + float(&segment["distance_m"])).abs();
        assert!(off_m < 0.1, "the plane is near the centroid: {off_m}");
        assert_eq!(
            segment["covariance"].as_array().map(|c| c.iter().map(|r| r.as_array().unwrap().len()).sum()),
            Some(16)
        );
    }
    let header = &json["header"];
    assert_eq!((&header["rows"], &header["columns"], &header["min_pixels"]), (&50.into(), &91.into(), &20.into()));
    let returns = ranges.range_m.iter().filter(|&&m| m > 0.0).count();
    assert_eq!(header["returns"], returns);
    let parts = ["edge_pixels", "segment_pixels", "unlabelled_pixels"].map(|key| header[key].as_u64().unwrap());
    assert_eq!(parts.iter().sum::<u64>(), returns as u64, "every return is one of three");
    assert_eq!(header["configuration"]["traces"].to_string(), r#"["0x1","1x0"]"#);
    assert!(told.contains(&format!("{} of them with 20 pixels or more", pixels.len())), "{told}");
    assert!(told.contains("ns per point"), "{told}");
}

/// Writes a scan of an office by some sensor.
fn office_scan(folder: &Path, sensor: &Sensor) -> (RangeImage, Geometry) {
    let scan = Scene::numbered(Set::Tuning, 4).scan(sensor, 0).unwrap();
    let image = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    let image = image.to_grey(&scan.geometry).unwrap();
    fs::write(folder.join("scan.pgm"), image.to_pgm()).unwrap();
    fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
    (RangeImage::from_grey(&image, &scan.geometry).unwrap(), scan.geometry)
}

/// The lines of segments.csv after the first, by their names.
fn csv(path: PathBuf) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_string));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|line| names.iter().cloned().zip(line).collect()).collect()
}

/// A point of points.ply.
struct Point {
    xyz_m: [f32; 3],
    rgb: [u8; 3],
    label: u32,
}

fn points(path: PathBuf) -> Vec<Point> {
    let bytes = fs::read(path).unwrap();
    let end = bytes.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    let head = std::str::from_utf8(&bytes[..end]).unwrap();
    assert!(head.starts_with("ply\nformat binary_little_endian 1.0\n"), "{head}");
    let count = head.split("element vertex ").nth(1).and_then(|rest| rest.lines().next()).unwrap().parse().unwrap();
    // behind them is the grid
    let points: Vec<Point> = bytes[end..]
        .chunks(19)
        .take(count)
        .map(|point| {
            let word = |i: usize| point[i..i + 4].try_into().unwrap();
            let xyz_m = [0, 4, 8].map(|i| f32::from_le_bytes(word(i)));
            Point { xyz_m, rgb: point[12..15].try_into().unwrap(), label: u32::from_le_bytes(word(15)) }
        })
        .collect();
    points
}

/// Whoever joins the list with the image of labels, or with the points, gets the right segments.
#[test]
fn the_label_of_the_list_is_that_of_image_and_points() {
    for (name, sensor) in [
        ("nodding", Sensor::nodding(50, 91)),
        ("spinning", Sensor::spinning(64, 256)),
        ("pinhole", Sensor::pinhole(60, 80)),
    ] {
        let folder = folder(&format!("join-{name}"));
        let (ranges, geometry) = office_scan(&folder, &sensor);
        for approach in ["plane", "edge", "region"] {
            let options = format!("--min-pixels 20 --approach {approach}");
            assert!(
                scanseg(&folder, &format!("segment scan.pgm --geometry geometry.toml --out out {options}"))
                    .status
                    .success()
            );
            let labels = GreyImage::read(folder.join("out/labels.png")).unwrap().values;
            let segments = csv(folder.join("out/segments.csv"));
            let points = points(folder.join("out/points.ply"));
            assert!(segments.len() > 3, "{name} {approach}: {}", segments.len());
            for segment in &segments {
                let number = |key: &str| segment[key].parse::<f64>().unwrap();
                let label = number("label") as u16;
                let pixels: Vec<usize> = (0..labels.len()).filter(|&i| labels[i] == label).collect();
                assert_eq!(pixels.len() as f64, number("pixels"), "{name} {approach} {label}");
                let mut centroid_m = [0.0; 3];
                for &i in &pixels {
                    let direction = geometry.direction(i / ranges.columns, i % ranges.columns);
                    for (sum, along) in centroid_m.iter_mut().zip(direction) {
                        *sum += along * f64::from(ranges.range_m[i]) / pixels.len() as f64;
                    }
                }
                let listed = ["x", "y", "z"].map(|axis| number(&format!("centroid_{axis}_m")));
                let of_points: Vec<&Point> = points.iter().filter(|p| p.label == u32::from(label)).collect();
                assert_eq!(of_points.len(), pixels.len());
                for axis in 0..3 {
                    let mean = of_points.iter().map(|p| f64::from(p.xyz_m[axis])).sum::<f64>() / pixels.len() as f64;
                    let apart = (centroid_m[axis] - listed[axis]).abs().max((mean - listed[axis]).abs());
                    assert!(apart < 1e-4, "{name} {approach} {label}: {centroid_m:?} {listed:?}");
                }
                assert!(of_points.iter().all(|p| p.rgb == label_colour(u32::from(label))));
            }
            let returns = ranges.range_m.iter().filter(|&&range_m| range_m > 0.0).count();
            assert_eq!(points.len(), returns, "every return is a point");
        }
    }
}

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

#[test]
fn every_option_of_the_configuration_is_used() {
    let folder = folder("options");
    small_scan(&folder);
    let options = "--preset paper --range-noise-m 0.02 --min-range-m 1.5 --max-range-m 4 --roof-angle-deg 45 \
         --step-angle-deg 3 --traces row*3,2x-2,antidiagonal --closing square";
    succeeds(&folder, &format!("segment scan.pgm --geometry geometry.toml --out out {options}"));
    let configuration = json(folder.join("out/segments.json"))["header"]["configuration"].clone();
    let expected = r#"{"approach":"edge","closing":"square","line_angle_deg":3.0,"max_range_m":4.0,"min_range_m":1.5,
        "plane_distance_m":0.005,"range_noise_m":0.02,"roof_angle_deg":45.0,
        "step_angle_deg":3.0,"traces":["0x3","2x-2","1x-1"]}"#;
    let read = |mut configuration: Value| {
        // rounded: 3 degrees in radians are not 3 degrees any more
        configuration["line_angle_deg"] = configuration["line_angle_deg"].as_f64().map(f64::round).into();
        configuration["plane_distance_m"] =
            configuration["plane_distance_m"].as_f64().map(|m| (1e3 * m).round() / 1e3).into();
        configuration
    };
    assert_eq!(read(configuration), serde_json::from_str::<Value>(expected).unwrap());
    fails(
        &folder,
        "segment scan.pgm --geometry geometry.toml --out o --approach plane --traces row",
        &["--approach edge"],
    );

    // each of them changes the segments
    let labels = |options: &str| {
        let command = format!("segment scan.pgm --geometry geometry.toml --out out --min-pixels 1 {options}");
        // a noise of 0.1 m is warned of
        assert!(scanseg(&folder, &command).status.success(), "{command}");
        (
            GreyImage::read(folder.join("out/labels.png")).unwrap(),
            json(folder.join("out/segments.json"))["header"].clone(),
        )
    };
    let (plain, _) = labels("");
    for option in ["--range-noise-m 0.1", "--min-range-m 1.5", "--max-range-m 2", "--max-labels 2", "--preset paper"] {
        let (changed, header) = labels(option);
        assert_ne!(changed, plain, "{option}");
        assert_eq!(header["unlabelled_pixels"] != 0, option == "--max-labels 2", "{option}");
    }
    let (plain, _) = labels("--preset paper");
    for option in [
        "--min-range-m 1.5",
        "--max-range-m 2",
        "--roof-angle-deg 3",
        "--step-angle-deg 30",
        "--traces row",
        "--closing square",
        "--max-labels 2",
        "--approach region",
    ] {
        let (changed, header) = labels(&format!("--preset paper {option}"));
        assert_ne!(changed, plain, "{option}");
        assert_eq!(header["unlabelled_pixels"] != 0, option == "--max-labels 2", "{option}");
    }
    let (plain, _) = labels("--approach region");
    for option in [
        "--range-noise-m 0.1",
        "--min-range-m 1.5",
        "--max-range-m 2",
        "--line-angle-deg 60",
        "--plane-distance-m 0.2",
        "--max-labels 2",
    ] {
        let (changed, header) = labels(&format!("--approach region {option}"));
        assert_ne!(changed, plain, "{option}");
        assert_eq!(header["unlabelled_pixels"] != 0, option == "--max-labels 2", "{option}");
    }

    // the geometry file's values hold where there is no option
    let geometry = fs::read_to_string(folder.join("geometry.toml")).unwrap();
    let limited = format!("range_noise_m = 0.003\nmin_range_m = 1.25\nmax_range_m = 900.0\n{geometry}");
    fs::write(folder.join("geometry.toml"), limited).unwrap();
    let configuration = labels("").1["configuration"].clone();
    let values = ["range_noise_m", "min_range_m", "max_range_m"].map(|key| configuration[key].as_f64().unwrap());
    assert!((values[0] - 0.003).abs() < 1e-9 && values[1..] == [1.25, 500.0], "{values:?}");
    assert_eq!(labels("--min-range-m 2").1["configuration"]["min_range_m"], 2.0);
}

#[test]
fn demo_needs_nothing_and_repeats_itself() {
    let folder = folder("demo");
    for arguments in ["demo --out a", "demo --out b --seed 0", "demo --out c --seed 1"] {
        let told = succeeds(&folder, arguments);
        assert!(told.contains("overview.png"), "{told}");
    }
    let names = FILES.into_iter().chain(["scan.png", "scan.pgm", "geometry.toml", "truth.png"]);
    for name in names {
        let [a, b, c] = ["a", "b", "c"].map(|out| fs::read(folder.join(out).join(name)).unwrap());
        assert!(a == b, "{name}");
        assert!(a != c || name == "geometry.toml", "{name}");
    }
    assert_eq!(fs::read_dir(folder.join("a")).unwrap().count(), FILES.len() + 4);
    // what it says about itself is true: the same again from its files
    succeeds(&folder, "segment a/scan.png --geometry a/geometry.toml --out d");
    for name in FILES {
        assert!(
            fs::read(folder.join("a").join(name)).unwrap() == fs::read(folder.join("d").join(name)).unwrap(),
            "{name}"
        );
    }
    assert_eq!(Geometry::read(folder.join("a/geometry.toml")).unwrap().range_noise_m, Some(0.01));
    let large = json(folder.join("a/segments.json"))["segments"][3]["pixels"].as_u64().unwrap();
    assert!(large > 3000, "floor, ceiling and walls are found: {large}");
    fails(&folder, "demo --out e --range-noise-m -1", &["range_noise_m"]);
}

#[test]
fn what_cannot_be_used_is_named_in_one_line_and_nothing_is_written() {
    let folder = folder("errors");
    small_scan(&folder);
    let pgm = fs::read(folder.join("scan.pgm")).unwrap();
    fs::write(folder.join("short.pgm"), &pgm[..pgm.len() - 1000]).unwrap();
    fs::write(folder.join("text.pgm"), "not an image").unwrap();
    let png = GreyImage::read(folder.join("scan.pgm")).unwrap().to_png();
    fs::write(folder.join("short.png"), &png[..png.len() / 2]).unwrap();
    let geometry = fs::read_to_string(folder.join("geometry.toml")).unwrap();
    fs::write(folder.join("wrong.toml"), geometry.replace("nodding", "hovering")).unwrap();
    let listed = "version = 1\nunit_m = 0.001\nkind = \"nodding\"\nturn_axis = \"y\"\n\
         beam_deg = { start = 0.0, step = 1.0 }\nturn_deg = [1.0, 2.0, 3.0]\n";
    fs::write(folder.join("listed.toml"), listed).unwrap();
    fs::write(folder.join("steep.toml"), geometry.replace("step = 2.0", "step = 100.0")).unwrap();
    fs::write(folder.join("file"), "").unwrap();

    let with =
        |scan: &str, geometry: &str, rest: &str| format!("segment {scan} --geometry {geometry} --out out {rest}");
    fails(&folder, &with("absent.pgm", "geometry.toml", ""), &["absent.pgm", "No such file"]);
    fails(&folder, &with("scan.pgm", "absent.toml", ""), &["absent.toml", "No such file"]);
    fails(&folder, &with("short.pgm", "geometry.toml", ""), &["short.pgm", "50 x 91"]);
    fails(&folder, &with("short.png", "geometry.toml", ""), &["short.png", "byte"]);
    fails(&folder, &with("text.pgm", "geometry.toml", ""), &["text.pgm"]);
    fails(&folder, &with("geometry.toml", "geometry.toml", ""), &["geometry.toml"]);
    fails(&folder, &with("scan.pgm", "scan.pgm", ""), &["scan.pgm"]);
    fails(&folder, &with("scan.pgm", "wrong.toml", ""), &["wrong.toml", "kind"]);
    fails(&folder, &with("scan.pgm", "listed.toml", ""), &["listed.toml", "scan.pgm", "turn_deg", "3", "50"]);
    fails(&folder, &with("scan.pgm", "steep.toml", ""), &["steep.toml", "beam_deg.step", "90"]);
    for (option, says) in [
        ("--preset best", "paper"),
        ("--frob 1", "--frob"),
        ("--min-pixels 0", "--min-pixels"),
        ("--min-pixels many", "many"),
        ("--range-noise-m -1", "--range-noise-m cannot be -1"),
        ("--range-noise-m nan", "--range-noise-m cannot be NaN"),
        ("--min-range-m 0", "--min-range-m cannot be 0"),
        ("--max-range-m 501", "--max-range-m cannot be 501"),
        ("--roof-angle-deg 0", "--roof-angle-deg cannot be 0"),
        ("--step-angle-deg 91", "--step-angle-deg cannot be 91"),
        ("--traces diagonally", "--traces"),
        ("--traces row*0", "factor of 0"),
        ("--traces column*17", "17 rows"),
        ("--traces 0x0", "0 columns"),
        ("--traces row,row,row,row,row,row,row,row,row", "9 are too many"),
        ("--closing circle", "plus"),
        ("--approach both", "region"),
        ("--line-angle-deg 0", "--line-angle-deg cannot be 0"),
        ("--plane-distance-m -1", "--plane-distance-m cannot be -1"),
        ("--max-labels 0", "--max-labels"),
    ] {
        fails(&folder, &with("scan.pgm", "geometry.toml", option), &[says]);
        if !option.starts_with("--min-pixels") {
            fails(&folder, &format!("bench scan.pgm --geometry geometry.toml {option}"), &[says]);
        }
    }
    fails(&folder, "segment scan.pgm --geometry geometry.toml", &["--out"]);
    fails(&folder, "segment scan.pgm --geometry geometry.toml --out file", &["file"]);
    fails(&folder, "segment scan.pgm --geometry geometry.toml --out file/out", &["file/out"]);
    fails(&folder, "frob", &["frob"]);
    fails(&folder, "bench scan.pgm --geometry geometry.toml --repeat 0", &["--repeat"]);
}

#[test]
fn more_segments_than_labels_png_can_number() {
    let folder = folder("many");
    // Returns like the black squares of a chess board: each is an area of its own.
    let (rows, columns) = (370, 370);
    let values = (0..rows * columns).map(|i| if (i / columns + i % columns) % 2 == 0 { 1000 } else { 0 }).collect();
    fs::write(folder.join("scan.pgm"), GreyImage { rows, columns, max_value: 65535, values }.to_pgm()).unwrap();
    let geometry = "version = 1\nunit_m = 0.001\nrange_noise_m = 0.01\nkind = \"pinhole\"\ndepth = \"range\"\nfx = 300.0\nfy = 300.0\n\
         cx = 185.0\ncy = 185.0\n";
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    let arguments = "segment scan.pgm --geometry geometry.toml --out out --preset paper --min-pixels";
    fails(&folder, &format!("{arguments} 1"), &["scan.pgm", "68450", "65535", "larger --min-pixels"]);
    succeeds(&folder, &format!("{arguments} 2"));
    assert_eq!(json(folder.join("out/segments.json"))["header"]["segments_found"], 68450);
    assert!(GreyImage::read(folder.join("out/labels.png")).unwrap().values.iter().all(|&n| n == 0));
}

#[test]
fn bench_counts_what_segment_finds() {
    let folder = folder("bench");
    small_scan(&folder);
    let told = succeeds(&folder, "bench scan.pgm --geometry geometry.toml --repeat 2 --json");
    let timing: Value = serde_json::from_str(&told).unwrap();
    assert_eq!(timing["points"], 50 * 91);
    let [median, min] = ["median_ns_per_point", "min_ns_per_point"].map(|key| timing[key].as_f64().unwrap());
    assert!(0.0 < min && min <= median, "{told}");
    succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out out");
    let header = json(folder.join("out/segments.json"))["header"].clone();
    assert!(timing["segments"].as_u64() > Some(0));
    assert_eq!(timing["segments"], header["segments_listed"]);
    let told = succeeds(&folder, "bench scan.pgm --geometry geometry.toml --repeat 1");
    assert!(told.contains("median_ns_per_point") && told.contains("points 4550"), "{told}");

    let told = succeeds(
        &folder,
        "bench scan.pgm --geometry geometry.toml --repeat 1 --json --approach edge --range-noise-m 0.01",
    );
    let timing: Value = serde_json::from_str(&told).unwrap();
    succeeds(&folder, "segment scan.pgm --geometry geometry.toml --out out --approach edge --range-noise-m 0.01");
    let by_edges = json(folder.join("out/segments.json"))["header"].clone();
    assert_eq!(timing["segments"], by_edges["segments_listed"]);
    assert_ne!(by_edges["edge_pixels"], header["edge_pixels"]);
}

#[test]
fn evaluate_counts_the_classes_of_hand_made_images() {
    let folder = folder("evaluate");
    // Truth 1 is found whole but for 2 of 10 pixels, 2 in two pieces, 3 and 4 as one, 5 not at all;
    // segment 9 is nowhere.
    let truth = [1, 1, 1, 1, 1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 4, 4, 4, 5, 5, 5, 0, 0, 0];
    let labels = [1, 1, 1, 1, 1, 1, 1, 1, 0, 0, 2, 2, 3, 3, 7, 7, 7, 7, 7, 7, 0, 0, 0, 9, 9, 9];
    write_labels(folder.join("truth.pgm"), 13, 255, &truth);
    write_labels(folder.join("labels.png"), 13, 65535, &labels);
    let told = succeeds(&folder, "evaluate --truth truth.pgm --labels labels.png --out out");
    let keys = ["correct", "over_segmented", "under_segmented", "missed", "noise", "truth_regions", "segments"];
    let counts = |json: &Value| keys.map(|key| json[key].as_u64().unwrap());
    let hoover = json(folder.join("out/hoover.json"));
    assert_eq!(counts(&hoover), [1, 1, 1, 1, 1, 5, 5]);
    assert_eq!(hoover["tolerance"], 0.8);
    assert!(told.lines().any(|line| line.split_whitespace().eq(["correct", "1"])), "{told}");
    let csv = fs::read_to_string(folder.join("out/hoover.csv")).unwrap();
    let lines: Vec<_> = csv.lines().collect();
    assert_eq!(lines[0], "tolerance,truth_regions,segments,correct,over_segmented,under_segmented,missed,noise");
    assert_eq!((lines.len(), lines[1], lines[30]), (51, "0.51,5,5,1,1,1,1,1", "0.8,5,5,1,1,1,1,1"));
    assert_eq!((lines[31], lines[50]), ("0.81,5,5,0,1,1,2,2", "1,5,5,0,1,1,2,2"));

    succeeds(&folder, "evaluate --truth truth.pgm --labels labels.png --out out --tolerance 0.9 --min-pixels 4");
    assert_eq!(counts(&json(folder.join("out/hoover.json"))), [0, 0, 0, 2, 2, 2, 2]);
    assert_eq!(fs::read_to_string(folder.join("out/hoover.csv")).unwrap().lines().count(), 2);

    let plain = succeeds(&folder, "evaluate --truth truth.pgm --labels truth.pgm --tolerance 1");
    assert!(plain.lines().any(|line| line.split_whitespace().eq(["correct", "5"])), "{plain}");
    write_labels(folder.join("turned.png"), 2, 255, &labels);
    let sizes = ["turned.png", "13 rows x 2 columns", "truth.pgm", "2 rows x 13 columns"];
    fails(&folder, "evaluate --truth truth.pgm --labels turned.png --out new", &sizes);
    fails(&folder, "evaluate --truth truth.pgm --labels labels.png --out new --tolerance 0.5", &["tolerance 0.5"]);
    fails(&folder, "evaluate --truth truth.pgm --labels absent.png --out new", &["absent.png"]);
}

#[test]
fn office_writes_scenes_with_their_truth() {
    let folder = folder("office");
    for (options, name, size) in [
        ("--scene 4", "tuning-04", (200, 361)),
        ("--scene 4 --sensor pinhole --set validation --noise-m 0.01", "validation-04", (240, 320)),
    ] {
        let out = folder.join(name);
        succeeds(&folder, &format!("office --out {name} {options}"));
        assert_eq!(fs::read_dir(&out).unwrap().count(), 4);
        let [scan, truth] = ["", "-truth"].map(|s| GreyImage::read(out.join(format!("{name}{s}.pgm"))).unwrap());
        assert_eq!((scan.rows, scan.columns), size);
        assert_eq!((truth.rows, truth.columns), size);
        let geometry = Geometry::read(out.join("geometry.toml")).unwrap();
        assert_eq!(geometry.range_noise_m.is_some(), name.starts_with("validation"));
        let ranges = RangeImage::from_grey(&scan, &geometry).unwrap();
        assert!(ranges.range_m.iter().zip(&truth.values).all(|(&range_m, &id)| (range_m > 0.0) == (id != 0)));
        assert!(out.join(format!("{name}.png")).exists());
    }
    fails(&folder, "office --out new --scene 1 --noise-m -1", &["range_noise_m"]);
    fails(&folder, "office --out new --set best", &["tuning"]);
}

/// A unit that is wrong by 1000 leaves hardly a count within the limits of the program: that is
/// said, and the results are those of an image without returns. A few counts outside are nothing
/// to speak of.
#[test]
fn units_that_leave_no_return_are_said() {
    let folder = folder("units_that_leave_no_return_are_said");
    let counts = |far: usize| (0..128).map(|i| if i < far { 60_000 } else { 2000 + i as u16 }).collect();
    let image = |far| GreyImage { rows: 8, columns: 16, max_value: 65535, values: counts(far) }.to_pgm();
    let geometry = |unit_m: f64, lines: &str| {
        format!(
            "version = 1\nunit_m = {unit_m:?}\n{lines}range_noise_m = 0.01\nkind = \"nodding\"\nturn_axis = \"y\"\n\
             beam_deg = {{ start = -7.5, step = 1.0 }}\nturn_deg = {{ start = -4.0, step = 1.0 }}\n"
        )
    };
    for (unit_m, far, said) in [
        (0.001_f64, 0, ""),
        (1.0, 0, "mm.pgm: 128 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 1 right?"),
        (
            1e-6,
            0,
            "mm.pgm: 128 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 0.000001 right?",
        ),
        (
            0.005,
            120,
            "mm.pgm: 120 of 128 counts lie outside of 0.05 m to 100 m and are no return: is unit_m = 0.005 right?",
        ),
        (0.005, 20, ""),
        (0.001, 0, ""),
        // without a least range of its own, and with a largest one of 500 m
        (-1e-6, 0, "mm.pgm: 128 of 128 counts are nearer than 0.05 m: is unit_m = 0.000001 right?"),
        (-1.0, 0, "mm.pgm: 128 of 128 counts lie outside of 0.00 m to 500 m and are no return: is unit_m = 1 right?"),
        (-0.001, 0, ""),
    ] {
        let limits = if unit_m < 0.0 { "min_range_m = 0\nmax_range_m = 10000\n" } else { "" };
        fs::write(folder.join("mm.pgm"), image(far)).unwrap();
        fs::write(folder.join("geometry.toml"), geometry(unit_m.abs(), limits)).unwrap();
        for command in
            ["segment mm.pgm --geometry geometry.toml --out out", "bench mm.pgm --geometry geometry.toml --repeat 1"]
        {
            let output = scanseg(&folder, command);
            assert!(output.status.success(), "{command}");
            let expected = if said.is_empty() { String::new() } else { format!("scanseg: warning: {said}\n") };
            assert_eq!(String::from_utf8(output.stderr).unwrap(), expected, "{command} {unit_m}");
        }
    }
}

/// The page has all in it, whatever its scan is called; nothing else differs.
#[test]
#[cfg(target_os = "linux")]
fn open_writes_a_page_that_needs_no_other_file() {
    let folder = folder("open");
    small_scan(&folder);
    fs::rename(folder.join("scan.pgm"), folder.join("<script>.pgm")).unwrap();
    let arguments = ["segment", "<script>.pgm", "--geometry", "geometry.toml", "--out", "out", "--open"];
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_scanseg"));
    // no program opens it
    let run = command.current_dir(&folder).env("PATH", "").args(arguments).output().unwrap();
    assert!(run.status.success(), "{run:?}");
    let told = String::from_utf8(run.stdout).unwrap();
    let path = folder.join("out/view.html");
    assert!(told.ends_with(&format!("look at {}\n", path.display())), "{told}");
    assert_eq!(fs::read_dir(folder.join("out")).unwrap().count(), FILES.len() + 1);
    let page = fs::read_to_string(path).unwrap();
    assert!(
        !page.contains("{{")
            || !["style", "viewer", "data"].iter().any(|part| page.contains(&format!("{{{{{part}}}}}")))
    );
    assert!(!page.contains("<script>.pgm") && page.contains("\\u003cscript>.pgm"));
    for outside in ["src=\"", "href=\"http", "@import", "url("] {
        let own = page.split("<script>").next().unwrap();
        assert!(!own.contains(outside), "{outside}");
    }
    let listed = json(folder.join("out/segments.json"))["segments"].as_array().unwrap().len();
    assert_eq!(page.matches("\"covariance\":").count(), listed);
}
