//! The plane segmenter: what must hold of every scan.

use crate::common::{self, plane_configs, scans};
use proptest::prelude::*;
use scanseg_core::{Finished, PlaneConfig, PlaneSegmenter, PushError, Ranging, Segmenter, Status, live_labels};
use scanseg_tests::checks::planes::{assert_adds_up, assert_consistent, assert_lines};
use scanseg_tests::reference::planes::fit_plane;
use scanseg_tests::scenes::{scan_of, scanner, uniform};
use scanseg_tests::stream::{Event, Record, Rig, Room, Scan};
use scanseg_tests::walls::Kind;
use std::collections::BTreeMap;

/// Ranges with 1 cm of noise.
const DEFAULT: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn what_is_told_adds_up(scan in scans(24), config in plane_configs()) {
        let record = scan.record(config, live_labels(scan.columns));
        record.assert_order_of_planes(scan.turn_rad.len());
        assert_adds_up(&scan, &config, &record);
    }

    /// A scan cut anywhere is a scan, and until the cut everything comes as in the whole scan.
    #[test]
    fn cut_anywhere(scan in scans(24), config in plane_configs(), part in 0.0f64..1.0) {
        let rows = (part * scan.turn_rad.len() as f64) as usize;
        let record = scan.cut(rows).record(config, live_labels(scan.columns));
        record.assert_order_of_planes(rows);
        let whole = scan.record(config, live_labels(scan.columns));
        prop_assert_eq!(&whole.statuses[..rows], &record.statuses[..]);
        // all but the segments that the end completes
        let ends = record.events.iter().rposition(|event| matches!(event, Event::Row { .. })).map_or(0, |last| last + 1);
        prop_assert_eq!(&whole.events[..ends], &record.events[..ends]);
    }

    /// What came before leaves no trace, with a table of any size: a whole scan, one dropped by
    /// `reset`, a scan broken off.
    #[test]
    fn every_scan_starts_clean(
        scan in scans(16), config in plane_configs(), other in any::<u64>(), index in 0usize..40,
    ) {
        let columns = scan.columns;
        let areas = 1 + (index * columns) % live_labels(columns);
        let expected = scan.record(config, areas);
        let other = Scan { rig: scan.rig.clone(), ..scan_of(20, columns, 0, (other % 6) as usize, other) };
        let mut room = Room::new(columns, config, areas);
        let mut segmenter = PlaneSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = || {
            let mut record = Record::default();
            scan.feed(&mut segmenter, &mut record).unwrap();
            (other.feed(&mut segmenter, &mut Record::default()), record)
        };
        prop_assert_eq!(&record().1, &expected);
        prop_assert_eq!(&record().1, &expected);
        let mut broken = Record { break_at: Some(index), ..Record::default() };
        other.feed(&mut segmenter, &mut broken).unwrap();
        let stopped = broken.statuses.last() == Some(&Status::Stopped) || broken.finished == Some(Finished::Stopped);
        prop_assert_eq!(stopped, broken.events.len() == index + 1);
        let mut again = Record::default();
        scan.feed(&mut segmenter, &mut again).unwrap();
        prop_assert_eq!(&again, &expected);
        segmenter.push_row(other.row_m(0), 0.0, &mut Record::default()).unwrap();
        segmenter.reset();
        let refused = segmenter.push_row(&vec![1.0; columns + 1], 0.0, &mut Record::default());
        prop_assert_eq!(refused, Err(PushError::RowLength { expected: columns, got: columns + 1 }));
        let mut last = Record::default();
        scan.feed(&mut segmenter, &mut last).unwrap();
        prop_assert_eq!(&last, &expected);
    }

    #[test]
    fn few_labels(scan in scans(24), config in plane_configs(), share in 0.0f64..1.0) {
        let areas = 1 + (share * share * (live_labels(scan.columns) - 1) as f64) as usize;
        assert_consistent(&scan, &config, areas);
    }

    /// Any bits as ranges and turn angles: no panic, and every row is taken or refused.
    #[test]
    fn any_bits(columns in crate::common::columns(), rig in 0usize..7, seed: u64, config in plane_configs(), wide: bool) {
        let ranging = if wide { config.ranging.with_limits(1e-6, 500.0) } else { config.ranging };
        let config = config.with_ranging(ranging);
        let mut scan = scan_of(12, columns, rig, 0, seed);
        let bits = |row, column| f32::from_bits((uniform(seed ^ 9, row, column) * 4294967296.0) as u32);
        for (i, range_m) in scan.range_m.iter_mut().enumerate() {
            if uniform(seed, 77, i) < 0.5 {
                *range_m = bits(i / columns, i % columns);
            } else if wide && uniform(seed, 79, i / columns) < 0.5 {
                *range_m = [1e-5, 2e-4, 499.0][i / columns % 3];
            }
        }
        let mut room = Room::new(columns, config, live_labels(columns));
        let mut segmenter = PlaneSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = Record::default();
        let mut rows = 0;
        for row in 0..12 {
            let turn_rad = if uniform(seed, 78, row) < 0.3 { bits(row, 1 << 18) } else { scan.turn_rad[row] };
            match segmenter.push_row(scan.row_m(row), turn_rad, &mut record) {
                Ok(status) => {
                    record.statuses.push(status);
                    rows += 1;
                }
                Err(e) => {
                    let refused = matches!(e, PushError::TurnAngle { .. });
                    prop_assert!(refused, "{}", e);
                }
            }
        }
        record.finished = Some(segmenter.finish(&mut record));
        record.assert_order_of_planes(rows);
    }
}

