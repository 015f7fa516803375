//! Each tuned number of the default shows: doubled or halved, it changes what is found in some of a
//! few scans, which are on record.

use scanseg_core::{PlaneConfig, Ranging, Rules};
use scanseg_formats::{GreyImage, RangeImage};
use scanseg_sim::office::{Missing, Scene, Sensor, Set, SimulatedScan, Trouble};
use scanseg_sim::segmentation::Segmentation;

/// A scan, its ranges as a file has them, and the noise that is stated.
struct Case {
    name: &'static str,
    scan: SimulatedScan,
    ranges: RangeImage,
    noise_m: f32,
}

fn cases() -> Vec<Case> {
    let nodding = || Sensor { range_noise_m: 0.005, ..Sensor::nodding(100, 181) };
    let fine = || Sensor { range_noise_m: 0.01, ..Sensor::nodding(200, 361) };
    let spinning = || Sensor { range_noise_m: 0.005, ..Sensor::spinning(64, 512) };
    let seams = || Sensor { turn_misreported_deg: 0.6, ..fine() };
    let large_seams = || Sensor { turn_misreported_deg: 2.0, ..fine() };
    let off = Trouble::TurnOff { sd_deg: 0.3 };
    let rings = Trouble::RingOffsets { sd_m: 0.05 };
    let steps = Trouble::DisparitySteps { step_per_m: 0.00285, noise_per_m: 0.0005, alike_px: 1 };
    let grown = Trouble::GrowingNoise { constant_m: 0.001, per_m2: 0.0015 };
    let missing = Trouble::Missing(Missing::Share(0.6));
    let of = |name, number, sensor: Sensor, trouble, noise_m| {
        let scan =
            Scene::numbered(Set::Tuning, number).troubled_scan(&sensor, trouble, 0).expect("a sensor that works");
        let SimulatedScan { rows, columns, ref range_m, ref geometry, .. } = scan;
        let image = RangeImage { rows, columns, range_m: range_m.clone() };
        let image: GreyImage = image.to_grey(geometry).expect("ranges that fit");
        let ranges = RangeImage::from_grey(&image, geometry).expect("an image that fits");
        Case { name, scan, ranges, noise_m }
    };
    vec![
        of("an office", 3, nodding(), Trouble::None, 0.005),
        of("an office at 10 mm", 6, fine(), Trouble::None, 0.01),
        of("noise stated at a third", 7, fine(), Trouble::None, 0.003),
        of("noise not stated", 8, nodding(), Trouble::None, 0.0),
        of("no noise", 9, Sensor::nodding(200, 361), Trouble::None, 0.0),
        of("turns off", 1, fine(), off, 0.01),
        of("turns off, another office", 10, fine(), off, 0.01),
        of("seams", 2, seams(), Trouble::None, 0.01),
        of("seams, another office", 11, seams(), Trouble::None, 0.01),
        of("bearings that bend", 4, fine(), Trouble::BearingScale(1.02), 0.01),
        of("bearings that bend more", 4, fine(), Trouble::BearingScale(1.15), 0.01),
        of("large seams", 22, large_seams(), Trouble::None, 0.01),
        of("large seams, another office", 17, large_seams(), Trouble::None, 0.01),
        of("large seams, a third office", 38, large_seams(), Trouble::None, 0.01),
        of("rings", 5, spinning(), rings, 0.005),
        of("steps", 12, fine(), steps, 0.0),
        of("growing noise, unsaid", 13, fine(), grown, 0.001),
        of("missing pixels", 14, nodding(), missing, 0.005),
    ]
}

impl Case {
    fn labels(&self, rules: &'static Rules) -> Vec<u32> {
        let config = PlaneConfig::new(Ranging::new(self.noise_m)).with_rules(rules);
        Segmentation::of(&self.ranges, &self.scan.geometry, config, None, || ()).expect("a scan that fits").numbers(1)
    }
}

/// A number for labels: FNV-1a.
fn digest(labels: &[u32]) -> u64 {
    let bytes = labels.iter().flat_map(|label| label.to_le_bytes());
    bytes.fold(0xcbf2_9ce4_8422_2325, |sum, byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

/// Multiplies a tuned number.
type Change = fn(&mut Rules, f32);

macro_rules! changes {
    ($($float:ident)*; $($whole:ident)*) => {
        [
            $((stringify!($float), (|rules, by| rules.$float *= by) as Change),)*
            $((stringify!($whole), (|rules, by| rules.$whole = (rules.$whole as f32 * by) as _) as Change),)*
        ]
    };
}

/// Every tuned number.
fn changes() -> impl IntoIterator<Item = (&'static str, Change)> {
    changes![
        least_noise_m least_beam_rad off_plane left_price leave_price max_tan_square most_turn rough rough_by_chance
        line_price lone_price chance uneven bent rougher wobble most_wobble bend_cos_square bend_step seam_rad seam_uneven
        turn_rad ring_m turn_prior_rad ring_prior_m turn_gain turn_gain_per_pixel turn_other turn_cos_square
        turn_alone_least turn_alone_most turn_off noise_share noise_square noise_less noise_trust noise_most;
        gap_columns gap_points hidden bend_points seam_columns seam_rows turn_points turn_rows
    ]
}

#[test]
fn each_number_shows() {
    // small ones first: most numbers show in one of them
    let mut cases = cases();
    cases.sort_by_key(|case| case.ranges.range_m.len());
    let found: Vec<_> = cases.iter().map(|case| case.labels(&Rules::TUNED)).collect();
    let mut silent = Vec::<String>::new();
    for (name, change) in changes() {
        for by in [0.5, 2.0] {
            let mut rules = Rules::TUNED;
            change(&mut rules, by);
            let rules = Box::leak(Box::new(rules));
            if !cases.iter().zip(&found).any(|(case, found)| case.labels(rules) != *found) {
                silent.push(format!("{name} times {by}"));
            }
        }
    }
    assert!(silent.is_empty(), "shows in no scan: {silent:?}");
}

/// What is found, so that a number that changed fails.
#[test]
fn what_is_found_is_on_record() {
    let lines = cases().into_iter().map(|case| {
        let labels = case.labels(&Rules::TUNED);
        let segments = labels.iter().max().unwrap_or(&0);
        format!("{}: {segments} segments, {:016x}", case.name, digest(&labels))
    });
    insta::assert_snapshot!(lines.collect::<Vec<_>>().join("\n"));
}
