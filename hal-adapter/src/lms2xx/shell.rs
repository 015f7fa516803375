//! A scanner on its port: what does not depend on whether the port blocks.

use super::command::CommandBytes;
use super::scan::Scan;
use super::session::{Phase, Session, SessionEvent};
use super::settings::Settings;
use super::telegram::TelegramError;
use super::trouble::Trouble;

/// An LMS 2xx on a port, with a [`Clock`](crate::Clock) and a delay: [`Scanner::next_event`] for a
/// [blocking port](super::blocking::Port), [`Scanner::next_event_async`] for an [async one](super::asynch::Port).
#[derive(Debug)]
pub struct Scanner<P, C, D> {
    pub(super) session: Session,
    pub(super) inbox: Inbox,
    pub(super) outbox: Outbox,
    pub(super) port: P,
    pub(super) clock: C,
    pub(super) delay: D,
}

impl<P, C, D> Scanner<P, C, D> {
    /// Touches nothing yet: the scanner is looked for in the first calls for an event. 1200 bytes at most, beside port, clock and delay;
    /// `const`, so that it can be made in place in a static.
    pub const fn new(port: P, clock: C, delay: D, settings: Settings) -> Self {
        Self { session: Session::new(settings), inbox: Inbox::new(), outbox: Outbox::EMPTY, port, clock, delay }
    }

    /// The scan that came with the last event, if that was [`ScannerEvent::Scan`].
    #[must_use]
    pub fn scan(&self) -> Option<Scan<'_>> {
        self.session.scan()
    }

    /// How far the scanner is.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.session.phase()
    }

    /// Gives port, clock and delay back. The scanner is left as it is.
    pub fn release(self) -> (P, C, D) {
        (self.port, self.clock, self.delay)
    }
}

/// What a scanner on its port has to tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScannerEvent {
    /// A scan may be beginning: read the tilt encoder now. Of several in a row the last one belongs to the scan.
    Start {
        /// When the start byte came, by the clock given, microseconds: the time when the last byte was read, less that of the
        /// bytes behind it and of the silence between telegrams among them. It is as late as the port was in handing its
        /// bytes over.
        time_us: u64,
    },
    /// A scan: `scan()` gives it until the next call.
    Scan,
    /// A damaged telegram, or one unlike the settings.
    Rejected(TelegramError),
    /// Something went wrong and is being dealt with; just go on.
    Trouble(Trouble),
}

/// Why the port can no longer be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Error<E> {
    /// The port's own error.
    Port(E),
    /// The port has ended: a read gave no bytes, or a write took none.
    Ended,
}

impl<E: core::fmt::Display> core::fmt::Display for Error<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Port(error) => write!(f, "scanner port: {error}"),
            Self::Ended => write!(f, "scanner port has ended"),
        }
    }
}

impl<E: core::error::Error> core::error::Error for Error<E> {}

/// Bytes read and not yet used up.
#[derive(Debug)]
pub(super) struct Inbox {
    bytes: [u8; 64],
    from: usize,
    to: usize,
    /// When they were read.
    read_us: u64,
    /// The session may have more to say about bytes already used.
    open: bool,
}

impl Inbox {
    const fn new() -> Self {
        Self { bytes: [0; 64], from: 0, to: 0, read_us: 0, open: false }
    }

    /// Room for one read.
    pub(super) fn room(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// So many bytes have been read into `room`, at this time. 0 means that the port has ended.
    pub(super) fn filled<E>(&mut self, count: usize, now_us: u64) -> Result<(), Error<E>> {
        (self.from, self.to, self.read_us, self.open) = (0, count, now_us, true);
        if count == 0 { Err(Error::Ended) } else { Ok(()) }
    }

    /// Feeds the session; `None` when it needs more.
    pub(super) fn next(&mut self, session: &mut Session) -> Option<ScannerEvent> {
        if !self.open {
            return None;
        }
        let rest = self.bytes.get(self.from..self.to).unwrap_or(&[]);
        let (used, event) = feed(session, rest, self.read_us);
        self.from += used;
        self.open = event.is_some();
        event
    }
}

/// A command on its way out, kept here so that an error of the port or a dropped future does not cut it off.
#[derive(Debug)]
pub(super) struct Outbox {
    bytes: CommandBytes,
    sent: usize,
    gap_us: u32,
    then: Then,
}

/// What has to come before the next bytes are written.
#[derive(Debug, Clone, Copy)]
enum Then {
    Write,
    Flush,
    Gap,
}

/// The next thing to do with an [`Outbox`].
pub(super) enum Todo<'a> {
    Write(&'a [u8]),
    Flush,
    Gap { us: u32 },
}

impl Outbox {
    const EMPTY: Self = Self { bytes: CommandBytes::EMPTY, sent: 0, gap_us: 0, then: Then::Write };

    pub(super) fn new(bytes: CommandBytes, gap_us: u32) -> Self {
        Self { bytes, gap_us, ..Self::EMPTY }
    }

    /// `None`: every byte has left the port, so that the rate may be changed.
    pub(super) fn todo(&self) -> Option<Todo<'_>> {
        let rest = self.bytes.as_slice().get(self.sent..).unwrap_or(&[]);
        Some(match (self.then, rest) {
            (Then::Flush, _) => Todo::Flush,
            (_, []) => return None,
            (Then::Gap, _) => Todo::Gap { us: self.gap_us },
            (Then::Write, [first, ..]) if self.gap_us > 0 => Todo::Write(core::slice::from_ref(first)),
            (Then::Write, _) => Todo::Write(rest),
        })
    }

    /// The port has taken so many bytes.
    pub(super) fn written<E>(&mut self, count: usize) -> Result<(), Error<E>> {
        self.sent += count;
        self.then = Then::Flush;
        if count == 0 { Err(Error::Ended) } else { Ok(()) }
    }

    pub(super) fn flushed(&mut self) {
        self.then = if self.gap_us > 0 { Then::Gap } else { Then::Write };
    }

    pub(super) fn gap_over(&mut self) {
        self.then = Then::Write;
    }
}

/// Gives a session bytes, the last of which came at `now_us`: how many it used, and what it told; `None` when it needs more.
pub(crate) fn feed(session: &mut Session, bytes: &[u8], now_us: u64) -> (usize, Option<ScannerEvent>) {
    let (used, event) = session.feed(to_ms(now_us), bytes);
    let event = match event {
        SessionEvent::NeedMore => return (used, None),
        SessionEvent::Start { bytes_ago } => {
            let bytes_behind = bytes.len().saturating_sub(used) as u32 + u32::from(bytes_ago);
            // The line is silent after each telegram.
            let (settings, baud) = (session.settings(), session.baud());
            let length = settings.telegram_bytes();
            let silence_us = settings.period_us().saturating_sub(baud.line_time_us(length));
            let age_us = baud.line_time_us(bytes_behind) + bytes_behind / length * silence_us;
            ScannerEvent::Start { time_us: now_us.saturating_sub(u64::from(age_us)) }
        }
        SessionEvent::Scan => ScannerEvent::Scan,
        SessionEvent::Rejected(error) => ScannerEvent::Rejected(error),
    };
    (used, Some(event))
}

/// The session's clock.
pub(super) fn to_ms(us: u64) -> u32 {
    (us / 1000) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn size() {
        assert!(size_of::<Scanner<(), (), ()>>() <= 1200, "as its documentation says");
    }
}
