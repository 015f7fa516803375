//! Counts of the events of a rig.

/// Why a valid telegram did not become a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Dropped {
    /// The tilt was not sampled near its beams.
    NoTurn,
    /// The tilt did not move, or its encoder was stuck.
    Standing,
    /// The tilt moved faster than it can: the encoder jumped.
    Jump,
    /// The tilt was not where the scan or the next row had it: an encoder error, or the only row of
    /// a sweep.
    Alone,
    /// The scanner reported an error or implausible values.
    Status,
    /// The number of columns is not that of the settings.
    Columns,
    /// The sink had broken off the scan.
    Stopped,
    /// The segmenter refused the row.
    Refused,
}

/// Counts since the rig was made. They wrap at 2^32, which telegrams reach after two years.
///
/// `telegrams` is the sum of `rows` and of all dropped telegrams, plus those under way. Between calls
/// of the rig that is one while a row is held. In the report of a scan's end it is two where the tilt
/// turned ([`End::Turned`](super::End::Turned): the row held and the one that agrees with it begin the
/// next scan), one where the sweep was covered, and none otherwise.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Counters {
    /// Bytes given to [`Rig::receive`](super::Rig#method.receive).
    pub bytes: u64,
    /// Valid scan telegrams; rows of the scanner in a rig with a [`Mount`](super::Mount).
    pub telegrams: u32,
    /// Rejected beginnings of telegrams. This is not the number of damaged telegrams: a damaged
    /// telegram can contain several beginnings, and one whose start byte is lost contains none.
    pub rejected: u32,
    /// Lost telegrams, by the time between valid ones; lost packets in a rig with a mount, see
    /// [`ScannerCounters::lost`](crate::scanner::ScannerCounters::lost). After a [`Trouble`](crate::lms2xx::Trouble)
    /// the count goes on with the first valid telegram, or with the second if the scanner's answer
    /// to the start command was lost.
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
    /// Samples of the tilt that failed.
    pub encoder_errors: u32,
    /// Troubles of the scanner, see [`Trouble`](crate::lms2xx::Trouble).
    pub troubles: u32,
    /// Scans begun.
    pub scans: u32,
    /// Segments given out.
    pub segments: u32,
    /// Bytes of the scanner that its port lost because they were taken out too late, as far as it
    /// noticed, see [`Rig::port_lost`](super::Rig::port_lost).
    pub overruns: u32,
    /// Bytes of the scanner lost because the queue behind its port was full.
    pub queue_full: u32,
}

impl Counters {
    /// Returns the number of valid telegrams that did not become rows.
    #[must_use]
    pub const fn dropped(&self) -> u32 {
        let Self { no_turn, standing, jump, alone, status, columns, stopped, refused, .. } = *self;
        let tilt = no_turn.wrapping_add(standing).wrapping_add(jump).wrapping_add(alone);
        tilt.wrapping_add(status).wrapping_add(columns).wrapping_add(stopped).wrapping_add(refused)
    }

    /// Returns the count of this reason.
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

/// Adds 1, and wraps.
pub(super) fn count(counter: &mut u32) {
    *counter = counter.wrapping_add(1);
}
