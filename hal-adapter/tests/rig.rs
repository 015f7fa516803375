//! What a rig is told besides good telegrams of its own scanner; the whole chain is tested on the virtual rig.

use core::ops::ControlFlow;

use scanseg_core::{Finished, LabelRow, PushError, Sink, Status};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{
    Baud, Decoder, Event, MeasuringMode, ScannerEvent, Settings, TelegramError, Trouble, Unit, Variant,
};
use scanseg_hal::pairing::Latch;
use scanseg_hal::rig::{Dropped, End, Rig, RigSink, RowSegmenter, ScanFinished, TiltLimits};

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

impl RowSegmenter for Stops {
    fn push_row(&mut self, _: &[f32], _: f32, _: &mut impl Sink) -> Result<Status, PushError> {
        self.0 += 1;
        Ok(if self.0 < 2 { Status::Buffered } else { Status::Stopped })
    }

    fn finish(&mut self, _: &mut impl Sink) -> Finished {
        self.0 = 0;
        Finished::Stopped
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

/// A decoder that holds a scan of so many columns.
fn scan_of(columns: u16) -> Decoder {
    let mut bytes = vec![0x02, 0x80];
    bytes.extend((2 * columns + 4).to_le_bytes());
    bytes.push(0xB0);
    bytes.extend((columns | 1 << 14).to_le_bytes());
    bytes.resize(bytes.len() + 2 * usize::from(columns), 1);
    bytes.push(0x10);
    bytes.extend(check_word(&bytes).to_le_bytes());
    let mut decoder = Decoder::new();
    let begun = decoder.feed(&bytes);
    assert_eq!(decoder.feed(&bytes[begun.used..]).event, Event::Telegram { code: 0xB0 });
    decoder
}

#[test]
fn what_a_rig_is_told() {
    let mut rows_m = [0.0; 2 * 181];
    let mut rig = Rig::new(SETTINGS, LIMITS, Stops(0), &mut rows_m).expect("rig");
    let mut seen = Seen::default();
    let (own, other) = (scan_of(181), scan_of(361));
    let telegram = |rig: &mut Rig<'_, Stops>, seen: &mut Seen, row: u64, decoder: &Decoder| {
        let time_us = 1_000_000 + row * PERIOD_US;
        rig.tilt(Some(Latch { turn_rad: 1e-6 * time_us as f32, time_us }));
        rig.handle(ScannerEvent::Start { time_us }, None, seen);
        let scan = decoder.telegram().and_then(|telegram| telegram.scan());
        rig.handle(ScannerEvent::Scan, scan, seen);
    };
    for row in 0..3 {
        telegram(&mut rig, &mut seen, row, &own);
    }
    telegram(&mut rig, &mut seen, 3, &other);
    telegram(&mut rig, &mut seen, 4, &own);
    assert_eq!(seen.dropped, [Dropped::NoTurn, Dropped::Columns, Dropped::Stopped]);
    rig.handle(ScannerEvent::Scan, None, &mut seen);
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
