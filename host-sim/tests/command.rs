//! The `scanseg` command as a process: what it writes and prints.

use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;

use scanseg_formats::{Geometry, GreyImage};
use scanseg_sim::office::Sensor;
use scanseg_sim::picture::label_colour;
use serde_json::Value;

use crate::outputs::{FILES, Point, json, office_scan, points, small_scan};
use crate::program::{fails, folder, scanseg, succeeds};

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

/// The lines of segments.csv after the first, by their names.
fn csv(path: PathBuf) -> Vec<BTreeMap<String, String>> {
    let text = fs::read_to_string(path).unwrap();
    let mut lines = text.lines().map(|line| line.split(',').map(str::to_string));
    let names: Vec<String> = lines.next().unwrap().collect();
    lines.map(|line| names.iter().cloned().zip(line).collect()).collect()
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
