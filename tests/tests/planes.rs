//! The planes of large, far surfaces.

use nalgebra::Vector3;
use scanseg_core::{EdgeConfig, MAX_COLUMNS, MAX_RANGE_M, Ranging, Segment, SegmentSums, TurnAxis, live_labels};
use scanseg_tests::reference::planes::fit_plane;
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Rig, Scan};
use std::f32::consts::{FRAC_PI_2, PI};

/// Whether the sums of a segment of the paper's approaches are exact.
fn is_exact(segment: &Segment) -> bool {
    matches!(segment.sums, SegmentSums::Moments(moments) if moments.is_exact())
}

/// A million points on a plane 30 m away, oblique, with noise of 5 mm: the core's plane agrees with
/// total least squares in f64 of the true points. (The core rounds them to 0.24 mm; that adds 0.07
/// mm to the noise, 1e-4 of its square.)
#[test]
fn a_million_points_30_m_away() {
    let (rows, columns) = (1000, 1000);
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.1, step_rad: 2e-4 }, axis: TurnAxis::Y };
    let turn_rad = (0..rows).map(|row| 0.1 + 2e-4 * row as f32).collect();
    let normal = Vector3::new(0.8, 0.48, -0.36);
    let mut scan = Scan::of(columns, turn_rad, rig, |direction| 30.0 / normal.dot(&Vector3::from(direction)));
    for (i, range_m) in scan.range_m.iter_mut().enumerate() {
        let gauss = (0..4).map(|k| uniform(3, i, k)).sum::<f64>() - 2.0;
        *range_m += (0.005 * 3f64.sqrt() * gauss) as f32;
    }
    // no edges at all
    let config = EdgeConfig::paper().with_ranging(Ranging::new(1.0));
    let config = config.with_roof_angle_rad(PI).with_step_angle_rad(FRAC_PI_2);
    let segments = scan.record(config, live_labels(columns)).segments();
    assert_eq!(segments.len(), 1);
    let segment = segments[&1];
    assert_eq!(segment.pixels() as usize, rows * columns);
    assert!(is_exact(&segment));
    let found = segment.plane().unwrap();

    let beams = scan.reference_beams();
    let point = |(pixel, &range_m): ((usize, usize), &f32)| beams.direction(pixel) * f64::from(range_m);
    let points: Vec<_> = scan.size().pixels().zip(&scan.range_m).map(point).collect();
    let expected = fit_plane(&points).unwrap();
    let normal_off = (Vector3::from(found.normal.map(f64::from)) - expected.normal).norm();
    let distance_off = f64::from(found.distance_m) / expected.distance_m - 1.0;
    let rms_off = f64::from(found.rms_m) / expected.rms_m - 1.0;
    println!("normal {normal_off:.1e}, distance {distance_off:.1e}, rms {rms_off:.1e} of {:.4} m", expected.rms_m);
    // the noise is that of the range, and the incidence oblique
    assert!((0.002..0.005).contains(&expected.rms_m));
    assert!(normal_off < 1e-5 && distance_off.abs() < 1e-5 && rms_off.abs() < 1e-3);
    assert!((expected.distance_m - 30.0).abs() < 1e-3 && (expected.normal + normal).norm() < 1e-4);
    for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
        let scale = (expected.covariance[(i, i)] * expected.covariance[(j, j)]).sqrt();
        let off = f64::from(found.covariance[i][j]) - expected.covariance[(i, j)];
        assert!(off.abs() < 1e-3 * scale, "{i}{j}: off by {:.1e}", off / scale);
    }
}

/// Two halves of a wall at the largest range, which the last row joins: each has sums that fit,
/// both together have not. Of such a segment it is known that its moments are not exact, and it has
/// no plane.
#[test]
fn more_points_than_sums_have_room_for() {
    let (rows, columns) = (140, MAX_COLUMNS);
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.08, step_rad: 1e-5 }, axis: TurnAxis::Y };
    let turn_rad = (0..rows).map(|row| 1e-3 * (row as f32 - 70.0)).collect();
    let gap = |i: usize| i % columns == columns / 2 && i / columns < rows - 1;
    let range_m = (0..rows * columns).map(|i| if gap(i) { 0.0 } else { MAX_RANGE_M }).collect();
    let scan = Scan { columns, range_m, turn_rad, rig };
    let ranging = Ranging::new(10.0).with_limits(0.05, MAX_RANGE_M);
    let config = EdgeConfig::paper().with_ranging(ranging).with_roof_angle_rad(PI).with_step_angle_rad(0.0);
    let record = scan.record(config, 2);
    let segments = record.segments();
    let segment = segments[&1];
    assert_eq!((segments.len(), segment.pixels() as usize), (1, rows * columns - (rows - 1)));
    assert!(!is_exact(&segment) && segment.plane().is_none(), "{segment:?}");

    // one row less, and they are two
    let halves = scan.cut(rows - 1).record(config, 2).segments();
    assert_eq!(halves.len(), 2);
    for half in halves.values() {
        let plane = half.plane().unwrap();
        assert!(is_exact(half) && plane.normal[0] < -0.99, "{half:?}");
    }
}
