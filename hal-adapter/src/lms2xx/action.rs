//! What a session asks of its caller and what it reports.

use super::command::CommandBytes;
use super::settings::Baud;
use super::telegram::TelegramError;
use super::trouble::Trouble;

/// The phase of a session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Phase {
    /// It looks for the scanner at all baud rates.
    Finding,
    /// The scanner answers and is being set up.
    SettingUp,
    /// The scanner sends scan lines.
    Running,
}

/// What a session asks of its caller.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum Action {
    /// Set the port to this rate and drop the bytes it has received.
    SetBaud(Baud),
    /// Send these bytes, with a pause of `gap_us` after each byte at [`Baud::B500000`] (elsewhere
    /// it is 0).
    Send {
        /// The bytes.
        bytes: CommandBytes,
        /// Pause after each byte, microseconds.
        gap_us: u32,
    },
    /// Receive for at most this time. Give the bytes to [`Session::feed`](super::Session::feed),
    /// then poll again.
    Wait {
        /// Milliseconds, at least 1.
        ms: u32,
    },
    /// Nothing to do. The session has met this trouble and retries by itself.
    Tell(Trouble),
}

/// What [`Session::feed`](super::Session::feed) found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum SessionEvent {
    /// All bytes are used. Call [`Session::poll`](super::Session::poll).
    NeedMore,
    /// A telegram may be beginning, see [`Event::Start`](super::Event::Start): read the tilt
    /// encoder now. Only while running.
    Start {
        /// Bytes between the start byte and the last byte used.
        bytes_ago: u16,
    },
    /// A scan line that fits the settings. [`Session::scan_line`](super::Session::scan_line)
    /// returns it until the next call of `feed` or `poll`.
    ScanLine,
    /// A damaged telegram, or one that does not fit the settings. Only while running.
    Rejected(TelegramError),
}
