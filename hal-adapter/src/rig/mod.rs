//! Scanner, tilt encoder and segmenter together: bytes and samples of the tilt in, segments out, scan after scan.
//!
//! A [`Rig`] needs no port and no clock. It is told what happens, and gives what it finds to a [`RigSink`]:
//!
//! - [`Rig::tilt`]: the tilt was sampled. Once per telegram is enough.
//! - [`Rig::receive`]: bytes of the scanner, with the [`Session`] that reads them; or [`Rig::handle`]: an event of a
//!   [`blocking`](crate::lms2xx::blocking) or [`asynch`](crate::lms2xx::asynch) scanner.
//! - [`Rig::idle`]: time has passed.
//!
//! A sweep of the tilt is a scan. It ends when the tilt turns back, when it has covered the angle set, when no row comes
//! any more, and when the scanner restarts; its last segments are given out then, and the next one starts clean.
//!
//! No row gets a turn angle that is not known. A telegram makes a row only if the tilt was sampled near its beams, turned
//! at a plausible rate ([`TiltLimits`]), and goes on where the rows before it were; a scan begins with two rows that agree.
//! Every other telegram is dropped with its reason, [`Dropped`], and counted in [`Counters`]. An encoder that is wrong by so
//! little that the rate stays within the limits is believed: between rows that is at most the difference of the limits
//! times the time.
//!
//! All beams of a row get the turn angle of the row, its mean. What is left of the tilt's movement within a row is in the
//! table of [`pairing`](crate::pairing); with one mirror turn per row it is a quarter of that with two.
//!
//! ```
//! use core::ops::ControlFlow;
//! use scanseg_core::{Config, EdgeSegmenter, LabelRow, Segment, Sink, buffers};
//! use scanseg_hal::lms2xx::{Action, Baud, MeasuringMode, Session, Settings, Unit, Variant};
//! use scanseg_hal::rig::{Rig, RigSink, TiltLimits, beams};
//!
//! struct Print;
//! impl Sink for Print {
//!     fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> { ControlFlow::Continue(()) }
//!     fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
//!         println!("{:?}", segment.plane());
//!         ControlFlow::Continue(())
//!     }
//! }
//! impl RigSink for Print {}
//!
//! const SETTINGS: Settings = Settings {
//!     baud: Baud::B500000,
//!     variant: Variant::Deg180Step1,
//!     unit: Unit::Millimetre,
//!     mode: MeasuringMode::Range32Field,
//!     interlaced: false,
//! };
//! const COLUMNS: usize = SETTINGS.variant.columns() as usize;
//! const CONFIG: Config = Config::paper();
//! let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY; // on a microcontroller: statics
//! let mut rows_m = [0.0; 2 * COLUMNS];
//! let segmenter = EdgeSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, buffers.memory())?;
//! let limits = TiltLimits { min_rate_rad_per_s: 0.2, max_rate_rad_per_s: 0.6, sweep_rad: 3.0, pause_us: 1_000_000 };
//! let mut rig = Rig::new(SETTINGS, limits, segmenter, &mut rows_m)?;
//! let mut session = Session::new(SETTINGS);
//! # let (now_us, received, sample) = (0u64, [0u8; 0], None);
//! // again and again:
//! match session.poll((now_us / 1000) as u32) {
//!     Action::SetBaud(_) | Action::Send { .. } => {} // do it
//!     Action::Wait { .. } => {
//!         rig.tilt(sample);
//!         rig.receive(&mut session, &received, now_us, &mut Print);
//!     }
//!     Action::Tell(trouble) => rig.trouble(trouble, &mut Print),
//! }
//! rig.idle(now_us, &mut Print);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod counters;
mod segmenter;

use scanseg_core::{Beams, Columns, Finished, PushError, Status, TurnAxis};

pub use counters::{Counters, Dropped};
pub use segmenter::{End, RigSink, RowSegmenter, ScanFinished, ScanStarted};

use crate::lms2xx::{Scan, ScannerEvent, Session, SessionEvent, Settings, Severity, Trouble, Variant};
use crate::pairing::{Latch, Pairing, RowTurn, Sweep, shorter_way};
use segmenter::Counting;

/// How the tilt moves within a sweep.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TiltLimits {
    /// Slowest rate, radians a second, above 0. A tilt that is slower stands, or its encoder is stuck.
    pub min_rate_rad_per_s: f32,
    /// Fastest rate, radians a second, not below the slowest, and less than half a turn per telegram. A tilt that is faster
    /// has an encoder that jumps. Leave room for the encoder's steps: 14 bits a turn, read every 13 ms, give the rate to
    /// 0.03 rad/s.
    pub max_rate_rad_per_s: f32,
    /// A scan that has covered so much is complete, radians, above 0: half a turn for a scanner that goes round and round,
    /// infinite for one that turns back by itself.
    pub sweep_rad: f32,
    /// A scan is over when no row has come for so long, microseconds; at least three telegrams.
    pub pause_us: u32,
}

