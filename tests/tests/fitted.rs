//! Planes of weighted sums that are given: their covariance, and what has none.

use scanseg_core::{Fitted, PlaneConfig, Ranging};
use scanseg_tests::checks::planes::assert_sound;
use scanseg_tests::scenes::scanner;

const NOISE_M: f32 = 0.005;

/// The sums of a wall 2 m ahead, seen 0.2 rad to either side and up and down, whose points weigh so
/// much.
fn ahead(points: u32, weight: f32, squares: f32) -> Fitted {
    let w = weight * points as f32;
    Fitted::from_numbers([w, w, 0.98, 0.0, 0.0, 0.0, 0.02 * w, 0.01 * w, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, squares])
}

#[test]
fn residuals_that_are_larger_than_the_noise_count() {
    // weights of 5 mm at 2 m
    let weight = 16.0 / 2.5e-5;
    let usual = ahead(1000, weight, 900.0).plane(1000).unwrap();
    assert_sound(&usual);
    assert_eq!((usual.normal, usual.distance_m), ([-1.0, 0.0, 0.0], 2.0));
    // at the middle of the points the plane is met 2 m / 0.98 away
    assert!((usual.rms_m - (900f32 / 1000.0 / weight).sqrt() * 4.0 / 0.98).abs() < 1e-6, "{usual:?}");
    // of the distance along the mean beam: that of the mean range
    let expected =
        [0.0, 4.0 / (0.02 * weight * 1000.0), 4.0 / (0.01 * weight * 1000.0), 16.0 / (0.96 * weight * 1000.0)];
    for (i, expected) in expected.into_iter().enumerate() {
        assert!((usual.covariance[i][i] - expected).abs() <= 1e-3 * expected, "{i}: {usual:?} {expected}");
    }
    assert_eq!(ahead(1000, weight, 990.0).plane(1000).unwrap().covariance, usual.covariance);
    let rough = ahead(1000, weight, 4.0 * 997.0).plane(1000).unwrap();
    assert!((rough.rms_m / usual.rms_m - (4.0f32 * 997.0 / 900.0).sqrt()).abs() < 1e-5);
    for i in 1..4 {
        assert!((rough.covariance[i][i] / usual.covariance[i][i] - 4.0).abs() < 0.01, "{i}: {rough:?}");
    }
}

/// However many points: 1e-6 rad and 1e-6 of the distance are left. At 5 mm and 10 000 pixels that
/// is less than a hundredth of the covariance.
#[test]
fn rounding_is_left() {
    let plane = ahead(1 << 30, 1e15, 0.0).plane(1 << 30).unwrap();
    assert_sound(&plane);
    for (i, expected) in [0.0, 1e-12, 1e-12, 4e-12].into_iter().enumerate() {
        assert!((plane.covariance[i][i] - expected).abs() <= 1e-2 * expected, "{i}: {plane:?}");
    }
    let usual = ahead(10_000, 16.0 / 2.5e-5, 9e3).plane(10_000).unwrap();
    for i in 1..4 {
        assert!(plane.covariance[i][i] < 0.01 * usual.covariance[i][i], "{i}: {usual:?}");
    }
}

#[test]
fn what_has_no_plane() {
    let fitted = ahead(1000, 1e6, 900.0);
    assert_eq!(Fitted::from_numbers(fitted.numbers()), fitted);
    assert_eq!([0, 3, 4].map(|pixels| fitted.plane(pixels).is_some()), [false, false, true]);
    assert_eq!((Fitted::default().plane(100), Fitted::default().centroid_m()), (None, [0.0; 3]));
    for (i, bad) in (0..15).flat_map(|i| [f32::NAN, f32::INFINITY].map(|bad| (i, bad))) {
        let mut numbers = fitted.numbers();
        numbers[i] = bad;
        if let Some(plane) = Fitted::from_numbers(numbers).plane(1000) {
            assert!(plane.covariance.as_flattened().iter().all(|c| c.is_finite()), "{i} {bad}: {plane:?}");
            assert!(
                plane.distance_m.is_finite() && plane.rms_m.is_finite() && plane.normal.iter().all(|n| n.is_finite())
            );
        }
    }
    // one row; two rows have one, though few pixels
    let scan = |rows| scanner(rows, 61, 0.0, |u| 2.0 / u[0]);
    let planes = |rows| -> Vec<_> {
        let scan = scan(rows);
        let record = scan.record(PlaneConfig::new(Ranging::new(NOISE_M)), 122);
        let segments = record.segments();
        segments.values().map(|segment| (segment.pixels(), segment.plane().is_some())).collect()
    };
    assert_eq!((planes(1), planes(2)), (vec![(61, false)], vec![(122, true)]));
    // one column: it may be tilted any way
    let column = scanner(61, 1, 0.0, |u| 2.0 / u[0]);
    let segments = column.record(PlaneConfig::new(Ranging::new(NOISE_M)), 2).segments();
    assert!(segments.values().all(|segment| segment.plane().is_none()), "{segments:?}");
}
