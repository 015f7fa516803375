//! The record of figures that an image sends, and what is counted for it.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

/// A record of figures: this, then [`COUNT`] words, all lowest byte first.
pub const MAGIC: u32 = 0x5E6F_1605;

/// Words behind [`MAGIC`]: ticks, ticks within the segmenter, those of them within its sink
/// (planes, frames), waits, ticks of [`EMPTY_WAITS`] waits for nothing, bytes of stack used, bytes
/// of stack there are, most bytes in the queue, bytes lost by a late interrupt, and by a full
/// queue, ticks of the dearest row, and of the dearest end of a scan, both within the segmenter
/// and without its sink, and of the longest time from the last byte of a telegram to the labels that it
/// gives: interrupts and frames included, 0 where it is not measured.
pub const COUNT: usize = 13;

/// See [`COUNT`].
pub const EMPTY_WAITS: u32 = 1000;

/// Ticks within the segmenter, and within its sink.
pub(super) static IN_SEGMENTER: AtomicU32 = AtomicU32::new(0);
pub(super) static IN_SINK: AtomicU32 = AtomicU32::new(0);

/// Most ticks of one row, and of one end of a scan.
pub(super) static WORST_ROW: AtomicU32 = AtomicU32::new(0);
pub(super) static WORST_END: AtomicU32 = AtomicU32::new(0);

/// Most ticks from the last byte of a telegram to its labels.
pub(super) static LATENCY: AtomicU32 = AtomicU32::new(0);

/// Ticks within the segmenter alone when the row, or the end of a scan, began.
pub(super) static BEGAN: AtomicU32 = AtomicU32::new(0);

/// There is one thread: a load and a store do, which is all that a Cortex-M0 has.
pub(super) fn add(to: &AtomicU32, ticks: u32) {
    to.store(to.load(Relaxed).wrapping_add(ticks), Relaxed);
}
