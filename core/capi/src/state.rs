//! A segmenter in the caller's memory.
//!
//! ```text
//! memory: | State: number, own address, columns, phase, AnySegmenter | areas | numbers | words | angles | halves | traces |
//!                                                       |               ^       ^         ^       ^        ^        ^
//!                                                       +---------------+-------+---------+-------+--------+--------+
//! ```
//!
//! The segmenter refers to the slices behind it, with the lifetime `'static`. That is sound because
//! - the slices do not overlap the `State` nor each other, and nothing but the segmenter ever
//!   touches them: calls only borrow parts of the `State`, by raw pointers to its fields;
//! - the block stays where it is: a `State` knows its own address, so that a copy is told from it;
//! - nothing outlives the block: the segmenter is never moved out of it, and gives out no reference
//!   beyond a call;
//! - neither `State` nor segmenter have anything to drop, so that the memory may simply be used for
//!   something else.
//!
//! The caller's part, which the header states: while the segmenter is in use the block is not
//! written to.

use scanseg_core::{AnySegmenter, Area, Finished, Memory, PushError, RowBeams, Segmenter, Sink, Sizes, Trace};

use crate::checked::Checked;
use crate::config::{SCANSEG_FREE, SCANSEG_PINHOLE};
use crate::status::{
    SCANSEG_ERROR_ALIGNMENT, SCANSEG_ERROR_BUSY, SCANSEG_ERROR_CONFIG, SCANSEG_ERROR_MEMORY_SIZE,
    SCANSEG_ERROR_NO_SEGMENTER, SCANSEG_ERROR_NULL, SCANSEG_ERROR_ROW_BEAMS, SCANSEG_ERROR_ROW_LENGTH,
    SCANSEG_ERROR_SCAN_OVER, SCANSEG_ERROR_TOO_MANY_ROWS, SCANSEG_ERROR_TURN_ANGLE, Status,
};

/// Alignment of the memory of a segmenter, bytes.
pub const SCANSEG_STATE_ALIGN: usize = 8;

/// A segmenter, in memory of yours.
#[repr(align(8))]
pub struct State {
    /// Tells a segmenter from any other memory.
    number: u64,
    /// Where it was made.
    address: usize,
    columns: usize,
    phase: Phase,
    /// Whether rows have no angle.
    camera: bool,
    /// Whether rows bring their directions.
    free: bool,
    /// Its references are those that the module describes.
    segmenter: AnySegmenter<'static>,
}

const _: () = assert!(align_of::<State>() == SCANSEG_STATE_ALIGN);
// the fixed part of SCANSEG_STATE_SIZE_WITH
const _: () = assert!(size_of::<State>() <= 1536);

const NUMBER: u64 = 0x5ca2_5e61_a11f_0001;

/// What a segmenter may be asked for.
#[derive(Clone, Copy, PartialEq)]
#[repr(u32)]
enum Phase {
    /// The next row.
    Scanning,
    /// Nothing: a call is under way.
    Busy,
    /// To be reset.
    Over,
}

/// Where everything is in the block, in bytes.
pub(crate) struct Layout {
    sizes: Sizes,
    angles: usize,
    traces: usize,
    /// All of it.
    pub bytes: usize,
}

impl Layout {
    pub fn of(checked: &Checked) -> Layout {
        let columns = checked.config.columns as usize;
        let mut sizes = checked.sizes();
        if checked.config.max_labels > 0 {
            sizes.areas = sizes.areas.min(checked.config.max_labels as usize);
        }
        let angles = checked.lists() * columns;
        let bytes = size_of::<State>() + sizes.bytes() + size_of::<f32>() * angles + size_of_val(checked.used_traces());
        Layout { sizes, angles, traces: checked.used_traces().len(), bytes }
    }
}

/// Gives out the parts of a block, one after the other.
struct Parts {
    next: *mut u8,
}

