//! The geometry of a range image: where each pixel's beam points, and what its values mean.
//!
//! Directions are unit vectors, x forward, y left, z up. Angles are degrees, as in the geometry file.

/// Angles of the rows or of the columns of a range image, in degrees.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// Index `i` is at `start + i * step`.
    Even {
        /// Angle of index 0.
        start: f64,
        /// Angle from one index to the next; not zero.
        step: f64,
    },
    /// One angle per index.
    Listed(Vec<f64>),
}

impl Angles {
    /// Angle of index `i` in degrees. `i` must lie within a list.
    pub fn at(&self, i: usize) -> f64 {
        match self {
            Angles::Even { start, step } => start + i as f64 * step,
            Angles::Listed(list) => list[i],
        }
    }
}

/// The axis about which a 2D scanner turns; it lies in the scan plane.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TurnAxis {
    /// Tilt: about the axis to the left, direction = (cos b cos t, sin b, cos b sin t).
    Y,
    /// Pan: about the upright axis, direction = (cos b cos t, cos b sin t, sin b).
    Z,
}

/// What a pinhole camera's pixel values measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Depth {
    /// Along the camera's axis.
    Z,
    /// Along the beam.
    Range,
}

/// Where the beams of the pixels point.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A 2D scanner whose scan plane turns about an axis that lies in the plane.
    Nodding {
        /// Angle in the scan plane from its middle, one per column; the axis is at +-90.
        beam_deg: Angles,
        /// Turn of the scan plane, one per row.
        turn_deg: Angles,
        /// The axis.
        turn_axis: TurnAxis,
    },
    /// A spinning scanner: direction = (cos e cos a, cos e sin a, sin e).
    Spinning {
        /// Azimuth a, one per column.
        azimuth_deg: Angles,
        /// Elevation e, one per row.
        elevation_deg: Angles,
        /// Whether the last column neighbours the first.
        wraps: bool,
    },
    /// A camera: direction = normalised (1, -(u - cx) / fx, -(v - cy) / fy).
    Pinhole {
        /// Focal length along a row, pixels.
        fx: f64,
        /// Focal length along a column, pixels.
        fy: f64,
        /// Column of the optical axis.
        cx: f64,
        /// Row of the optical axis.
        cy: f64,
        /// What the pixel values measure.
        depth: Depth,
    },
}

/// The geometry file of a range image, version 1.
#[derive(Clone, Debug, PartialEq)]
pub struct Geometry {
    /// Metres per count.
    pub unit_m: f64,
    /// Counts that mean "no return", besides 0.
    pub no_return: Vec<u16>,
    /// Returns nearer than this are dropped, metres.
    pub min_range_m: Option<f64>,
    /// Returns farther than this are dropped, metres.
    pub max_range_m: Option<f64>,
    /// Standard deviation of one range, metres.
    pub range_noise_m: Option<f64>,
    /// Where the beams point.
    pub kind: Kind,
}

impl Geometry {
    /// Unit vector of the beam of a pixel.
    pub fn direction(&self, row: usize, column: usize) -> [f64; 3] {
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, turn_axis } => {
                let (sb, cb) = beam_deg.at(column).to_radians().sin_cos();
                let (st, ct) = turn_deg.at(row).to_radians().sin_cos();
                match turn_axis {
                    TurnAxis::Y => [cb * ct, sb, cb * st],
                    TurnAxis::Z => [cb * ct, cb * st, sb],
                }
            }
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                let (sa, ca) = azimuth_deg.at(column).to_radians().sin_cos();
                let (se, ce) = elevation_deg.at(row).to_radians().sin_cos();
                [ce * ca, ce * sa, se]
            }
            Kind::Pinhole { fx, fy, cx, cy, .. } => {
                let u = -(column as f64 - cx) / fx;
                let v = -(row as f64 - cy) / fy;
                let n = (1.0 + u * u + v * v).sqrt();
                [1.0 / n, u / n, v / n]
            }
        }
    }
}
