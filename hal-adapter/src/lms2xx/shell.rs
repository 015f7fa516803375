//! What the blocking and the async scanner share.

use super::session::{Session, SessionEvent};
use super::telegram::TelegramError;
use super::trouble::Trouble;

/// What a scanner on its port has to tell.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum ScannerEvent {
    /// A scan may be beginning: read the tilt encoder now. Of several in a row the last one belongs to the scan.
    Start {
        /// When the start byte came, by the clock given: the time of the call less that of the bytes behind it, and of the
        /// silence between telegrams among them. It is as late as the port was in handing its bytes over.
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
    /// The port has ended: a read gave no bytes.
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
    /// The session may have more to say about bytes already used.
    open: bool,
}

impl Inbox {
    pub(super) const fn new() -> Self {
        Self { bytes: [0; 64], from: 0, to: 0, open: false }
    }

    /// Room for one read.
    pub(super) fn room(&mut self) -> &mut [u8] {
        &mut self.bytes
    }

    /// So many bytes have been read into `room`. 0 means that the port has ended.
    pub(super) fn filled<E>(&mut self, count: usize) -> Result<(), Error<E>> {
        self.from = 0;
        self.to = count;
        self.open = true;
        if count == 0 { Err(Error::Ended) } else { Ok(()) }
    }

    /// Feeds the session; `None` when it needs more.
    pub(super) fn next(&mut self, session: &mut Session, now_us: u64) -> Option<ScannerEvent> {
        if !self.open {
            return None;
        }
        let rest = self.bytes.get(self.from..self.to).unwrap_or(&[]);
        let (used, event) = feed(session, rest, now_us);
        self.from += used;
        self.open = event.is_some();
        event
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
