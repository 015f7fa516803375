//! What must hold of every scan, whatever is in it.

use crate::common::{edge_configs, scans};
use proptest::prelude::*;
use scanseg_core::{
    COUNTS_PER_RAD, EdgeConfig, EdgeSegmenter, Finished, MAX_ERROR_RAD, MAX_ROWS, PushError, Ranging, Segmenter,
    Status, Trace, TurnAxis, live_labels,
};
use scanseg_tests::art::{Picture, canonical};
use scanseg_tests::reference::edges;
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::{Angles, Event, Record, Rig, Room, Scan, settings};
use std::f32::consts::{FRAC_PI_2, PI};

const CASES: u32 = 100;

/// What a fresh segmenter reports, with room for all labels.
fn fresh(scan: &Scan, config: &EdgeConfig) -> Record {
    scan.record(*config, live_labels(scan.columns))
}

/// What a segmenter with a table of `areas` live labels reports of `scan` after `before` was done
/// with it.
fn after(scan: &Scan, config: &EdgeConfig, areas: usize, before: impl FnOnce(&mut EdgeSegmenter)) -> Record {
    let mut room = Room::new(scan.columns, *config, areas);
    let mut segmenter = EdgeSegmenter::new(*config, scan.beams(), scan.columns, room.memory()).unwrap();
    before(&mut segmenter);
    let mut record = Record::default();
    scan.feed(&mut segmenter, &mut record).unwrap();
    record
}

