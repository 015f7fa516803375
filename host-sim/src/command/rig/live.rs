//! A sink that shows the last row on its way to another sink.

use std::ops::ControlFlow;

use scanseg_core::{EdgeRow, Join, Label, LabelRow, Pixel, Segment, Sink};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Dropped, RigSink, ScanFinished, ScanStarted};

/// Gives everything to another sink, and keeps the last row as a line of text.
pub struct Live<S> {
    pub sink: S,
    /// The last row: each segment its letter, `.` for a return in none, blank for no return.
    pub row: String,
}

impl<S: RigSink> Live<S> {
    pub fn new(sink: S) -> Live<S> {
        Live { sink, row: String::new() }
    }
}

#[deny(clippy::missing_trait_methods)]
impl<S: RigSink> Sink for Live<S> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        let pixels: Vec<Pixel> = row.pixels().collect();
        // Every third column: 60 letters.
        let letters = pixels.iter().skip(1).step_by(3).map(|pixel| match pixel {
            Pixel::Segment(Label(label)) => char::from(b'A' + (label % 26) as u8),
            Pixel::NoReturn => ' ',
            Pixel::Edge | Pixel::Unlabelled => '.',
        });
        self.row = format!("row {:3} |{}|", row.row(), letters.rev().collect::<String>());
        self.sink.row(row)
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.sink.join(join)
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.sink.segment(segment)
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        self.sink.edges(row)
    }
}

#[deny(clippy::missing_trait_methods)]
impl<S: RigSink> RigSink for Live<S> {
    fn scan_started(&mut self, scan: &ScanStarted) {
        self.sink.scan_started(scan);
    }

    fn row_dropped(&mut self, dropped: Dropped) {
        self.sink.row_dropped(dropped);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.sink.scan_finished(scan);
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.sink.trouble(trouble);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scanseg_core::{Beams, EdgeConfig, EdgeSegmenter, Segmenter};
    use scanseg_hal::rig::{Counters, End};
    use scanseg_sim::segmentation::OwnedMemory;

    /// Every call, word for word.
    #[derive(Default)]
    struct Calls(Vec<String>);

    impl Calls {
        fn note(&mut self, call: String) -> ControlFlow<()> {
            self.0.push(call);
            ControlFlow::Continue(())
        }
    }

    #[deny(clippy::missing_trait_methods)]
    impl Sink for Calls {
        fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
            self.note(format!("row {} {:?}", row.row(), row.pixels().collect::<Vec<_>>()))
        }

        fn join(&mut self, join: Join) -> ControlFlow<()> {
            self.note(format!("join {join:?}"))
        }

        fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
            self.note(format!("segment {segment:?}"))
        }

        fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
            self.note(format!("edges {} {:?}", row.row(), row.runs().collect::<Vec<_>>()))
        }
    }

    #[deny(clippy::missing_trait_methods)]
    impl RigSink for Calls {
        fn scan_started(&mut self, scan: &ScanStarted) {
            _ = self.note(format!("{scan:?}"));
        }

        fn row_dropped(&mut self, dropped: Dropped) {
            _ = self.note(format!("dropped {dropped:?}"));
        }

        fn scan_finished(&mut self, scan: &ScanFinished) {
            _ = self.note(format!("{scan:?}"));
        }

        fn trouble(&mut self, trouble: Trouble) {
            _ = self.note(format!("trouble {trouble:?}"));
        }
    }

    /// Makes every call that there is: a comb whose teeth join, and what a rig tells.
    fn tell(sink: &mut impl RigSink) {
        const COLUMNS: usize = 9;
        let config = EdgeConfig::paper();
        let mut memory = OwnedMemory::new(config, COLUMNS, None);
        let beams = Beams::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 4.0, cy_px: 4.0 };
        let mut segmenter = EdgeSegmenter::new(config, beams, COLUMNS, memory.memory()).unwrap();
        sink.scan_started(&ScanStarted { number: 1, columns: COLUMNS as u16, turn_rad: 0.5 });
        for row in 0..8 {
            let ranges_m: Vec<f32> = (0..COLUMNS)
                .map(|column| if row < 5 && column % 4 == 2 { 0.0 } else { 2.0 + (column / 7) as f32 })
                .collect();
            segmenter.push_row(&ranges_m, 0.0, sink).unwrap();
        }
        segmenter.finish(sink);
        sink.row_dropped(Dropped::Jump);
        sink.trouble(Trouble::Silent);
        let counters = Counters::default();
        sink.scan_finished(&ScanFinished { number: 1, end: End::Turned, rows: 8, unlabelled: 0, counters });
    }

    #[test]
    fn every_call_goes_on() {
        let (mut direct, mut live) = (Calls::default(), Live::new(Calls::default()));
        tell(&mut direct);
        tell(&mut live);
        for call in ["row", "join", "segment", "edges", "ScanStarted", "dropped", "ScanFinished", "trouble"] {
            assert!(direct.0.iter().any(|made| made.starts_with(call)), "no {call} in {:?}", direct.0);
        }
        assert_eq!(direct.0, live.sink.0);
        assert!(live.row.starts_with("row   7 |"), "{}", live.row);
    }

    #[test]
    fn a_sink_that_breaks_off_is_heard() {
        struct Full;

        impl Sink for Full {
            fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
                ControlFlow::Break(())
            }

            fn edges(&mut self, _: &EdgeRow<'_>) -> ControlFlow<()> {
                ControlFlow::Break(())
            }
        }

        impl RigSink for Full {}

        let config = EdgeConfig::paper();
        let mut memory = OwnedMemory::new(config, 3, None);
        let beams = Beams::Pinhole { fx_px: 100.0, fy_px: 100.0, cx_px: 1.0, cy_px: 1.0 };
        let mut segmenter = EdgeSegmenter::new(config, beams, 3, memory.memory()).unwrap();
        let mut live = Live::new(Full);
        let statuses: Vec<_> = (0..5).map(|_| segmenter.push_row(&[1.0; 3], 0.0, &mut live).unwrap()).collect();
        assert!(statuses.contains(&scanseg_core::Status::Stopped), "{statuses:?}");
    }
}
