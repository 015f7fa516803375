//! The plane segmenter: what must hold of every scan.

#[allow(dead_code)]
mod common;

use common::{configs, scan_of, scans, uniform};
use proptest::prelude::*;
use scanseg_core::{Config, Finished, Pixel, PlaneSegmenter, PushError, Segment, Status, live_labels};
use scanseg_tests::reference::labels::Class;
use scanseg_tests::stream::{Event, Record, Room, Scan, Segmenter, class};
use std::collections::BTreeMap;

/// With less noise too, down to none.
fn plane_configs() -> impl Strategy<Value = Config<'static>> {
    let noises = prop::sample::select([0.01f32, 0.0, 0.002, 0.3].as_slice());
    (configs(), noises).prop_map(|(config, range_noise_m)| Config { range_noise_m, ..config })
}

/// Every label of the end is one segment, which has its pixels and its bounds, and edges are what has no area.
fn assert_adds_up(scan: &Scan, config: &Config, record: &Record) {
    let labels = record.labels();
    let mut bounds = BTreeMap::<u32, (u32, [usize; 4])>::new();
    for ((row, column), &label) in scan.size().pixels().zip(&labels).filter(|&(_, &label)| label != 0) {
        let (count, [_, bottom, left, right]) = bounds.entry(label).or_insert((0, [row, row, column, column]));
        *count += 1;
        (*bottom, *left, *right) = (row, (*left).min(column), (*right).max(column));
    }
    let mut segments = record.segments();
    for event in &record.events {
        if let Event::Join(join) = event {
            segments.remove(&join.from.0);
        }
    }
    let of = |s: &Segment| (s.pixels(), [s.first_row, s.last_row, s.first_column, s.last_column].map(usize::from));
    assert_eq!(segments.iter().map(|(&label, s)| (label, of(s))).collect::<BTreeMap<_, _>>(), bounds);
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    let edges: Vec<_> = classes.iter().map(|&class| class == Class::Edge).collect();
    assert_eq!(record.edges(scan.columns), edges);
    let image = scan.image(config);
    for (pixel, class) in scan.size().pixels().zip(classes) {
        assert_eq!(class == Class::NoReturn, image.range(pixel).is_none(), "{pixel:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn what_is_told_adds_up(scan in scans(24), config in plane_configs()) {
        let record = scan.record_planes(&config, live_labels(scan.columns));
        record.assert_order_of_planes(scan.turn_rad.len());
        assert_adds_up(&scan, &config, &record);
    }

    /// A scan cut anywhere is a scan, and until the cut everything comes as in the whole scan.
    #[test]
    fn cut_anywhere(scan in scans(24), config in plane_configs(), part in 0.0f64..1.0) {
        let rows = (part * scan.turn_rad.len() as f64) as usize;
        let record = scan.cut(rows).record_planes(&config, live_labels(scan.columns));
        record.assert_order_of_planes(rows);
        let whole = scan.record_planes(&config, live_labels(scan.columns));
        prop_assert_eq!(&whole.statuses[..rows], &record.statuses[..]);
        // all but the segments that the end completes
        let ends = record.events.iter().rposition(|event| matches!(event, Event::Row { .. })).map_or(0, |last| last + 1);
        prop_assert_eq!(&whole.events[..ends], &record.events[..ends]);
    }

    /// What came before leaves no trace, with a table of any size: a whole scan, one dropped by `reset`, a scan broken off.
    #[test]
    fn every_scan_starts_clean(
        scan in scans(16), config in plane_configs(), other in any::<u64>(), index in 0usize..40,
    ) {
        let columns = scan.columns;
        let areas = 1 + (index * columns) % live_labels(columns);
        let expected = scan.record_planes(&config, areas);
        let other = Scan { rig: scan.rig.clone(), ..scan_of(20, columns, 0, (other % 6) as usize, other) };
        let mut room = Room::new(columns, &config, areas);
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
        segmenter.push(other.row_m(0), 0.0, &mut Record::default()).unwrap();
        segmenter.reset();
        let refused = segmenter.push(&vec![1.0; columns + 1], 0.0, &mut Record::default());
        prop_assert_eq!(refused, Err(PushError::RowLength { expected: columns, got: columns + 1 }));
        let mut last = Record::default();
        scan.feed(&mut segmenter, &mut last).unwrap();
        prop_assert_eq!(&last, &expected);
    }

    /// With a table that is too small: pixels without a label are counted, all of a line or none, and only where the row
    /// has as many areas, or joins of them, as the table has room; everything else still adds up.
    #[test]
    fn few_labels(scan in scans(24), config in plane_configs(), share in 0.0f64..1.0) {
        let columns = scan.columns;
        let areas = 1 + (share * share * (live_labels(columns) - 1) as f64) as usize;
        let record = scan.record_planes(&config, areas);
        record.assert_order_of_planes(scan.turn_rad.len());
        assert_adds_up(&scan, &config, &record);
        let pixels = record.pixels();
        let unlabelled = pixels.iter().filter(|&&pixel| pixel == Pixel::Unlabelled).count() as u32;
        let rows = scan.turn_rad.len();
        prop_assert_eq!(record.finished, Some(Finished::Complete { rows, unlabelled }));
        let mut above = std::collections::BTreeSet::new();
        let (mut row, mut joined) = (0, 0);
        for event in &record.events {
            match event {
                Event::Join(_) => joined += 1,
                Event::Row { pixels, .. } => {
                    let label = |pixel: &Pixel| if let Pixel::Segment(label) = pixel { Some(label.0) } else { None };
                    let here: std::collections::BTreeSet<_> = pixels.iter().filter_map(label).collect();
                    // areas of the row above may not have been known to end yet
                    let most = here.union(&above).count() + joined;
                    let full = pixels.contains(&Pixel::Unlabelled);
                    prop_assert!(!full || most >= areas, "row {}: {} of {} areas", row, most, areas);
                    (above, row, joined) = (here, row + 1, 0);
                }
                _ => {}
            }
        }
    }

    /// Any bits as ranges and turn angles: no panic, and every row is taken or refused.
    #[test]
    fn any_bits(columns in common::columns(), rig in 0usize..7, seed: u64, config in plane_configs(), wide: bool) {
        let config = if wide { Config { min_range_m: 1e-6, max_range_m: 500.0, ..config } } else { config };
        let mut scan = scan_of(12, columns, rig, 0, seed);
        let bits = |row, column| f32::from_bits((uniform(seed ^ 9, row, column) * 4294967296.0) as u32);
        for (i, range_m) in scan.range_m.iter_mut().enumerate() {
            if uniform(seed, 77, i) < 0.5 {
                *range_m = bits(i / columns, i % columns);
            } else if wide && uniform(seed, 79, i / columns) < 0.5 {
                *range_m = [1e-5, 2e-4, 499.0][i / columns % 3];
            }
        }
        let mut room = Room::new(columns, &config, live_labels(columns));
        let mut segmenter = PlaneSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = Record::default();
        let mut rows = 0;
        for row in 0..12 {
            let turn_rad = if uniform(seed, 78, row) < 0.3 { bits(row, 1 << 18) } else { scan.turn_rad[row] };
            match segmenter.push(scan.row_m(row), turn_rad, &mut record) {
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
        record.finished = Some(segmenter.end(&mut record));
        record.assert_order_of_planes(rows);
    }
}

/// The properties are about something: scans of all kinds have joins, segments that go on after they were reported, and
/// segments of all sizes.
#[test]
fn scans_hold_all_cases() {
    let (mut life, mut largest, mut full) = ([0; 4], 0, 0);
    for seed in 0..300 {
        let scan = scan_of(24, 33, seed as usize % 7, seed as usize % 6, seed);
        let record = scan.record_planes(&Config::paper(), live_labels(33));
        let of_scan = record.assert_order_of_planes(24);
        for (sum, more) in
            life.iter_mut().zip([of_scan.begun as usize, of_scan.joins, of_scan.resumed, of_scan.reports])
        {
            *sum += more;
        }
        largest += record.segments().values().filter(|segment| segment.pixels() > 100).count();
        let few = scan.record_planes(&Config::paper(), 4);
        full += usize::from(few.unlabelled(33).iter().sum::<u32>() > 0);
    }
    println!("begun, joins, resumed, reports {life:?}; {largest} of 100 pixels; {full} times full");
    let [begun, joins, resumed, reports] = life;
    assert!(begun > 3000 && joins > 300 && resumed > 100 && reports > 2000 && largest > 100 && full > 50);
}
