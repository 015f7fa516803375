//! The geometry of a range image: where each pixel's beam points, and what its values mean.
//!
//! Directions are unit vectors, x forward, y left, z up. Angles are degrees, as in the geometry
//! file, which [`Geometry::read`] and [`Geometry::to_toml`] read and write.
use std::error::Error;
use std::fmt;

pub use scanseg_core::TurnAxis;

use crate::noise::Noise;

/// Angles of the rows or of the columns of a range image, in degrees.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// Index `i` is at `start_deg + i * step_deg`.
    Even {
        /// Angle of index 0.
        start_deg: f64,
        /// Angle from one index to the next; not zero.
        step_deg: f64,
    },
    /// One angle per index.
    Listed(Vec<f64>),
}

impl Angles {
    /// Returns the angle of index `i` in degrees. `i` must lie within a list.
    pub fn at(&self, i: usize) -> f64 {
        match self {
            Angles::Even { start_deg, step_deg } => start_deg + i as f64 * step_deg,
            Angles::Listed(list) => list[i],
        }
    }
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
}

impl Geometry {
    /// Checks that an image of `rows` x `columns` pixels can have this geometry: listed angles have
    /// one entry per row or column, and the beams of the corners have directions (numbers too large
    /// for `f64` leave them without).
    ///
    /// # Errors
    /// [`GeometryError::Entries`] or [`GeometryError::NoDirection`].
    pub fn fits(&self, rows: usize, columns: usize) -> Result<(), GeometryError> {
        let entries = |key, angles: &Angles, axis, needed| match angles {
            Angles::Listed(list) if list.len() != needed => {
                Err(GeometryError::Entries { key, listed: list.len(), axis, needed })
            }
            _ => Ok(()),
        };
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => {
                entries("turn_deg", turn_deg, "rows", rows)?;
                entries("beam_deg", beam_deg, "columns", columns)?;
            }
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                entries("elevation_deg", elevation_deg, "rows", rows)?;
                entries("azimuth_deg", azimuth_deg, "columns", columns)?;
            }
            Kind::Pinhole { .. } => {}
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

    /// Checks the rules of the geometry file that hold for any image: everything finite,
    /// `unit_m` above 0, ranges ordered, no empty list, no step and no focal length of 0.
    ///
    /// # Errors
    /// [`GeometryError::Value`] for the first value that breaks one.
    pub fn check(&self) -> Result<(), GeometryError> {
        let number = |key: &str, x: f64, good: bool, rule: &'static str| {
            if good && x.is_finite() { Ok(()) } else { Err(GeometryError::value(key, x, rule)) }
        };
        let angles = |key: &str, angles: &Angles| match angles {
            Angles::Even { start_deg, step_deg } => {
                number(&format!("{key}.start"), *start_deg, true, "finite")?;
                number(&format!("{key}.step"), *step_deg, *step_deg != 0.0, "finite and not 0")
            }
            Angles::Listed(list) if list.is_empty() => Err(GeometryError::value(key, "[]", "one angle or more")),
            Angles::Listed(list) => {
                (0..).zip(list).try_for_each(|(i, a)| number(&format!("{key}[{i}]"), *a, true, "finite"))
            }
        };
        number("unit_m", self.unit_m, self.unit_m > 0.0, "finite and above 0")?;
        if let Some(m) = self.min_range_m {
            number("min_range_m", m, m >= 0.0, "finite and not below 0")?;
        }
        if let Some(m) = self.max_range_m {
            let min_m = self.min_range_m.unwrap_or(0.0);
            number("max_range_m", m, m > min_m, "finite and above 0 and above `min_range_m`")?;
        }
        if let Some(m) = self.range_noise_m {
            number("range_noise_m", m, m >= 0.0, "finite and not below 0")?;
        }
        for ((key, value), (_, none)) in { self.noise }.keys().into_iter().zip({ Noise::NONE }.keys()) {
            let rule = if *none == 0.0 { "finite and not below 0" } else { "finite and not below 1" };
            number(key, *value, *value >= *none, rule)?;
        }
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => {
                angles("beam_deg", beam_deg)?;
                angles("turn_deg", turn_deg)
            }
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                angles("azimuth_deg", azimuth_deg)?;
                angles("elevation_deg", elevation_deg)
            }
            Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } => {
                number("fx", *fx_px, *fx_px != 0.0, "finite and not 0")?;
                number("fy", *fy_px, *fy_px != 0.0, "finite and not 0")?;
                number("cx", *cx_px, true, "finite")?;
                number("cy", *cy_px, true, "finite")
            }
        }
    }

    /// Returns the unit vector of the beam of a pixel. Listed angles must have an entry for it; see
    /// [`Geometry::fits`].
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
            Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } => {
                let u = -(column as f64 - cx_px) / fx_px;
                let v = -(row as f64 - cy_px) / fy_px;
                let n = (1.0 + u * u + v * v).sqrt();
                [1.0 / n, u / n, v / n]
            }
        }
    }
}

