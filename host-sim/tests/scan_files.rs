//! `scanseg segment` on clouds and depth images of others, and what it writes for other programs.

mod program;
mod recorded;

use std::collections::HashMap;
use std::fs;
use std::path::Path;

use program::{fails, folder, scanseg, succeeds};
use recorded::recorded;
use scanseg_core::{PlaneConfig, Ranging};
use scanseg_formats::{GreyImage, ReadOptions, Scan, ScanFile};
use scanseg_sim::export::{Segmented, Verdict, planarities_of};
use scanseg_sim::segmentation::Segmentation;
use serde_json::Value;

fn read(path: &Path, geometry: Option<&Path>) -> Scan {
    let options = ReadOptions { geometry: geometry.map(Path::to_path_buf), ..ReadOptions::default() };
    ScanFile::open(path, &options).unwrap().frame(0).unwrap()
}

fn labels(scan: &Scan, range_noise_m: f32) -> Vec<u32> {
    let config = PlaneConfig::new(Ranging::new(range_noise_m));
    Segmentation::of(&scan.image, &scan.geometry, config, None, || ()).unwrap().numbers(1)
}

/// The part of the pixels that have the label which most pixels of their label have in the other image.
fn agreement(a: &[u32], b: &[u32]) -> f64 {
    let mut pairs: HashMap<(u32, u32), usize> = HashMap::new();
    a.iter().zip(b).for_each(|(a, b)| *pairs.entry((*a, *b)).or_default() += 1);
    let mut most: HashMap<u32, usize> = HashMap::new();
    pairs.iter().for_each(|((a, _), count)| {
        let best = most.entry(*a).or_default();
        *best = (*best).max(*count);
    });
    most.values().sum::<usize>() as f64 / a.len() as f64
}

/// The same scan as a range image with its geometry file and as a cloud without one.
#[test]
fn a_cloud_has_the_labels_of_its_range_image() {
    let sets = [
        ("office1-kinect", "office1.pcd", "office1.depth_mm.pgm", "geometry.toml", 0.004),
        ("synpeb", "test_100.pcd", "test_100.range_100um.pgm", "test_100.geometry.toml", 0.001),
    ];
    for (set, cloud, image, geometry, noise_m) in sets {
        let Some(data) = recorded(set) else { return };
        let (cloud, image) = (read(&data.join(cloud), None), read(&data.join(image), Some(&data.join(geometry))));
        let (a, b) = (labels(&cloud, noise_m), labels(&image, noise_m));
        let both = agreement(&a, &b).min(agreement(&b, &a));
        println!("{set}: {:.3} % of the pixels alike", 100.0 * both);
        assert!(both >= 0.99, "{set}: {both}");
    }
}

#[test]
fn all_frames_have_folders_of_their_own() {
    let Some(data) = recorded("ouster-os1") else { return };
    let folder = folder("all-frames");
    let capture = data.join("OS-1-128_v2.3.0_1024x10_lb_n3.pcap");
    // the noise that is stated of it warns
    let output = scanseg(&folder, &format!("segment {} --all-frames --out out", capture.display()));
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.success());
    let list = |frame: &str| fs::read_to_string(folder.join("out").join(frame).join("segments.csv")).unwrap();
    let lists = ["frame-0", "frame-1", "frame-2"].map(list);
    assert!(lists[0] != lists[1] && lists[1] != lists[2] && fs::read_dir(folder.join("out")).unwrap().count() == 3);
    assert!(said.contains("out/frame-2\n"), "{said}");
    fails(&folder, &format!("segment {} --all-frames --frame 1 --out out", capture.display()), &["--all-frames"]);
}

#[test]
fn a_table_is_one_segment() {
    let Some(data) = recorded("../cases/15-organised-cloud") else { return };
    let folder = folder("table");
    succeeds(&folder, &format!("segment {} --out out", data.join("table.pcd").display()));
    let list: Value = serde_json::from_slice(&fs::read(folder.join("out/segments.json")).unwrap()).unwrap();
    let [segment] = &list["segments"].as_array().unwrap()[..] else { panic!("{list}") };
    assert_eq!((&segment["pixels"], &segment["planarity"]), (&2391.into(), &"planar".into()));
    let number = |value: &Value| value.as_f64().unwrap();
    let plane = [0, 1, 2].map(|i| number(&segment["normal"][i])).into_iter().chain([number(&segment["distance_m"])]);
    for (found, right) in plane.zip([-0.546, -0.022, 0.837, 0.529]) {
        assert!((found - right).abs() < 0.002, "{segment}");
    }
}

