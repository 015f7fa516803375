//! A rig that is told anything: the counters agree with what was seen, and no row comes that cannot
//! be the next of its scan.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_core::{
    Finished, Label, LabelRow, MAX_ROWS, Moments, PushError, RowBeams, Segment, SegmentSums, Segmenter, Sink, Status,
};
use scanseg_fuzz::scanner::{Damage, Fill, Piece, settings};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Session, Settings, Trouble};
use scanseg_hal::rig::{Dropped, Rig, RigSink, ScanFinished, ScanStarted, TiltLimits};
use std::cell::Cell;
use std::f32::consts::{PI, TAU};
use std::ops::ControlFlow;
use std::rc::Rc;

#[derive(Debug, Arbitrary)]
enum Step {
    /// So many telegrams, one after the other, the tilt sampled with each.
    Rows(u8),
    /// The tilt moves otherwise: 64ths of the middle of the limits.
    Rate(i8),
    /// The tilt is elsewhere.
    Jump(f32),
    /// Time goes on.
    Later(u32),
    /// Time is another.
    At(u64),
    Tilt(Option<f32>),
    /// What comes from the scanner, the last of it now.
    Came(Piece),
    Idle,
    Trouble,
    Finish,
    /// From so many rows on the segmenter answers so.
    Answer {
        rows: u8,
        kind: u8,
    },
}

#[derive(Debug)]
struct Input {
    settings: Settings,
    limits: TiltLimits,
    room: bool,
    steps: Vec<Step>,
}

impl Arbitrary<'_> for Input {
    fn arbitrary(u: &mut Unstructured) -> Result<Input> {
        let mut settings = settings(u)?;
        let usual = TiltLimits {
            min_rate_rad_per_s: 0.2,
            max_rate_rad_per_s: 0.6,
            sweep_rad: if u.arbitrary()? { 0.1 } else { f32::INFINITY },
            pause_us: 3_000_000,
        };
        let limits = if u.ratio(7u8, 8u8)? {
            settings.interlaced = false;
            usual
        } else {
            let [min_rate_rad_per_s, max_rate_rad_per_s, sweep_rad] = u.arbitrary()?;
            TiltLimits { min_rate_rad_per_s, max_rate_rad_per_s, sweep_rad, pause_us: u.arbitrary()? }
        };
        Ok(Input { settings, limits, room: u.ratio(15u8, 16u8)?, steps: u.arbitrary()? })
    }
}

/// Checks the rows of a scan, and answers as it is told to.
struct Checker {
    columns: usize,
    /// Of the rows of this scan, whether taken or not.
    turns_rad: Vec<f32>,
    /// Whether the limits leave no doubt which way the tilt turned from row to row.
    one_way: bool,
    /// From so many rows on, and what.
    answer: Rc<Cell<(usize, u8)>>,
    segments: u32,
}

impl Segmenter for Checker {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> std::result::Result<Status, PushError> {
        let turn_rad = beams.into().turn_rad;
        assert_eq!(ranges_m.len(), self.columns);
        assert!(ranges_m.iter().all(|range_m| range_m.is_finite() && *range_m >= 0.0) && turn_rad.is_finite());
        self.turns_rad.push(turn_rad);
        let ways: Vec<f32> =
            self.turns_rad.windows(2).map(|pair| (pair[1] - pair[0] + PI).rem_euclid(TAU) - PI).collect();
        // as far as digits tell
        let digits = 1e-5 * turn_rad.abs() + 1e-5;
        let is_one_way = ways.iter().all(|way| *way >= -digits) || ways.iter().all(|way| *way <= digits);
        assert!(is_one_way || !self.one_way, "{:?}", self.turns_rad);
        let (from, answer) = self.answer.get();
        if self.turns_rad.len() > from {
            match answer % 4 {
                0 => {}
                1 => return Ok(Status::Stopped),
                2 if self.turns_rad.len() > 1 => return Err(PushError::TooManyRows { max_rows: MAX_ROWS }),
                _ => return Err(PushError::TurnAngle { turn_rad }),
            }
        }
        let label = Label(self.segments);
        self.segments += 1;
        _ = sink.segment(&Segment {
            label,
            first_row: 0,
            last_row: 0,
            first_column: 0,
            last_column: 0,
            sums: SegmentSums::Moments(Moments::default()),
        });
        Ok(Status::Buffered)
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        Finished::Complete { rows: std::mem::take(&mut self.turns_rad).len(), unlabelled: 0 }
    }

