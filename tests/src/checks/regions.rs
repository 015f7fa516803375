//! The region-based segmenter against the reference, and what must hold of it always.

use crate::art::{Picture, canonical};
use crate::reference::labels::Class;
use crate::reference::lines::Thresholds;
use crate::reference::regions::{Regions, regions};
use crate::stream::{Record, Scan, class};
use scanseg_core::{Finished, Pixel, RegionConfig, live_labels};

/// Decisions in doubt that are gone both ways.
const MOST_DOUBTS: usize = 4;

/// Ways that are gone, of those doubts and of what they lead to.
const MOST_WAYS: usize = 1 << (2 * MOST_DOUBTS);

/// How much of a scan was compared.
#[derive(Clone, Copy, Debug)]
pub struct Compared {
    /// The first rows, all of whose pixels were.
    pub rows: usize,
    /// Decisions of the reference in the scan that single precision may turn.
    pub doubts: usize,
}

fn expected(scan: &Scan, config: &RegionConfig, given: Vec<bool>) -> Regions {
    let thresholds = Thresholds {
        line_angle_rad: config.line_angle_rad.into(),
        range_noise_m: config.ranging.range_noise_m.into(),
        plane_distance_m: config.plane_distance_m.into(),
    };
    regions(&scan.image(&config.ranging), &scan.reference_beams(), &thresholds, given)
}

/// Compares everything with the reference; where some of its decisions are in doubt, with all that
/// it may find as they fall: one of it must be what was found. With more doubts than are gone both
/// ways, or too many ways, only the rows before that are compared, as a scan that ends there.
pub fn assert_same(scan: &Scan, config: &RegionConfig) -> Compared {
    let columns = scan.columns;
    let record = scan.record(*config, live_labels(columns));
    record.assert_order_of_regions(scan.turn_rad.len());
    assert_eq!(record.unlabelled(columns).iter().sum::<u32>(), 0, "pixels without a label");
    assert_counts(scan, &record);
    let first = expected(scan, config, vec![]);
    let doubts = first.doubt.decided.len();
    if let Some(&row) = first.doubt.rows.get(MOST_DOUBTS) {
        return Compared { doubts, ..assert_same(&scan.cut(row), config) };
    }
    let found = Found::of(&record, columns);
    let mut open: Vec<_> = first.doubt.others().collect();
    let mut ways = 1;
    let mut same = found.is(&first);
    while let Some(given) = open.pop().filter(|_| !same) {
        let other = expected(scan, config, given);
        same = found.is(&other);
        open.extend(other.doubt.others());
        ways += 1;
        if ways == MOST_WAYS {
            // one way leads to doubts that others have not
            let row = first.doubt.rows[doubts - 1];
            return Compared { doubts, ..assert_same(&scan.cut(row), config) };
        }
    }
    if !same {
        let Found { edges, classes, labels } = found;
        println!("none of {ways} ways is what was found");
        assert_eq!(Picture::bits(columns, &edges), Picture::bits(columns, &first.breaks));
        assert_eq!(Picture::classes(columns, &classes), Picture::classes(columns, &first.classes));
        let expected = Picture::labels(columns, &first.classes, &first.labels);
        assert_eq!(Picture::labels(columns, &classes, &labels), expected);
        // a picture does not tell all labels apart
        assert_eq!(labels, first.labels);
    }
    Compared { rows: scan.turn_rad.len(), doubts }
}

/// What the core found.
struct Found {
    edges: Vec<bool>,
    classes: Vec<Class>,
    labels: Vec<u32>,
}

impl Found {
    fn of(record: &Record, columns: usize) -> Found {
        let classes = record.pixels().into_iter().map(class).collect();
        Found { edges: record.edges(columns), classes, labels: canonical(&record.labels()) }
    }

    fn is(&self, expected: &Regions) -> bool {
        self.edges == expected.breaks && self.classes == expected.classes && self.labels == expected.labels
    }
}

/// Every segment counts the pixels of its label.
pub fn assert_counts(scan: &Scan, record: &Record) {
    let labels = record.labels();
    let mut counted = std::collections::BTreeMap::new();
    for &label in labels.iter().filter(|&&label| label != 0) {
        *counted.entry(label).or_insert(0) += 1;
    }
    let segments = record.segments();
    assert_eq!(
        segments.values().map(|s| (s.label.0, s.pixels())).collect::<std::collections::BTreeMap<_, _>>(),
        counted
    );
    for (pixel, &label) in scan.size().pixels().zip(&labels).filter(|&(_, &label)| label != 0) {
        let segment = segments[&label];
        let rows = usize::from(segment.first_row)..=usize::from(segment.last_row);
        let columns = usize::from(segment.first_column)..=usize::from(segment.last_column);
        assert!(rows.contains(&pixel.0) && columns.contains(&pixel.1), "{pixel:?} {segment:?}");
    }
}

/// With a table that is too small: lines go without a label only where nothing that touches them
/// has one that takes them, and everything that is told still adds up.
pub fn assert_consistent(scan: &Scan, config: &RegionConfig, areas: usize) {
    let record = scan.record(*config, areas);
    record.assert_order_of_regions(scan.turn_rad.len());
    assert_counts(scan, &record);
    let full = scan.record(*config, live_labels(scan.columns));
    assert_eq!(record.edges(scan.columns), full.edges(scan.columns));
    let classes = |record: &Record| record.pixels().into_iter().map(class).collect::<Vec<_>>();
    assert_eq!(classes(&record), classes(&full));
    // no two segments, or none and one, can share a run
    let unlabelled = record.pixels().iter().filter(|&&pixel| pixel == Pixel::Unlabelled).count() as u32;
    let rows = scan.turn_rad.len();
    assert_eq!(record.finished, Some(Finished::Complete { rows, unlabelled }));
}