/// Pushes the first rows without finishing.
fn push(scan: &Scan, rows: usize, segmenter: &mut EdgeSegmenter, record: &mut Record) {
    for row in 0..rows {
        let status = segmenter.push_row(scan.row_m(row), scan.turn_rad[row], record).unwrap();
        record.statuses.push(status);
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    /// Metres or feet: scaling by a power of two, which is exact, changes no bearing angle and no
    /// edge.
    #[test]
    fn unit_of_length(scan in scans(16), config in edge_configs(), exponent in -6i32..=2) {
        let factor = f32::from(exponent as i8).exp2();
        let scaled = Scan { range_m: scan.range_m.iter().map(|range_m| range_m * factor).collect(), ..scan.clone() };
        let Ranging { range_noise_m, min_range_m, max_range_m, .. } = config.ranging;
        let ranging = Ranging::new(range_noise_m * factor).with_limits(min_range_m * factor, max_range_m * factor);
        let scaled_config = config.with_ranging(ranging);
        for &trace in config.traces {
            prop_assert_eq!(scan.counts(&config.ranging, trace), scaled.counts(&ranging, trace));
        }
        let columns = scan.columns;
        let (record, scaled) = (fresh(&scan, &config), fresh(&scaled, &scaled_config));
        prop_assert_eq!(record.edges(columns), scaled.edges(columns));
        prop_assert_eq!(record.pixels(), scaled.pixels());
    }

    /// A scan cut anywhere is a scan: it is what the reference finds in the rows pushed, and until
    /// the cut everything comes as in the whole scan.
    #[test]
    fn cut_anywhere(scan in scans(24), config in edge_configs(), part in 0.0f64..1.0) {
        let rows = (part * scan.turn_rad.len() as f64) as usize;
        let cut = scan.cut(rows);
        let record = fresh(&cut, &config);
        record.assert_order(rows);
        let expected = cut.expected(&config);
        prop_assert_eq!(record.edges(scan.columns), expected.edges);
        prop_assert_eq!(canonical(&record.labels()), expected.labels);
        prop_assert_eq!(record.finished, Some(Finished::Complete { rows, unlabelled: 0 }));

        let whole = fresh(&scan, &config);
        prop_assert_eq!(&whole.statuses[..rows], &record.statuses[..]);
        let mut pushed = Record::default();
        after(&scan, &config, live_labels(scan.columns), |segmenter| push(&scan, rows, segmenter, &mut pushed));
        prop_assert_eq!(&whole.events[..pushed.events.len()], &pushed.events[..]);
    }

    /// What came before leaves no trace: a whole scan, one dropped by `reset`, rows that were
    /// refused, a scan broken off.
    #[test]
    fn every_scan_starts_clean(
        scan in scans(16), config in edge_configs(), other in any::<u64>(), part in 0.0f64..1.0, index in 0usize..40,
    ) {
        let (rows, columns) = (scan.turn_rad.len(), scan.columns);
        // often too few, so that pixels without a label are counted
        let areas = 1 + (index * columns) % live_labels(columns);
        let expected = scan.record(config, areas);
        let kind = (other % 6) as usize;
        let other = Scan { rig: scan.rig.clone(), ..scan_of(20, columns, 0, kind, other) };
        let some = 1 + (part * 19.0) as usize;
        let mut ignored = Record::default();
        let finished = after(&scan, &config, areas, |segmenter| other.feed(segmenter, &mut ignored).unwrap());
        prop_assert_eq!(&finished, &expected);
        let dropped = after(&scan, &config, areas, |segmenter| {
            push(&other, some, segmenter, &mut ignored);
            segmenter.reset();
        });
        prop_assert_eq!(&dropped, &expected);
        let stopped = after(&scan, &config, areas, |segmenter| {
            let mut record = Record { break_at: Some(index), ..Record::default() };
            other.feed(segmenter, &mut record).unwrap();
        });
        prop_assert_eq!(&stopped, &expected);

        // refused rows in between, in every place
        let mut room = Room::new(columns, config, areas);
        let mut segmenter = EdgeSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
        let mut record = Record::default();
        for row in 0..rows {
            refuse(&mut segmenter, columns, &mut record);
            let status = segmenter.push_row(scan.row_m(row), scan.turn_rad[row], &mut record).unwrap();
            record.statuses.push(status);
        }
        refuse(&mut segmenter, columns, &mut record);
        record.finished = Some(segmenter.finish(&mut record));
        prop_assert_eq!(record, expected);
    }

    /// Edges of a mirrored scan, up to the rounding of bearing angles: an edge by a threshold that
    /// is stricter than the rounding must be one in the mirror, and what is one there must be one
    /// by a laxer threshold.
    ///
    /// A bearing angle is kept at the later pixel of its pair, which along the row is the earlier
    /// one in the mirror: there the mirror image is shifted by one column, and BA' = pi - Phi - BA.
    /// Along a column BA' = BA.
    #[test]
    fn mirrored(
        rows in 1usize..12, columns in crate::common::columns(), scene in 0usize..6, seed: u64, config in edge_configs(), z: bool,
    ) {
        let axis = if z { TurnAxis::Z } else { TurnAxis::Y };
        let step_rad = 0.01f32;
        let angles = Angles::Even { start_rad: -0.5 * step_rad * (columns - 1) as f32, step_rad };
        let scan = Scan { rig: Rig::Nodding { angles, axis }, ..scan_of(rows, columns, 0, scene, seed) };
        let mut mirror = scan.clone();
        mirror.range_m.chunks_mut(columns).for_each(|row| row.reverse());

        // of two counts, and the error of each angle
        let rounding = 1.1 + 2.0 * f64::from(MAX_ERROR_RAD * COUNTS_PER_RAD);
        for trace in [Trace::ROW, Trace::COLUMN] {
            let along_row = trace == Trace::ROW;
            // column c is column `columns - 1 - c` in the mirror, less one along the row
            let last = if along_row { columns } else { columns - 1 };
            let (counts, mirrored) = (scan.counts(&config.ranging, trace), mirror.counts(&config.ranging, trace));
            let phi = if along_row { f64::from(step_rad) } else { 0.0 };
            let phi_counts = phi * 65535.0 / std::f64::consts::PI;
            for (row, column) in scan.size().pixels().filter(|&(_, column)| !along_row || column > 0) {
                let one = f64::from(counts[row * columns + column]);
                let other = f64::from(mirrored[row * columns + last - column]);
                prop_assert_eq!(one == 0.0, other == 0.0);
                let sum = if along_row { 65535.0 - phi_counts - one } else { one };
                // both are rounded, and not to 0
                prop_assert!(one == 0.0 || (sum - other).abs() <= rounding, "{} {}", one, other);
            }

            // the rounding either way at each of Sobel's weights, 8 for |gx| and 8 for |gy|, and
            // the steps' Phi
            let traces = [trace];
            let config = config.with_traces(&traces);
            let (eighths, steps) = (16 * (rounding / 8.0).ceil() as i32, rounding.ceil() + phi_counts.ceil());
            let bounds = [(eighths, -steps), (-eighths, steps)].map(|(eighths, steps)| {
                let mut settings = settings(&config);
                settings.roof_eighths = settings.roof_eighths.saturating_add_signed(eighths);
                settings.step_counts = (f64::from(settings.step_counts) + steps).max(0.0) as u32;
                edges::edges(&scan.image(&config.ranging), &settings, std::slice::from_ref(&counts))
            });
            let found = fresh(&mirror, &config).edges(columns);
            for (row, column) in scan.size().pixels().filter(|&(_, column)| !along_row || column > 0) {
                let [strict, lax] = [0, 1].map(|i| bounds[i][row * columns + column]);
                let found = found[row * columns + last - column];
                let at = (trace, row, column);
                prop_assert!(strict <= found && found <= lax, "{:?}: {} {} {}", at, strict, found, lax);
            }
        }
    }
}

/// Rows that cannot be taken are refused by name and value, and nothing is reported.
fn refuse(segmenter: &mut EdgeSegmenter, columns: usize, record: &mut Record) {
    let events = record.events.len();
    for got in [0, columns - 1, columns + 1] {
        let refused = segmenter.push_row(&vec![2.0; got], 0.0, record);
        assert_eq!(refused, Err(PushError::RowLength { expected: columns, got }));
    }
    let row = vec![2.0; columns];
    for turn_rad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 6301.0, -6301.0] {
        match segmenter.push_row(&row, turn_rad, record) {
            Err(PushError::TurnAngle { turn_rad: got }) => assert_eq!(got.to_bits(), turn_rad.to_bits()),
            other => panic!("{turn_rad}: {other:?}"),
        }
    }
    assert_eq!(record.events.len(), events);
}

