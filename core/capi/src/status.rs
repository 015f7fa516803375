//! What a call answers.

use core::ffi::CStr;

/// What a call answers: one of the `SCANSEG_` statuses. 0 is success, above 0 there is something to
/// know, below 0 the call did nothing.
pub type Status = i32;

/// Done.
pub const SCANSEG_OK: Status = 0;
/// Done; but the array of events was full, and `events_lost` events did not fit. A callback was
/// given all of them.
pub const SCANSEG_EVENTS_FULL: Status = 1;
/// The callback asked to stop. The scan is dropped: reset the segmenter for the next one.
pub const SCANSEG_STOPPED: Status = 2;
/// The points have no plane: fewer than four, on a line, or too many and far to be summed up
/// exactly.
pub const SCANSEG_NO_PLANE: Status = 3;
/// A pointer is NULL that must not be.
pub const SCANSEG_ERROR_NULL: Status = -1;
/// `struct_size` is not that of this library: the header is of another version, or the field was
/// not set.
pub const SCANSEG_ERROR_STRUCT_SIZE: Status = -2;
/// The program was compiled with a header of another `SCANSEG_ABI_VERSION`.
pub const SCANSEG_ERROR_ABI_VERSION: Status = -3;
/// A pointer is not aligned as its type asks; the memory of a segmenter, to `SCANSEG_STATE_ALIGN`.
pub const SCANSEG_ERROR_ALIGNMENT: Status = -4;
/// The memory is smaller than `scanseg_state_size` says.
pub const SCANSEG_ERROR_MEMORY_SIZE: Status = -5;
/// A value of the configuration cannot be used: `scanseg_bad_field` says which.
pub const SCANSEG_ERROR_CONFIG: Status = -6;
/// There is no segmenter: not made yet, overwritten, or copied from elsewhere.
pub const SCANSEG_ERROR_NO_SEGMENTER: Status = -7;
/// The segmenter was called from its own callback.
pub const SCANSEG_ERROR_BUSY: Status = -8;
/// The scan is over: finished, or stopped by the callback. Reset the segmenter for the next one.
pub const SCANSEG_ERROR_SCAN_OVER: Status = -9;
/// The row does not have one range per column, or not one direction. The row was not taken.
pub const SCANSEG_ERROR_ROW_LENGTH: Status = -10;
/// The angle of the row is NaN, infinite or beyond 6300 rad. The row was not taken.
pub const SCANSEG_ERROR_TURN_ANGLE: Status = -11;
/// The scan already has 65535 rows. The row was not taken.
pub const SCANSEG_ERROR_TOO_MANY_ROWS: Status = -12;
/// The array of labels is too small. Nothing was done.
pub const SCANSEG_ERROR_LABELS_SIZE: Status = -13;
/// The work memory is smaller than `SCANSEG_IMAGE_WORK` says. Nothing was done.
pub const SCANSEG_ERROR_WORK_SIZE: Status = -14;

/// A number or a direction of `scanseg_row_beams` cannot be used. The row was not taken.
pub const SCANSEG_ERROR_ROW_BEAMS: Status = -15;

pub(crate) fn message(status: Status) -> &'static CStr {
    match status {
        SCANSEG_OK => c"success",
        SCANSEG_EVENTS_FULL => c"the array of events was full, some are lost",
        SCANSEG_STOPPED => c"stopped by the callback",
        SCANSEG_NO_PLANE => c"the points have no plane",
        SCANSEG_ERROR_NULL => c"a pointer is NULL",
        SCANSEG_ERROR_STRUCT_SIZE => c"struct_size is not that of this library",
        SCANSEG_ERROR_ABI_VERSION => c"compiled with a header of another ABI version",
        SCANSEG_ERROR_ALIGNMENT => c"a pointer is not aligned",
        SCANSEG_ERROR_MEMORY_SIZE => c"the memory is too small",
        SCANSEG_ERROR_CONFIG => c"a value of the configuration cannot be used",
        SCANSEG_ERROR_NO_SEGMENTER => c"there is no segmenter: not made yet, overwritten or copied",
        SCANSEG_ERROR_BUSY => c"the segmenter was called from its own callback",
        SCANSEG_ERROR_SCAN_OVER => c"the scan is over, reset the segmenter",
        SCANSEG_ERROR_ROW_LENGTH => c"the row does not have one range per column",
        SCANSEG_ERROR_TURN_ANGLE => c"the angle of the row cannot be used",
        SCANSEG_ERROR_TOO_MANY_ROWS => c"too many rows in one scan",
        SCANSEG_ERROR_LABELS_SIZE => c"the array of labels is too small",
        SCANSEG_ERROR_WORK_SIZE => c"the work memory is too small",
        SCANSEG_ERROR_ROW_BEAMS => c"the beams of the row cannot be used",
        _ => c"unknown status",
    }
}