/// The properties are about something: scans of all kinds have joins, segments that go on after
/// they were reported, and segments of all sizes.
#[test]
fn scans_hold_all_cases() {
    let (mut life, mut largest, mut full) = ([0; 4], 0, 0);
    for seed in 0..300 {
        let scan = scan_of(24, 33, seed as usize % 7, seed as usize % 6, seed);
        let record = scan.record(DEFAULT, live_labels(33));
        let of_scan = record.assert_order_of_planes(24);
        for (sum, more) in
            life.iter_mut().zip([of_scan.begun as usize, of_scan.joins, of_scan.resumed, of_scan.reports])
        {
            *sum += more;
        }
        largest += record.segments().values().filter(|segment| segment.pixels() > 100).count();
        let few = scan.record(DEFAULT, 4);
        full += usize::from(few.unlabelled(33).iter().sum::<u32>() > 0);
    }
    println!("begun, joins, resumed, reports {life:?}; {largest} of 100 pixels; {full} times full");
    let [begun, joins, resumed, reports] = life;
    assert!(begun > 3000 && joins > 300 && resumed > 10 && reports > 2000 && largest > 100 && full > 50);
}

/// A wall, and one behind it that is up to 16 times as far: no line is of both.
#[test]
fn lines_end_at_large_steps() {
    for (case, noise_m) in (0..200).flat_map(|case| [(case, 0.0), (case, 0.01)]) {
        let near = [2, 3, 6, 12][case % 4];
        let far = [2.0, 4.0, 8.0, 16.0][case / 4 % 4];
        let mut scan = scanner(1, 40, 0.0, |direction| 1.0 / direction[0]);
        for (column, range_m) in scan.range_m.iter_mut().enumerate() {
            let angle = (column as f32 - 19.5).to_radians();
            *range_m = if column < near { 1.0 / angle.cos() } else { far / (angle - 0.1).cos() };
            *range_m += noise_m * 12f32.sqrt() * (uniform(case as u64, 0, column) as f32 - 0.5);
        }
        let config = PlaneConfig::new(Ranging::new(noise_m));
        let labels = scan.record(config, live_labels(40)).labels();
        assert_ne!(labels[near - 1], labels[near], "{far} m behind {near} pixels, noise {noise_m} m: {labels:?}");
    }
}

/// Lines of single rows of all kinds, with noise and missing pixels: where the core cuts costs no
/// more than the best cuts, in f64, of all that are possible. It keeps eight last cuts only, which
/// are too few on curves that fit lines for long: there it may cost more, but not twice as much.
#[test]
fn lines_are_the_cheapest() {
    let (mut best, mut rows) = (0, 0);
    for seed in 0..400 {
        let columns = [9, 33, 64, 97][seed as usize % 4];
        let scan = scan_of(1, columns, seed as usize % 7, seed as usize % 6, seed);
        // rows of a spinning scanner are no planes
        if matches!(scan.rig, Rig::Spinning { .. }) {
            continue;
        }
        rows += 1;
        let ranging = Ranging::new([0.0, 0.003, 0.01, 0.05][seed as usize / 4 % 4]);
        best += usize::from(assert_lines(&scan, &PlaneConfig::new(ranging)));
    }
    println!("{best} of {rows} rows are the best");
    assert!(100 * best >= 88 * rows && rows > 200, "{best} of {rows}");
}

