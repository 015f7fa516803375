//! Where the beams of one row point.

use crate::arithmetic::dot;
use crate::beam::Beams;
use crate::config::Ranging;
use crate::error::PushError;

/// How the turn of a nodding scanner goes on while it measures a row.
///
/// Column `c` is turned by `c * step_rad + (c % sets) * set_rad` more than the row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColumnTurns {
    /// From a column to the next, radians; over a row within +-pi / 2.
    pub step_rad: f32,
    /// Sets of columns that lie between one another and are measured set after set, at least 1: with
    /// 2 the even columns, then the odd ones.
    pub sets: u8,
    /// From a set to the next, radians; over all sets within +-pi / 2.
    pub set_rad: f32,
}

impl ColumnTurns {
    /// All columns are turned alike.
    pub const NONE: ColumnTurns = ColumnTurns { step_rad: 0.0, sets: 1, set_rad: 0.0 };

    /// How much more than its row a column is turned, radians.
    #[must_use]
    pub fn of(&self, column: usize) -> f32 {
        let set = column.checked_rem(usize::from(self.sets)).unwrap_or(0);
        column as f32 * self.step_rad + set as f32 * self.set_rad
    }

    /// The same of the columns from `from` on, which may lie outside, without a division for each.
    pub(crate) fn of_chunk<const N: usize>(&self, from: isize, turned_rad: &mut [f32; N]) {
        let sets = isize::from(self.sets).max(1);
        let (mut set, mut along_rad) = (from.checked_rem_euclid(sets).unwrap_or(0), from as f32 * self.step_rad);
        for turned_rad in turned_rad {
            *turned_rad = along_rad + set as f32 * self.set_rad;
            along_rad += self.step_rad;
            set = if set + 1 < sets { set + 1 } else { 0 };
        }
    }
}

/// Where the beams of one row point, beside what [`Beams`] says of all rows. Made from the turn angle
/// alone where there is nothing else to say.
///
/// What is not used costs nothing. What is used costs a sine and a cosine per pixel at most.
///
/// ```
/// use scanseg_core::{ColumnTurns, RowBeams};
/// // tilts by 0.38 deg while it measures two sets of 180 columns, one after the other
/// let sets = ColumnTurns { step_rad: 1e-5, sets: 2, set_rad: 6.6e-3 };
/// let row = RowBeams::from(0.2).with_column_turns(sets);
/// # assert_eq!(row.turn_rad, 0.2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct RowBeams<'a> {
    /// The turn of a nodding scanner, the elevation of a spinning one, radians, within +-6300; not
    /// used with pinhole and free beams.
    pub turn_rad: f32,
    /// Added to the angles of all columns, radians, within +-2 pi: a laser that looks beside the
    /// others. Nodding and spinning scanners.
    pub offset_rad: f32,
    /// Added to the turn of each column. Nodding scanners.
    pub column_turns: ColumnTurns,
    /// Distance of the scanner's origin from the axis about which it turns, along the beam at angle
    /// 0, metres, within +-10. Nodding scanners.
    pub lever_arm_m: f32,
    /// Unit vectors of the beams, one per column, with [`Beams::Free`]; elsewhere empty. Of a pixel
    /// without a return it does not matter.
    pub directions: &'a [[f32; 3]],
}

impl From<f32> for RowBeams<'_> {
    /// A row at this turn angle or elevation, radians.
    fn from(turn_rad: f32) -> Self {
        RowBeams { turn_rad, offset_rad: 0.0, column_turns: ColumnTurns::NONE, lever_arm_m: 0.0, directions: &[] }
    }
}

impl<'a> RowBeams<'a> {
    /// A row of free beams: one unit vector per column.
    #[must_use]
    pub fn free(directions: &'a [[f32; 3]]) -> Self {
        RowBeams { directions, ..RowBeams::from(0.0) }
    }

    /// The same with [`RowBeams::offset_rad`].
    #[must_use]
    pub fn with_offset_rad(self, offset_rad: f32) -> Self {
        RowBeams { offset_rad, ..self }
    }

    /// The same with [`RowBeams::column_turns`].
    #[must_use]
    pub fn with_column_turns(self, column_turns: ColumnTurns) -> Self {
        RowBeams { column_turns, ..self }
    }

    /// The same with [`RowBeams::lever_arm_m`].
    #[must_use]
    pub fn with_lever_arm_m(self, lever_arm_m: f32) -> Self {
        RowBeams { lever_arm_m, ..self }
    }
}

impl RowBeams<'_> {
    /// Whether columns lie where [`Beams`] and the turn angle alone say.
    pub(crate) fn is_plain(&self) -> bool {
        let ColumnTurns { step_rad, set_rad, .. } = self.column_turns;
        [self.offset_rad, step_rad, set_rad, self.lever_arm_m] == [0.0; 4]
    }

    /// Whether these can be the beams of a row of `ranges_m`.
    pub(crate) fn check(&self, beams: &Beams, ranging: &Ranging, ranges_m: &[f32]) -> Result<(), PushError> {
        use core::f32::consts::{FRAC_PI_2, TAU};
        // turn angles of 6300 rad still have a resolution of 0.03 deg; NaN is not within
        if !(-6300.0..=6300.0).contains(&self.turn_rad) {
            return Err(PushError::TurnAngle { turn_rad: self.turn_rad });
        }
        let within = |field, value: f32, most: f32| {
            if (-most..=most).contains(&value) { Ok(()) } else { Err(PushError::RowBeams { field, value }) }
        };
        let (nodding, spinning) = (matches!(beams, Beams::Nodding { .. }), matches!(beams, Beams::Spinning { .. }));
        within("offset_rad", self.offset_rad, if nodding || spinning { TAU } else { 0.0 })?;
        within("lever_arm_m", self.lever_arm_m, if nodding { 10.0 } else { 0.0 })?;
        let most_rad = if nodding { FRAC_PI_2 } else { 0.0 };
        let expected = ranges_m.len();
        let ColumnTurns { step_rad, sets, set_rad } = self.column_turns;
        within("step_rad", step_rad * expected as f32, most_rad)?;
        within("set_rad", set_rad * f32::from(sets), most_rad)?;
        if sets == 0 {
            return Err(PushError::RowBeams { field: "sets", value: 0.0 });
        }
        if !matches!(beams, Beams::Free { .. }) {
            return Ok(());
        }
        let got = self.directions.len();
        if got != expected {
            return Err(PushError::RowLength { expected, got });
        }
        let far = |u: &[f32; 3]| !(0.99..=1.01).contains(&dot(*u, *u));
        let of_returns = self.directions.iter().zip(ranges_m).enumerate();
        match of_returns.into_iter().find(|(_, (u, range_m))| ranging.clean(**range_m) > 0.0 && far(u)) {
            Some((column, _)) => Err(PushError::Direction { column }),
            None => Ok(()),
        }
    }
}
