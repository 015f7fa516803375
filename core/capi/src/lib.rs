//! scanseg for C and C++: the functions of `include/scanseg.h`, which is made from this crate.
//!
//! Segmenters live in the caller's memory ([`State`]), results go to the caller's arrays
//! ([`Output`]), and every call answers with a [`Status`]. It checks and passes on; the work is done by
//! `scanseg-core`, which has no `unsafe`.
//!
//! # Safety of all functions
//! Every pointer may be NULL or not aligned: that is answered with a status. Otherwise it points to
//! as much as its description says, for the time of the call; what is written to overlaps nothing
//! else. A segmenter is used by one thread at a time, and its memory is left alone while it is in
//! use.
#![no_std]
#![allow(clippy::missing_safety_doc)] // the section above

#[cfg(feature = "std")]
extern crate std;

#[cfg(all(not(feature = "std"), not(panic = "abort")))]
compile_error!("without the feature `std` panics must abort: build with the profile `capi`, or for bare metal");

mod check;
mod checked;
mod config;
mod event;
mod image;
mod output;
#[cfg(all(not(feature = "std"), not(test)))]
mod panic;
mod row;
mod state;
mod status;

pub use check::SCANSEG_ABI_VERSION;
pub use config::*;
pub use event::*;
pub use output::*;
pub use row::RowBeams;
pub use state::*;
pub use status::*;

use core::ffi::{c_char, c_void};

use check::check_pointer;
use checked::{Checked, Refused};
use image::{Labels, WORK_PER_LABEL};
use output::Collector;
use scanseg_core::MAX_ROWS;
use state::{Handle, Layout};

/// Version of this header: first number.
pub const SCANSEG_VERSION_MAJOR: u32 = 0;
/// Version of this header: second number.
pub const SCANSEG_VERSION_MINOR: u32 = 1;
/// Version of this header: third number.
pub const SCANSEG_VERSION_PATCH: u32 = 0;

fn status(result: Result<(), Status>) -> Status {
    result.err().unwrap_or(SCANSEG_OK)
}

/// Version of the library, "major.minor.patch".
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_version() -> *const c_char {
    concat!(env!("CARGO_PKG_VERSION"), "\0").as_ptr().cast()
}

/// Version of the library: 10000 * major + 100 * minor + patch.
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_version_number() -> u32 {
    10_000 * SCANSEG_VERSION_MAJOR + 100 * SCANSEG_VERSION_MINOR + SCANSEG_VERSION_PATCH
}

/// `SCANSEG_ABI_VERSION` of the library.
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_abi_version() -> u32 {
    SCANSEG_ABI_VERSION
}

/// What a status means, in a few words. Never NULL.
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_strerror(status: Status) -> *const c_char {
    status::message(status).as_ptr()
}

/// Sets a configuration to the defaults:
/// `scanseg_config_init(&config, sizeof config, SCANSEG_ABI_VERSION)`.
///
/// @return `SCANSEG_OK`, or an error if the header is of another version than the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_config_init(config: *mut Config, struct_size: u32, abi_version: u32) -> Status {
    if let Err(error) = check_pointer(config) {
        return error;
    }
    if abi_version != SCANSEG_ABI_VERSION {
        return SCANSEG_ERROR_ABI_VERSION;
    }
    if struct_size as usize != size_of::<Config>() {
        return SCANSEG_ERROR_STRUCT_SIZE;
    }
    // SAFETY: not NULL, aligned, of this size.
    unsafe { config.write(Config::defaults(struct_size, abi_version)) };
    SCANSEG_OK
}

/// Name of the first field of a configuration that cannot be used; NULL if there is none, or no
/// configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_bad_field(config: *const Config) -> *const c_char {
    // SAFETY: the caller's promise, at the head of the crate.
    match unsafe { Checked::read(config) } {
        Err(Refused { field: Some(field), .. }) => field.as_ptr(),
        _ => core::ptr::null(),
    }
}

