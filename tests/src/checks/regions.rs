//! The region-based segmenter against the reference, and what must hold of it always.

use crate::art::{Picture, canonical};
use crate::reference::lines::Thresholds;
use crate::reference::regions::{Regions, regions};
use crate::stream::{Record, Scan, class};
use scanseg_core::{Finished, Pixel, RegionConfig, live_labels};

fn expected(scan: &Scan, config: &RegionConfig) -> Regions {
    let thresholds = Thresholds {
        line_angle_rad: config.line_angle_rad.into(),
        range_noise_m: config.ranging.range_noise_m.into(),
        plane_distance_m: config.plane_distance_m.into(),
    };
    regions(&scan.image(&config.ranging), &scan.reference_beams(), &thresholds)
}

/// Compares everything where no decision of the reference is in doubt. Returns whether it did.
pub fn assert_same(scan: &Scan, config: &RegionConfig) -> bool {
    let columns = scan.columns;
    let record = scan.record(*config, live_labels(columns));
    record.assert_order_of_regions(scan.turn_rad.len());
    assert_eq!(record.unlabelled(columns).iter().sum::<u32>(), 0, "pixels without a label");
    assert_counts(scan, &record);
    let expected = expected(scan, config);
    if expected.doubt.doubtful > 0 {
        return false;
    }
    assert_eq!(Picture::bits(columns, &record.edges(columns)), Picture::bits(columns, &expected.breaks));
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    assert_eq!(Picture::classes(columns, &classes), Picture::classes(columns, &expected.classes));
    let labels = canonical(&record.labels());
    assert_eq!(
        Picture::labels(columns, &classes, &labels),
        Picture::labels(columns, &expected.classes, &expected.labels)
    );
    assert_eq!(labels, expected.labels);
    true
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