/// What is wrong with a rig.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum RigError {
    /// The limits of the rate are not 0 < slowest <= fastest < half a turn per telegram, here in radians a second.
    Rates {
        /// The slowest.
        min: f32,
        /// The fastest.
        max: f32,
    },
    /// A sweep is not above 0.
    Sweep(f32),
    /// The pause is shorter than three telegrams.
    Pause {
        /// Microseconds needed.
        needed_us: u32,
        /// Microseconds given.
        got_us: u32,
    },
    /// Partial scans that are not whole rows: of the interlaced variants only those in steps of 1 degree make rows.
    Interlaced,
    /// The memory for rows is too small.
    Memory {
        /// Ranges needed.
        needed: usize,
        /// Ranges given.
        got: usize,
    },
}

impl core::fmt::Display for RigError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Rates { min, max } => write!(f, "the tilt cannot turn at {min} to {max} rad/s"),
            Self::Sweep(sweep_rad) => write!(f, "a sweep cannot be {sweep_rad} rad"),
            Self::Pause { needed_us, got_us } => write!(f, "pause must be {needed_us} us or more, is {got_us}"),
            Self::Interlaced => write!(f, "interlaced scans make rows only in steps of 1 degree"),
            Self::Memory { needed, got } => write!(f, "rows need memory for {needed} ranges, got {got}"),
        }
    }
}

impl core::error::Error for RigError {}

/// The beams of an LMS 2xx that tilts: columns from right to left, turn angles upwards from level (the y axis of
/// [`Beams::Nodding`]).
#[must_use]
pub const fn beams(variant: Variant) -> Beams<'static> {
    let start_rad = -0.5 * (variant.view_deg() as f32).to_radians();
    let step_rad = (0.01 * variant.step_cdeg() as f32).to_radians();
    Beams::Nodding { columns: Columns::Even { start_rad, step_rad }, axis: TurnAxis::Y }
}

/// Where the tilt was when a row was measured.
#[derive(Debug, Clone, Copy)]
struct Place {
    turn_rad: f32,
    rising: bool,
    start_us: u64,
}

impl Place {
    /// How far the tilt has turned since `before`, radians; `None` if the same sweep cannot have brought it here.
    fn since(&self, before: &Place, limits: &TiltLimits) -> Option<f32> {
        let moved_rad = shorter_way(self.turn_rad - before.turn_rad);
        let moved_rad = if self.rising { moved_rad } else { -moved_rad };
        let time_us = self.start_us.checked_sub(before.start_us)?;
        let most_rad = limits.max_rate_rad_per_s * 1e-6 * time_us as f32;
        let goes_on = self.rising == before.rising && time_us <= u64::from(limits.pause_us);
        (goes_on && moved_rad > 0.0 && moved_rad <= most_rad).then_some(moved_rad)
    }
}

/// A scan under way.
#[derive(Debug, Clone, Copy)]
struct Progress {
    last: Place,
    covered_rad: f32,
    rows: u16,
    /// The sink broke off: what is left of the sweep is dropped.
    stopped: bool,
}

/// Scanner, tilt and segmenter: see the [module](self).
#[derive(Debug)]
pub struct Rig<'a, S> {
    settings: Settings,
    limits: TiltLimits,
    segmenter: S,
    pairing: Pairing,
    /// The row that came last, and the one held.
    row_m: &'a mut [f32],
    held_m: &'a mut [f32],
    /// A row that does not go on where the scan was. If the next one agrees with it, a new scan begins with it.
    held: Option<Place>,
    scan: Option<Progress>,
    /// Start bytes: of the telegram under way, and of the last good one.
    start_us: u64,
    last_start_us: Option<u64>,
    counters: Counters,
}