#[test]
fn a_cloud_without_rows_is_refused_and_says_what_to_do() {
    let Some(data) = recorded("velodyne") else { return };
    let folder = folder("velodyne-list");
    let list = data.join("vlp32_1713492677464078412.pcd");
    let arguments = format!("segment {} --out out", list.display());
    fails(&folder, &arguments, &["points without rows and columns: its HEIGHT is 1", "HEIGHT above 1"]);
}

/// The points of another program, which tells the channel of each and leaves out what has no return.
#[test]
fn a_list_of_points_with_their_ring_has_rows() {
    let Some(data) = recorded("velodyne") else { return };
    let scan = read(&data.join("vlp16_1673400472138016708.pcd"), None);
    // 360 / 0.199; one ring sees nothing, and 1298 points lie within 0.02 degrees of another of their ring
    assert_eq!(scan.image.rows, 15);
    assert!((1800..=1815).contains(&scan.image.columns), "{}", scan.image.columns);
    assert!(scan.measured > 14_831 - 1298 - 150, "{}", scan.measured);

    // the half of the pixels that has no return must not make rows of the rest
    let folder = folder("rings");
    let file = data.join("vlp16_1673400472138016708.pcd");
    succeeds(&folder, &format!("segment {} --sensor velodyne-vlp16 --out out", file.display()));
    let table = fs::read_to_string(folder.join("out/segments.csv")).unwrap();
    let distances = table.lines().skip(1).map(|line| line.split(',').nth(12).unwrap());
    let (planes, none): (Vec<_>, Vec<_>) = distances.partition(|distance_m| !distance_m.is_empty());
    assert!(planes.len() > 70 && none.len() <= 5, "{} {}", planes.len(), none.len());
}

#[test]
fn coordinates_in_millimetres_are_suspected() {
    let folder = folder("millimetres");
    let text =
        "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 8\nHEIGHT 8\nPOINTS 64\nDATA ascii\n";
    let line = |i: i32| format!("2000 {} {}\n", 100 * (i % 8 - 3), 100 * (i / 8 - 3));
    fs::write(folder.join("mm.pcd"), text.to_string() + &(0..64).map(line).collect::<String>()).unwrap();
    let output = scanseg(&folder, "segment mm.pcd --out out");
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        output.status.success() && stderr.contains("64 of 64") && stderr.contains("is unit_m = 1 right?"),
        "{stderr}"
    );
    let stdout = succeeds(&folder, "segment mm.pcd --unit-m 0.001 --range-noise-m 0.002 --out out");
    assert!(stdout.contains("64 with a return"), "{stdout}");
}

/// A wall, seen by a camera at 2 m, with some noise.
fn wall(noise_m: f64) -> GreyImage {
    let (rows, columns) = (40, 60);
    let mut state = 3u64;
    // the sum of twelve even numbers from 0 to 1 is nearly normal
    let mut even = || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 40) as f64 / (1u64 << 24) as f64
    };
    let mut normal = || (0..12).map(|_| even()).sum::<f64>() - 6.0;
    let values = (0..rows * columns).map(|_| (1e4 * (2.0 + noise_m * normal())).round() as u16).collect();
    GreyImage { rows, columns, max_value: 65535, values }
}

