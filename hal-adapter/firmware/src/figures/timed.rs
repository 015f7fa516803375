//! Segmenters and sinks whose ticks are counted.

use core::ops::ControlFlow;
use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use scanseg_core::{EdgeRow, Finished, Join, LabelRow, PushError, RowBeams, Segment, Segmenter, Sink, Status};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Dropped, RigSink, ScanFinished, ScanStarted};

use super::record::{BEGAN, IN_SEGMENTER, IN_SINK, LATENCY, WORST_END, WORST_ROW, add};
use super::timer::{now, since_telegram};

/// A segmenter, or a sink, whose ticks are counted. Those of a segmenter include its sink's.
#[derive(Debug)]
pub struct Timed<S>(pub S);

fn timed<T>(ticks: &AtomicU32, work: impl FnOnce() -> T) -> T {
    let before = now();
    let done = work();
    add(ticks, now().wrapping_sub(before));
    done
}

/// The same of the segmenter; notes the most ticks without those of the sink.
fn timed_alone<T>(worst: &AtomicU32, work: impl FnOnce() -> T) -> T {
    if !cfg!(feature = "figures") {
        return work();
    }
    // in a static, for there is no stack to spare
    let alone = || IN_SEGMENTER.load(Relaxed).wrapping_sub(IN_SINK.load(Relaxed));
    BEGAN.store(alone(), Relaxed);
    let done = timed(&IN_SEGMENTER, work);
    worst.store(worst.load(Relaxed).max(alone().wrapping_sub(BEGAN.load(Relaxed))), Relaxed);
    done
}

#[deny(clippy::missing_trait_methods)]
impl<S: Segmenter> Segmenter for Timed<S> {
    fn push_row<'r, T: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut T,
    ) -> Result<Status, PushError> {
        let done = timed_alone(&WORST_ROW, || self.0.push_row(ranges_m, beams, sink));
        if cfg!(feature = "figures") {
            LATENCY.store(LATENCY.load(Relaxed).max(since_telegram()), Relaxed);
        }
        done
    }

    fn finish<T: Sink + ?Sized>(&mut self, sink: &mut T) -> Finished {
        timed_alone(&WORST_END, || self.0.finish(sink))
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
