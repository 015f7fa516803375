//! What a call gives out: labels and events, into arrays of the caller.

use core::ffi::c_void;
use core::ops::ControlFlow;

use scanseg_core::{Join, LabelRow, Moments, Pixel, Segment, SegmentSums, Sink};

use crate::check::{check_pointer, check_struct};
use crate::event::{Event, SCANSEG_JOIN, SCANSEG_SEGMENT};
use crate::image::{Events, Labels};
use crate::status::{SCANSEG_ERROR_LABELS_SIZE, SCANSEG_EVENTS_FULL, SCANSEG_OK, Status};

/// A pixel: nothing was measured.
pub const SCANSEG_NO_RETURN: u32 = 0;
/// A pixel: part of an edge; of the approaches by plane and region: on no surface.
pub const SCANSEG_ON_EDGE: u32 = 0xFFFF_FFFF;
/// A pixel: part of an area that got no label, because the table of live labels was full.
pub const SCANSEG_UNLABELLED: u32 = 0xFFFF_FFFE;

/// Rows of labels that `scanseg_finish` gives out at most: `SCANSEG_EDGE` is so many rows late, the
/// others are not.
pub const SCANSEG_LATENCY_ROWS: usize = 3;

/// Called with each event while a call runs: `user` is that of the output, the event lives for the
/// call. Answer 0 to go on, anything else to drop the scan. It must return (no exception, no
/// longjmp), and must not use the segmenter.
pub type OnEvent = Option<unsafe extern "C" fn(user: *mut c_void, event: *const Event) -> i32>;

/// Where a call puts what it finds, and how much that was. Start with `SCANSEG_OUTPUT_INIT`, set
/// what you want, and use it for all calls. Everything may be left out: without labels and events
/// only the callback is told, and so on.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Output {
    /// `sizeof(scanseg_output)`.
    pub struct_size: u32,
    /// Given out: number of the first row of `labels`.
    pub first_row: u32,
    /// For the labels, one per pixel, row after row: the label of a segment, `SCANSEG_NO_RETURN`,
    /// `SCANSEG_ON_EDGE` or `SCANSEG_UNLABELLED`. NULL: no labels.
    pub labels: *mut u32,
    /// Elements of `labels`: at least `columns` for `scanseg_push_row`, and with `SCANSEG_EDGE`
    /// `SCANSEG_LATENCY_ROWS * columns` for `scanseg_finish`; `rows * columns` for
    /// `scanseg_segment_image`.
    pub label_capacity: usize,
    /// For the events, in their order. NULL: no events.
    pub events: *mut Event,
    /// Elements of `events`; for one row `SCANSEG_MAX_EVENTS(columns)` always suffice.
    pub event_capacity: usize,
    /// Called with each event; or NULL. Needs no array.
    pub on_event: OnEvent,
    /// For the callback.
    pub user: *mut c_void,
    /// Given out: events in `events`.
    pub event_count: usize,
    /// Given out: events that did not fit; by `scanseg_segment_image` also where there is no array.
    pub events_lost: usize,
    /// Given out: rows in `labels`, or that would be if there were `labels`.
    pub row_count: u32,
    /// Given out: pixels in these rows that got no label, because the table of live labels was
    /// full.
    pub unlabelled: u32,
    /// Given out by `scanseg_finish` and `scanseg_segment_image`: rows of the scan.
    pub scan_rows: u32,
    /// Given out: the share by which beam angles are too small, as the walls of the scan so far tell
    /// it. 0.01: a beam that is said to be 30 deg from the middle one is 30.3 deg from it, and
    /// planes are those of the points along such beams. 0 where angles are right or nothing tells,
    /// and but for `SCANSEG_PLANE` with nodding beams; else 0.003 to 0.12 either way.
    pub beam_stretch: f32,
}

/// Takes the results of one call.
pub(crate) struct Collector<'a> {
    to: *mut Output,
    output: Output,
    /// Labels that were given out.
    pixels: usize,
    events: Events,
    /// Of a whole image.
    image: Option<Labels<'a>>,
}

