//! A scanner on its port: the part that blocking and async ports share.

use super::action::{Phase, SessionEvent};
use super::command::CommandBytes;
use super::scan_line::ScanLine;
use super::session::Session;
use super::settings::Settings;
use super::telegram::TelegramError;
use super::trouble::Trouble;

/// An LMS 2xx on a port, with a [`Clock`](crate::Clock) and a delay: [`Scanner::next_event`] for a
/// [blocking port](super::blocking::Port), [`Scanner::next_event_async`] for an [async
/// one](super::asynch::Port).
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
    /// Returns a scanner on this port. The port is not used yet: the first calls for an event look
    /// for the scanner. At most 1200 bytes besides port, clock and delay. `const`, so that it can
    /// be made in a static.
    pub const fn new(port: P, clock: C, delay: D, settings: Settings) -> Self {
        Self { session: Session::new(settings), inbox: Inbox::new(), outbox: Outbox::EMPTY, port, clock, delay }
    }

    /// Returns a scanner to which nothing is sent, see [`Session::listening`].
    pub const fn listening(port: P, clock: C, delay: D, settings: Settings) -> Self {
        Self { session: Session::listening(settings), inbox: Inbox::new(), outbox: Outbox::EMPTY, port, clock, delay }
    }

    /// Returns the scan line that came with the last event, if that was [`ScannerEvent::ScanLine`].
    #[must_use]
    pub fn scan_line(&self) -> Option<ScanLine<'_>> {
        self.session.scan_line()
    }

    /// Returns the phase of the session.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.session.phase()
    }

    /// Returns port, clock and delay. Nothing is sent to the scanner.
    pub fn release(self) -> (P, C, D) {
        (self.port, self.clock, self.delay)
    }
}

/// An event of a scanner on its port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScannerEvent {
    /// A telegram may be beginning: read the tilt encoder now. Of several in a row the last one is
    /// right.
    Start {
        /// Time of the start byte, microseconds of the clock given. It is the time when the last
        /// byte was read, less the time that the bytes behind the start byte and the pauses among
        /// them took. A delay of the port is contained in it.
        time_us: u64,
    },
    /// A scan line. `scan_line()` returns it until the next call.
    ScanLine,
    /// A damaged telegram, or one that does not fit the settings.
    Rejected(TelegramError),
    /// A trouble with the scanner. The session retries by itself; go on.
    Trouble(Trouble),
}

/// An error of the port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
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

/// Bytes that were read and are not yet used.
#[derive(Debug)]
pub(super) struct Inbox {
    bytes: [u8; 64],
    from: usize,
    to: usize,
    /// Time when they were read, microseconds.
    read_us: u64,
    /// The session may have more events for bytes already used.
    open: bool,
}

impl Inbox {
    const fn new() -> Self {
        Self { bytes: [0; 64], from: 0, to: 0, read_us: 0, open: false }
    }

    /// Returns memory for one read.
    pub(super) fn room(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// Takes note that so many bytes were read into `room` at this time. 0 means that the port has
    /// ended.
    pub(super) fn filled<E>(&mut self, count: usize, now_us: u64) -> Result<(), Error<E>> {
        (self.from, self.to, self.read_us, self.open) = (0, count, now_us, true);
        if count == 0 { Err(Error::Ended) } else { Ok(()) }
    }

    /// Returns the next event; `None` when more bytes are needed.
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

/// A command that is being sent. It is kept here so that sending can go on after an error of the
/// port or a dropped future.
#[derive(Debug)]
pub(super) struct Outbox {
    bytes: CommandBytes,
    sent: usize,
    gap_us: u32,
    then: Then,
}

/// What comes next.
#[derive(Clone, Copy, Debug)]
enum Then {
    Write,
    Flush,
    Gap,
}

/// What to do with an [`Outbox`].
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

    /// Returns what to do; `None` when all bytes have left the port.
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

    /// Takes note that the port has accepted so many bytes.
    pub(super) fn written<E>(&mut self, count: usize) -> Result<(), Error<E>> {
        self.sent += count;
        self.then = Then::Flush;
        if count == 0 { Err(Error::Ended) } else { Ok(()) }
    }

    /// Takes note that the port has sent its bytes.
    pub(super) fn flushed(&mut self) {
        self.then = if self.gap_us > 0 { Then::Gap } else { Then::Write };
    }

    /// Takes note that the pause is over.
    pub(super) fn gap_over(&mut self) {
        self.then = Then::Write;
    }
}

/// Gives bytes to a session. The last of them came at `now_us`. Returns the number of bytes used
/// and the event; `None` when more bytes are needed.
pub(crate) fn feed(session: &mut Session, bytes: &[u8], now_us: u64) -> (usize, Option<ScannerEvent>) {
    let (used, event) = session.feed(to_ms(now_us), bytes);
    let event = match event {
        SessionEvent::NeedMore => return (used, None),
        SessionEvent::Start { bytes_ago } => {
            let bytes_behind = bytes.len().saturating_sub(used) as u32 + u32::from(bytes_ago);
            // there is a pause after each telegram
            let (settings, baud) = (session.settings(), session.baud());
            let length = settings.telegram_bytes();
            let silence_us = settings.period_us().saturating_sub(baud.line_time_us(length));
            let age_us = baud.line_time_us(bytes_behind) + bytes_behind / length * silence_us;
            ScannerEvent::Start { time_us: now_us.saturating_sub(u64::from(age_us)) }
        }
        SessionEvent::ScanLine => ScannerEvent::ScanLine,
        SessionEvent::Rejected(error) => ScannerEvent::Rejected(error),
    };
    (used, Some(event))
}

/// Returns the time for the session, which counts milliseconds.
pub(super) fn to_ms(us: u64) -> u32 {
    // 16 binary digits after the other: a division of 64 bits takes a microcontroller 0.9 KB of flash
    let (mut ms, mut rest) = (0u32, 0);
    for shift in [48, 32, 16, 0] {
        let part = (rest << 16) | (us >> shift) as u32 & 0xFFFF;
        (ms, rest) = ((ms << 16) | (part / 1000), part % 1000);
    }
    ms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn milliseconds() {
        for us in [0, 999, 1000, 65_535_999, 65_536_000, 4_294_967_295, 4_294_967_296, 4_294_967_295_999, u64::MAX] {
            for us in [us, us / 7 * 5, us.rotate_left(20)] {
                assert_eq!(to_ms(us), (us / 1000) as u32, "{us}");
            }
        }
    }

    #[test]
    fn size() {
        assert!(size_of::<Scanner<(), (), ()>>() <= 1200, "as documented");
    }
}
