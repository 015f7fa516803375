//! The rows of an LMS 2xx, as those of every other line scanner.

use super::scan_line::ScanLine;
use super::session::Session;
use super::shell::{ScannerEvent, feed};
use super::telegram::TelegramError;
use crate::pairing::MIRROR_TURN_US;
use crate::scanner::{LineEvent, LineScanner, Row, RowMemory, ScannerCounters, count};

/// A session whose scan lines become rows. Some 80 bytes beside the session and the memory for one
/// row, which has room for the columns of a telegram.
///
/// Poll the session as ever, see [`Session::poll`]; its bytes go to [`LineScanner::feed`] here. A
/// partial scan line is a row of its own: its beams lie at their own angles, and so do those of a
/// sub-range.
#[derive(Debug)]
pub struct Rows<'a> {
    /// The session.
    pub session: Session,
    memory: RowMemory<'a>,
    counters: ScannerCounters,
    /// When the telegram under way began, and the last valid one.
    start_us: Option<u64>,
    last_start_us: Option<u64>,
    /// The row given out: its beams, the turns of the mirror merged in it, that of the first beam.
    row: Option<(usize, u16, u16)>,
}

impl<'a> Rows<'a> {
    /// Returns the rows of a session.
    #[must_use]
    pub fn new(session: Session, memory: RowMemory<'a>) -> Self {
        let counters = ScannerCounters::default();
        Self { session, memory, counters, start_us: None, last_start_us: None, row: None }
    }

    /// Makes a row of the session's scan line.
    fn take(&mut self) -> Option<(usize, u16, u16)> {
        let (settings, line) = (self.session.settings(), self.session.scan_line()?);
        let columns = usize::from(line.columns());
        let beams = columns.min(self.memory.ranges_m.len()).min(self.memory.angles_rad.len());
        count(&mut self.counters.dropped_beams, (columns - beams) as u32);
        line.ranges_m(settings.mode, self.memory.ranges_m);
        let variant = settings.variant;
        for (column, angle_rad) in self.memory.angles_rad.iter_mut().take(beams).enumerate() {
            *angle_rad = line.angle_rad(variant, column as u16);
        }
        let merged = if line.partial_quarter().is_some() { 1 } else { variant.mirror_turns() };
        Some((beams, merged, line.first_column().checked_rem(merged)?))
    }

    /// Counts the telegrams lost since the last valid one, by the time.
    fn count_lost(&mut self) {
        let scans = self.session.scan_line().map_or(1, |line| line.scans().max(1));
        let period_us = u64::from(self.session.settings().period_us()).max(1) * u64::from(scans);
        let Some(start_us) = self.start_us else { return };
        if let Some(last_us) = self.last_start_us.replace(start_us) {
            let periods = (start_us.saturating_sub(last_us) + period_us / 2) / period_us;
            count(&mut self.counters.lost, periods.saturating_sub(1) as u32);
        }
    }
}

impl LineScanner for Rows<'_> {
    type Error = TelegramError;

    fn feed(&mut self, bytes: &[u8], now_us: u64) -> (usize, LineEvent<TelegramError>) {
        self.row = None;
        let mut used = 0;
        loop {
            let (more, event) = feed(&mut self.session, bytes.get(used..).unwrap_or(&[]), now_us);
            used += more;
            match event {
                None => return (used, LineEvent::NeedMore),
                Some(ScannerEvent::Start { time_us }) => self.start_us = Some(time_us),
                Some(ScannerEvent::ScanLine) => {
                    count(&mut self.counters.packets, 1);
                    count(&mut self.counters.rows, 1);
                    self.count_lost();
                    self.row = self.take();
                    return (used, LineEvent::Row);
                }
                Some(ScannerEvent::Rejected(error)) => {
                    count(&mut self.counters.rejected, 1);
                    return (used, LineEvent::Rejected(error));
                }
                // those of a session come from its `poll`
                Some(ScannerEvent::Trouble(_)) => {}
            }
        }
    }

    fn row(&self) -> Option<Row<'_>> {
        let (beams, merged_turns, first_turn) = self.row?;
        let (angles_rad, ranges_m) = (self.memory.angles_rad.get(..beams)?, self.memory.ranges_m.get(..beams)?);
        // it begins to send when the mirror has passed the left edge of the field of view
        let left_rad = 0.5 * f32::from(self.session.settings().variant.view_deg()).to_radians();
        let after = angles_rad.last().map_or(0.0, |last_rad| (left_rad - last_rad) / core::f32::consts::TAU);
        let end_us = self.start_us.unwrap_or(0).saturating_sub((after * MIRROR_TURN_US) as u64);
        Some(Row { angles_rad, ranges_m, end_us, mirror_turn_us: MIRROR_TURN_US, merged_turns, first_turn })
    }

    fn counters(&self) -> ScannerCounters {
        self.counters
    }
}

impl ScanLine<'_> {
    /// Returns the angle of a column of this scan line, radians from the middle of the field of
    /// view, counter-clockwise: of a scanner that is set to `variant`.
    #[must_use]
    pub fn angle_rad(&self, variant: super::format::Variant, column: u16) -> f32 {
        let (first_cdeg, step_cdeg) = match self.partial_quarter() {
            Some(quarter) => (25 * i32::from(quarter), 100),
            None => (0, i32::from(variant.step_cdeg())),
        };
        let cdeg =
            first_cdeg + i32::from(self.first_column() + column) * step_cdeg - 50 * i32::from(variant.view_deg());
        (cdeg as f32 / 100.0).to_radians()
    }
}
