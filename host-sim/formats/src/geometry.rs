//! The geometry of a range image: where each pixel's beam points, and what its values mean.
//!
//! Directions are unit vectors, x forward, y left, z up. Angles are degrees, as in the geometry
//! file, which [`Geometry::read`] and [`Geometry::to_toml`] read and write.

pub use scanseg_core::TurnAxis;

use crate::angles::Angles;
use crate::beside::Beside;
use crate::geometry_error::GeometryError;
use crate::limits::{CENTRE_PX, ERROR_M, FOCAL_PX, LEVER_ARM_M, Limits, MAX_RANGE_M, MIN_RANGE_M, UNIT_M};
use crate::noise::{LIMITS, Noise};

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
        fx_px: f64,
        /// Focal length along a column, pixels.
        fy_px: f64,
        /// Column of the optical axis.
        cx_px: f64,
        /// Row of the optical axis.
        cy_px: f64,
        /// What the pixel values measure.
        depth: Depth,
    },
    /// Any beams, as an organised point cloud has them. A geometry file has no such kind.
    Free {
        /// A unit vector for each pixel; anything where nothing was measured.
        directions: Vec<[f32; 3]>,
        /// Pixels of a row.
        columns: usize,
        /// Whether the last column neighbours the first.
        wraps: bool,
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
    /// Further errors of the scanner.
    pub noise: Noise,
    /// Where the beams point.
    pub kind: Kind,
    /// Rows, columns and an origin beside the others.
    pub beside: Beside,
}

impl Geometry {
    /// A geometry that says nothing but where the beams point: counts of a millimetre.
    pub fn of(kind: Kind) -> Geometry {
        let (min_range_m, max_range_m, range_noise_m) = (None, None, None);
        Geometry {
            unit_m: 0.001,
            no_return: vec![],
            min_range_m,
            max_range_m,
            range_noise_m,
            noise: Noise::NONE,
            kind,
            beside: Beside::NONE,
        }
    }

    /// Checks that an image of `rows` x `columns` pixels can have this geometry: listed angles have
    /// one entry per row or column, and the beams of the corners have directions (numbers too large
    /// for `f64` leave them without).
    ///
    /// # Errors
    /// [`GeometryError::Entries`] or [`GeometryError::NoDirection`]; several in one.
    pub fn fits(&self, rows: usize, columns: usize) -> Result<(), GeometryError> {
        let mut errors = vec![];
        for (key, angles) in self.angles().into_iter().flatten().chain(self.offsets()) {
            let of_rows = ["turn_deg", "elevation_deg", "row_offset_deg"].contains(&key);
            let (axis, needed) = if of_rows { ("rows", rows) } else { ("columns", columns) };
            match angles {
                Angles::Listed(list) if list.len() != needed => {
                    errors.push(GeometryError::Entries { key, listed: list.len(), axis, needed });
                }
                _ => {}
            }
        }
        GeometryError::all(errors)?;
        if let Kind::Free { directions, columns: of_row, .. } = &self.kind {
            let (key, listed, needed) = ("directions", directions.len(), rows * columns);
            let fits = listed == needed && *of_row == columns;
            return if fits { Ok(()) } else { Err(GeometryError::Entries { key, listed, axis: "pixels", needed }) };
        }
        if rows == 0 || columns == 0 {
            return Ok(());
        }
        // Every formula is monotone in the index up to its sine, so that the corners are the
        // largest numbers.
        for row in [0, rows - 1] {
            for column in [0, columns - 1] {
                if self.direction(row, column).iter().any(|x| !x.is_finite()) {
                    return Err(GeometryError::NoDirection { row, column });
                }
            }
        }
        Ok(())
    }

