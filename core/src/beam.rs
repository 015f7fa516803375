//! Where the beams of an image point.

use crate::error::ConfigError;

/// The most columns of an image.
pub const MAX_COLUMNS: usize = 16_384;

/// Angles of the columns, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Columns<'a> {
    /// Column `c` is at `start_rad + c * step_rad`.
    Even {
        /// Angle of column 0; within +-2 pi.
        start_rad: f32,
        /// From a column to the next; not 0, within +-pi / 2.
        step_rad: f32,
    },
    /// One angle per column, each within +-2 pi. Costs a sine and a cosine per pixel, which
    /// [`Columns::Even`] does not.
    Listed(&'a [f32]),
    /// The same for a nodding scanner whose lasers look beside the plane of the row, as the columns
    /// of a spinning lidar whose rows are its firings. Costs two sines and cosines per pixel.
    Beside {
        /// One angle per column, each within +-2 pi.
        angles_rad: &'a [f32],
        /// How much more than its row each column is turned, within +-pi / 2.
        turns_rad: &'a [f32],
    },
}

impl Columns<'_> {
    /// The angles that are listed.
    pub(crate) fn listed(&self) -> &[f32] {
        match self {
            Columns::Even { .. } => &[],
            Columns::Listed(list) | Columns::Beside { angles_rad: list, .. } => list,
        }
    }

    /// The angle of a column, radians; 0 of one that is not there.
    pub(crate) fn rad(&self, column: usize) -> f32 {
        match *self {
            Columns::Even { start_rad, step_rad } => start_rad + column as f32 * step_rad,
            Columns::Listed(list) | Columns::Beside { angles_rad: list, .. } => {
                list.get(column).copied().unwrap_or(0.0)
            }
        }
    }

    /// How much more than its row a column is turned, radians.
    pub(crate) fn turn_rad(&self, column: usize) -> f32 {
        match self {
            Columns::Beside { turns_rad, .. } => turns_rad.get(column).copied().unwrap_or(0.0),
            _ => 0.0,
        }
    }
}

/// The axis about which a nodding scanner turns. It lies in the scan plane, at beam angles +-90
/// deg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TurnAxis {
    /// To the left: the scanner tilts. Direction = (cos b cos t, sin b, cos b sin t).
    Y,
    /// Upright: the scanner pans. Direction = (cos b cos t, cos b sin t, sin b).
    Z,
}

/// Where the beams of an image point: unit vectors, x forward, y left, z up.
///
/// The angle of a row is not here: it is given with each row, because a real encoder only knows it
/// then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beams<'a> {
    /// A 2D scanner whose scan plane turns about an axis in the plane. A row's angle is its turn t.
    Nodding {
        /// Beam angles b, measured in the scan plane from its middle.
        columns: Columns<'a>,
        /// The axis.
        axis: TurnAxis,
    },
    /// A spinning scanner: direction = (cos e cos a, cos e sin a, sin e). A row's angle is its
    /// elevation e.
    Spinning {
        /// Azimuths a.
        columns: Columns<'a>,
        /// Whether the last column neighbours the first. Even azimuths must then go round exactly
        /// once.
        wraps: bool,
    },
    /// A camera: direction = normalised (1, -(u - cx) / fx, -(v - cy) / fy) for column u, row v.
    /// The row's angle is not used: row v is the v-th row pushed. Ranges are along the beam.
    Pinhole {
        /// Focal length along a row, pixels; not 0.
        fx_px: f32,
        /// Focal length along a column, pixels; not 0.
        fy_px: f32,
        /// Column of the optical axis.
        cx_px: f32,
        /// Row of the optical axis.
        cy_px: f32,
    },
    /// Any beams: each row brings [`RowBeams::directions`](crate::RowBeams::directions). Takes some
    /// two times as long as the other kinds, so take one of those where the beams are so arranged.
    Free {
        /// Whether the last column neighbours the first.
        wraps: bool,
    },
}

impl Beams<'_> {
    /// Whether an image of `count` columns can have these beams.
    pub(crate) fn check(&self, count: usize) -> Result<(), ConfigError> {
        use core::f32::consts::{FRAC_PI_2, TAU};
        let value = |field, value| Err(ConfigError::Value { field, value });
        if count == 0 || count > MAX_COLUMNS {
            return Err(ConfigError::Count { field: "columns", value: count as i32 });
        }
        let listed = |field, list: &[f32], most: f32| {
            if list.len() != count {
                return Err(ConfigError::Listed { columns: count, got: list.len() });
            }
            list.iter().find(|&a| !(-most..=most).contains(a)).map_or(Ok(()), |&a| value(field, a))
        };
        let angles = |columns: &Columns| match *columns {
            Columns::Even { start_rad, .. } if !(-TAU..=TAU).contains(&start_rad) => value("start_rad", start_rad),
            Columns::Even { step_rad, .. } if step_rad == 0.0 || !(-FRAC_PI_2..=FRAC_PI_2).contains(&step_rad) => {
                value("step_rad", step_rad)
            }
            Columns::Even { .. } => Ok(()),
            Columns::Listed(list) | Columns::Beside { angles_rad: list, .. } => listed("columns", list, TAU),
        };
        let turns = |columns: &Columns, most: f32| match *columns {
            Columns::Beside { turns_rad, .. } => listed("turns_rad", turns_rad, most),
            _ => Ok(()),
        };
        match self {
            Beams::Nodding { columns, .. } => angles(columns).and_then(|()| turns(columns, FRAC_PI_2)),
            Beams::Spinning { columns, wraps } => {
                // columns of a spinning scanner do not turn
                angles(columns).and_then(|()| turns(columns, 0.0))?;
                match *columns {
                    // the angle across the seam is that of any other pair of neighbours, to 1 % of
                    // it
                    Columns::Even { step_rad, .. }
                        if *wraps
                            && libm::fabsf(libm::fabsf(step_rad) * count as f32 - TAU) > 0.01 * step_rad.abs() =>
                    {
                        value("wraps: step_rad", step_rad)
                    }
                    _ => Ok(()),
                }
            }
            &Beams::Pinhole { fx_px, fy_px, cx_px, cy_px } => {
                let far = 1e6;
                for (field, v) in [("fx_px", fx_px), ("fy_px", fy_px)] {
                    if !(0.1..=far).contains(&v.abs()) {
                        return value(field, v);
                    }
                }
                for (field, v) in [("cx_px", cx_px), ("cy_px", cy_px)] {
                    if !(-far..=far).contains(&v) {
                        return value(field, v);
                    }
                }
                Ok(())
            }
            Beams::Free { .. } => Ok(()),
        }
    }
}