/// What is written can be read again as the same scan; outlines lie on their planes.
#[test]
fn what_other_programs_get() {
    let folder = folder("exports");
    fs::write(folder.join("wall.png"), wall(0.002).to_png()).unwrap();
    let arguments = "segment wall.png --fx 60 --unit-m 0.0001 --range-noise-m 0.002";
    succeeds(&folder, &format!("{arguments} --out out --write ply,pcd,json,csv,geojson"));
    let written = |name: &str| fs::read(folder.join("out").join(name)).unwrap();
    let clouds = ["points.pcd", "points.ply"].map(|name| read(&folder.join("out").join(name), None));
    for scan in &clouds {
        assert_eq!((scan.image.rows, scan.image.columns, scan.measured), (40, 60, 2400));
        assert!(matches!(scan.geometry.kind, scanseg_formats::Kind::Pinhole { .. }), "{:?}", scan.geometry.kind);
    }
    assert_eq!(clouds[0].image, clouds[1].image);
    let outlines: Value = serde_json::from_slice(&written("outlines.json")).unwrap();
    let [outline] = &outlines.as_array().unwrap()[..] else { panic!("{outlines}") };
    let number = |value: &Value| value.as_f64().unwrap();
    // 59 x 39 steps of 2 m / 60
    let area_m2 = 59.0 * 39.0 * (2.0f64 / 60.0).powi(2);
    assert!((number(&outline["area_m2"]) - area_m2).abs() < 0.01 * area_m2, "{outline}");
    for corner in outline["corners_m"].as_array().unwrap() {
        let along: f64 = (0..3).map(|i| number(&corner[i]) * number(&outline["normal"][i])).sum();
        assert!((along + number(&outline["distance_m"])).abs() < 1e-5, "{outline}");
    }
    let geojson: Value = serde_json::from_slice(&written("outlines.geojson")).unwrap();
    assert_eq!(geojson["features"][0]["properties"]["planarity"], "planar");
    let csv = String::from_utf8(written("outlines.csv")).unwrap();
    assert_eq!(csv.lines().count() - 1, outline["corners_m"].as_array().unwrap().len());
    assert!(written("outlines.ply").starts_with(b"ply\nformat ascii 1.0\n"));
    // and nothing of it unless it is asked for
    succeeds(&folder, &format!("{arguments} --out plain"));
    assert!(!folder.join("plain/outlines.json").exists());
}

#[cfg(feature = "ros")]
#[test]
fn a_recording_has_rows_planes_and_points_in_the_order_of_time() {
    let folder = folder("recording");
    fs::write(folder.join("wall.png"), wall(0.002).to_png()).unwrap();
    succeeds(&folder, "segment wall.png --fx 60 --unit-m 0.0001 --range-noise-m 0.002 --out out --write mcap");
    let recording = fs::read(folder.join("out/recording.mcap")).unwrap();
    let messages: Vec<_> = mcap::MessageStream::new(&recording).unwrap().map(|message| message.unwrap()).collect();
    let on = |topic: &str| messages.iter().filter(|message| message.channel.topic == topic).count();
    assert_eq!((on("/rows"), on("/planes"), on("/points")), (40, 1, 1));
    assert!(messages.is_sorted_by_key(|message| message.log_time));
    // and its points are a scan again
    let options = ReadOptions { topic: Some("/points".into()), ..ReadOptions::default() };
    let scan = ScanFile::open(folder.join("out/recording.mcap"), &options).unwrap().frame(0).unwrap();
    assert_eq!((scan.image.rows, scan.image.columns, scan.measured), (40, 60, 2400));
}

#[cfg(not(feature = "ros"))]
#[test]
fn a_recording_says_what_reads_it() {
    let folder = folder("no-recording");
    fs::write(folder.join("run.mcap"), b"\x89MCAP0\r\n").unwrap();
    fails(&folder, "segment run.mcap --out out", &["a recording of ROS 2 without the feature ros of this build"]);
}

#[test]
fn a_surface_that_is_rougher_than_the_noise_is_no_plane() {
    let geometry =
        "version = 1\nunit_m = 0.0001\nkind = \"pinhole\"\ndepth = \"z\"\nfx = 60\nfy = 60\ncx = 29.5\ncy = 19.5\n";
    let folder = folder("rough");
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    for (noise_m, verdict) in [(0.004, Verdict::Planar), (0.012, Verdict::Rough)] {
        fs::write(folder.join("wall.png"), wall(noise_m).to_png()).unwrap();
        let scan = read(&folder.join("wall.png"), Some(&folder.join("geometry.toml")));
        let ranging = Ranging::new(0.004);
        let segmentation =
            Segmentation::of(&scan.image, &scan.geometry, PlaneConfig::new(ranging), None, || ()).unwrap();
        let labels = segmentation.numbers(30);
        let segmented = Segmented {
            image: &scan.image,
            geometry: &scan.geometry,
            ranging: &ranging,
            range_noise_m: &[],
            labels: &labels,
            segments: segmentation.of_pixels(30),
        };
        let found = planarities_of(&segmented)[0];
        assert_eq!(found.verdict, verdict, "{found:?}");
        let times = noise_m as f32 / 0.004;
        let residual = found.residual_per_noise.unwrap();
        assert!((0.8 * times..1.2 * times).contains(&residual), "{found:?}");
    }
}
