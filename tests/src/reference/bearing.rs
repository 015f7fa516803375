//! Bearing angles along a trace (paper, section 3).

use super::beams::{Beams, angle_between};
use super::{Image, Trace};
use std::f64::consts::PI;

/// Beams nearer to each other than this, rad, have no bearing angle. (A nodding scanner's rows meet
/// on its axis.)
pub const MIN_BEAM_ANGLE_RAD: f64 = 1e-5;

/// The bearing angle, rad, 0 to pi: the angle between the beam of this pixel and the line from the
/// previous pixel's point to this one's.
///
/// `range_m` and `previous_m` are the two ranges, positive, `phi_rad` the angle between the beams,
/// in (0, pi]. It is the paper's formula in another form, in which no two large numbers cancel:
/// range - previous cos phi = (range - previous) + previous (1 - cos phi), and 1 - cos phi = 2
/// sin^2(phi / 2).
pub fn bearing_angle(range_m: f64, previous_m: f64, phi_rad: f64) -> f64 {
    let versine = 2.0 * (phi_rad / 2.0).sin().powi(2);
    (previous_m * phi_rad.sin()).atan2((range_m - previous_m) + previous_m * versine)
}

/// The bearing angle as the paper prints it; the same arguments. Loses digits near 0 and pi and for
/// small angles, up to NaN. Here to show that [`bearing_angle`] is the same thing.
pub fn bearing_angle_arccos(range_m: f64, previous_m: f64, phi_rad: f64) -> f64 {
    let (r1, r0, cos_phi) = (range_m, previous_m, phi_rad.cos());
    ((r1 - r0 * cos_phi) / (r1 * r1 + r0 * r0 - 2.0 * r1 * r0 * cos_phi).sqrt()).acos()
}

/// A bearing angle, rad, 0 to pi, as a count of pi / 65535, rounded half up; at least 1, for 0
/// means that there is none.
pub fn count(bearing_rad: f64) -> u16 {
    (bearing_rad / PI * 65535.0).round().clamp(1.0, 65535.0) as u16
}

/// The bearing angle of every pixel along a trace, rad. None where the previous pixel is outside of
/// the image, where either pixel has no return, and where the beams are less than
/// [`MIN_BEAM_ANGLE_RAD`] apart.
pub fn bearing_angles(image: &Image, beams: &Beams, trace: Trace) -> Vec<Option<f64>> {
    let bearing = |pixel| {
        let previous = trace.previous(image.size, pixel)?;
        let range_m = image.range(pixel)?;
        let previous_m = image.range(previous)?;
        let phi_rad = angle_between(beams.direction(pixel), beams.direction(previous));
        (phi_rad >= MIN_BEAM_ANGLE_RAD).then(|| bearing_angle(range_m.into(), previous_m.into(), phi_rad))
    };
    image.size.pixels().map(bearing).collect()
}

