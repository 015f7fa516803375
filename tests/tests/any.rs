//! What holds of all approaches alike: chosen at run time they do what they do by themselves, and
//! every sink is told all.

use crate::common::{edge_configs, plane_configs, region_configs, scans};
use proptest::prelude::*;
use scanseg_core::{
    AnyConfig, AnySegmenter, Approach, EdgeConfig, EdgeSegmenter, Finished, MAX_LATENCY_ROWS, PlaneConfig,
    PlaneSegmenter, Ranging, RegionConfig, RegionSegmenter, Segmenter, Sink, Status, live_labels,
};
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::{Event, Record, Room, Scan};

/// Everything that can be done with a segmenter: a scan that is dropped, one that is broken off, a
/// whole one.
fn use_all(scan: &Scan, other: &Scan, break_at: usize, segmenter: &mut impl Segmenter) -> [Record; 3] {
    let mut dropped = Record::default();
    for row in 0..other.turn_rad.len() {
        let status = segmenter.push_row(other.row_m(row), other.turn_rad[row], &mut dropped).unwrap();
        dropped.statuses.push(status);
    }
    segmenter.reset();
    let mut broken = Record { break_at: Some(break_at), ..Record::default() };
    scan.feed(segmenter, &mut broken).unwrap();
    let mut whole = Record::default();
    scan.feed(segmenter, &mut whole).unwrap();
    [dropped, broken, whole]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn chosen_at_run_time(
        scan in scans(12), plane in plane_configs(), edge in edge_configs(), region in region_configs(), index in 0usize..30,
    ) {
        let (columns, other) = (scan.columns, Scan { rig: scan.rig.clone(), ..scan_of(7, scan.columns, 0, 2, 8) });
        for config in [AnyConfig::from(plane), AnyConfig::from(edge), AnyConfig::from(region)] {
            let areas = live_labels(columns);
            let mut room = Room::new(columns, config, areas);
            let own = match config {
                AnyConfig::Plane(config) => {
                    let mut segmenter = PlaneSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
                    use_all(&scan, &other, index, &mut segmenter)
                }
                AnyConfig::Edge(config) => {
                    let mut segmenter = EdgeSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
                    use_all(&scan, &other, index, &mut segmenter)
                }
                AnyConfig::Region(config) => {
                    let mut segmenter = RegionSegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
                    use_all(&scan, &other, index, &mut segmenter)
                }
                _ => panic!("an approach without a test: {config:?}"),
            };
            let mut room = Room::new(columns, config, areas);
            let mut segmenter = AnySegmenter::new(config, scan.beams(), columns, room.memory()).unwrap();
            let chosen = use_all(&scan, &other, index, &mut segmenter);
            prop_assert_eq!(&chosen, &own);
            prop_assert_eq!(&chosen[2], &scan.record(config, areas));
        }
    }
}

const RANGING: Ranging = Ranging::new(0.02).with_limits(0.1, 50.0);

fn configs() -> [AnyConfig<'static>; 3] {
    let (edge, region) = (EdgeConfig::paper().with_ranging(RANGING), RegionConfig::paper().with_ranging(RANGING));
    [PlaneConfig::new(RANGING).into(), edge.into(), region.into()]
}

/// A scan with all kinds of events.
fn eventful() -> Scan {
    scan_of(9, 40, 3, 3, 5)
}

#[test]
fn a_configuration_knows_its_approach() {
    assert_eq!(configs().map(|config| config.approach()), [Approach::Plane, Approach::Edge, Approach::Region]);
    assert_eq!(Approach::default(), Approach::Plane);
    for config in configs() {
        assert_eq!(config.ranging(), RANGING);
    }
    let sizes = [
        PlaneConfig::new(RANGING).sizes(77),
        EdgeConfig::paper().with_ranging(RANGING).sizes(77),
        RegionConfig::paper().with_ranging(RANGING).sizes(77),
    ];
    assert_eq!(configs().map(|config| config.sizes(77)), sizes);
}

/// Row r is given out when row r + 3 is pushed, and the last three when the scan is finished; by
/// the other approaches at once. No approach waits for more rows than is said.
#[test]
fn latency() {
    let scan = eventful();
    let rows = scan.turn_rad.len();
    let mut longest = 0;
    for (config, latency_rows) in configs().into_iter().zip([0, 3, 0]) {
        let mut room = Room::new(scan.columns, config, live_labels(scan.columns));
        let mut segmenter = AnySegmenter::new(config, scan.beams(), scan.columns, room.memory()).unwrap();
        assert_eq!(segmenter.latency_rows(), latency_rows);
        longest = longest.max(latency_rows);
        let mut record = Record::default();
        let rows_given = |record: &Record| record.pixels().len() / scan.columns;
        for row in 0..rows {
            let status = segmenter.push_row(scan.row_m(row), scan.turn_rad[row], &mut record).unwrap();
            let labelled = row.checked_sub(latency_rows).map(|row| Status::Labelled { row, unlabelled: 0 });
            assert_eq!(status, labelled.unwrap_or(Status::Buffered));
            assert_eq!(rows_given(&record), (row + 1).saturating_sub(latency_rows));
        }
        assert_eq!(segmenter.finish(&mut record), Finished::Complete { rows, unlabelled: 0 });
        assert_eq!(rows_given(&record), rows);
    }
    assert_eq!(longest, MAX_LATENCY_ROWS);
}

/// Debug output of a segmenter tells what is set and how far the scan has come.
#[test]
fn segmenters_as_text() {
    let scan = eventful();
    for (config, name) in configs().into_iter().zip(["Plane", "Edge", "Region"]) {
        let mut room = Room::new(scan.columns, config, 4);
        let mut segmenter = AnySegmenter::new(config, scan.beams(), scan.columns, room.memory()).unwrap();
        for row in 0..2 {
            segmenter.push_row(scan.row_m(row), scan.turn_rad[row], &mut Record::default()).unwrap();
        }
        let text = format!("{segmenter:?}");
        for part in [&format!("{name}Segmenter"), "range_noise_m: 0.02", "columns: 40", "rows: 2"] {
            assert!(text.contains(part), "{part}: {text}");
        }
        assert!(text.len() < 1000, "{text}");
    }
}

/// A sink behind a reference, and one of a type that is not known, is told what any sink is.
#[test]
fn sinks_behind_references() {
    let scan = eventful();
    for config in configs() {
        let expected = scan.record(config, live_labels(scan.columns));
        for kind in
            [|event: &Event| matches!(event, Event::Segment(_)), |event: &Event| matches!(event, Event::Row { .. })]
        {
            assert!(expected.events.iter().any(kind));
        }
        let mut records = [(); 2].map(|()| Record::default());
        let [by_reference, by_dyn] = &mut records;
        let by_dyn: &mut dyn Sink = by_dyn;
        for_each_row(&scan, config, by_reference);
        for_each_row(&scan, config, by_dyn);
        for record in records {
            assert_eq!(record.events, expected.events);
        }
    }
}

/// Gives the sink to the segmenter by one reference more.
fn for_each_row<S: Sink + ?Sized>(scan: &Scan, config: AnyConfig, mut sink: &mut S) {
    let mut room = Room::new(scan.columns, config, live_labels(scan.columns));
    let mut segmenter = AnySegmenter::new(config, scan.beams(), scan.columns, room.memory()).unwrap();
    for row in 0..scan.turn_rad.len() {
        segmenter.push_row::<&mut S>(scan.row_m(row), scan.turn_rad[row], &mut sink).unwrap();
    }
    segmenter.finish::<S>(sink);
}
