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
//! Every other telegram is dropped with its reason, [`Dropped`], and counted in [`Counters`]. What cannot be seen is an
//! encoder that is wrong by so little that the rate stays within the limits: by at most the difference between the rate and
//! a limit, times the time between two rows, if that is up to four telegrams; over a longer time, in which telegrams were
//! lost, times that between two samples, since a scan goes on only if these did.
//!
//! All beams of a row get the turn angle of the row, its mean. What that leaves of the tilt's movement is in the table of
//! [`pairing`](crate::pairing): on the floor there, at 0.5 rad/s, 5.6 mm if two mirror turns make a row, 1.1 mm if each is
//! a row of its own. So take a variant in steps of 1 degree for a tilt that moves.
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
mod limits;
mod segmenter;

use core::mem;

use scanseg_core::{Finished, PushError, Status};

pub use counters::{Counters, Dropped};
pub use limits::{RigError, TiltLimits, beams};
pub use segmenter::{End, RigSink, RowSegmenter, ScanFinished, ScanStarted};

use crate::lms2xx::{Scan, ScannerEvent, Session, Settings, Severity, Trouble, feed};
use crate::pairing::{Latch, Pairing, RowTurn, Sweep, shorter_way};
use counters::count;
use segmenter::Counting;

/// Telegrams between two rows, up to which the limits of the rate are enough to see a jump of the encoder.
const NEAR: u32 = 4;

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
        let time_s = 1e-6 * time_us as f32;
        let [least_rad, most_rad] = [limits.min_rate_rad_per_s, limits.max_rate_rad_per_s].map(|rate| rate * time_s);
        let goes_on = self.rising == before.rising && time_us <= u64::from(limits.pause_us);
        (goes_on && (least_rad..=most_rad).contains(&moved_rad)).then_some(moved_rad)
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
    /// The last sample at which the tilt turned at a plausible rate, and when one did not go on where the one before was.
    followed: Option<Place>,
    jumped_us: u64,
    /// Start bytes: of the telegram under way, if it was seen, and of the last good one.
    start_us: Option<u64>,
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
        limits.check(&settings)?;
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
            followed: None,
            jumped_us: 0,
            start_us: None,
            last_start_us: None,
            counters: Counters::default(),
        })
    }

    /// The tilt was sampled, by the clock of the bytes; `None`: it could not be read. Sample it when bytes have come, and
    /// before they are given to [`Rig::receive`].
    pub fn tilt(&mut self, sample: Option<Latch>) {
        let Some(latch) = sample else { return count(&mut self.counters.encoder_errors) };
        self.pairing.sample(latch);
        let Some(rate) = self.pairing.rate_rad_per_s().filter(|&rate| self.limits.plausible(rate)) else { return };
        let here = Place { turn_rad: latch.turn_rad, rising: rate > 0.0, start_us: latch.time_us };
        if let Some(before) = &self.followed {
            if latch.time_us.saturating_sub(before.start_us) < self.pairing.spacing_us() {
                return;
            }
            if here.since(before, &self.limits).is_none() {
                self.jumped_us = latch.time_us;
            }
        }
        self.followed = Some(here);
    }

    /// Bytes of the scanner, the last of which came at `now_us`, any origin.
    pub fn receive(&mut self, session: &mut Session, bytes: &[u8], now_us: u64, sink: &mut impl RigSink) {
        self.counters.bytes = self.counters.bytes.wrapping_add(bytes.len() as u64);
        let mut rest = bytes;
        while let (used, Some(event)) = feed(session, rest, now_us) {
            rest = rest.get(used..).unwrap_or(&[]);
            self.handle(event, session.scan(), sink);
        }
    }

    /// What a scanner on its port has told, and with [`ScannerEvent::Scan`] its scan.
    pub fn handle(&mut self, event: ScannerEvent, scan: Option<Scan<'_>>, sink: &mut impl RigSink) {
        match (event, scan) {
            (ScannerEvent::Start { time_us }, _) => {
                self.start_us = Some(time_us);
                self.pairing.start(time_us);
            }
            (ScannerEvent::Scan, Some(scan)) => self.telegram(&scan, sink),
            (ScannerEvent::Scan, None) => {}
            (ScannerEvent::Rejected(_), _) => count(&mut self.counters.rejected),
            (ScannerEvent::Trouble(trouble), _) => self.trouble(trouble, sink),
        }
    }

    /// Something is wrong with the scanner: ends the scan.
    pub fn trouble(&mut self, trouble: Trouble, sink: &mut impl RigSink) {
        count(&mut self.counters.troubles);
        (self.start_us, self.last_start_us) = (None, None);
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
        count(&mut self.counters.telegrams);
        // The first scan after a trouble may come while the session still waits for an answer, and has no start then.
        let Some(start_us) = self.start_us.take() else { return self.drop_row(Dropped::NoTurn, sink) };
        self.count_lost(start_us);
        let turn = self.pairing.row(Sweep::of(scan, self.settings.variant));
        if scan.status().severity() >= Some(Severity::Error) || scan.status().implausible() {
            return self.drop_row(Dropped::Status, sink);
        }
        if usize::from(scan.columns()) != self.row_m.len() {
            return self.drop_row(Dropped::Columns, sink);
        }
        match self.place(turn, start_us) {
            Err(dropped) => self.drop_row(dropped, sink),
            Ok(place) => {
                scan.ranges_m(self.settings.mode, self.row_m);
                self.row(place, sink);
            }
        }
    }

    /// Telegrams that must have come since the last good one, by the time.
    fn count_lost(&mut self, start_us: u64) {
        let period_us = u64::from(self.settings.period_us()).max(1);
        if let Some(last_us) = self.last_start_us.replace(start_us) {
            let periods = (start_us.saturating_sub(last_us) + period_us / 2) / period_us;
            self.counters.lost = self.counters.lost.wrapping_add(periods.saturating_sub(1) as u32);
        }
    }

    fn place(&self, turn: Option<RowTurn>, start_us: u64) -> Result<Place, Dropped> {
        let turn = turn.ok_or(Dropped::NoTurn)?;
        let rate_rad_per_s = turn.rate_rad_per_s();
        if self.limits.plausible(rate_rad_per_s) {
            Ok(Place { turn_rad: turn.turn_rad(), rising: rate_rad_per_s > 0.0, start_us })
        } else if rate_rad_per_s.abs() < self.limits.min_rate_rad_per_s {
            Err(Dropped::Standing)
        } else {
            Err(Dropped::Jump)
        }
    }

    /// How far the tilt has turned from one row to another, radians; `None` if it is not sure that these are of one sweep.
    /// Over a long time the limits of the rate leave room for a jump, so there the samples must have shown none.
    fn goes_on(&self, before: &Place, place: &Place) -> Option<f32> {
        let near = place.start_us.saturating_sub(before.start_us) <= u64::from(NEAR * self.settings.period_us());
        let sure = near || self.jumped_us < before.start_us;
        place.since(before, &self.limits).filter(|_| sure)
    }

    /// A row with a plausible turn angle: the next of the scan, the second of a new scan, or one to be held.
    fn row(&mut self, place: Place, sink: &mut impl RigSink) {
        if let Some(moved_rad) = self.scan.and_then(|scan| self.goes_on(&scan.last, &place)) {
            self.drop_held(sink);
            let covered_rad = self.scan.map_or(0.0, |scan| scan.covered_rad);
            if covered_rad + moved_rad > self.limits.sweep_rad {
                self.end(End::Covered, sink);
                self.begin(place, sink);
                self.push(place, 0.0, sink);
            } else {
                self.push(place, moved_rad, sink);
            }
        } else if let Some((held, moved_rad)) = self.held.and_then(|held| Some((held, self.goes_on(&held, &place)?))) {
            self.held = None;
            self.end(End::Turned, sink);
            self.begin(held, sink);
            mem::swap(&mut self.row_m, &mut self.held_m);
            self.push(held, 0.0, sink);
            mem::swap(&mut self.row_m, &mut self.held_m);
            self.push(place, moved_rad, sink);
        } else {
            self.drop_held(sink);
            mem::swap(&mut self.row_m, &mut self.held_m);
            self.held = Some(place);
        }
    }

    fn begin(&mut self, first: Place, sink: &mut impl RigSink) {
        count(&mut self.counters.scans);
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
                scan.rows = scan.rows.saturating_add(1);
                scan.stopped = status == Status::Stopped;
                count(&mut self.counters.rows);
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
        count(self.counters.of(dropped));
        sink.row_dropped(dropped);
    }
}
