//! The rig: from events to rows, from rows to scans.

use core::mem;

use scanseg_core::{Finished, PushError, RowBeams, Segmenter, Status};

use super::counters::{Counters, Dropped, count};
use super::limits::{RigError, TiltLimits};
use super::place::Place;
use super::sink::{Counting, End, RigSink, ScanFinished, ScanStarted};
use crate::latch::Latch;
use crate::lms2xx::{Settings, Trouble};
use crate::pairing::Pairing;

/// The largest distance of two rows, in telegrams, at which the limits of the rate suffice to
/// detect a jump of the encoder.
const NEAR: u32 = 4;

/// A scan under way.
#[derive(Clone, Copy, Debug)]
struct Progress {
    last: Place,
    /// Angle since the first row.
    covered_rad: f32,
    rows: u16,
    /// The sink has broken off: the rest of the sweep is dropped.
    stopped: bool,
}

/// What a rig knows of its scanner.
pub trait Turns {
    /// What says where the beams of a row point: a turn angle where that is enough.
    type Beams<'r>: Into<RowBeams<'r>>;

    /// The last row and the row held change their places.
    fn swap(&mut self) {}

    /// Returns where the beams of the last row point; its mean turn angle is `turn_rad`. `rest` is
    /// what is kept behind its ranges: directions if they are free.
    fn beams<'r>(&self, turn_rad: f32, rest: &'r [f32]) -> Self::Beams<'r>;
}

/// Scanner, tilt and segmenter: see [`rig`](crate::rig). `K` is what the rig knows of its scanner: the
/// [`Settings`] of an LMS 2xx, bare or as [`OwnTurns`](super::OwnTurns), or the [`Mount`](super::Mount) of another line scanner.
#[derive(Debug)]
pub struct Rig<'a, S, K = Settings> {
    pub(super) scanner: K,
    columns: u16,
    /// Time from row to row.
    period_us: u32,
    limits: TiltLimits,
    segmenter: S,
    pub(super) pairing: Pairing,
    /// The ranges of the last row, and of the row held; behind them the directions of free beams.
    pub(super) row_m: &'a mut [f32],
    held_m: &'a mut [f32],
    /// A row that does not continue the scan. If the next row agrees with it, a new scan begins
    /// with it.
    held: Option<Place>,
    scan: Option<Progress>,
    /// The last sample with a plausible rate, and the time of the last sample that did not continue
    /// the one before.
    followed: Option<Place>,
    jumped_us: u64,
    /// Times of start bytes: of the telegram under way, and of the last valid one.
    pub(super) start_us: Option<u64>,
    pub(super) last_start_us: Option<u64>,
    pub(super) counters: Counters,
}

