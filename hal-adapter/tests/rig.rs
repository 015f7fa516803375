//! What a rig is told besides good telegrams of its own scanner; the whole chain is tested on the
//! virtual rig.

use core::ops::ControlFlow;

use scanseg_core::{
    EdgeConfig, EdgeRow, EdgeSegmenter, Finished, Join, LabelRow, PushError, RowBeams, Segment, Segmenter, Sink,
    Status, buffers,
};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{
    Baud, Event, MeasuringMode, SCAN_LINE, ScannerEvent, Settings, TelegramDecoder, TelegramError, Trouble, Unit,
    Variant,
};
use scanseg_hal::rig::{Dropped, End, Rig, RigSink, ScanFinished, ScanStarted, TiltLimits, beams};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
const PERIOD_US: u64 = SETTINGS.period_us() as u64;
const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.1, max_rate_rad_per_s: 2.0, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };

/// Breaks off at the second row.
struct Stops(usize);

impl Segmenter for Stops {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        _: &[f32],
        _: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        self.0 += 1;
        Ok(if self.0 < 2 { Status::Buffered } else { Status::Stopped })
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        self.0 = 0;
        Finished::Stopped
    }

    fn reset(&mut self) {
        self.0 = 0;
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

#[derive(Default)]
struct Seen {
    dropped: Vec<Dropped>,
    finished: Vec<ScanFinished>,
    troubles: Vec<Trouble>,
}

impl Sink for Seen {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl RigSink for Seen {
    fn row_dropped(&mut self, dropped: Dropped) {
        self.dropped.push(dropped);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.finished.push(*scan);
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.troubles.push(trouble);
    }
}

/// A decoder that holds a scan line with these values.
fn scan_line(values: &[u16]) -> TelegramDecoder {
    let bytes = frame(&scan_payload(&[SCAN_LINE], values.len() as u16 | 1 << 14, values, &[], 0x10));
    let mut decoder = TelegramDecoder::new();
    let begun = decoder.feed(&bytes);
    assert_eq!(decoder.feed(&bytes[begun.used..]).event, Event::Telegram { code: 0xB0 });
    decoder
}

/// Gives a rig the telegram of a row and a sample of a tilt that turns at 1 rad/s.
fn telegram<S: Segmenter>(
    rig: &mut Rig<'_, S>,
    sink: &mut (impl RigSink + ?Sized),
    row: u64,
    decoder: &TelegramDecoder,
) {
    let time_us = 1_000_000 + row * PERIOD_US;
    rig.tilt(Some(Latch { turn_rad: 1e-6 * time_us as f32, time_us }));
    rig.handle(ScannerEvent::Start { time_us }, None, sink);
    let line = decoder.telegram().and_then(|telegram| telegram.scan_line());
    rig.handle(ScannerEvent::ScanLine, line, sink);
}

#[test]
fn what_a_rig_is_told() {
    let mut rows_m = [0.0; 2 * 181];
    let mut rig = Rig::new(SETTINGS, LIMITS, Stops(0), &mut rows_m).expect("rig");
    let mut seen = Seen::default();
    let (own, other) = (scan_line(&[257; 181]), scan_line(&[257; 361]));
    for row in 0..3 {
        telegram(&mut rig, &mut seen, row, &own);
    }
    telegram(&mut rig, &mut seen, 3, &other);
    telegram(&mut rig, &mut seen, 4, &own);
    assert_eq!(seen.dropped, [Dropped::NoTurn, Dropped::Columns, Dropped::Stopped]);
    rig.handle(ScannerEvent::ScanLine, None, &mut seen);
    rig.handle(ScannerEvent::Rejected(TelegramError::Status(0x17)), None, &mut seen);
    rig.tilt(None);
    rig.handle(ScannerEvent::Trouble(Trouble::Silent), None, &mut seen);
    assert_eq!(seen.troubles, [Trouble::Silent]);
    let [scan] = seen.finished[..] else { panic!("{:?}", seen.finished) };
    assert_eq!((scan.end, scan.rows, scan.unlabelled), (End::Trouble, 2, 0));
    let counters = rig.counters();
    assert_eq!((counters.telegrams, counters.rows, counters.dropped()), (5, 2, 3));
    assert_eq!((counters.columns, counters.stopped, counters.no_turn), (1, 1, 1));
    assert_eq!((counters.rejected, counters.encoder_errors, counters.troubles, counters.lost), (1, 1, 1, 0));
    assert_eq!(rig.release().0, 0);
}

/// Counts the calls of each method.
#[derive(Debug, Default, PartialEq)]
struct Calls([usize; 8]);

impl Sink for Calls {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        self.0[0] += 1;
        ControlFlow::Continue(())
    }

    fn join(&mut self, _: Join) -> ControlFlow<()> {
        self.0[1] += 1;
        ControlFlow::Continue(())
    }

    fn segment(&mut self, _: &Segment) -> ControlFlow<()> {
        self.0[2] += 1;
        ControlFlow::Continue(())
    }

    fn edges(&mut self, _: &EdgeRow<'_>) -> ControlFlow<()> {
        self.0[3] += 1;
        ControlFlow::Continue(())
    }
}

impl RigSink for Calls {
    fn scan_started(&mut self, _: &ScanStarted) {
        self.0[4] += 1;
    }

    fn row_dropped(&mut self, _: Dropped) {
        self.0[5] += 1;
    }

    fn scan_finished(&mut self, _: &ScanFinished) {
        self.0[6] += 1;
    }

    fn trouble(&mut self, _: Trouble) {
        self.0[7] += 1;
    }
}

/// Two areas that join below a gap, each call of the segmenter and of the rig once at least.
fn calls<S: RigSink + ?Sized>(sink: &mut S) {
    const COLUMNS: usize = SETTINGS.variant.columns() as usize;
    const CONFIG: EdgeConfig = EdgeConfig::paper();
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut rows_m = [0.0; 2 * COLUMNS];
    let segmenter = EdgeSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, buffers.memory()).expect("segmenter");
    let mut rig = Rig::new(SETTINGS, LIMITS, segmenter, &mut rows_m).expect("rig");
    let mut gap = [2000; COLUMNS];
    gap[85..95].fill(0);
    let (gap, whole) = (scan_line(&gap), scan_line(&[2000; COLUMNS]));
    for row in 0..20 {
        telegram(&mut rig, sink, row, if row < 10 { &gap } else { &whole });
    }
    rig.trouble(Trouble::Silent, sink);
}

/// The rig's own sink between the segmenter and the user's, and references to sinks, forward every
/// call.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn no_call_is_lost() {
    let mut direct = Calls::default();
    calls(&mut direct);
    assert_eq!(direct.0[0], 19, "a row each but for the first telegram, which has no rate yet");
    assert!(direct.0.iter().all(|&calls| calls > 0), "{direct:?}");
    let mut forwarded = Calls::default();
    let mut reference: &mut dyn RigSink = &mut forwarded;
    calls::<&mut dyn RigSink>(&mut reference);
    calls::<dyn RigSink>(reference);
    assert_eq!(forwarded, Calls(direct.0.map(|calls| 2 * calls)));
}
