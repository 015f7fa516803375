//! What is reported of a scan of any approach agrees with its labels. Without a reference: the planes
//! are fitted anew.

use crate::common::scans;
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;
use scanseg_core::{AnyConfig, Pixel, Ranging};
use scanseg_tests::walls::{Kind, View, by_edges, by_planes, by_regions, direction, room};

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    /// Every return is labelled, on no plane, or counted as unlabelled, with a table of any size, and
    /// nothing else is; the segments have the labelled pixels, each once.
    ///
    /// Kills: counts that forget the rows of `finish`; pixels of a segment that was joined twice.
    #[test]
    fn every_return_is_told(scan in scans(24), approach in 0usize..3, noise_m in 0.0f64..0.05, share in 0.0f64..1.0) {
        let config: AnyConfig = [by_planes, by_edges, by_regions][approach](noise_m);
        let areas = 1 + (share * 2.0 * scan.columns as f64) as usize;
        let record = scan.record(config, areas);
        let Ranging { min_range_m, max_range_m, .. } = config.ranging();
        let (mut labelled, mut unlabelled) = (0, 0);
        for (pixel, range_m) in record.pixels().into_iter().zip(&scan.range_m) {
            prop_assert_eq!(pixel == Pixel::NoReturn, !(min_range_m..=max_range_m).contains(range_m));
            labelled += u32::from(matches!(pixel, Pixel::Segment(_)));
            unlabelled += u32::from(pixel == Pixel::Unlabelled);
        }
        prop_assert_eq!(record.pixels().len(), scan.range_m.len());
        let labels = record.labels();
        let of_segments: u32 = record.segments().values().filter(|segment| labels.contains(&segment.label.0))
            .map(|segment| segment.pixels()).sum();
        prop_assert_eq!(of_segments, labelled);
        let rows = scan.turn_rad.len();
        prop_assert_eq!(record.finished, Some(scanseg_core::Finished::Complete { rows, unlabelled }));
    }
}

/// The plane u . m = 1 / r of least squares of the range errors.
fn refit(points: &[(Vector3<f64>, f64)]) -> Vector3<f64> {
    let mut m = Vector3::zeros();
    for step in 0..6 {
        let (mut left, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for (u, range_m) in points {
            let q = if step == 0 { 1.0 / range_m } else { u.dot(&m) };
            let error = if step == 0 { q } else { q * (1.0 - range_m * q) };
            left += u * u.transpose() / q.powi(4);
            right += u * (error / q.powi(4));
        }
        m += left.try_inverse().expect("no line") * right;
    }
    m
}

/// The planes of the large segments of rooms agree with a refit from the labels: within three
/// standard deviations of normal and distance, as the plane says them, and what the weights differ
/// by (1e-3).
#[test]
fn planes_are_those_of_their_pixels() {
    let mut compared = 0;
    for (seed, noise_m, config) in [
        (1, 0.01, by_planes(0.01)),
        (2, 0.005, by_planes(0.005)),
        (3, 0.0, by_planes(0.0)),
        (4, 0.0, by_edges(0.0)),
        (5, 0.005, by_regions(0.005)),
        (6, 0.01, by_regions(0.01)),
    ] {
        for kind in [Kind::Tilting, Kind::Panning, Kind::Around, Kind::Camera] {
            let step_rad = 1f32.to_radians();
            let columns = if kind == Kind::Around { 360 } else { 100 };
            let view = View { kind, rows: 100, columns, column_rad: step_rad, row_rad: -step_rad, middle_rad: 0.0 };
            let drawn = view.of(&room([3.0, 4.0, 2.0, 3.0, 1.5, 1.2], 0.4), noise_m, seed);
            let (record, scan) = (drawn.record(config), &drawn.scan);
            let labels = record.labels();
            for (label, segment) in record.segments() {
                let of_it =
                    scan.size().pixels().zip(&labels).zip(&scan.range_m).filter(|((_, other), _)| **other == label);
                let points: Vec<_> = of_it
                    .map(|((pixel, _), &range_m)| (direction(&scan.rig, scan.turn_rad[pixel.0], pixel), range_m.into()))
                    .collect();
                if points.len() < 300 {
                    continue;
                }
                let Some(found) = segment.plane() else { panic!("{kind:?} {seed}: {segment:?}") };
                let m = refit(&points);
                let (distance_m, normal) = (1.0 / m.norm(), -m.normalize());
                let sd = |i: usize| f64::from(found.covariance[i][i]).sqrt();
                for (i, &one) in found.normal.iter().enumerate() {
                    let off = (f64::from(one) - normal[i]).abs();
                    assert!(off < 3.0 * sd(i) + 1e-3, "{kind:?} {seed}: {normal} {found:?}");
                }
                let off_m = (f64::from(found.distance_m) - distance_m).abs();
                assert!(off_m < 3.0 * sd(3) + 1e-3, "{kind:?} {seed}: {distance_m} {found:?}");
                compared += 1;
            }
        }
    }
    println!("{compared} planes");
    assert!(compared > 60, "{compared}");
}