/// [`bearing_angles`] as [counts](count); 0 where there is none.
pub fn bearing_counts(image: &Image, beams: &Beams, trace: Trace) -> Vec<u16> {
    bearing_angles(image, beams, trace).into_iter().map(|bearing| bearing.map_or(0, count)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::Size;
    use crate::reference::beams::TurnAxis;
    use proptest::prelude::*;

    fn deg(angles: impl IntoIterator<Item = f64>) -> Vec<f64> {
        angles.into_iter().map(f64::to_radians).collect()
    }

    proptest! {
        /// For angles well away from 0 and pi and beams well apart the arccos is good to 1e-9.
        #[test]
        fn agrees_with_the_paper(r1 in 0.5f64..20.0, r0 in 0.5f64..20.0, phi in 0.05f64..3.0) {
            let bearing = bearing_angle(r1, r0, phi);
            prop_assume!((0.01..3.13).contains(&bearing));
            prop_assert!((bearing - bearing_angle_arccos(r1, r0, phi)).abs() < 1e-9);
        }
    }

    /// Equal ranges make an isosceles triangle: half of pi minus half of phi. A right angle at the
    /// previous point: pi/2 minus phi. A right angle at this point: pi/2.
    #[test]
    fn known_triangles() {
        for phi in [1e-4, 0.01, 0.5, 1.5] {
            assert!((bearing_angle(3.0, 3.0, phi) - (PI / 2.0 - phi / 2.0)).abs() < 1e-14, "{phi}");
            assert!((bearing_angle(3.0 / phi.cos(), 3.0, phi) - (PI / 2.0 - phi)).abs() < 1e-11, "{phi}");
            assert!((bearing_angle(3.0 * phi.cos(), 3.0, phi) - PI / 2.0).abs() < 1e-11, "{phi}");
        }
    }

    #[test]
    fn counts_of_angles() {
        assert_eq!(count(0.0), 1);
        assert_eq!(count(0.49 * PI / 65535.0), 1);
        assert_eq!(count(1.49 * PI / 65535.0), 1);
        assert_eq!(count(1.51 * PI / 65535.0), 2);
        assert_eq!(count(PI / 3.0), 21845);
        assert_eq!(count(PI), 65535);
    }

    /// A scanner in the corner of two walls, x = 2 in front and y = 2 to the left: corner at beam
    /// angle 45 degrees. From left to right in the image the beam moves to the left, along the
    /// front wall in the direction 90 degrees and along the left wall in the direction 180 degrees:
    /// the bearing angle is 90 - b on the one and 180 - b on the other, so it falls by the beam
    /// step, and 135 - b for the pair across the corner.
    #[test]
    fn corner_of_two_walls() {
        let beam_deg = [42.5, 43.5, 44.5, 45.5, 46.5, 47.5f64];
        let beams = Beams::Nodding { beam_rad: deg(beam_deg), turn_rad: deg([0.0]), axis: TurnAxis::Y };
        let range_m = beam_deg.map(|b| f64::min(2.0 / b.to_radians().cos(), 2.0 / b.to_radians().sin()) as f32);
        let image = Image::new(Size { rows: 1, columns: 6, wraps: false }, range_m.to_vec());
        let bearing = bearing_angles(&image, &beams, Trace::HORIZONTAL);
        assert_eq!(bearing[0], None);
        for (column, expected_deg) in [(1, 46.5), (2, 45.5), (3, 89.5), (4, 133.5), (5, 132.5)] {
            // Ranges in f32 err by 1.2e-7 m, over 5 cm.
            let bearing_deg = bearing[column].unwrap().to_degrees();
            assert!((bearing_deg - expected_deg).abs() < 5e-4, "column {column}: {bearing_deg}");
        }
        let step_deg = bearing[1].unwrap().to_degrees() - bearing[2].unwrap().to_degrees();
        assert!((step_deg - 1.0).abs() < 1e-3, "{step_deg}");
    }

    /// The wall x = 2 along the columns of a tilting scanner: from one turn to the next the point
    /// moves along the wall by 2 (0, tan b (1/cos t1 - 1/cos t0), tan t1 - tan t0).
    #[test]
    fn wall_along_columns_of_a_tilting_scanner() {
        let (beam_deg, turn_deg) = ([0.0, 60.0, 90.0f64], [10.0, 11.0f64]);
        let beams = Beams::Nodding { beam_rad: deg(beam_deg), turn_rad: deg(turn_deg), axis: TurnAxis::Y };
        let size = Size { rows: 2, columns: 3, wraps: false };
        let range_m = size.pixels().map(|(row, column)| {
            let (b, t) = (beam_deg[column].to_radians(), turn_deg[row].to_radians());
            if column == 2 { 5.0 } else { (2.0 / (b.cos() * t.cos())) as f32 }
        });
        let image = Image::new(size, range_m.collect());
        let bearing = bearing_angles(&image, &beams, Trace::VERTICAL);
        assert_eq!(bearing[..3], [None; 3]);
        // Straight ahead it is that of a line in the plane that holds the beam: 90 - t.
        assert!((bearing[3].unwrap().to_degrees() - 79.0).abs() < 1e-3);
        let (b, t0, t1) = (beam_deg[1].to_radians(), turn_deg[0].to_radians(), turn_deg[1].to_radians());
        let along = nalgebra::Vector3::new(0.0, b.tan() * (1.0 / t1.cos() - 1.0 / t0.cos()), t1.tan() - t0.tan());
        let expected = (along.dot(&beams.direction((1, 1))) / along.norm()).acos();
        assert!((bearing[4].unwrap() - expected).abs() < 1e-5);
        // On the axis the beams are the same.
        assert_eq!(bearing[5], None);
    }

    /// What each trace compares with, told by one pixel without a return.
    #[test]
    fn no_bearing_without_both_returns() {
        let beams = Beams::Pinhole { fx: 100.0, fy: 100.0, cx: 1.0, cy: 1.0 };
        let mut image = Image::new(Size { rows: 3, columns: 3, wraps: false }, vec![2.0; 9]);
        for nothing in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            image.range_m[4] = nothing;
            let some = |trace| bearing_angles(&image, &beams, trace).iter().map(Option::is_some).collect::<Vec<_>>();
            let (f, t) = (false, true);
            assert_eq!(some(Trace::HORIZONTAL), [f, t, t, f, f, f, f, t, t]);
            assert_eq!(some(Trace::VERTICAL), [f, f, f, t, f, t, t, f, t]);
            assert_eq!(some(Trace { rows: 1, columns: 1 }), [f, f, f, f, f, t, f, t, f]);
            assert_eq!(some(Trace { rows: 1, columns: -1 }), [f, f, f, t, f, f, f, t, f]);
            assert_eq!(some(Trace { rows: 0, columns: 2 }), [f, f, t, f, f, t, f, f, t]);
            assert_eq!(some(Trace { rows: 0, columns: 0 }), [f; 9]);
        }
    }

    #[test]
    fn limits_of_range_are_returns() {
        let mut image = Image::new(Size { rows: 1, columns: 4, wraps: false }, vec![0.9, 1.0, 4.0, 4.1]);
        (image.min_range_m, image.max_range_m) = (1.0, 4.0);
        let returns = [0, 1, 2, 3].map(|column| image.range((0, column)));
        assert_eq!(returns, [None, Some(1.0), Some(4.0), None]);
    }

    #[test]
    fn beams_too_near_to_each_other() {
        let beam_rad = vec![0.0, 0.9e-5, 2.0e-5];
        let beams = Beams::Nodding { beam_rad, turn_rad: vec![0.0], axis: TurnAxis::Y };
        let image = Image::new(Size { rows: 1, columns: 3, wraps: false }, vec![2.0; 3]);
        let bearing = bearing_angles(&image, &beams, Trace::HORIZONTAL);
        assert_eq!(bearing[..2], [None; 2]);
        assert!((bearing[2].unwrap() - (PI / 2.0 - 0.55e-5)).abs() < 1e-9);
    }

    /// A full circle of equal ranges: the same angle everywhere, across the seam too.
    #[test]
    fn wraps_around() {
        let beams = Beams::Spinning { azimuth_rad: deg([0.0, 90.0, 180.0, 270.0]), elevation_rad: deg([0.0]) };
        let mut image = Image::new(Size { rows: 1, columns: 4, wraps: true }, vec![3.0; 4]);
        let circle = bearing_angles(&image, &beams, Trace::HORIZONTAL);
        assert!(circle.iter().all(|bearing| (bearing.unwrap() - 0.25 * PI).abs() < 1e-14), "{circle:?}");
        image.size.wraps = false;
        assert_eq!(bearing_angles(&image, &beams, Trace::HORIZONTAL)[0], None);
        // A single column is its own left neighbour, along the same beam.
        let image = Image::new(Size { rows: 1, columns: 1, wraps: true }, vec![3.0]);
        assert_eq!(bearing_counts(&image, &beams, Trace::HORIZONTAL), [0]);
    }
}
