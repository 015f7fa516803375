//! The region-based segmenter: what the reference finds in the whole image, and what must hold of
//! every scan.

use crate::common::{region_configs, scans};
use proptest::prelude::*;
use scanseg_core::{PushError, Ranging, RegionConfig, RegionSegmenter, Segmenter, Status, TurnAxis, live_labels};
use scanseg_tests::checks::regions::{assert_consistent, assert_same};
use scanseg_tests::scenes::{scan_of, uniform};
use scanseg_tests::stream::{Angles, Event, Record, Rig, Room, Scan};

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn same_as_the_reference(scan in scans(16), config in region_configs()) {
        assert_same(&scan, &config);
    }

    /// A scan cut anywhere is a scan, and until the cut everything comes as in the whole scan.
    #[test]
    fn cut_anywhere(scan in scans(24), config in region_configs(), part in 0.0f64..1.0) {
        let rows = (part * scan.turn_rad.len() as f64) as usize;
        let record = scan.cut(rows).record(config, live_labels(scan.columns));
        record.assert_order_of_regions(rows);
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
        scan in scans(16), config in region_configs(), other in any::<u64>(), index in 0usize..40,
    ) {
        let columns = scan.columns;
        let areas = 1 + (index * columns) % live_labels(columns);
        let expected = scan.record(config, areas);
        let other = Scan { rig: scan.rig.clone(), ..scan_of(20, columns, 0, (other % 6) as usize, other) };
        let mut room = Room::new(columns, config, areas);
        let mut segmenter = RegionSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = || {
            let mut record = Record::default();
            scan.feed(&mut segmenter, &mut record).unwrap();
            (other.feed(&mut segmenter, &mut Record::default()), record)
        };
        prop_assert_eq!(&record().1, &expected);
        prop_assert_eq!(&record().1, &expected);
        let mut broken = Record { break_at: Some(index), ..Record::default() };
        other.feed(&mut segmenter, &mut broken).unwrap();
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
    fn few_labels(scan in scans(24), config in region_configs(), share in 0.0f64..1.0) {
        let areas = 1 + (share * share * (live_labels(scan.columns) - 1) as f64) as usize;
        assert_consistent(&scan, &config, areas);
    }

    /// Any bits as ranges and turn angles: no panic, and every row is taken or refused.
    #[test]
    fn any_bits(columns in crate::common::columns(), rig in 0usize..7, seed: u64, config in region_configs()) {
        let mut scan = scan_of(12, columns, rig, 0, seed);
        let bits = |row, column| f32::from_bits((uniform(seed ^ 9, row, column) * 4294967296.0) as u32);
        for (i, range_m) in scan.range_m.iter_mut().enumerate() {
            if uniform(seed, 77, i) < 0.5 {
                *range_m = bits(i / columns, i % columns);
            }
        }
        let mut room = Room::new(columns, config, live_labels(columns));
        let mut segmenter = RegionSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = Record::default();
        for row in 0..12 {
            let turn_rad = if uniform(seed, 78, row) < 0.3 { bits(row, 1 << 18) } else { scan.turn_rad[row] };
            match segmenter.push_row(scan.row_m(row), turn_rad, &mut record) {
                Ok(status) => {
                    let labelled = matches!(status, Status::Labelled { unlabelled: 0, .. });
                    prop_assert!(labelled, "{:?}", status);
                }
                Err(e) => {
                    let refused = matches!(e, PushError::TurnAngle { .. });
                    prop_assert!(refused, "{}", e);
                }
            }
        }
        segmenter.finish(&mut record);
    }
}

/// The comparison is about something: of scans of all kinds two thirds are compared as a whole,
/// with joins, regions and lines of all sizes, and of the others what comes before the doubts.
#[test]
fn most_scans_are_compared() {
    let (mut whole, mut rows, mut joins, mut segments, mut largest) = (0, 0, 0, 0, 0);
    for seed in 0..150 {
        let scan = scan_of(16, 33, seed as usize % 7, seed as usize % 6, seed);
        let no_noise = RegionConfig::paper().with_ranging(Ranging::new(0.0)).with_plane_distance_m(0.02);
        for config in [RegionConfig::paper(), no_noise] {
            let compared = assert_same(&scan, &config);
            rows += compared.rows;
            if compared.rows < 16 {
                continue;
            }
            whole += 1;
            let record = scan.record(config, live_labels(33));
            joins += record.events.iter().filter(|event| matches!(event, Event::Join(_))).count();
            segments += record.segments().len();
            largest += record.segments().values().filter(|segment| segment.pixels() > 100).count();
        }
    }
    println!(
        "{whole} of 300 as a whole, {rows} of 4800 rows, {joins} joins, {segments} segments, {largest} of 100 pixels"
    );
    assert!(3 * whole > 2 * 300 && 5 * rows > 4 * 4800 && joins > 100 && segments > 1000 && largest > 50);
}

