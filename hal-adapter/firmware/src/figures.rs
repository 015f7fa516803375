//! Figures of a run: instructions, stack. Without the feature `figures` there is nothing of it in
//! the image.
//!
//! A timer counts while the program has something to do and stands while it waits for a byte. Under
//! QEMU's `-icount shift=6` an instruction takes 64 ns of its time, so that the figures do not
//! depend on the host, nor on when the bytes come.

use core::ops::ControlFlow;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use scanseg_core::{EdgeRow, Finished, Join, LabelRow, PushError, Segment, Segmenter, Sink, Status};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Dropped, RigSink, ScanFinished, ScanStarted};

/// A record of figures: this, then [`COUNT`] words, all lowest byte first.
pub const MAGIC: u32 = 0x5E6F_1605;

/// Words behind [`MAGIC`]: ticks, ticks within the segmenter, those of them within its sink
/// (planes, frames), waits, ticks of [`EMPTY_WAITS`] waits for nothing, bytes of stack used, bytes
/// of stack there are.
pub const COUNT: usize = 7;

/// See [`COUNT`].
pub const EMPTY_WAITS: u32 = 1000;

#[cfg(all(feature = "figures", target_os = "none"))]
mod timer;
#[cfg(all(feature = "figures", target_os = "none"))]
pub use timer::{begin, now, pause, resume, send};

#[cfg(not(all(feature = "figures", target_os = "none")))]
mod nothing {
    //! In place of the timer.
    /// Starts the timer.
    #[inline(always)]
    pub fn begin() {}
    /// Stops the timer: a wait begins.
    #[inline(always)]
    pub fn pause() {}
    /// The wait is over.
    #[inline(always)]
    pub fn resume() {}
    /// Ticks so far.
    #[inline(always)]
    pub fn now() -> u32 {
        0
    }
    /// Sends the record.
    #[inline(always)]
    pub fn send(_link: impl embedded_io::Write) {}
}
#[cfg(not(all(feature = "figures", target_os = "none")))]
pub use nothing::{begin, now, pause, resume, send};

/// Ticks within the segmenter, and within its sink.
static IN_SEGMENTER: AtomicU32 = AtomicU32::new(0);
static IN_SINK: AtomicU32 = AtomicU32::new(0);

/// A segmenter, or a sink, whose ticks are counted. Those of a segmenter include its sink's.
#[derive(Debug)]
pub struct Timed<S>(pub S);

fn timed<T>(ticks: &AtomicU32, work: impl FnOnce() -> T) -> T {
    let before = now();
    let done = work();
    add(ticks, now().wrapping_sub(before));
    done
}

#[deny(clippy::missing_trait_methods)]
impl<S: Segmenter> Segmenter for Timed<S> {
    fn push_row<T: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        turn_rad: f32,
        sink: &mut T,
    ) -> Result<Status, PushError> {
        timed(&IN_SEGMENTER, || self.0.push_row(ranges_m, turn_rad, sink))
    }

    fn finish<T: Sink + ?Sized>(&mut self, sink: &mut T) -> Finished {
        timed(&IN_SEGMENTER, || self.0.finish(sink))
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn latency_rows(&self) -> usize {
        self.0.latency_rows()
    }
}

/// Rows of labels and of edges are not timed: the link does not carry them.
#[deny(clippy::missing_trait_methods)]
impl<S: Sink> Sink for Timed<S> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.0.row(row)
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        timed(&IN_SINK, || self.0.join(join))
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        timed(&IN_SINK, || self.0.segment(segment))
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        self.0.edges(row)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<S: RigSink> RigSink for Timed<S> {
    fn scan_started(&mut self, scan: &ScanStarted) {
        self.0.scan_started(scan);
    }

    fn row_dropped(&mut self, dropped: Dropped) {
        self.0.row_dropped(dropped);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.0.scan_finished(scan);
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.0.trouble(trouble);
    }
}

/// There is one thread: a load and a store do, which is all that a Cortex-M0 has.
fn add(to: &AtomicU32, ticks: u32) {
    to.store(to.load(Relaxed).wrapping_add(ticks), Relaxed);
}
