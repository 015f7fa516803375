//! Figures of a run: instructions, stack. Without the feature `figures` there is nothing of it in the image.
//!
//! A timer counts while the program has something to do and stands while it waits for a byte. Under QEMU's
//! `-icount shift=6` an instruction takes 64 ns of its time, so that the figures do not depend on the host, nor on when the
//! bytes come.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use scanseg_core::{Finished, PushError, Sink, Status};
use scanseg_hal::rig::RowSegmenter;

/// A record of figures: this, then [`COUNT`] words, all lowest byte first.
pub const MAGIC: u32 = 0x5E6F_1605;

/// Words behind [`MAGIC`]: ticks, ticks within the segmenter, waits, ticks of [`EMPTY_WAITS`] waits for nothing, bytes of
/// stack used, bytes of stack there are.
pub const COUNT: usize = 6;

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

/// Ticks within the segmenter.
static IN_SEGMENTER: AtomicU32 = AtomicU32::new(0);

/// A segmenter whose ticks are counted, those of its sink included.
#[derive(Debug)]
pub struct Timed<S>(pub S);

impl<S: RowSegmenter> RowSegmenter for Timed<S> {
    fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
        let before = now();
        let status = self.0.push_row(ranges_m, turn_rad, sink);
        add(&IN_SEGMENTER, now().wrapping_sub(before));
        status
    }

    fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        let before = now();
        let finished = self.0.finish(sink);
        add(&IN_SEGMENTER, now().wrapping_sub(before));
        finished
    }
}

/// There is one thread: a load and a store do, which is all that a Cortex-M0 has.
fn add(to: &AtomicU32, ticks: u32) {
    to.store(to.load(Relaxed).wrapping_add(ticks), Relaxed);
}