/// A scan with all kinds of events, many of each, and a few rows.
fn eventful() -> (Scan, EdgeConfig<'static>) {
    let config = EdgeConfig::paper().with_roof_angle_rad(PI).with_step_angle_rad(0.0);
    let is_eventful = |scan: &Scan| {
        let events = fresh(scan, &config).events;
        let count = |wanted: fn(&Event) -> bool| events.iter().filter(|event| wanted(event)).count();
        count(|event| matches!(event, Event::Join(_))) > 5 && count(|event| matches!(event, Event::Segment(_))) > 10
    };
    let scan = (0..200).map(|seed| scan_of(9, 40, 3, 3, seed)).find(is_eventful).unwrap();
    (scan, config)
}

/// The sink may break off at any event: nothing follows, and the next scan is clean.
#[test]
fn break_at_any_event() {
    let (scan, config) = eventful();
    let whole = fresh(&scan, &config);
    for index in 0..whole.events.len() {
        let mut broken = Record { break_at: Some(index), ..Record::default() };
        let next =
            after(&scan, &config, live_labels(scan.columns), |segmenter| scan.feed(segmenter, &mut broken).unwrap());
        assert_eq!(broken.events, whole.events[..=index], "nothing after the event");
        if broken.finished.is_none() {
            assert_eq!(broken.statuses.last(), Some(&Status::Stopped));
            let kept = broken.statuses.len() - 1;
            assert_eq!(broken.statuses[..kept], whole.statuses[..kept]);
        } else {
            assert_eq!(broken.finished, Some(Finished::Stopped));
        }
        assert_eq!(next, whole);
    }
}

/// A scan of no rows is complete.
#[test]
fn no_rows() {
    let (scan, config) = eventful();
    let record = fresh(&scan.cut(0), &config);
    assert_eq!(record.events, []);
    assert_eq!(record.finished, Some(Finished::Complete { rows: 0, unlabelled: 0 }));
}

/// One row more than a scan may have is refused; the scan can be finished, and the next one starts
/// clean.
#[test]
fn too_many_rows() {
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: 0.0, step_rad: 0.01 }, axis: TurnAxis::Y };
    let scan = Scan { columns: 1, range_m: vec![2.0; MAX_ROWS], turn_rad: vec![0.0; MAX_ROWS], rig };
    let config = EdgeConfig::paper();
    let mut room = Room::new(1, config, 1);
    let mut segmenter = EdgeSegmenter::new(config, scan.beams(), 1, room.memory()).unwrap();
    let mut record = Record::default();
    push(&scan, MAX_ROWS, &mut segmenter, &mut record);
    let events = record.events.len();
    assert_eq!(segmenter.push_row(&[2.0], 0.0, &mut record), Err(PushError::TooManyRows { max_rows: MAX_ROWS }));
    assert_eq!(record.events.len(), events);
    record.finished = Some(segmenter.finish(&mut record));
    record.assert_order(MAX_ROWS);
    let segments = record.segments();
    assert_eq!(segments.len(), 1);
    assert_eq!((segments[&1].pixels(), segments[&1].first_row, segments[&1].last_row), (65_535, 0, 65_534));
    let mut next = Record::default();
    scan.cut(5).feed(&mut segmenter, &mut next).unwrap();
    assert_eq!(next, scan.cut(5).record(config, 1));
}

/// A column image of a scan whose list of column angles is its own mirror image is mirrored
/// exactly.
#[test]
fn mirrored_exactly() {
    let columns = 45;
    let half: Vec<f32> = (1..=columns / 2).map(|i| 0.03 * i as f32 + 0.01 * (i as f32).sin()).collect();
    let list: Vec<f32> = half.iter().rev().map(|angle| -angle).chain([0.0]).chain(half.iter().copied()).collect();
    let config = EdgeConfig::paper().with_traces(&[Trace::COLUMN]).with_step_angle_rad(FRAC_PI_2);
    for scene in 0..6 {
        let rig = Rig::Nodding { angles: Angles::Listed(list.clone()), axis: TurnAxis::Y };
        let scan = Scan { rig, ..scan_of(20, columns, 0, scene, 5) };
        let mut mirror = scan.clone();
        mirror.range_m.chunks_mut(columns).for_each(|row| row.reverse());
        let (record, mirrored) = (fresh(&scan, &config), fresh(&mirror, &config));
        let mut edges = record.edges(columns);
        edges.chunks_mut(columns).for_each(|row| row.reverse());
        assert_eq!(Picture::bits(columns, &edges), Picture::bits(columns, &mirrored.edges(columns)));
    }
}