/// A surface that is hardly bent, and an angle of lines that single precision cannot tell from 0:
/// the reference must doubt its turns.
#[test]
fn an_angle_below_all_digits() {
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: 1.2, step_rad: 0.05 }, axis: TurnAxis::Y };
    #[rustfmt::skip]
    let range_m = vec![
        1.0657865, 1.1767924, 1.3172379, 1.49994, 1.7464583, 2.096069, 2.628661, 3.5355043, 5.4171734, 11.637765,
        1.0655437, 1.1765349, 1.3169641, 1.4996496, 1.7461529, 2.0957572, 2.6283734, 3.5353513, 5.4176774, 11.64407,
        1.0653058, 1.1762826, 1.3166962, 1.4993653, 1.7458538, 2.0954518, 2.6280913, 3.5352015, 5.4181714, 11.650255,
    ];
    let scan = Scan { columns: 10, range_m, turn_rad: vec![0.0, 0.0024543693, 0.0049087387], rig };
    let config = RegionConfig::paper().with_ranging(Ranging::new(0.0));
    let config = config.with_line_angle_rad(1e-29).with_plane_distance_m(0.05);
    assert!(assert_same(&scan, &config).doubts > 0, "no doubt");
}

/// The ends of a line a fraction of a millimetre from the scanner, far off the plane of the wall beside it: how much of their
/// range's noise shows depends on where exactly they are seen.
#[test]
fn ends_beside_the_scanner() {
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.675, step_rad: 0.05 }, axis: TurnAxis::Y };
    let turn_rad = (0..28).map(|row| 0.05 * row as f32 - 0.675).collect();
    let mut scan = Scan::of(28, turn_rad, rig, |beam| 1.0 / beam[0]);
    scan.range_m[27 * 28 + 13..][..2].fill(1.8e-4);
    for range_noise_m in [0.28, 0.4] {
        let ranging = Ranging::new(range_noise_m).with_limits(1e-4, 100.0);
        let compared = assert_same(&scan, &RegionConfig::paper().with_ranging(ranging));
        assert_eq!(compared.doubts, 0, "in doubt at {range_noise_m}");
    }
    scan.range_m[27 * 28 + 13..][..2].fill(1e-40);
    let nearest = Ranging::new(0.28).with_limits(f32::MIN_POSITIVE / 1e6, 100.0);
    assert!(assert_same(&scan, &RegionConfig::paper().with_ranging(nearest)).doubts > 0, "no doubt");
}

/// Returns at no distance at all between far ones: in single precision the squares of their chords are 0, and with them the
/// noise that a turn must be beyond.
#[test]
fn turns_at_the_scanner() {
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.2, step_rad: 0.1 }, axis: TurnAxis::Y };
    let scan = Scan { columns: 5, range_m: vec![0.6, 1e-30, 0.6, 1e-30, 0.6], turn_rad: vec![0.0], rig };
    let ranging = Ranging::new(0.4).with_limits(f32::MIN_POSITIVE, 100.0);
    assert!(assert_same(&scan, &RegionConfig::paper().with_ranging(ranging)).doubts > 0, "no doubt");
}

/// Lines that touch, two pixels each, every line a region of its own: no image has more live
/// labels. Each row is a zigzag whose corners are at every second pixel, and no two lines are in
/// one plane.
#[test]
fn worst_case_of_live_labels() {
    let config = RegionConfig::paper().with_ranging(Ranging::new(0.0)).with_plane_distance_m(0.0);
    let step_rad = 0.02f32;
    for columns in 2..70 {
        for shift in [0, 1] {
            let angles = Angles::Even { start_rad: -step_rad * columns as f32 / 2.0, step_rad };
            let rig = Rig::Nodding { angles, axis: TurnAxis::Y };
            let turn_rad: Vec<f32> = (0..6).map(|row| step_rad * row as f32).collect();
            let mut scan = Scan { columns, range_m: vec![0.0; 6 * columns], turn_rad, rig };
            // corners at odd columns, or in every second row at even ones
            let is_corner = |row: usize, column: usize| !(column + row * shift).is_multiple_of(2);
            let corner_m = |row: usize, column: usize| {
                let far = if (column / 2).is_multiple_of(2) { 0.1 } else { 0.0 };
                1.0 + far + 0.01 * uniform(0, row, column)
            };
            for (row, column) in scan.size().pixels() {
                let range_m = if is_corner(row, column) || column == 0 {
                    corner_m(row, column)
                } else {
                    // half way between the corners to either side
                    let inverse = 1.0 / corner_m(row, column - 1) + 1.0 / corner_m(row, column + 1);
                    2.0 * f64::from(step_rad).cos() / inverse
                };
                scan.range_m[row * columns + column] = range_m as f32;
            }
            let record = scan.record(config, live_labels(columns));
            assert_eq!(record.unlabelled(columns).iter().sum::<u32>(), 0, "{columns} columns");
            record.assert_order_of_regions(6);
            let lines: usize =
                (0..6).map(|row| if row * shift % 2 == 0 { columns / 2 } else { (columns - 1) / 2 }).sum();
            assert_eq!(record.segments().len(), lines.max(6), "{columns} columns, {shift}");
            if columns > 3 {
                let lost = scan.record(config, live_labels(columns) - 2);
                assert!(lost.unlabelled(columns).iter().sum::<u32>() > 0, "{columns} columns");
            }
        }
    }
}
