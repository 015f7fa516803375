//! The time of the core apart from that of its sink.

use std::ops::ControlFlow;
use std::time::Duration;

use scanseg_core::{EdgeRow, Join, LabelRow, Segment, Sink};

/// Gives everything to another sink, and counts the time that this takes.
pub(super) struct Apart<S, C> {
    sink: S,
    /// Tells the time.
    clock: C,
    /// Time spent in the sink.
    pub spent: Duration,
}

impl<S: Sink, C: Fn() -> Duration> Apart<S, C> {
    pub fn new(sink: S, clock: C) -> Self {
        Apart { sink, clock, spent: Duration::ZERO }
    }

    fn counted(&mut self, call: impl FnOnce(&mut S) -> ControlFlow<()>) -> ControlFlow<()> {
        let before = (self.clock)();
        let flow = call(&mut self.sink);
        self.spent += (self.clock)().saturating_sub(before);
        flow
    }
}

#[deny(clippy::missing_trait_methods)]
impl<S: Sink, C: Fn() -> Duration> Sink for Apart<S, C> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.counted(|sink| sink.row(row))
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.counted(|sink| sink.join(join))
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.counted(|sink| sink.segment(segment))
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        self.counted(|sink| sink.edges(row))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_core::{Beams, EdgeConfig, EdgeSegmenter, Segmenter};
    use std::cell::Cell;

    use crate::segmentation::OwnedMemory;

    /// A sink that takes a second for each row, five for each row of edges, 100 for each segment.
    struct Slow<'a>(&'a Cell<u64>);

    impl Slow<'_> {
        fn take(&self, seconds: u64) -> ControlFlow<()> {
            self.0.set(self.0.get() + seconds);
            ControlFlow::Continue(())
        }
    }

    impl Sink for Slow<'_> {
        fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
            self.take(1)
        }

        fn segment(&mut self, _: &Segment) -> ControlFlow<()> {
            self.take(100)
        }

        fn edges(&mut self, _: &EdgeRow<'_>) -> ControlFlow<()> {
            self.take(5)
        }
    }

    #[test]
    fn what_the_sink_takes_is_known() {
        let now_s = Cell::new(0);
        let mut sink = Apart::new(Slow(&now_s), || Duration::from_secs(now_s.get()));
        let config = EdgeConfig::paper();
        let mut memory = OwnedMemory::new(config, 3, None);
        let beams = Beams::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 1.0, cy_px: 1.0 };
        let mut segmenter = EdgeSegmenter::new(config, beams, 3, memory.memory()).unwrap();
        for _ in 0..4 {
            segmenter.push_row(&[1.0; 3], 0.0, &mut sink).unwrap();
            // the core's own time, which is not the sink's
            now_s.set(now_s.get() + 1000);
        }
        segmenter.finish(&mut sink);
        assert_eq!(sink.spent, Duration::from_secs(4 + 4 * 5 + 100));
    }
}
