//! The plane segmenter against the reference, and what must hold of it always.

use crate::reference::labels::Class;
use crate::reference::row_lines::{LINE, RowOfLines};
use crate::stream::{Event, Record, Scan, class};
use nalgebra::{Matrix4, Vector3};
use scanseg_core::{Finished, Pixel, Plane, PlaneConfig, Segment, live_labels};
use std::collections::{BTreeMap, BTreeSet};

/// Every label of the end is one segment, which has its pixels and its bounds, and edges are what
/// has no area.
pub fn assert_adds_up(scan: &Scan, config: &PlaneConfig, record: &Record) {
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
    let image = scan.image(&config.ranging);
    for (pixel, class) in scan.size().pixels().zip(classes) {
        assert_eq!(class == Class::NoReturn, image.range(pixel).is_none(), "{pixel:?}");
    }
}

/// Compares the lines of a scan of one row with the cheapest ones: they cost at most twice as much.
/// Returns whether they cost the same.
pub fn assert_lines(scan: &Scan, config: &PlaneConfig) -> bool {
    let record = scan.record(*config, live_labels(scan.columns).max(scan.columns));
    let row = RowOfLines::new(&scan.image(&config.ranging), &scan.reference_beams(), &config.ranging);
    let (found, best) = (row.price(&record.labels()), row.least());
    assert!(found > best - 0.01 - 1e-3 * best && found < 2.0 * best + LINE, "{found} {best} {scan:?} {config:?}");
    found < best + 0.01 + 1e-3 * best
}

/// With a table that is too small: pixels without a label are counted, all of a line or none, and
/// only where the row has as many areas, or joins of them, as the table has room; everything else
/// still adds up.
pub fn assert_consistent(scan: &Scan, config: &PlaneConfig, areas: usize) {
    let record = scan.record(*config, areas);
    record.assert_order_of_planes(scan.turn_rad.len());
    assert_adds_up(scan, config, &record);
    let pixels = record.pixels();
    let unlabelled = pixels.iter().filter(|&&pixel| pixel == Pixel::Unlabelled).count() as u32;
    let rows = scan.turn_rad.len();
    assert_eq!(record.finished, Some(Finished::Complete { rows, unlabelled }));
    // planes are carried on below three missing pixels
    let mut above: [BTreeSet<u32>; 4] = Default::default();
    let (mut row, mut joined) = (0, 0);
    for event in &record.events {
        match event {
            Event::Join(_) => joined += 1,
            Event::Row { pixels, .. } => {
                let label = |pixel: &Pixel| if let Pixel::Segment(label) = pixel { Some(label.0) } else { None };
                let here: BTreeSet<_> = pixels.iter().filter_map(label).collect();
                // areas of the rows above may not have been known to end yet
                let most = above.iter().fold(here.clone(), |all, row| &all | row).len() + joined;
                let full = pixels.contains(&Pixel::Unlabelled);
                assert!(!full || most >= areas, "row {row}: {most} of {areas} areas");
                above.rotate_right(1);
                (above[0], row, joined) = (here, row + 1, 0);
            }
            _ => {}
        }
    }
}

/// The normal is a unit vector; the covariance is symmetric, positive semi-definite and of rank 3.
pub fn assert_sound(plane: &Plane) {
    let normal = Vector3::from(plane.normal.map(f64::from));
    assert!((normal.norm() - 1.0).abs() < 1e-6 && plane.distance_m > 0.0, "{plane:?}");
    let covariance = covariance(plane);
    assert_eq!(covariance, covariance.transpose());
    let mut values: Vec<f64> = covariance.symmetric_eigenvalues().iter().copied().collect();
    values.sort_by(f64::total_cmp);
    assert!(values[0].abs() < 1e-6 * values[3] && values[1] > 0.0, "{values:?}");
    assert!((covariance * normal.push(0.0)).norm() < 1e-5 * values[3], "along the normal");
}

/// The covariance of a plane.
pub fn covariance(plane: &Plane) -> Matrix4<f64> {
    Matrix4::from_fn(|i, j| plane.covariance[i][j].into())
}
