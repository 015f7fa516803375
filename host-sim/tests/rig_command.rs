//! `scanseg rig`, `replay` and `listen` as processes.

use std::fs;
use std::path::Path;

use scanseg_core::{EdgeConfig, Trace};
use scanseg_formats::RangeImage;
use scanseg_hal::link::{FrameDecoder, Message, Received, SegmentReport};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_sim::segmentation::Segmentation;

use crate::program::{fails, folder, scanseg, succeeds};
use crate::recorded::recorded;

/// Segments in a file of frames, in the order in which they came.
fn segments(path: &Path) -> Vec<SegmentReport> {
    let mut segments = vec![];
    FrameDecoder::new().feed(&fs::read(path).unwrap(), |received| match received {
        Received::Message { lost: 0, message: Message::Segment(segment) } => segments.push(segment),
        Received::Message { lost: 0, .. } => {}
        other => panic!("{other:?}"),
    });
    segments
}

/// Lines about segments and scans, without the counters.
fn told(text: &str) -> Vec<&str> {
    text.lines().filter(|line| line.starts_with("scan ") || line.starts_with("segment ")).collect()
}

#[test]
fn what_was_seen_live_is_replayed_and_heard() {
    let folder = folder("live");
    let faults = ["", " --faults loss=0.0005,flip=0.0005,insert=0.0001"];
    for faults in faults {
        let live = succeeds(
            &folder,
            &format!("rig --traces row*4,column*4 --range-noise-m 0.01 --save c.txt --link live.bin{faults}"),
        );
        assert!(told(&live).len() > 12, "{live}");
        let replayed =
            succeeds(&folder, "replay c.txt --traces row*4,column*4 --range-noise-m 0.01 --link replayed.bin");
        assert!(told(&replayed).starts_with(&told(&live)), "{live}\n{replayed}");
        let (live_segments, replayed_segments) =
            (segments(&folder.join("live.bin")), segments(&folder.join("replayed.bin")));
        assert!(!live_segments.is_empty() && replayed_segments.starts_with(&live_segments));
        let heard = succeeds(&folder, "listen live.bin");
        assert!(told(&heard).starts_with(&told(&live)));
        let counted = live.lines().rfind(|line| line.starts_with("so far")).unwrap();
        assert_eq!(counted.contains(" 0 lost,"), faults.is_empty(), "{counted}");
        // The replay has not seen the set-up; apart from that it counts the same.
        let counted = |text: &str| -> Vec<String> {
            let lines = text.lines().filter(|line| line.starts_with("so far"));
            lines.map(|line| line.split_once(" bytes,").unwrap().1.to_string()).collect()
        };
        assert!(counted(&replayed).starts_with(&counted(&live)), "{live}\n{replayed}");
    }
}

/// Rows that were telegrams give, to the bit, the segments of the same rows as an image.
#[test]
fn raw_telegrams_and_their_image_give_the_same_segments() {
    let folder = folder("raw");
    let mut sensor = Sensor::nodding(60, 361);
    sensor.quantisation_m = 0.001;
    let scan = Scene::numbered(Set::Tuning, 4).scan(&sensor, 0).unwrap();
    let mut raw = vec![];
    for row_m in scan.range_m.chunks(361) {
        let mut telegram = vec![0x02, 0x80, 0xD6, 0x02, 0xB0];
        telegram.extend((361u16 | 1 << 14).to_le_bytes());
        // 8191 and its like are no ranges.
        row_m.iter().for_each(|m| telegram.extend(((m * 1000.0).round() as u16).to_le_bytes()));
        telegram.push(0x10);
        telegram.extend(check_word(&telegram).to_le_bytes());
        raw.extend(telegram);
    }
    fs::write(folder.join("raw.bin"), &raw).unwrap();
    fs::write(folder.join("geometry.toml"), scan.geometry.to_toml()).unwrap();
    let replay = "replay raw.bin --geometry geometry.toml --range-bits 15 --traces row*4,column*4 --range-noise-m 0.01 --min-pixels 1";
    let text = succeeds(&folder, &format!("{replay} --link raw.link"));
    assert!(text.contains("scan 1 over (asked): 60 rows"), "{text}");
    let mut found = segments(&folder.join("raw.link"));

    let ranges = RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m };
    let traces = [Trace::ROW.times(4), Trace::COLUMN.times(4)];
    let config = EdgeConfig::paper().with_traces(&traces);
    let whole = Segmentation::of(&ranges, &scan.geometry, config, None, || ()).unwrap();
    let mut expected: Vec<SegmentReport> = whole.segments.iter().map(SegmentReport::from).collect();
    assert_eq!(found.len(), expected.len());
    found.sort_by_key(|segment| segment.label);
    expected.sort_by_key(|segment| segment.label);
    for (found, expected) in found.iter().zip(&expected) {
        assert_eq!((found.label, found.pixels, found.first_row), (expected.label, expected.pixels, expected.first_row));
        // Turn angles go by way of times: they are not the same to the last bit.
        assert!(found.centroid_m.iter().zip(expected.centroid_m).all(|(a, b)| (a - b).abs() < 1e-3));
    }

    // The files are those of `segment`, and the labels too.
    let names = |folder: &Path| {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    for approach in ["--approach plane", "--traces row*4,column*4"] {
        let options = format!("--geometry geometry.toml {approach} --range-noise-m 0.001 --min-pixels 5 --out");
        let text = succeeds(&folder, &format!("replay raw.bin --range-bits 15 {options} replayed"));
        assert!(text.ends_with("look at replayed/scan-1/overview.png\n"), "{text}");
        fs::write(folder.join("scan.pgm"), ranges.to_grey(&scan.geometry).unwrap().to_pgm()).unwrap();
        succeeds(&folder, &format!("segment scan.pgm {options} segmented"));
        let [replayed, segmented] = ["replayed/scan-1", "segmented"].map(|name| folder.join(name));
        assert_eq!(names(&replayed), names(&segmented));
        let [a, b] = [&replayed, &segmented].map(|out| fs::read(out.join("labels.png")).unwrap());
        assert!(a == b, "{approach}");
    }

    // A damaged telegram costs its row, and the rows after it keep their turn angles.
    raw[10 * 732 + 100] ^= 1;
    raw.remove(30 * 732 + 300);
    fs::write(folder.join("raw.bin"), &raw).unwrap();
    let text = succeeds(&folder, replay);
    assert!(text.contains("scan 1 over (asked): 58 rows") && text.contains(" 2 lost,"), "{text}");
}

