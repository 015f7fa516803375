//! Where beams point.

use nalgebra::Vector3;

/// The axis that a nodding scanner turns about.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnAxis {
    /// Tilt: y, to the left.
    Y,
    /// Pan: z, up.
    Z,
}

/// The beam direction of every pixel, in a frame with x forward, y left, z up.
#[derive(Clone, Debug)]
pub enum Beams {
    /// A 2D scanner whose scan plane turns about an axis that lies in the plane.
    Nodding {
        /// Angle in the scan plane from its middle, one per column; the axis is at +-pi/2.
        beam_rad: Vec<f64>,
        /// Turn of the scan plane, one per row.
        turn_rad: Vec<f64>,
        /// What the plane turns about.
        axis: TurnAxis,
    },
    /// A spinning lidar.
    Spinning {
        /// Azimuth, one per column.
        azimuth_rad: Vec<f64>,
        /// Elevation, one per row.
        elevation_rad: Vec<f64>,
    },
    /// A camera that looks along x; columns go to the right, rows down.
    Pinhole {
        /// Focal length across columns, pixels.
        fx: f64,
        /// Focal length across rows, pixels.
        fy: f64,
        /// Column of the principal point.
        cx: f64,
        /// Row of the principal point.
        cy: f64,
    },
}

impl Beams {
    /// The unit vector along the beam of pixel (row, column). Panics if there is no angle for that
    /// row or column.
    pub fn direction(&self, (row, column): (usize, usize)) -> Vector3<f64> {
        match self {
            Beams::Nodding { beam_rad, turn_rad, axis } => {
                let (sin_b, cos_b) = beam_rad[column].sin_cos();
                let (sin_t, cos_t) = turn_rad[row].sin_cos();
                match axis {
                    TurnAxis::Y => Vector3::new(cos_b * cos_t, sin_b, cos_b * sin_t),
                    TurnAxis::Z => Vector3::new(cos_b * cos_t, cos_b * sin_t, sin_b),
                }
            }
            Beams::Spinning { azimuth_rad, elevation_rad } => {
                let (sin_a, cos_a) = azimuth_rad[column].sin_cos();
                let (sin_e, cos_e) = elevation_rad[row].sin_cos();
                Vector3::new(cos_e * cos_a, cos_e * sin_a, sin_e)
            }
            Beams::Pinhole { fx, fy, cx, cy } => {
                Vector3::new(1.0, -(column as f64 - cx) / fx, -(row as f64 - cy) / fy).normalize()
            }
        }
    }
}

/// The angle between two directions, 0 to pi, rad; exact for small and large angles alike, where
/// the arccos of the dot product is not.
pub fn angle_between(a: Vector3<f64>, b: Vector3<f64>) -> f64 {
    a.cross(&b).norm().atan2(a.dot(&b))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: Vector3<f64>, b: [f64; 3]) {
        assert!((a - Vector3::from(b)).norm() < 1e-15, "{a:?} {b:?}");
    }

    /// 30, 45 and 60 degrees have known sines.
    #[test]
    fn directions() {
        let deg = |angles: &[f64]| angles.iter().map(|a| a.to_radians()).collect::<Vec<_>>();
        let (half, sqrt3_2) = (0.5, 3f64.sqrt() / 2.0);

        let tilt = Beams::Nodding { beam_rad: deg(&[-90.0, 30.0]), turn_rad: deg(&[0.0, 60.0]), axis: TurnAxis::Y };
        close(tilt.direction((1, 0)), [0.0, -1.0, 0.0]);
        close(tilt.direction((0, 1)), [sqrt3_2, half, 0.0]);
        close(tilt.direction((1, 1)), [sqrt3_2 * half, half, sqrt3_2 * sqrt3_2]);

        let pan = Beams::Nodding { beam_rad: deg(&[-90.0, 30.0]), turn_rad: deg(&[0.0, 60.0]), axis: TurnAxis::Z };
        close(pan.direction((1, 0)), [0.0, 0.0, -1.0]);
        close(pan.direction((0, 1)), [sqrt3_2, 0.0, half]);
        close(pan.direction((1, 1)), [sqrt3_2 * half, sqrt3_2 * sqrt3_2, half]);

        let spinning = Beams::Spinning { azimuth_rad: deg(&[0.0, 60.0]), elevation_rad: deg(&[0.0, 30.0]) };
        close(spinning.direction((0, 1)), [half, sqrt3_2, 0.0]);
        close(spinning.direction((1, 0)), [sqrt3_2, 0.0, half]);
        close(spinning.direction((1, 1)), [sqrt3_2 * half, sqrt3_2 * sqrt3_2, half]);

        let pinhole = Beams::Pinhole { fx: 2.0, fy: 4.0, cx: 1.0, cy: 2.0 };
        close(pinhole.direction((2, 1)), [1.0, 0.0, 0.0]);
        close(pinhole.direction((2, 3)), [half.sqrt(), -half.sqrt(), 0.0]);
        close(pinhole.direction((6, 1)), [half.sqrt(), 0.0, -half.sqrt()]);
    }

    /// Rows of a nodding scanner: cos Phi = sin^2 b + cos^2 b cos dt, less than dt, and nothing on
    /// the axis.
    #[test]
    fn angles_between_rows() {
        let turn: f64 = 0.1;
        let beam_rad: Vec<f64> = vec![0.0, 1.0, 90f64.to_radians()];
        let beams = Beams::Nodding { beam_rad: beam_rad.clone(), turn_rad: vec![0.3, 0.3 + turn], axis: TurnAxis::Y };
        let phi = |column| angle_between(beams.direction((0, column)), beams.direction((1, column)));
        assert!((phi(0) - turn).abs() < 1e-15);
        let (sin_b, cos_b) = beam_rad[1].sin_cos();
        assert!((phi(1) - (sin_b * sin_b + cos_b * cos_b * turn.cos()).acos()).abs() < 1e-14);
        assert!(phi(2) < 1e-16);
    }

    #[test]
    fn small_and_large_angles() {
        let x = Vector3::x();
        for angle in [1e-9, 1e-5, 1.0, std::f64::consts::PI - 1e-5] {
            let other = Vector3::new(f64::cos(angle), 0.0, f64::sin(angle));
            assert!((angle_between(x, other) / angle - 1.0).abs() < 1e-15, "{angle}");
        }
        assert_eq!(angle_between(x, x), 0.0);
        assert_eq!(angle_between(x, -x), std::f64::consts::PI);
    }
}
