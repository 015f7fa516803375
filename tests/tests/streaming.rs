//! The streaming segmenter finds what the reference finds in the whole image, given the same
//! bearing angles.

use crate::common::{edge_configs, scans};
use proptest::prelude::*;
use scanseg_core::{EdgeConfig, Element, Trace, live_labels};
use scanseg_tests::art::{Picture, canonical};
use scanseg_tests::checks::edges::{assert_consistent, assert_same};
use scanseg_tests::reference::labels;
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::class;

proptest! {
    #![proptest_config(ProptestConfig::with_cases(CASES))]

    #[test]
    fn same_as_the_reference(scan in scans(40), config in edge_configs()) {
        assert_same(&scan, &config);
    }

    #[test]
    fn consistent_with_few_labels(scan in scans(24), config in edge_configs(), share in 0.0f64..1.0) {
        let areas = 1 + (share * share * (live_labels(scan.columns) - 1) as f64) as usize;
        assert_consistent(&scan, &config, areas);
    }
}

const CASES: u32 = 250;

/// Area pixels are exactly those with a return: no roofs, no steps.
fn only_holes() -> EdgeConfig<'static> {
    let along_rows = EdgeConfig::paper().with_traces(&[Trace::ROW]);
    along_rows.with_roof_angle_rad(std::f32::consts::PI).with_step_angle_rad(0.0)
}

/// Every 3 x 4 image of holes, and every 4 x 3, in every table of live labels that could be too
/// small.
#[test]
fn every_small_pattern() {
    for (rows, columns) in [(3, 4), (4, 3), (2, 6), (12, 1), (1, 12)] {
        for wraps in [0, 4] {
            let mut scan = scan_of(rows, columns, wraps, 0, 0);
            for bits in 0..1 << 12 {
                for (i, range_m) in scan.range_m.iter_mut().enumerate() {
                    *range_m = if bits >> i & 1 == 1 { 2.0 } else { 0.0 };
                }
                let record = scan.record(only_holes(), live_labels(columns));
                let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
                let expected = labels::labels(scan.size(), &classes);
                assert_eq!(canonical(&record.labels()), expected, "{}", Picture::labels(columns, &classes, &expected));
                record.assert_order(rows);
            }
        }
    }
}

/// The generator does make what the comparison is about.
#[test]
fn scans_are_of_all_kinds() {
    let [mut segments, mut planes, mut covariances, mut joins, mut lost] = [0; 5];
    for seed in 0..60 {
        let scan = scan_of(20, 33, seed as usize % 7, seed as usize % 6, seed);
        for config in [EdgeConfig::paper(), only_holes().with_closing(Element::Square)] {
            let compared = assert_same(&scan, &config);
            segments += compared[0];
            planes += compared[1];
            covariances += compared[2];
            let events = scan.record(config, live_labels(33)).events;
            joins += events.iter().filter(|event| matches!(event, scanseg_tests::stream::Event::Join(_))).count();
            lost += assert_consistent(&scan, &config, 3);
        }
    }
    println!(
        "{segments} segments, {planes} planes, {covariances} covariances, {joins} joins, {lost} pixels unlabelled"
    );
    assert!(segments > 500 && planes > 100 && covariances > 20 && joins > 200 && lost > 200);
}

/// The checkerboard of holes needs floor((columns + 1) / 2) live labels at once, and so on: the
/// worst case is met.
#[test]
fn worst_case_of_live_labels() {
    for columns in 1..70 {
        let mut scan = scan_of(6, columns, 0, 0, 0);
        for (row, column) in scan.size().pixels() {
            scan.range_m[row * columns + column] = if (row + column).is_multiple_of(2) { 2.0 } else { 0.0 };
        }
        assert_eq!(assert_consistent(&scan, &only_holes(), live_labels(columns)), 0);
        if columns > 3 {
            assert!(assert_consistent(&scan, &only_holes(), live_labels(columns) - 2) > 0, "{columns} columns");
        }
    }
}