/// What is wrong with a geometry, or with a geometry for an image.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum GeometryError {
    /// The text is not TOML.
    Syntax {
        /// Line of the mistake, from 1.
        line: usize,
        /// What the TOML reader says.
        message: String,
    },
    /// A required key is missing.
    Missing {
        /// Its name.
        key: String,
    },
    /// A key that the format does not have, or not for this kind.
    Unknown {
        /// Its name.
        key: String,
        /// The file's `kind`.
        kind: &'static str,
    },
    /// A value of the wrong type.
    Type {
        /// Its key.
        key: String,
        /// What the format asks for.
        expected: &'static str,
        /// What the file has.
        found: &'static str,
    },
    /// A value outside its range.
    Value {
        /// Its key.
        key: String,
        /// The value as text.
        found: String,
        /// What it must be.
        rule: &'static str,
    },
    /// A list of angles does not have one entry per row or column of the image.
    Entries {
        /// Its key.
        key: &'static str,
        /// Entries of the list.
        listed: usize,
        /// `"rows"` or `"columns"`.
        axis: &'static str,
        /// Rows or columns of the image.
        needed: usize,
    },
    /// The numbers are too large for a pixel's beam to have a direction.
    NoDirection {
        /// Row of the pixel.
        row: usize,
        /// Column of the pixel.
        column: usize,
    },
}

impl GeometryError {
    /// [`GeometryError::Value`] of anything that prints.
    pub(crate) fn value(key: &str, found: impl fmt::Debug, rule: &'static str) -> Self {
        GeometryError::Value { key: short(key), found: short(&format!("{found:?}").replace('"', "")), rule }
    }
}

/// The most characters of a key or value of a file in a message.
const MOST: usize = 40;

/// Returns the text, or its beginning if it is long.
pub(crate) fn short(text: &str) -> String {
    match text.char_indices().nth(MOST) {
        None => text.to_string(),
        Some((end, _)) => format!("{}...", &text[..end]),
    }
}

impl fmt::Display for GeometryError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            GeometryError::Syntax { line, message } => write!(f, "line {line}: {message}"),
            GeometryError::Missing { key } => write!(f, "missing key `{key}`"),
            GeometryError::Unknown { key, kind } => write!(f, "`{key}` is not a key of a {kind} geometry"),
            GeometryError::Type { key, expected, found } => write!(f, "`{key}` must be {expected}, not {found}"),
            GeometryError::Value { key, found, rule } => write!(f, "`{key}` is {found}, must be {rule}"),
            GeometryError::Entries { key, listed, axis, needed } => {
                write!(f, "`{key}` lists {listed} angles, the image has {needed} {axis}")
            }
            GeometryError::NoDirection { row, column } => {
                write!(f, "the beam of row {row}, column {column} has no direction: numbers too large")
            }
        }
    }
}

impl Error for GeometryError {}
