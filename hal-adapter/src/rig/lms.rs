//! The rig of an LMS 2xx: its telegrams become rows.

use scanseg_core::{ColumnTurns, RowBeams, Segmenter};

use super::counters::{Dropped, count};
use super::limits::{RigError, TiltLimits};
use super::pipeline::{Rig, Turns};
use super::sink::RigSink;
use crate::lms2xx::{ScanLine, ScannerEvent, Session, Settings, Severity, feed};
use crate::pairing::{BeamAges, Pairing, RowTurn};

/// The settings of an LMS 2xx in whose rig each beam has the turn angle of its own time; with bare
/// [`Settings`] all beams of a row have its mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OwnTurns {
    settings: Settings,
    /// Of the last row and of the row held: the turn of its first beam less its mean, radians, and
    /// how its columns go on turning.
    row: (f32, ColumnTurns),
    held: (f32, ColumnTurns),
}

impl OwnTurns {
    /// Returns the settings as those of such a rig.
    #[must_use]
    pub const fn new(settings: Settings) -> Self {
        let still = (0.0, ColumnTurns::NONE);
        Self { settings, row: still, held: still }
    }
}

/// What a rig knows of its LMS 2xx: [`Settings`], or [`OwnTurns`].
pub trait LmsRows: Turns {
    /// Returns the settings of the scanner's session.
    fn settings(&self) -> &Settings;

    /// Takes note of the turn of the last row.
    fn turned(&mut self, turn: &RowTurn) {
        let _ = turn;
    }
}

impl Turns for Settings {
    type Beams<'r> = f32;

    fn beams(&self, turn_rad: f32, _: &[f32]) -> f32 {
        turn_rad
    }
}

impl LmsRows for Settings {
    fn settings(&self) -> &Settings {
        self
    }
}

impl Turns for OwnTurns {
    type Beams<'r> = RowBeams<'r>;

    fn swap(&mut self) {
        core::mem::swap(&mut self.row, &mut self.held);
    }

    fn beams<'r>(&self, turn_rad: f32, _: &'r [f32]) -> RowBeams<'r> {
        let (first_rad, column_turns) = self.row;
        RowBeams::from(turn_rad + first_rad).with_column_turns(column_turns)
    }
}

impl LmsRows for OwnTurns {
    fn settings(&self) -> &Settings {
        &self.settings
    }

    fn turned(&mut self, turn: &RowTurn) {
        let RowBeams { turn_rad, column_turns, .. } = turn.beams();
        self.row = (turn_rad - turn.turn_rad(), column_turns);
    }
}

impl<'a, S: Segmenter, K: LmsRows> Rig<'a, S, K> {
    /// Returns the rig of an LMS 2xx. `scanner` are the settings of its session. `segmenter` has
    /// the columns of the variant and its [`beams`](super::beams). `rows_m` is memory for two rows
    /// of ranges.
    ///
    /// # Errors
    /// [`RigError`]: the limits do not fit the settings, or `rows_m` is too short.
    pub fn new(scanner: K, limits: TiltLimits, segmenter: S, rows_m: &'a mut [f32]) -> Result<Self, RigError> {
        let settings = scanner.settings();
        let rows = (settings.variant.columns(), 1, settings.period_us(), Pairing::middle_us(settings));
        Self::of_parts(scanner, rows, limits, segmenter, rows_m)
    }

    /// Takes bytes of the scanner. The last of them came at `now_us`, microseconds.
    pub fn receive(&mut self, session: &mut Session, bytes: &[u8], now_us: u64, sink: &mut (impl RigSink + ?Sized)) {
        self.counters.bytes = self.counters.bytes.wrapping_add(bytes.len() as u64);
        let mut rest = bytes;
        while let (used, Some(event)) = feed(session, rest, now_us) {
            rest = rest.get(used..).unwrap_or(&[]);
            self.handle(event, session.scan_line(), sink);
        }
    }

    /// Takes an event of a scanner on its port, and with [`ScannerEvent::ScanLine`] its scan line.
    pub fn handle(&mut self, event: ScannerEvent, line: Option<ScanLine<'_>>, sink: &mut (impl RigSink + ?Sized)) {
        match (event, line) {
            (ScannerEvent::Start { time_us }, _) => {
                self.start_us = Some(time_us);
                self.pairing.start(time_us);
            }
            (ScannerEvent::ScanLine, Some(line)) => self.telegram(&line, sink),
            (ScannerEvent::ScanLine, None) => {}
            (ScannerEvent::Rejected(_), _) => count(&mut self.counters.rejected),
            (ScannerEvent::Trouble(trouble), _) => self.trouble(trouble, sink),
        }
    }

    fn telegram(&mut self, line: &ScanLine<'_>, sink: &mut (impl RigSink + ?Sized)) {
        count(&mut self.counters.telegrams);
        // The first telegram after a trouble may come while the session still waits for an answer.
        // It has no start byte.
        let Some(start_us) = self.start_us.take() else { return self.drop_row(Dropped::NoTurn, sink) };
        self.count_lost(start_us, line.scans());
        let turn = self.pairing.row(BeamAges::of(line, self.scanner.settings().variant));
        if !line.fits(self.scanner.settings().variant) {
            return self.drop_row(Dropped::Columns, sink);
        }
        if line.status().severity() >= Some(Severity::Error) || line.status().implausible() {
            return self.drop_row(Dropped::Status, sink);
        }
        let Some(turn) = turn else { return self.drop_row(Dropped::NoTurn, sink) };
        match self.place(turn.turn_rad(), turn.rate_rad_per_s(), start_us) {
            Err(dropped) => self.drop_row(dropped, sink),
            Ok(place) => {
                line.row_m(self.scanner.settings().mode, self.scanner.settings().variant, self.row_m);
                self.scanner.turned(&turn);
                self.row(place, sink);
            }
        }
    }

    /// Counts the telegrams lost since the last valid one, by the time; at most those of 71 minutes.
    fn count_lost(&mut self, start_us: u64, scans: u8) {
        let period_us = self.scanner.settings().period_us().max(1).saturating_mul(u32::from(scans.max(1)));
        if let Some(last_us) = self.last_start_us.replace(start_us) {
            let since_us = u32::try_from(start_us.saturating_sub(last_us)).unwrap_or(u32::MAX);
            let periods = since_us.saturating_add(period_us / 2).checked_div(period_us).unwrap_or(0);
            self.counters.lost = self.counters.lost.wrapping_add(periods.saturating_sub(1));
        }
    }
}