impl Parts {
    /// # Safety
    /// The block has that many elements left, aligned, all zeros, and nothing else refers to them
    /// for as long as the slice is used. All zeros are a value of `T`.
    unsafe fn take<T: 'static>(&mut self, count: usize) -> &'static mut [T] {
        let start = self.next.cast::<T>();
        // SAFETY: the caller's promise.
        unsafe {
            self.next = start.add(count).cast();
            core::slice::from_raw_parts_mut(start, count)
        }
    }
}

/// Makes a segmenter at the start of `memory`.
///
/// # Safety
/// `memory` is NULL or points to `size` bytes that nothing else refers to while the segmenter is in
/// use.
pub(crate) unsafe fn make(memory: *mut u8, size: usize, checked: &Checked) -> Result<*mut State, Status> {
    if memory.is_null() {
        return Err(SCANSEG_ERROR_NULL);
    }
    if !memory.addr().is_multiple_of(SCANSEG_STATE_ALIGN) {
        return Err(SCANSEG_ERROR_ALIGNMENT);
    }
    let layout = Layout::of(checked);
    if size < layout.bytes {
        return Err(SCANSEG_ERROR_MEMORY_SIZE);
    }
    let state = memory.cast::<State>();
    let sizes = layout.sizes;
    // SAFETY: The block has `layout.bytes`, which is the sum of the parts. It is aligned to 8, the
    // size of the state is a multiple of 8, and the parts come with falling alignment (4, 4, 4, 4,
    // 2, 1). All are plain numbers, so that zeros are values of them. The parts do not overlap, and
    // the module says why nothing else refers to them.
    let (memory, angles, traces) = unsafe {
        memory.write_bytes(0, layout.bytes);
        let mut parts = Parts { next: state.add(1).cast() };
        let areas = parts.take::<Area>(sizes.areas);
        let numbers = parts.take::<f32>(sizes.numbers);
        let words = parts.take::<u32>(sizes.words);
        let angles = parts.take::<f32>(layout.angles);
        let halves = parts.take::<u16>(sizes.halves);
        let traces = parts.take::<Trace>(layout.traces);
        (Memory { numbers, halves, words, areas }, angles, traces)
    };
    // of the same lengths, where there are any
    let listed = checked.angles_rad.iter().chain(checked.turns_rad);
    angles.iter_mut().zip(listed).for_each(|(to, &angle_rad)| *to = angle_rad);
    traces.iter_mut().zip(checked.used_traces()).for_each(|(to, &trace)| *to = trace);
    let columns = checked.config.columns as usize;
    let (angles, turns) = angles.split_at_checked(columns).unwrap_or((angles, &[]));
    let segmenter = AnySegmenter::new(checked.any_config(traces), checked.beams(angles, turns), columns, memory);
    // cannot fail: everything was checked before
    let segmenter = segmenter.map_err(|_| SCANSEG_ERROR_CONFIG)?;
    let [camera, free] = [SCANSEG_PINHOLE, SCANSEG_FREE].map(|kind| checked.config.beams == kind);
    let (address, phase) = (state.addr(), Phase::Scanning);
    let made = State { number: NUMBER, address, columns, phase, camera, free, segmenter };
    // SAFETY: the block is aligned and large enough, and no part reaches in here.
    unsafe { state.write(made) };
    Ok(state)
}

/// A segmenter that was found in good order, for one call.
pub(crate) struct Handle {
    state: *mut State,
    pub columns: usize,
}

impl Handle {
    /// # Safety
    /// `state` is NULL or points to memory of the size of a `State` that was written to at some
    /// time.
    pub unsafe fn new(state: *mut State) -> Result<Handle, Status> {
        if state.is_null() {
            return Err(SCANSEG_ERROR_NULL);
        }
        if !state.is_aligned() {
            return Err(SCANSEG_ERROR_ALIGNMENT);
        }
        // SAFETY: aligned, not NULL; numbers may have any value. The phase is read only of a
        // segmenter.
        let (columns, phase) = unsafe {
            if (*state).number != NUMBER || (*state).address != state.addr() {
                return Err(SCANSEG_ERROR_NO_SEGMENTER);
            }
            ((*state).columns, (*state).phase)
        };
        if phase == Phase::Busy { Err(SCANSEG_ERROR_BUSY) } else { Ok(Handle { state, columns }) }
    }