    fn reset(&mut self) {
        self.turns_rad.clear();
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

#[derive(Default)]
struct Seen {
    started: u32,
    finished: u32,
    dropped: u32,
    troubles: u32,
    segments: u32,
}

impl Sink for Seen {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn segment(&mut self, _: &Segment) -> ControlFlow<()> {
        self.segments += 1;
        ControlFlow::Continue(())
    }
}

impl RigSink for Seen {
    fn scan_started(&mut self, scan: &ScanStarted) {
        assert_eq!(self.started, self.finished, "one scan at a time");
        self.started += 1;
        assert_eq!(scan.number, self.started);
    }

    fn row_dropped(&mut self, _: Dropped) {
        self.dropped += 1;
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.finished += 1;
        assert_eq!((scan.number, self.finished), (self.started, self.started));
    }

    fn trouble(&mut self, _: Trouble) {
        self.troubles += 1;
    }
}

fuzz_target!(|input: Input| {
    let Input { settings, limits, room, steps } = input;
    let columns = usize::from(settings.variant.columns());
    let mut rows_m = vec![f32::NAN; 2 * columns - usize::from(!room)];
    let one_way = limits.max_rate_rad_per_s * 1e-6 * (limits.pause_us as f32) < 3.0;
    let answer = Rc::new(Cell::new((usize::MAX, 0)));
    let segmenter = Checker { columns, turns_rad: vec![], one_way, answer: Rc::clone(&answer), segments: 0 };
    let Ok(mut rig) = Rig::new(settings, limits, segmenter, &mut rows_m) else { return };
    let mut session = Session::listening(settings);
    let mut seen = Seen::default();
    let telegram = Piece::Scan { index_bytes: 0, status: 0x10, fill: Fill::default(), turn: 0, damage: Damage::None };
    let telegram = telegram.bytes(&settings);
    let (mut now_us, mut turn_rad, mut rate_rad_per_s) = (1_000_000_u64, 0.0_f32, 0.4_f32);
    let (mut bytes, mut rejected) = (0, 0);
    for step in steps {
        let mut receive = |rig: &mut Rig<'_, Checker>, came: &[u8], now_us: u64, seen: &mut Seen| {
            rig.receive(&mut session, came, now_us, seen);
            bytes += came.len() as u64;
        };
        match step {
            Step::Rows(rows) => {
                for _ in 0..rows % 32 {
                    let period_us = u64::from(settings.period_us());
                    now_us = now_us.saturating_add(period_us);
                    turn_rad += rate_rad_per_s * period_us as f32 * 1e-6;
                    rig.tilt(Some(Latch { turn_rad, time_us: now_us }));
                    receive(&mut rig, &telegram, now_us, &mut seen);
                }
            }
            Step::Rate(rate) => rate_rad_per_s = 0.4 * f32::from(rate) / 64.0,
            Step::Jump(to_rad) => turn_rad = to_rad,
            Step::Later(us) => now_us = now_us.saturating_add(us.into()),
            Step::At(us) => now_us = us,
            Step::Tilt(sample) => rig.tilt(sample.map(|turn_rad| Latch { turn_rad, time_us: now_us })),
            Step::Came(piece) => receive(&mut rig, &piece.bytes(&settings), now_us, &mut seen),
            Step::Idle => rig.idle(now_us, &mut seen),
            Step::Trouble => rig.trouble(Trouble::Silent, &mut seen),
            Step::Finish => {
                rig.finish(&mut seen);
                assert_eq!(seen.started, seen.finished);
            }
            Step::Answer { rows, kind } => answer.set((rows.into(), kind)),
        }
        let counters = rig.counters();
        assert_eq!(counters.bytes, bytes);
        assert!(counters.rejected >= rejected);
        rejected = counters.rejected;
        assert_eq!([counters.scans, counters.dropped()], [seen.started, seen.dropped]);
        assert_eq!([counters.segments, counters.troubles], [seen.segments, seen.troubles]);
        let held = counters.telegrams - counters.rows - counters.dropped();
        assert!(held <= 1, "{counters:?}");
    }
});