impl<'a, S: RowSegmenter> Rig<'a, S> {
    /// `settings` are those of the scanner's session. `segmenter` has as many columns as the variant, see [`beams`].
    /// `rows_m`: twice as many ranges; what they hold does not matter.
    ///
    /// # Errors
    /// [`RigError`].
    pub fn new(settings: Settings, limits: TiltLimits, segmenter: S, rows_m: &'a mut [f32]) -> Result<Self, RigError> {
        let TiltLimits { min_rate_rad_per_s: min, max_rate_rad_per_s: max, sweep_rad, pause_us: got_us } = limits;
        let period_us = settings.period_us();
        let half_turn_rad_per_s = core::f32::consts::PI * 1e6 / period_us as f32;
        if !(min > 0.0 && min <= max && max < half_turn_rad_per_s) {
            return Err(RigError::Rates { min, max });
        }
        if sweep_rad.is_nan() || sweep_rad <= 0.0 {
            return Err(RigError::Sweep(sweep_rad));
        }
        if got_us < 3 * period_us {
            return Err(RigError::Pause { needed_us: 3 * period_us, got_us });
        }
        if settings.interlaced && settings.variant.turns() > 1 {
            return Err(RigError::Interlaced);
        }
        let columns = usize::from(settings.variant.columns());
        let (needed, got) = (2 * columns, rows_m.len());
        let Some((row_m, held_m)) = rows_m.get_mut(..needed).and_then(|rows_m| rows_m.split_at_mut_checked(columns))
        else {
            return Err(RigError::Memory { needed, got });
        };
        Ok(Self {
            settings,
            limits,
            segmenter,
            pairing: Pairing::new(&settings),
            row_m,
            held_m,
            held: None,
            scan: None,
            start_us: 0,
            last_start_us: None,
            counters: Counters::default(),
        })
    }

    /// The tilt was sampled, by the clock of the bytes; `None`: it could not be read. Sample it when bytes have come, and
    /// before they are given to [`Rig::receive`].
    pub fn tilt(&mut self, sample: Option<Latch>) {
        match sample {
            Some(latch) => self.pairing.sample(latch),
            None => self.counters.encoder_errors += 1,
        }
    }

    /// Bytes of the scanner, the last of which came at `now_us`, any origin.
    pub fn receive(&mut self, session: &mut Session, bytes: &[u8], now_us: u64, sink: &mut impl RigSink) {
        self.counters.bytes += bytes.len() as u64;
        let mut rest = bytes;
        loop {
            let (used, event) = session.feed((now_us / 1000) as u32, rest);
            rest = rest.get(used..).unwrap_or(&[]);
            let event = match event {
                SessionEvent::NeedMore => return,
                SessionEvent::Start { bytes_ago } => {
                    let age_us = session.baud().line_time_us(rest.len() as u32 + u32::from(bytes_ago));
                    ScannerEvent::Start { time_us: now_us.saturating_sub(u64::from(age_us)) }
                }
                SessionEvent::Scan => ScannerEvent::Scan,
                SessionEvent::Rejected(error) => ScannerEvent::Rejected(error),
            };
            self.handle(event, session.scan(), sink);
        }
    }

    /// What a scanner on its port has told, and with [`ScannerEvent::Scan`] its scan.
    pub fn handle(&mut self, event: ScannerEvent, scan: Option<Scan<'_>>, sink: &mut impl RigSink) {
        match (event, scan) {
            (ScannerEvent::Start { time_us }, _) => {
                self.start_us = time_us;
                self.pairing.start(time_us);
            }
            (ScannerEvent::Scan, Some(scan)) => self.telegram(&scan, sink),
            (ScannerEvent::Scan, None) => {}
            (ScannerEvent::Rejected(_), _) => self.counters.rejected += 1,
            (ScannerEvent::Trouble(trouble), _) => self.trouble(trouble, sink),
        }
    }

    /// Something is wrong with the scanner: ends the scan.
    pub fn trouble(&mut self, trouble: Trouble, sink: &mut impl RigSink) {
        self.counters.troubles += 1;
        self.last_start_us = None;
        self.end(End::Trouble, sink);
        sink.trouble(trouble);
    }

    /// It is now `now_us`: ends the scan if no row has come for too long. Call it now and then.
    pub fn idle(&mut self, now_us: u64, sink: &mut impl RigSink) {
        let over = |place: &Place| now_us.saturating_sub(place.start_us) > u64::from(self.limits.pause_us);
        let scan_over = self.scan.is_none_or(|scan| over(&scan.last));
        if scan_over && self.held.is_none_or(|held| over(&held)) {
            self.end(End::Pause, sink);
        }
    }

    /// Ends the scan, if one is under way.
    pub fn finish(&mut self, sink: &mut impl RigSink) {
        self.end(End::Asked, sink);
    }

    /// What has happened so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Gives the segmenter back.
    pub fn release(self) -> S {
        self.segmenter
    }

    fn telegram(&mut self, scan: &Scan<'_>, sink: &mut impl RigSink) {
        self.counters.telegrams += 1;
        self.count_lost();
        let turn = self.pairing.row(Sweep::of(scan, self.settings.variant));
        if scan.status().severity() >= Some(Severity::Error) || scan.status().implausible() {
            return self.drop_row(Dropped::Status, sink);
        }
        if usize::from(scan.columns()) != self.row_m.len() {
            return self.drop_row(Dropped::Columns, sink);
        }
        match self.place(turn) {
            Err(dropped) => self.drop_row(dropped, sink),
            Ok(place) => {
                for (to_m, beam) in self.row_m.iter_mut().zip(scan.beams(self.settings.mode)) {
                    *to_m = beam.range_mm(scan.unit()).map_or(0.0, |mm| mm as f32 / 1000.0);
                }
                self.row(place, sink);
            }
        }
    }