/// Bytes that a segmenter of this configuration needs: at most `SCANSEG_STATE_SIZE(columns)`, or
/// what `SCANSEG_STATE_SIZE_WITH` gives. To be aligned to `SCANSEG_STATE_ALIGN`, which any memory
/// of `malloc` is.
///
/// @param size is set to the bytes; to 0 if there is an error.
/// @return `SCANSEG_OK`, or what is wrong with the configuration.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_state_size(config: *const Config, size: *mut usize) -> Status {
    if let Err(error) = check_pointer(size) {
        return error;
    }
    // SAFETY: the caller's promise, at the head of the crate.
    let (bytes, status) = match unsafe { Checked::read(config) } {
        Ok(checked) => (Layout::of(&checked).bytes, SCANSEG_OK),
        Err(refused) => (0, refused.status),
    };
    // SAFETY: not NULL, aligned.
    unsafe { size.write(bytes) };
    status
}

/// `SCANSEG_STATE_ALIGN` of the library.
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_state_align() -> usize {
    state::SCANSEG_STATE_ALIGN
}

/// Makes a segmenter in `memory`, ready for the first row. What the memory held before does not
/// matter. The memory stays the caller's, who leaves it alone until done with the segmenter.
///
/// @param size bytes of `memory`; see `scanseg_state_size`.
/// @param segmenter is set to the segmenter, which is at the start of `memory`; to NULL if there is
///        an error.
/// @return `SCANSEG_OK`, or what is wrong.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_init(
    memory: *mut c_void,
    size: usize,
    config: *const Config,
    segmenter: *mut *mut State,
) -> Status {
    if let Err(error) = check_pointer(segmenter) {
        return error;
    }
    // SAFETY: the caller's promise, at the head of the crate.
    let made = unsafe {
        Checked::read(config)
            .map_err(|refused| refused.status)
            .and_then(|checked| state::make(memory.cast(), size, &checked))
    };
    // SAFETY: not NULL, aligned.
    unsafe { segmenter.write(made.unwrap_or(core::ptr::null_mut())) };
    status(made.map(|_| ()))
}

/// Takes the next row. Work is linear in the columns, whatever is seen: `SCANSEG_PLANE` takes up to
/// seven times as much for scenes that no plane explains as for an office.
///
/// @param ranges_m one range per column, metres along the beam. NaN, infinite and non-positive
///        ranges, and those outside of the configured limits, are pixels without a return.
/// @param columns elements of `ranges_m`; must be the columns of the image.
/// @param turn_rad the row's turn (nodding) or elevation (spinning), radians; a camera does not use
///        it.
/// @param output is given the labels of this row (`SCANSEG_EDGE`: of the row `SCANSEG_LATENCY_ROWS`
///        earlier, if there is one), and the joins and segments that it brings. After an error it
///        is as it was.
/// @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED`, or an error: then the row was
///        not taken.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_push_row(
    segmenter: *mut State,
    ranges_m: *const f32,
    columns: usize,
    turn_rad: f32,
    output: *mut Output,
) -> Status {
    // SAFETY: the caller's promise, at the head of the crate.
    unsafe { scanseg_push_row_beams(segmenter, ranges_m, columns, &RowBeams::at(turn_rad), output) }
}

/// Sets the beams of a row to those at this turn angle, and nothing else:
/// `scanseg_row_beams_init(&beams, sizeof beams, turn_rad)`.
///
/// @return `SCANSEG_OK`, or an error if the header is of another version than the library.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_row_beams_init(beams: *mut RowBeams, struct_size: u32, turn_rad: f32) -> Status {
    if let Err(error) = check_pointer(beams) {
        return error;
    }
    if struct_size as usize != size_of::<RowBeams>() {
        return SCANSEG_ERROR_STRUCT_SIZE;
    }
    // SAFETY: not NULL, aligned, of this size.
    unsafe { beams.write(RowBeams::at(turn_rad)) };
    SCANSEG_OK
}