/// The scanner's power fails and its encoder sticks: told, counted, and the next scan is whole.
#[test]
fn reset_and_stuck_encoder() {
    let folder = folder("reset");
    let text = succeeds(&folder, "rig --faults stuck=1.5,reset=4 --scans 5");
    assert!(text.contains(" while the tilt stood") && text.contains("trouble: scans have stopped"), "{text}");
    assert!(
        text.lines().any(|line| line.ends_with(" over (trouble): 1 rows") || line.contains(" over (trouble)")),
        "{text}"
    );
    assert!(text.contains("scan 5 over (turned): 200 rows"), "{text}");

    // as many scans as it takes: the encoder would stick while the scanner sets up again
    let text = succeeds(&folder, "rig --faults reset=3,stuck=6");
    assert!(text.contains("trouble: scans have stopped") && text.contains(" while the tilt stood"), "{text}");
}

#[test]
fn the_real_telegram() {
    let Some(data) = recorded("sick-lms200-telegram") else { return };
    let telegram = fs::read(data.join("lms200_b0_361.bin")).unwrap();
    let folder = folder("real");
    fs::write(folder.join("raw.bin"), telegram.repeat(6)).unwrap();
    let geometry = "version = 1\nunit_m = 0.001\nkind = \"nodding\"\nturn_axis = \"y\"\n\
        beam_deg = { start = -90.0, step = 0.5 }\nturn_deg = { start = 10.0, step = -0.5 }\n";
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    let text = succeeds(&folder, "replay raw.bin --geometry geometry.toml --range-bits 15");
    assert!(text.contains("6 telegrams, 0 lost, 0 rejected, 6 rows") && text.contains("\nsegment "), "{text}");
}

#[test]
fn failures() {
    let folder = folder("rig-failures");
    fs::write(folder.join("noise.bin"), [7; 5000]).unwrap();
    fs::write(folder.join("empty"), []).unwrap();
    fs::write(folder.join("bad.txt"), "scanseg capture 1\nscanner baud 300\n").unwrap();
    fs::write(folder.join("head.txt"), "scanseg capture 1\n").unwrap();
    let geometry =
        "version = 1\nunit_m = 0.001\nkind = \"pinhole\"\nfx = 1.0\nfy = 1.0\ncx = 0.0\ncy = 0.0\ndepth = \"z\"\n";
    fs::write(folder.join("geometry.toml"), geometry).unwrap();
    for (arguments, says) in [
        ("rig --faults loss=2", "2 is not within"),
        ("rig --faults rust=0.1", "`rust` is not"),
        ("rig --faults loss", "not loss=RATE"),
        ("rig --faults reset=-1", "-1 s is not within"),
        ("rig --faults stuck=soon", "`soon` is not a number"),
        ("rig --scan noise.bin", "--geometry"),
        ("rig --scan noise.bin --geometry geometry.toml", "noise.bin"),
        ("rig --roof-angle-deg nan", "--roof-angle-deg"),
        ("rig --scans 0", "--scans"),
        ("rig --save nowhere/c.txt", "nowhere/c.txt"),
        ("replay absent", "absent"),
        ("replay noise.bin", "--range-bits"),
        ("replay noise.bin --geometry geometry.toml --range-bits 13", "no scan of an LMS 2xx"),
        ("replay noise.bin --geometry geometry.toml --range-bits 12", "--range-bits"),
        ("replay bad.txt", "bad.txt: line 2"),
        ("replay head.txt", "settings"),
        ("replay head.txt --geometry geometry.toml --range-bits 13", "needs no --geometry"),
        ("listen absent", "absent"),
        ("listen empty", "no frame"),
        ("listen .", "directory"),
    ] {
        let printed = arguments.starts_with("rig --save");
        if printed {
            let output = scanseg(&folder, arguments);
            assert_eq!(output.status.code(), Some(2));
            assert!(String::from_utf8(output.stderr).unwrap().contains(says));
        } else {
            fails(&folder, arguments, &[says]);
        }
    }
    assert!(!folder.join("nowhere").exists());
}