impl<'a, S: Segmenter, K: Turns> Rig<'a, S, K> {
    /// Puts a rig together: columns of a row, numbers that are kept of each, the time from row to row,
    /// and the age of the middle beam when a row is told of.
    pub(super) fn of_parts(
        scanner: K,
        (columns, numbers, period_us, middle_us): (u16, usize, u32, u32),
        limits: TiltLimits,
        segmenter: S,
        rows_m: &'a mut [f32],
    ) -> Result<Self, RigError> {
        limits.check(period_us)?;
        let row = numbers * usize::from(columns);
        let (needed, got) = (2 * row, rows_m.len());
        let rows_m = rows_m.get_mut(..needed).and_then(|rows_m| rows_m.split_at_mut_checked(row));
        let (row_m, held_m) = rows_m.ok_or(RigError::Memory { needed, got })?;
        Ok(Self {
            scanner,
            columns,
            period_us,
            limits,
            segmenter,
            pairing: Pairing::of_rows(period_us, middle_us),
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

    /// Takes a sample of the tilt, by the same clock as the bytes; `None` if the encoder could not
    /// be read. Sample the tilt when bytes have come, before the call of [`Rig::receive`].
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

    /// Takes a trouble of the scanner, and ends the scan.
    pub fn trouble(&mut self, trouble: Trouble, sink: &mut (impl RigSink + ?Sized)) {
        count(&mut self.counters.troubles);
        (self.start_us, self.last_start_us) = (None, None);
        self.end(End::Trouble, sink);
        sink.trouble(trouble);
    }

    /// Takes the present time, and ends the scan if no row has come for [`TiltLimits::pause_us`].
    /// Call it regularly.
    pub fn idle(&mut self, now_us: u64, sink: &mut (impl RigSink + ?Sized)) {
        let over = |place: &Place| now_us.saturating_sub(place.start_us) > u64::from(self.limits.pause_us);
        let scan_over = self.scan.is_none_or(|scan| over(&scan.last));
        if scan_over && self.held.is_none_or(|held| over(&held)) {
            self.end(End::Pause, sink);
        }
    }

    /// Takes the numbers of bytes that the scanner's port has lost since it was opened, for the
    /// counters: those that were taken out too late, and those for which the queue behind the port
    /// had no room.
    pub fn port_lost(&mut self, overruns: u32, queue_full: u32) {
        (self.counters.overruns, self.counters.queue_full) = (overruns, queue_full);
    }

    /// Ends the scan, if one is under way.
    pub fn finish(&mut self, sink: &mut (impl RigSink + ?Sized)) {
        self.end(End::Asked, sink);
    }

    /// Returns the counts so far.
    #[must_use]
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Returns the segmenter.
    pub fn release(self) -> S {
        self.segmenter
    }

    /// Returns where the tilt was, or why that is not known.
    pub(super) fn place(&self, turn_rad: f32, rate_rad_per_s: f32, start_us: u64) -> Result<Place, Dropped> {
        if self.limits.plausible(rate_rad_per_s) {
            Ok(Place { turn_rad, rising: rate_rad_per_s > 0.0, start_us })
        } else if rate_rad_per_s.abs() < self.limits.min_rate_rad_per_s {
            Err(Dropped::Standing)
        } else {
            Err(Dropped::Jump)
        }
    }

    /// Returns the angle from one row to another, radians; `None` if it is not certain that both
    /// are of one sweep. Over a long time a jump can stay within the limits of the rate, so the
    /// samples must have shown none.
    #[inline(never)] // it is called twice: 200 bytes of flash
    fn goes_on(&self, before: &Place, place: &Place) -> Option<f32> {
        let near = place.start_us.saturating_sub(before.start_us) <= u64::from(NEAR * self.period_us);
        let sure = near || self.jumped_us < before.start_us;
        place.since(before, &self.limits).filter(|_| sure)
    }

    /// Takes a row with a plausible turn angle: the next of the scan, the second of a new scan, or
    /// one to be held.
    pub(super) fn row(&mut self, place: Place, sink: &mut (impl RigSink + ?Sized)) {
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
            self.swap();
            self.push(held, 0.0, sink);
            self.swap();
            self.push(place, moved_rad, sink);
        } else {
            self.drop_held(sink);
            self.swap();
            self.held = Some(place);
        }
    }

    /// The last row and the row held change their places.
    fn swap(&mut self) {
        mem::swap(&mut self.row_m, &mut self.held_m);
        self.scanner.swap();
    }

    /// Begins a scan.
    fn begin(&mut self, first: Place, sink: &mut (impl RigSink + ?Sized)) {
        count(&mut self.counters.scans);
        self.scan = Some(Progress { last: first, covered_rad: 0.0, rows: 0, stopped: false });
        sink.scan_started(&ScanStarted {
            number: self.counters.scans,
            columns: self.columns,
            turn_rad: first.turn_rad,
        });
    }

    /// Gives the last row to the segmenter.
    fn push(&mut self, place: Place, moved_rad: f32, sink: &mut (impl RigSink + ?Sized)) {
        let Some(scan) = &mut self.scan else { return };
        scan.last = place;
        scan.covered_rad += moved_rad;
        if scan.stopped {
            return self.drop_row(Dropped::Stopped, sink);
        }
        let mut counting = Counting { sink, segments: &mut self.counters.segments };
        let (ranges_m, rest) = self.row_m.split_at_checked(self.columns.into()).unwrap_or_default();
        let beams = self.scanner.beams(place.turn_rad, rest);
        match self.segmenter.push_row(ranges_m, beams, &mut counting) {
            Ok(status) => {
                scan.rows = scan.rows.saturating_add(1);
                scan.stopped = status == Status::Stopped;
                count(&mut self.counters.rows);
            }
            Err(PushError::TooManyRows { .. }) if scan.rows > 0 => {
                self.end(End::Covered, sink);
                self.begin(place, sink);
                self.push(place, 0.0, sink);
            }
            Err(_) => self.drop_row(Dropped::Refused, sink),
        }
    }

    /// Ends the scan, if one is under way, and drops the row held.
    fn end(&mut self, end: End, sink: &mut (impl RigSink + ?Sized)) {
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

    fn drop_held(&mut self, sink: &mut (impl RigSink + ?Sized)) {
        if self.held.take().is_some() {
            self.drop_row(Dropped::Alone, sink);
        }
    }

    pub(super) fn drop_row(&mut self, dropped: Dropped, sink: &mut (impl RigSink + ?Sized)) {
        count(self.counters.of(dropped));
        sink.row_dropped(dropped);
    }
}