/// The share of pixels that two labelings of an image agree on, each label of one going with the
/// label of the other that it shares most pixels with: the lesser of the two directions.
fn agreement(one: &[u32], other: &[u32]) -> f64 {
    let share = |one: &[u32], other: &[u32]| {
        let mut shared = BTreeMap::<u32, BTreeMap<u32, usize>>::new();
        for (&a, &b) in one.iter().zip(other) {
            *shared.entry(a).or_default().entry(b).or_insert(0) += 1;
        }
        shared.values().filter_map(|of| of.values().max()).sum::<usize>() as f64 / one.len() as f64
    };
    share(one, other).min(share(other, one))
}

/// Rows of spinning scanners and of cameras do not turn: what is stated of their turn is nothing.
#[test]
fn turns_are_those_of_nodding_scanners() {
    for rig in 3..7 {
        let scan = scan_of(24, 64, rig, 2, 7);
        let room = live_labels(scan.columns);
        let stated = PlaneConfig::new(DEFAULT.ranging.with_turn_noise_rad(0.05));
        assert_eq!(scan.record(stated, room), scan.record(DEFAULT, room), "{:?}", scan.rig);
    }
}

/// A simulated office at 1 deg.
fn office(scene: u32, noise_m: f64) -> (Scan, PlaneConfig) {
    let scan = common::office(Kind::Tilting, scene, noise_m);
    (scan, PlaneConfig::new(Ranging::new(noise_m.max(0.001) as f32)))
}

/// An office in a mirror has the same surfaces, but for pixels at their rims: which line of a row
/// comes first, and which of two equal planes, depends on the side. Scaling an office does not
/// scale its surfaces, since the noise is in metres.
#[test]
fn mirrored_offices() {
    for (scene, noise_m) in [(0, 0.0), (1, 0.005), (2, 0.01), (5, 0.005)] {
        let (scan, config) = office(scene, noise_m);
        let mirror = |pixels: &[f32]| pixels.chunks(scan.columns).flat_map(|row| row.iter().rev().copied()).collect();
        let mirrored = Scan { range_m: mirror(&scan.range_m), ..scan.clone() };
        let room = live_labels(scan.columns);
        let labels = scan.record(config, room).labels();
        let back = mirrored.record(config, room).labels();
        let back: Vec<u32> = back.chunks(scan.columns).flat_map(|row| row.iter().rev().copied()).collect();
        let agreement = agreement(&labels, &back);
        println!("scene {scene}, {noise_m} m: {agreement:.4} as in the mirror");
        assert!(agreement > 0.99, "{agreement}");
    }
}

/// The planes of an office's large segments are those of total least squares of their points in
/// f64, but for a part of how far off they say that they may be: they weigh range errors.
#[test]
fn planes_of_an_office() {
    let (scan, config) = office(3, 0.005);
    let record = scan.record(config, live_labels(scan.columns));
    let (labels, beams) = (record.labels(), scan.reference_beams());
    let mut compared = 0;
    for (label, segment) in record.segments().into_iter().filter(|(_, segment)| segment.pixels() >= 100) {
        let of_segment =
            scan.size().pixels().zip(&labels).zip(&scan.range_m).filter(|((_, other), _)| **other == label);
        let points: Vec<_> = of_segment.map(|((p, _), &range_m)| beams.direction(p) * f64::from(range_m)).collect();
        if points.is_empty() {
            // joined into another one since
            continue;
        }
        let (found, expected) = (segment.plane().unwrap(), fit_plane(&points).unwrap());
        let sd = |i: usize| f64::from(found.covariance[i][i]).sqrt();
        for (i, (&one, other)) in found.normal.iter().zip(&expected.normal).enumerate() {
            assert!((f64::from(one) - other).abs() < sd(i) + 1e-3, "{found:?} {expected:?}");
        }
        assert!((f64::from(found.distance_m) - expected.distance_m).abs() < sd(3) + 1e-3, "{found:?} {expected:?}");
        assert!((f64::from(found.rms_m) - expected.rms_m).abs() < 5e-4, "{found:?} {expected:?}");
        compared += 1;
    }
    assert!(compared > 10, "{compared}");
}