    /// Returns the angles of the rows and of the columns with their keys; none of a pinhole.
    pub fn angles(&self) -> Option<[(&'static str, &Angles); 2]> {
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => Some([("turn_deg", turn_deg), ("beam_deg", beam_deg)]),
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                Some([("elevation_deg", elevation_deg), ("azimuth_deg", azimuth_deg)])
            }
            Kind::Pinhole { .. } | Kind::Free { .. } => None,
        }
    }

    /// Returns the angles that are added to those, with their keys.
    fn offsets(&self) -> impl Iterator<Item = (&'static str, &Angles)> {
        let Beside { row_offset_deg, column_offset_deg, .. } = &self.beside;
        let offsets = [("row_offset_deg", row_offset_deg), ("column_offset_deg", column_offset_deg)];
        offsets.into_iter().filter_map(|(key, angles)| Some((key, angles.as_ref()?)))
    }

    /// Returns where the beams of a row start: with a lever arm not in the origin.
    pub fn origin(&self, row: usize, column: usize) -> [f64; 3] {
        let Kind::Nodding { turn_deg, turn_axis, .. } = &self.kind else { return [0.0; 3] };
        let (st, ct) = (turn_deg.at(row) + self.beside.column_deg(column)).to_radians().sin_cos();
        let out = match turn_axis {
            TurnAxis::Y => [ct, 0.0, st],
            TurnAxis::Z => [ct, st, 0.0],
        };
        out.map(|x| x * self.beside.lever_arm_m)
    }

    /// Checks the rules of the geometry file that hold for any image: numbers within their limits,
    /// ranges ordered, no empty list.
    ///
    /// # Errors
    /// [`GeometryError::Value`] for each value that breaks one.
    pub fn check(&self) -> Result<(), GeometryError> {
        let mut errors = vec![];
        let mut number = |key: &str, x: f64, limits: &Limits| errors.extend(limits.check(key, x).err());
        number("unit_m", self.unit_m, &UNIT_M);
        let optional = [
            ("min_range_m", self.min_range_m, &MIN_RANGE_M),
            ("max_range_m", self.max_range_m, &MAX_RANGE_M),
            ("range_noise_m", self.range_noise_m, &ERROR_M),
        ];
        optional.into_iter().for_each(|(key, x, limits)| _ = x.map(|x| number(key, x, limits)));
        for ((key, x), limits) in { self.noise }.keys().into_iter().zip(LIMITS) {
            number(key, *x, limits);
        }
        if let Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } = self.kind {
            [("fx", fx_px), ("fy", fy_px)].iter().for_each(|(key, x)| number(key, *x, &FOCAL_PX));
            [("cx", cx_px), ("cy", cy_px)].iter().for_each(|(key, x)| number(key, *x, &CENTRE_PX));
        }
        errors.extend(check_order(self.min_range_m, self.max_range_m).err());
        let angles = self.angles().into_iter().flatten().chain(self.offsets());
        angles.for_each(|(key, angles)| errors.extend(angles.check(key)));
        errors.extend(LEVER_ARM_M.check("lever_arm_m", self.beside.lever_arm_m).err());
        GeometryError::all(errors)
    }

    /// Returns the unit vector of the beam of a pixel. Listed angles must have an entry for it; see
    /// [`Geometry::fits`].
    pub fn direction(&self, row: usize, column: usize) -> [f64; 3] {
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, turn_axis } => {
                let (sb, cb) = (beam_deg.at(column) + self.beside.row_deg(row)).to_radians().sin_cos();
                let (st, ct) = (turn_deg.at(row) + self.beside.column_deg(column)).to_radians().sin_cos();
                match turn_axis {
                    TurnAxis::Y => [cb * ct, sb, cb * st],
                    TurnAxis::Z => [cb * ct, cb * st, sb],
                }
            }
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                let (sa, ca) = (azimuth_deg.at(column) + self.beside.row_deg(row)).to_radians().sin_cos();
                let (se, ce) = elevation_deg.at(row).to_radians().sin_cos();
                [ce * ca, ce * sa, se]
            }
            Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } => {
                let u = -(column as f64 - cx_px) / fx_px;
                let v = -(row as f64 - cy_px) / fy_px;
                let n = (1.0 + u * u + v * v).sqrt();
                [1.0 / n, u / n, v / n]
            }
            Kind::Free { directions, columns, .. } => directions[row * columns + column].map(f64::from),
        }
    }
}

/// Checks that the limits of ranges are in order.
pub(crate) fn check_order(min_range_m: Option<f64>, max_range_m: Option<f64>) -> Result<(), GeometryError> {
    match (min_range_m, max_range_m) {
        (Some(min_m), Some(max_m)) if max_m > 0.0 && max_m <= min_m => {
            Err(GeometryError::value("max_range_m", format!("{max_m:?}"), MAX_RANGE_M.text))
        }
        _ => Ok(()),
    }
}
