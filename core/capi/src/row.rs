//! The beams of a row as C has them.

use scanseg_core::{self as scanseg, ColumnTurns};

use crate::check::{check_pointer, check_struct};
use crate::status::{SCANSEG_ERROR_ROW_LENGTH, Status};

/// Where the beams of one row point, beside what the configuration says of all rows.
/// `scanseg_row_beams_init` sets it to a row of this turn and nothing else. What is not used costs
/// nothing; what is used costs a sine and a cosine per pixel at most.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct RowBeams {
    /// `sizeof(scanseg_row_beams)`.
    pub struct_size: u32,
    /// The row's turn (nodding) or elevation (spinning), radians, within +-6300.
    pub turn_rad: f32,
    /// Nodding and spinning: added to the angles of all columns, radians, within +-2 pi. A laser that
    /// looks beside the others.
    pub offset_rad: f32,
    /// Nodding: distance of the scanner's origin from the axis about which it turns, along the beam
    /// at angle 0, metres, within +-10.
    pub lever_arm_m: f32,
    /// Nodding: column c is turned by `c * column_turn_rad + (c % sets) * set_turn_rad` more than the
    /// row, as the turn goes on while the row is measured; over a row within +-pi / 2.
    pub column_turn_rad: f32,
    /// Nodding: sets of columns that lie between one another and are measured set after set, 1 to
    /// 255.
    pub sets: u32,
    /// Nodding: from a set to the next, radians; over all sets within +-pi / 2.
    pub set_turn_rad: f32,
    /// `SCANSEG_FREE`: the directions of the beams, unit vectors, x, y and z of each column; else NULL.
    pub directions: *const f32,
    /// Elements of `directions`: three times the columns, or 0.
    pub direction_count: usize,
}

impl RowBeams {
    /// A row at this turn angle or elevation.
    pub(crate) fn at(turn_rad: f32) -> RowBeams {
        RowBeams {
            struct_size: size_of::<RowBeams>() as u32,
            turn_rad,
            offset_rad: 0.0,
            lever_arm_m: 0.0,
            column_turn_rad: 0.0,
            sets: 1,
            set_turn_rad: 0.0,
            directions: core::ptr::null(),
            direction_count: 0,
        }
    }

    /// # Safety
    /// `beams` is NULL, or points to `struct_size` bytes, and its directions to as many numbers as it
    /// says, for `'a`.
    pub(crate) unsafe fn read<'a>(beams: *const RowBeams) -> Result<scanseg::RowBeams<'a>, Status> {
        // SAFETY: the caller's promise; no more than the size is read before that is checked.
        let beams = unsafe {
            check_struct(beams, &raw const (*beams).struct_size)?;
            beams.read()
        };
        let mut row = scanseg::RowBeams::from(beams.turn_rad)
            .with_offset_rad(beams.offset_rad)
            .with_lever_arm_m(beams.lever_arm_m)
            .with_column_turns(ColumnTurns {
                step_rad: beams.column_turn_rad,
                // what is too large is refused as none
                sets: u8::try_from(beams.sets).unwrap_or(0),
                set_rad: beams.set_turn_rad,
            });
        if beams.direction_count > 0 {
            check_pointer(beams.directions)?;
            if beams.direction_count % 3 != 0 {
                return Err(SCANSEG_ERROR_ROW_LENGTH);
            }
            // SAFETY: not NULL, aligned, and the caller's promise.
            let numbers = unsafe { core::slice::from_raw_parts(beams.directions, beams.direction_count) };
            row.directions = numbers.as_chunks().0;
        }
        Ok(row)
    }
}