    /// Refuses a scan that is over.
    pub fn scanning(&self) -> Result<(), Status> {
        // SAFETY: `new` has found a segmenter there.
        let phase = unsafe { (*self.state).phase };
        if phase == Phase::Over { Err(SCANSEG_ERROR_SCAN_OVER) } else { Ok(()) }
    }

    /// Uses the segmenter, and refuses other uses meanwhile: a callback might try.
    fn with<T>(&mut self, then: Phase, work: impl FnOnce(&mut AnySegmenter<'static>) -> (T, bool)) -> T {
        let state = self.state;
        // SAFETY: `new` has found a segmenter there that is not in use. Only this field is
        // borrowed, and while it is, the phase keeps others from borrowing it.
        let segmenter = unsafe {
            (*state).phase = Phase::Busy;
            &mut (*state).segmenter
        };
        let (result, over) = work(segmenter);
        // SAFETY: as above.
        unsafe { (*state).phase = if over { Phase::Over } else { then } };
        result
    }

    /// Whether rows have no angle.
    pub fn camera(&self) -> bool {
        // SAFETY: `new` has found a segmenter there.
        unsafe { (*self.state).camera }
    }

    /// Whether rows bring their directions.
    pub fn free(&self) -> bool {
        // SAFETY: `new` has found a segmenter there.
        unsafe { (*self.state).free }
    }

    /// Rows of labels that `finish` may give out.
    pub fn latency_rows(&self) -> usize {
        // SAFETY: `new` has found a segmenter there that is not in use.
        unsafe { &(*self.state).segmenter }.latency_rows()
    }

    /// The share by which beam angles are too small, as the scan so far tells it.
    pub fn beam_stretch(&self) -> f32 {
        // SAFETY: `new` has found a segmenter there that is not in use.
        match unsafe { &(*self.state).segmenter } {
            AnySegmenter::Plane(planes) => planes.beam_stretch(),
            AnySegmenter::Edge(_) | AnySegmenter::Region(_) => 0.0,
        }
    }

    /// Takes a row. Whether the sink broke off.
    pub fn push_row(&mut self, ranges_m: &[f32], beams: RowBeams, sink: &mut impl Sink) -> Result<bool, Status> {
        let pushed = self.with(Phase::Scanning, |segmenter| {
            let pushed = segmenter.push_row(ranges_m, beams, sink);
            (pushed, pushed == Ok(scanseg_core::Status::Stopped))
        });
        match pushed {
            Ok(status) => Ok(status == scanseg_core::Status::Stopped),
            Err(PushError::RowLength { .. }) => Err(SCANSEG_ERROR_ROW_LENGTH),
            Err(PushError::TurnAngle { .. }) => Err(SCANSEG_ERROR_TURN_ANGLE),
            Err(PushError::RowBeams { .. } | PushError::Direction { .. }) => Err(SCANSEG_ERROR_ROW_BEAMS),
            Err(_) => Err(SCANSEG_ERROR_TOO_MANY_ROWS),
        }
    }

    /// Ends the scan. Its rows, or `None` where the sink broke off.
    pub fn finish(&mut self, sink: &mut impl Sink) -> Option<usize> {
        let finished = self.with(Phase::Over, |segmenter| (segmenter.finish(sink), true));
        match finished {
            Finished::Complete { rows, .. } => Some(rows),
            Finished::Stopped => None,
        }
    }

    pub fn reset(&mut self) {
        self.with(Phase::Scanning, |segmenter| (segmenter.reset(), false));
    }
}