/// The same as `scanseg_push_row`, for a row whose beams lie beside where its turn alone says.
///
/// @param beams where they lie. It is not kept.
/// @return as `scanseg_push_row`, and `SCANSEG_ERROR_ROW_BEAMS` for beams that cannot be used.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_push_row_beams(
    segmenter: *mut State,
    ranges_m: *const f32,
    columns: usize,
    beams: *const RowBeams,
    output: *mut Output,
) -> Status {
    let push = || {
        // SAFETY: the caller's promise, at the head of the crate.
        let mut handle = unsafe { Handle::new(segmenter)? };
        handle.scanning()?;
        check_pointer(ranges_m)?;
        if columns != handle.columns {
            return Err(SCANSEG_ERROR_ROW_LENGTH);
        }
        // SAFETY: not NULL, aligned, and the caller's promise.
        let (ranges_m, beams, mut collector) = unsafe {
            let beams = RowBeams::read(beams)?;
            (core::slice::from_raw_parts(ranges_m, columns), beams, Collector::new(output, 1, columns, None)?)
        };
        let stopped = handle.push_row(ranges_m, beams, &mut collector)?;
        let done = collector.done(0, handle.beam_stretch());
        Ok(if stopped { SCANSEG_STOPPED } else { done })
    };
    push().unwrap_or_else(|error| error)
}

/// Ends the scan: gives out the labels that were still waiting (`SCANSEG_EDGE`: up to
/// `SCANSEG_LATENCY_ROWS` rows) and completes all segments. Before the next scan the segmenter is
/// to be reset.
///
/// @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED`, or an error: then the scan goes
///        on.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_finish(segmenter: *mut State, output: *mut Output) -> Status {
    let finish = || {
        // SAFETY: the caller's promise, at the head of the crate.
        let mut handle = unsafe { Handle::new(segmenter)? };
        handle.scanning()?;
        let rows = handle.latency_rows();
        // SAFETY: as above.
        let mut collector = unsafe { Collector::new(output, rows, handle.columns, None)? };
        let beam_stretch = handle.beam_stretch();
        let scan_rows = handle.finish(&mut collector);
        let done = collector.done(scan_rows.unwrap_or(0), beam_stretch);
        Ok(if scan_rows.is_none() { SCANSEG_STOPPED } else { done })
    };
    finish().unwrap_or_else(|error| error)
}

/// Drops what was pushed, if anything: the next row is the first of a new scan.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_reset(segmenter: *mut State) -> Status {
    // SAFETY: the caller's promise, at the head of the crate.
    status(unsafe { Handle::new(segmenter) }.map(|mut handle| handle.reset()))
}