impl<'a> Collector<'a> {
    /// Checks an output for a call that gives out up to `rows` rows, of a whole `image` or not.
    ///
    /// # Safety
    /// `output` is NULL or points to `struct_size` bytes, its arrays have as many elements as it
    /// says, nothing of them overlaps, and all stay until the collector is done.
    pub unsafe fn new(
        to: *mut Output,
        rows: usize,
        columns: usize,
        image: Option<Labels<'a>>,
    ) -> Result<Collector<'a>, Status> {
        // SAFETY: the caller's promise; no more than the size is read before that is checked.
        let mut output = unsafe {
            check_struct(to, &raw const (*to).struct_size)?;
            to.read()
        };
        if !output.labels.is_null() {
            check_pointer(output.labels)?;
            if output.label_capacity < rows * columns {
                return Err(SCANSEG_ERROR_LABELS_SIZE);
            }
        }
        if output.event_capacity > 0 || !output.events.is_null() {
            check_pointer(output.events)?;
        }
        (output.first_row, output.row_count, output.unlabelled, output.scan_rows) = (0, 0, 0, 0);
        // SAFETY: the pointer was checked, and the caller promises the capacity.
        let events = unsafe { Events::new(output.events, output.event_capacity) };
        Ok(Collector { to, output, pixels: 0, events, image })
    }

    /// Tells the caller how much there is, and by what share beam angles are too small.
    pub fn done(mut self, scan_rows: usize, beam_stretch: f32) -> Status {
        self.finish_image();
        let Collector { to, mut output, events, image, .. } = self;
        (output.scan_rows, output.beam_stretch) = (scan_rows as u32, beam_stretch);
        (output.event_count, output.events_lost) = (events.count, events.lost);
        let full = events.lost > 0 && !output.events.is_null();
        if image.is_none() && !full {
            output.events_lost = 0;
        }
        // SAFETY: `new` has read from there, and its caller promised that it stays.
        unsafe { to.write(output) };
        if full { SCANSEG_EVENTS_FULL } else { SCANSEG_OK }
    }

    /// Applies the joins to the labels of an image.
    fn finish_image(&mut self) {
        let Some(image) = &mut self.image else { return };
        image.finish(&mut self.events);
        let labels = self.output.labels;
        if labels.is_null() {
            return;
        }
        for i in 0..self.pixels {
            // SAFETY: `row` has written so many.
            unsafe { labels.add(i).write(image.find(labels.add(i).read())) };
        }
    }

    /// Takes a join or a segment: into the array, and to the callback.
    fn event(&mut self, event: &Event) -> ControlFlow<()> {
        match &mut self.image {
            None => {
                self.events.push(event);
            }
            Some(image) if event.kind == SCANSEG_JOIN => image.join(event.label, event.into, &mut self.events),
            Some(image) => image.segment(event, &mut self.events),
        }
        let Some(on_event) = self.output.on_event else { return ControlFlow::Continue(()) };
        // SAFETY: the caller gave this function for this use; the event lives for the call.
        match unsafe { on_event(self.output.user, event) } {
            0 => ControlFlow::Continue(()),
            _ => ControlFlow::Break(()),
        }
    }
}

impl Sink for Collector<'_> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        let out = &mut self.output;
        if out.row_count == 0 {
            out.first_row = row.row() as u32;
        }
        out.row_count += 1;
        for pixel in row.pixels() {
            let label = match pixel {
                Pixel::NoReturn => SCANSEG_NO_RETURN,
                Pixel::Edge => SCANSEG_ON_EDGE,
                Pixel::Segment(label) => label.0,
                Pixel::Unlabelled => {
                    out.unlabelled += 1;
                    SCANSEG_UNLABELLED
                }
            };
            if !out.labels.is_null() && self.pixels < out.label_capacity {
                // SAFETY: `new` has checked the pointer, and its caller promised the capacity.
                unsafe { out.labels.add(self.pixels).write(label) };
                self.pixels += 1;
            }
        }
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.event(&Event { kind: SCANSEG_JOIN, label: join.from.0, into: join.into.0, ..Event::default() })
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        let (moments, plane_sums) = match segment.sums {
            SegmentSums::Moments(moments) => (moments, [0.0; 15]),
            SegmentSums::Fitted { fitted, .. } => (Moments::default(), fitted.numbers()),
            _ => (Moments::default(), [0.0; 15]),
        };
        self.event(&Event {
            kind: SCANSEG_SEGMENT,
            label: segment.label.0,
            into: 0,
            pixels: segment.pixels(),
            first_row: segment.first_row,
            last_row: segment.last_row,
            first_column: segment.first_column,
            last_column: segment.last_column,
            first_moments: moments.first,
            second_moments: moments.second,
            plane_sums,
        })
    }
}
