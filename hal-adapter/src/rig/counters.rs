//! What a rig has seen, counted.

use serde::{Deserialize, Serialize};

/// Why a good telegram did not become a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Dropped {
    /// The tilt was not sampled near its beams.
    NoTurn,
    /// The tilt stood, or its encoder was stuck.
    Standing,
    /// The tilt moved faster than it can: its encoder jumped.
    Jump,
    /// The tilt was where neither the scan nor the next row had it: an encoder that was wrong, or the only row of a sweep.
    Alone,
    /// The scanner reported an error or implausible values.
    Status,
    /// It has not the columns of the settings.
    Columns,
    /// The sink has broken off the scan.
    Stopped,
    /// The segmenter refused it.
    Refused,
}

/// What has happened since the rig was made. Counts go round at 2^32: telegrams after two years.
///
/// `telegrams` is the sum of `rows` and all kinds of dropped ones, but for one that may still be held.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Bytes given to [`Rig::receive`](super::Rig::receive).
    pub bytes: u64,
    /// Good scan telegrams.
    pub telegrams: u32,
    /// Beginnings of telegrams that turned out to be damaged, or none. Not the number of telegrams lost: one that is
    /// damaged can contain several, and one whose start byte is lost contains none.
    pub rejected: u32,
    /// Telegrams that must have been sent between two good ones, by the time between them. After a trouble from the first
    /// good one on, or from the second if the scanner's answer that it starts was lost as well.
    pub lost: u32,
    /// Rows given to the segmenter.
    pub rows: u32,
    /// Telegrams dropped, see [`Dropped::NoTurn`].
    pub no_turn: u32,
    /// Telegrams dropped, see [`Dropped::Standing`].
    pub standing: u32,
    /// Telegrams dropped, see [`Dropped::Jump`].
    pub jump: u32,
    /// Telegrams dropped, see [`Dropped::Alone`].
    pub alone: u32,
    /// Telegrams dropped, see [`Dropped::Status`].
    pub status: u32,
    /// Telegrams dropped, see [`Dropped::Columns`].
    pub columns: u32,
    /// Telegrams dropped, see [`Dropped::Stopped`].
    pub stopped: u32,
    /// Telegrams dropped, see [`Dropped::Refused`].
    pub refused: u32,
    /// Samples of the tilt that could not be taken.
    pub encoder_errors: u32,
    /// Troubles of the scanner.
    pub troubles: u32,
    /// Scans begun.
    pub scans: u32,
    /// Segments given out.
    pub segments: u32,
}

impl Counters {
    /// Good telegrams that did not become rows.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        let Self { no_turn, standing, jump, alone, status, columns, stopped, refused, .. } = *self;
        let tilt = no_turn.wrapping_add(standing).wrapping_add(jump).wrapping_add(alone);
        tilt.wrapping_add(status).wrapping_add(columns).wrapping_add(stopped).wrapping_add(refused)
    }

    pub(super) fn of(&mut self, dropped: Dropped) -> &mut u32 {
        match dropped {
            Dropped::NoTurn => &mut self.no_turn,
            Dropped::Standing => &mut self.standing,
            Dropped::Jump => &mut self.jump,
            Dropped::Alone => &mut self.alone,
            Dropped::Status => &mut self.status,
            Dropped::Columns => &mut self.columns,
            Dropped::Stopped => &mut self.stopped,
            Dropped::Refused => &mut self.refused,
        }
    }
}

pub(super) fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