    /// Telegrams that must have come since the last good one, by the time.
    fn count_lost(&mut self) {
        let period_us = u64::from(self.settings.period_us());
        if let Some(last_us) = self.last_start_us.replace(self.start_us) {
            let periods = (self.start_us.saturating_sub(last_us) + period_us / 2) / period_us;
            self.counters.lost += periods.saturating_sub(1) as u32;
        }
    }

    fn place(&self, turn: Option<RowTurn>) -> Result<Place, Dropped> {
        let turn = turn.ok_or(Dropped::NoTurn)?;
        let rate_rad_per_s = turn.rate_rad_per_s();
        match rate_rad_per_s.abs() {
            rate if rate < self.limits.min_rate_rad_per_s => Err(Dropped::Standing),
            rate if rate <= self.limits.max_rate_rad_per_s => {
                Ok(Place { turn_rad: turn.turn_rad(), rising: rate_rad_per_s > 0.0, start_us: self.start_us })
            }
            _ => Err(Dropped::Jump),
        }
    }

    /// A row with a plausible turn angle: the next of the scan, the second of a new scan, or one to be held.
    fn row(&mut self, place: Place, sink: &mut impl RigSink) {
        if let Some(moved_rad) = self.scan.and_then(|scan| place.since(&scan.last, &self.limits)) {
            self.drop_held(sink);
            let covered_rad = self.scan.map_or(0.0, |scan| scan.covered_rad);
            if covered_rad + moved_rad > self.limits.sweep_rad {
                self.end(End::Covered, sink);
                self.begin(place, sink);
                self.push(place, 0.0, sink);
            } else {
                self.push(place, moved_rad, sink);
            }
        } else if let Some((held, moved_rad)) =
            self.held.and_then(|held| Some((held, place.since(&held, &self.limits)?)))
        {
            self.held = None;
            self.end(End::Turned, sink);
            self.begin(held, sink);
            self.row_m.swap_with_slice(self.held_m);
            self.push(held, 0.0, sink);
            self.row_m.swap_with_slice(self.held_m);
            self.push(place, moved_rad, sink);
        } else {
            self.drop_held(sink);
            self.held_m.copy_from_slice(self.row_m);
            self.held = Some(place);
        }
    }

    fn begin(&mut self, first: Place, sink: &mut impl RigSink) {
        self.counters.scans += 1;
        self.scan = Some(Progress { last: first, covered_rad: 0.0, rows: 0, stopped: false });
        sink.scan_started(&ScanStarted {
            number: self.counters.scans,
            columns: self.row_m.len() as u16,
            turn_rad: first.turn_rad,
        });
    }

    fn push(&mut self, place: Place, moved_rad: f32, sink: &mut impl RigSink) {
        let Some(scan) = &mut self.scan else { return };
        scan.last = place;
        scan.covered_rad += moved_rad;
        if scan.stopped {
            return self.drop_row(Dropped::Stopped, sink);
        }
        let mut counting = Counting { sink, segments: &mut self.counters.segments };
        match self.segmenter.push_row(self.row_m, place.turn_rad, &mut counting) {
            Ok(status) => {
                scan.rows += 1;
                scan.stopped = status == Status::Stopped;
                self.counters.rows += 1;
            }
            Err(PushError::TooManyRows) if scan.rows > 0 => {
                self.end(End::Covered, sink);
                self.begin(place, sink);
                self.push(place, 0.0, sink);
            }
            Err(_) => self.drop_row(Dropped::Refused, sink),
        }
    }

    fn end(&mut self, end: End, sink: &mut impl RigSink) {
        self.drop_held(sink);
        let Some(scan) = self.scan.take() else { return };
        let mut counting = Counting { sink: &mut *sink, segments: &mut self.counters.segments };
        let finished = self.segmenter.finish(&mut counting);
        let unlabelled = match finished {
            Finished::Complete { unlabelled, .. } => unlabelled,
            Finished::Stopped => 0,
        };
        let number = self.counters.scans;
        sink.scan_finished(&ScanFinished { number, end, rows: scan.rows, unlabelled, counters: self.counters });
    }

    fn drop_held(&mut self, sink: &mut impl RigSink) {
        if self.held.take().is_some() {
            self.drop_row(Dropped::Alone, sink);
        }
    }

    fn drop_row(&mut self, dropped: Dropped, sink: &mut impl RigSink) {
        self.counters.count(dropped);
        sink.row_dropped(dropped);
    }
}