/// Segments a whole image in one call, in place of `scanseg_push_row` for each row and
/// `scanseg_finish`, and applies all joins: each pixel has the label that its surface has in the end,
/// and the events are the segments that are left, each once, in the order of their labels. Any scan
/// that is under way is dropped before; the next image needs no reset. Work is linear in the pixels.
///
/// Where room runs out the result is still defined. Segments that do not fit in `events` are
/// counted: `event_count + events_lost` is the number of segments, and their labels are right.
/// Pixels for which the segmenter's table had no room are `SCANSEG_UNLABELLED`, and counted.
///
/// @param ranges_m `rows` times `columns` ranges, row after row; see `scanseg_push_row`.
/// @param rows rows of the image, up to 65535.
/// @param columns must be the columns of the segmenter.
/// @param turns_rad the turn (nodding) or elevation (spinning) of each row, radians; a camera and free
///        beams need none, and may have NULL.
/// @param directions with `SCANSEG_FREE` the directions of all pixels, x, y and z of each, row after
///        row: `3 * rows * columns` numbers; otherwise NULL.
/// @param work memory of yours that the call works in; what it holds before and afterwards does not
///        matter.
/// @param work_capacity elements of `work`: at least `SCANSEG_IMAGE_WORK(rows, columns)`.
/// @param output is given the labels of the image and its segments. The callback, if there is one,
///        is told each join and segment as they come, before the joins are applied.
/// @return `SCANSEG_OK`, `SCANSEG_EVENTS_FULL`, `SCANSEG_STOPPED` (the output has the rows and
///        segments so far), or an error. A turn angle or a direction that cannot be used is found when its row comes:
///        then the arrays hold nothing of use, and the scan is dropped.
#[unsafe(no_mangle)]
#[allow(clippy::too_many_arguments)] // arrays of C come with their lengths
pub unsafe extern "C" fn scanseg_segment_image(
    segmenter: *mut State,
    ranges_m: *const f32,
    rows: usize,
    columns: usize,
    turns_rad: *const f32,
    directions: *const f32,
    work: *mut u32,
    work_capacity: usize,
    output: *mut Output,
) -> Status {
    let segment = || {
        // SAFETY: the caller's promise, at the head of the crate.
        let mut handle = unsafe { Handle::new(segmenter)? };
        check_pointer(ranges_m)?;
        if !(turns_rad.is_null() && (handle.camera() || handle.free())) {
            check_pointer(turns_rad)?;
        }
        if handle.free() {
            check_pointer(directions)?;
        }
        check_pointer(work)?;
        if columns != handle.columns {
            return Err(SCANSEG_ERROR_ROW_LENGTH);
        }
        if rows > MAX_ROWS {
            return Err(SCANSEG_ERROR_TOO_MANY_ROWS);
        }
        let labels = rows * columns + 1;
        if work_capacity < WORK_PER_LABEL * labels {
            return Err(SCANSEG_ERROR_WORK_SIZE);
        }
        // SAFETY: not NULL, aligned, and the caller's promise; zeros are entries.
        let mut collector = unsafe {
            work.write_bytes(0, WORK_PER_LABEL * labels);
            let entries = core::slice::from_raw_parts_mut(work.cast(), labels);
            Collector::new(output, rows, columns, Some(Labels::new(entries)))?
        };
        handle.reset();
        for row in 0..rows {
            // SAFETY: not NULL, aligned, and the caller's promise.
            let (row_m, beams) = unsafe {
                let mut beams = RowBeams::at(if turns_rad.is_null() { 0.0 } else { turns_rad.add(row).read() });
                if handle.free() {
                    (beams.directions, beams.direction_count) = (directions.add(3 * row * columns), 3 * columns);
                }
                (core::slice::from_raw_parts(ranges_m.add(row * columns), columns), RowBeams::read(&beams)?)
            };
            match handle.push_row(row_m, beams, &mut collector) {
                Ok(false) => {}
                Ok(true) => {
                    collector.done(0, handle.beam_stretch());
                    return Ok(SCANSEG_STOPPED);
                }
                Err(error) => {
                    handle.reset();
                    return Err(error);
                }
            }
        }
        let beam_stretch = handle.beam_stretch();
        let scan_rows = handle.finish(&mut collector);
        let done = collector.done(scan_rows.unwrap_or(0), beam_stretch);
        Ok(if scan_rows.is_none() { SCANSEG_STOPPED } else { done })
    };
    segment().unwrap_or_else(|error| error)
}

/// The plane of a segment. `SCANSEG_PLANE`: that of least squares of the range errors, some 300
/// operations in single precision; segments of one row have none. Else: that of total least squares,
/// some 2000 operations in double precision; ask for the segments that matter.
///
/// @param segment an event of the kind `SCANSEG_SEGMENT`.
/// @param plane is set to the plane, unless there is none or an error.
/// @return `SCANSEG_OK`, `SCANSEG_NO_PLANE` or an error.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn scanseg_fit_plane(segment: *const Event, plane: *mut PlaneFit) -> Status {
    if let Err(error) = check_pointer(segment).and(check_pointer(plane)) {
        return error;
    }
    // SAFETY: both not NULL and aligned; numbers may have any value.
    match unsafe { event::fit_plane(&*segment) } {
        Ok(fit) => {
            // SAFETY: as above.
            unsafe { plane.write(fit) };
            SCANSEG_OK
        }
        Err(status) => status,
    }
}
