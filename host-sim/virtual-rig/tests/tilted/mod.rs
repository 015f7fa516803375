//! A scanner on a tilt whose ranges tell the turn angle, and a segmenter that only takes notes.
#![allow(dead_code)]

use std::cell::RefCell;
use std::ops::ControlFlow;
use std::rc::Rc;

use scanseg_core::{Finished, LabelRow, PushError, RowBeams, Segmenter, Sink, Status};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Settings, Trouble, Unit, Variant};
use scanseg_hal::rig::{Counters, Dropped, Rig, RigSink, ScanFinished, ScanStarted, TiltLimits};
use scanseg_virtual_rig::{Arrival, Chain, Motion, scanner_on_tilt};

pub const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
pub const COLUMNS: usize = SETTINGS.variant.columns() as usize;

/// Rate of the tilt, radians a second.
pub const RATE: f64 = 0.6;
pub const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.3, max_rate_rad_per_s: 0.9, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };

/// Back and forth between -0.6 and 0.6 rad.
pub fn to_and_fro(time_us: f64) -> f64 {
    let phase = (time_us * 1e-6 * RATE / 1.2).rem_euclid(2.0);
    1.2 * (if phase < 1.0 { phase } else { 2.0 - phase }) - 0.6
}

/// The range tells the turn angle of the beam, a millimetre for a milliradian.
pub fn telling(_bearing_deg: f64, turn_rad: f64) -> f64 {
    turn_rad + 5.0
}

/// A row as the segmenter got it.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    pub turn_rad: f64,
    /// Told by the ranges.
    pub truth_rad: f64,
}

/// Keeps the rows of the scans, each scan a list of its own.
#[derive(Clone, Debug, Default)]
pub struct Notes(pub Rc<RefCell<Vec<Vec<Row>>>>);

impl Segmenter for Notes {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        let (beams, columns) = (beams.into(), ranges_m.len());
        // of the middle beam
        let more_rad: f32 = (0..columns).map(|c| beams.column_turns.of(c)).sum();
        let turn_rad = f64::from(beams.turn_rad + more_rad / columns as f32);
        let mut sorted = ranges_m.to_vec();
        sorted.sort_by(f32::total_cmp);
        let truth_rad = f64::from(sorted[sorted.len() / 2]) - 5.0;
        let mut scans = self.0.borrow_mut();
        if scans.is_empty() {
            scans.push(vec![]);
        }
        scans.last_mut().unwrap().push(Row { turn_rad, truth_rad });
        Ok(Status::Buffered)
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        let mut scans = self.0.borrow_mut();
        let rows = scans.last().map_or(0, Vec::len);
        scans.push(vec![]);
        Finished::Complete { rows, unlabelled: 0 }
    }

    fn reset(&mut self) {
        _ = self.finish(&mut Seen::default());
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

/// Everything that a rig told.
#[derive(Debug, Default)]
pub struct Seen {
    pub started: Vec<ScanStarted>,
    pub finished: Vec<ScanFinished>,
    pub dropped: Vec<Dropped>,
    pub troubles: Vec<Trouble>,
}

impl Sink for Seen {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl RigSink for Seen {
    fn scan_started(&mut self, scan: &ScanStarted) {
        assert_eq!(self.started.len(), self.finished.len(), "one scan at a time");
        self.started.push(*scan);
    }

    fn row_dropped(&mut self, dropped: Dropped) {
        self.dropped.push(dropped);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.finished.push(*scan);
        assert_eq!(self.started.len(), self.finished.len(), "every scan that ends has begun");
        assert_eq!(self.started.last().map(|started| started.number), Some(scan.number));
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.troubles.push(trouble);
    }
}

/// The second good telegram since a trouble (the first may come without its start): scans sent
/// until then, and what the rig had counted.
#[derive(Clone, Copy, Debug)]
struct Since {
    troubles: u32,
    first: bool,
    sent: u32,
    counted: u32,
}

pub struct Bench {
    pub chain: Chain<'static, Notes>,
    pub seen: Seen,
    pub notes: Notes,
    since: Option<Since>,
    telegrams: u32,
}

impl Bench {
    pub fn new() -> Self {
        let motion: Motion = Rc::new(to_and_fro);
        let lms = scanner_on_tilt(SETTINGS, &motion, telling).running(Baud::B500000, SETTINGS.variant);
        let notes = Notes::default();
        let rows_m = Vec::leak(vec![0.0; 2 * COLUMNS]);
        let rig = Rig::new(SETTINGS, LIMITS, notes.clone(), rows_m).expect("rig");
        let chain = Chain::new(SETTINGS, lms, motion, rig);
        Self { chain, seen: Seen::default(), notes, since: None, telegrams: 0 }
    }

    /// A step of the chain. What the scanner has sent since the last trouble is a good telegram or
    /// counted as lost, whenever there is a good one.
    pub fn step(&mut self) -> Arrival {
        let came = self.chain.step(&mut self.seen);
        let Counters { telegrams, lost, troubles, .. } = self.counters();
        if telegrams != std::mem::replace(&mut self.telegrams, telegrams) {
            let (sent, counted) = (self.chain.lms.scans_sent, telegrams + lost);
            assert!(counted <= sent, "{sent} sent and {counted} counted: {:?}", self.counters());
            match self.since {
                // false beginnings may keep a telegram back for two more, and one is on the line
                Some(since) if since.troubles == troubles && !since.first => {
                    let (sent, counted) = (sent - since.sent, counted - since.counted);
                    assert!(sent.abs_diff(counted) <= 3, "{sent} sent and {counted} counted: {:?}", self.counters());
                }
                since => {
                    let first = since.is_none_or(|since| since.troubles != troubles);
                    self.since = Some(Since { troubles, first, sent, counted });
                }
            }
        }
        came
    }

    pub fn run_ms(&mut self, ms: u64) {
        let end_us = self.chain.now_us() + ms * 1000;
        while self.chain.now_us() < end_us {
            self.step();
        }
    }

    pub fn counters(&self) -> Counters {
        self.chain.rig.counters()
    }
}

/// Every row has its own turn angle, to within an error in radians, and rows of a scan follow each
/// other. Returns how many rows tell what the tilt cannot be: damaged telegrams that the check word
/// let through, one in 65 536.
pub fn check_rows(notes: &Notes, within_rad: f64) -> u32 {
    let mut false_rows = 0;
    for rows in notes.0.borrow().iter() {
        for row in rows {
            if row.truth_rad.abs() > 0.61 {
                false_rows += 1;
                continue;
            }
            let off_rad = (row.turn_rad - row.truth_rad).abs();
            assert!(off_rad <= within_rad, "{row:?} is off by {off_rad}");
        }
        let rising = rows.windows(2).filter(|pair| pair[1].turn_rad > pair[0].turn_rad).count();
        assert!(rising == 0 || rising + 1 == rows.len(), "a scan goes one way");
    }
    false_rows
}

/// Chance, the same in every run.
pub struct Random(pub u64);

impl Random {
    pub fn below(&mut self, bound: u64) -> u64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % bound
    }
}
