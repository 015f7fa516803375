//! Telegrams of the LMS 2xx in a stream of bytes.
//!
//! ```text
//! 02 | 80 | LEN lo | LEN hi | CODE data ... STATUS | CRC lo | CRC hi      LEN counts CODE to STATUS
//! ```
//! Before an answer the scanner sends one bare byte, ACK or NACK.

use super::crc::check_word;
use super::format::ScanLineFormat;
use super::scan_line::{ScanLine, ScanLineError};
use super::status::ScannerStatus;
use crate::bytes::{copy, move_down};

/// Length of the longest telegram, start byte and check word included: a scan line of 401 values.
pub const MAX_TELEGRAM: usize = 812;

const START: u8 = 0x02;
const SCANNER_ADDRESS: u8 = 0x80;
pub(crate) const ACK: u8 = 0x06;
pub(crate) const NACK: u8 = 0x15;
/// Start byte, address and length.
const HEADER: usize = 4;
const CHECK: usize = 2;

/// What [`TelegramDecoder::feed`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// All bytes are used and no event is complete. Feed more bytes.
    NeedMore,
    /// A byte that may begin a telegram: read the tilt encoder now. The last `Start` before a
    /// telegram is its own; others were false. In an undisturbed stream `bytes_ago` is 0. It is
    /// more when the search went back behind a bad telegram.
    Start {
        /// Bytes between the start byte and the last byte used.
        bytes_ago: u16,
    },
    /// The byte 0x06 outside any telegram. Meaningful only while a command waits for its answer.
    Ack,
    /// The byte 0x15 outside any telegram. Meaningful only while a command waits for its answer.
    Nack,
    /// A valid telegram. [`TelegramDecoder::telegram`] returns it until the next call of `feed`.
    Telegram {
        /// Its code: command + 0x80.
        code: u8,
    },
    /// Bytes that began like a telegram are not a valid one. The search resumes behind their start
    /// byte, so that a valid telegram among them is found.
    Rejected(TelegramError),
}

/// Why bytes that began like a telegram were rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum TelegramError {
    /// The check word differs.
    CheckWord {
        /// Computed over the bytes.
        computed: u16,
        /// Found behind them.
        found: u16,
    },
    /// The check word is right, but the status byte has none of the five severities.
    Status(u8),
    /// The fields of a scan telegram contradict each other or the [`ScanLineFormat`] expected.
    ScanLine(ScanLineError),
    /// The bytes stopped within it, see [`TelegramDecoder::expire`].
    Unfinished {
        /// Bytes that had come.
        got: u16,
    },
}

impl core::fmt::Display for TelegramError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::CheckWord { computed, found } => write!(f, "check word is {found:#06x}, should be {computed:#06x}"),
            Self::Status(status) => write!(f, "status byte {status:#04x} has no such severity"),
            Self::ScanLine(error) => write!(f, "scan telegram: {error}"),
            Self::Unfinished { got } => write!(f, "telegram broke off after {got} bytes"),
        }
    }
}

impl core::error::Error for TelegramError {}

/// Result of [`TelegramDecoder::feed`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Fed {
    /// Number of bytes used. Feed the rest again, even if it is empty, until [`Event::NeedMore`]
    /// comes.
    pub used: usize,
    /// What happened.
    pub event: Event,
}

/// Finds the telegrams of the scanner in bytes, which come in pieces of any size.
///
/// ```
/// use scanseg_hal::lms2xx::{TelegramDecoder, Event};
///
/// let mut decoder = TelegramDecoder::new();
/// let mut bytes: &[u8] = &[0x06, 0x02, 0x80, 0x03, 0x00, 0xA0, 0x00, 0x10, 0x16, 0x0A];
/// loop {
///     let fed = decoder.feed(bytes);
///     bytes = &bytes[fed.used..];
///     match fed.event {
///         Event::NeedMore => break,
///         Event::Telegram { code } => assert_eq!(code, 0xA0),
///         _ => {}
///     }
/// }
/// ```
///
/// The sequence of events, except for `NeedMore`, does not depend on the pieces. The work of one
/// call is bounded: at most one check word over at most [`MAX_TELEGRAM`] bytes.
#[derive(Clone, Debug)]
pub struct TelegramDecoder {
    buffer: [u8; MAX_TELEGRAM],
    /// The bytes held are `buffer[first..end]`. If there are any, the first one is a start byte.
    first: usize,
    end: usize,
    /// The start byte at `first` has been reported.
    announced: bool,
    /// Length of the valid telegram at `first`, until the next `feed`; else 0.
    complete: usize,
    /// Number of bytes held at which the next decision about the start byte at `first` can be made.
    decide_at: usize,
    format: Option<ScanLineFormat>,
}

/// A decision about the start byte at `first`.
enum Verdict {
    /// So many more bytes are needed.
    Need(usize),
    /// No telegram begins here. The bytes did not look enough like one to report it.
    NoTelegram,
    /// What began here is not a valid telegram.
    Bad(TelegramError),
    /// A valid telegram.
    Good { code: u8, length: usize },
}

impl Default for TelegramDecoder {
    fn default() -> Self {
        Self::new()
    }
}

impl TelegramDecoder {
    /// Returns a decoder without bytes. `const`, so that it can be made in a static.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_TELEGRAM], first: 0, end: 0, announced: false, complete: 0, decide_at: 0, format: None }
    }

    /// Sets the format that every scan line must have from now on. Others are rejected. `None`, the
    /// initial state, accepts every scan line whose fields do not contradict each other. The check
    /// word is weak, so set the format as soon as it is known.
    pub const fn expect_scan_lines(&mut self, format: Option<ScanLineFormat>) {
        self.format = format;
    }

    /// Drops all bytes held, for instance after a change of the baud rate.
    pub fn clear(&mut self) {
        self.first = 0;
        self.end = 0;
        self.announced = false;
        self.complete = 0;
        self.decide_at = 0;
    }

    /// Takes bytes up to the next event. Call it again with the rest of the input until
    /// [`Event::NeedMore`]: there can be several telegrams in bytes already used.
    pub fn feed(&mut self, input: &[u8]) -> Fed {
        self.drop_complete();
        let mut used = 0;
        loop {
            let rest = input.get(used..).unwrap_or(&[]);
            if self.first == self.end {
                // between telegrams, bytes are looked at one by one and not kept
                let Some(&byte) = rest.first() else { return Fed { used, event: Event::NeedMore } };
                used += 1;
                match byte {
                    START => {
                        self.hold(&[byte]);
                        self.announced = true;
                        return Fed { used, event: Event::Start { bytes_ago: 0 } };
                    }
                    ACK => return Fed { used, event: Event::Ack },
                    NACK => return Fed { used, event: Event::Nack },
                    _ => continue,
                }
            }
            let held = self.end - self.first;
            let verdict = if held < self.decide_at { Verdict::Need(self.decide_at - held) } else { self.examine() };
            match verdict {
                Verdict::NoTelegram => self.drop_start(),
                _ if !self.announced => {
                    self.announced = true;
                    return Fed { used, event: Event::Start { bytes_ago: (self.held().len() - 1) as u16 } };
                }
                Verdict::Need(count) => {
                    self.decide_at = held + count;
                    let taken = rest.get(..count).unwrap_or(rest);
                    if taken.is_empty() {
                        return Fed { used, event: Event::NeedMore };
                    }
                    self.hold(taken);
                    used += taken.len();
                }
                Verdict::Bad(error) => {
                    self.drop_start();
                    return Fed { used, event: Event::Rejected(error) };
                }
                Verdict::Good { code, length } => {
                    self.complete = length;
                    return Fed { used, event: Event::Telegram { code } };
                }
            }
        }
    }

    /// Returns the telegram that the last `feed` reported.
    #[must_use]
    pub fn telegram(&self) -> Option<Telegram<'_>> {
        if self.complete == 0 {
            return None;
        }
        let payload = self.held().get(HEADER..self.complete - CHECK)?;
        Some(Telegram { payload })
    }

    /// Gives up the unfinished telegram held, if any. Call it after a silence longer than the
    /// pauses within a telegram, a few milliseconds. A valid telegram can be among the bytes held
    /// behind a false start byte: call `feed(&[])` until `NeedMore` after this, and repeat both
    /// until this returns `None`.
    pub fn expire(&mut self) -> Option<TelegramError> {
        self.drop_complete();
        let got = self.held().len() as u16;
        if got == 0 {
            return None;
        }
        self.drop_start();
        Some(TelegramError::Unfinished { got })
    }

    /// Decides about the start byte at `first`. Decisions are made at fixed numbers of bytes held,
    /// so they do not depend on the pieces.
    fn examine(&self) -> Verdict {
        let held = self.held();
        let need = |length: usize| Verdict::Need(length - held.len());
        let Some(&address) = held.get(1) else { return need(2) };
        if address != SCANNER_ADDRESS {
            return Verdict::NoTelegram;
        }
        let (Some(&low), Some(&high)) = (held.get(2), held.get(3)) else { return need(HEADER) };
        let payload_length = usize::from(u16::from_le_bytes([low, high]));
        let length = HEADER + payload_length + CHECK;
        if payload_length < 2 || length > MAX_TELEGRAM {
            return Verdict::NoTelegram;
        }
        let Some(&code) = held.get(HEADER) else { return need(HEADER + 1) };
        if code < 0x80 {
            return Verdict::NoTelegram;
        }
        // the head of a scan telegram is checked at once, without waiting for the end of a false
        // one
        if let Some(head_length) = ScanLine::head_length(code) {
            if payload_length < head_length + 1 {
                return Verdict::Bad(TelegramError::ScanLine(ScanLineError::TooShort {
                    length: payload_length as u16,
                }));
            }
            let Some(head) = held.get(HEADER..HEADER + head_length) else { return need(HEADER + head_length) };
            if let Err(error) = ScanLine::check_head(head, payload_length, self.format.as_ref()) {
                return Verdict::Bad(TelegramError::ScanLine(error));
            }
        }
        let (Some(covered), Some(&[low, high])) = (held.get(..length - CHECK), held.get(length - CHECK..length)) else {
            return need(length);
        };
        let (computed, found) = (check_word(covered), u16::from_le_bytes([low, high]));
        if computed != found {
            return Verdict::Bad(TelegramError::CheckWord { computed, found });
        }
        let status = ScannerStatus(covered.last().copied().unwrap_or(0));
        if status.severity().is_none() {
            return Verdict::Bad(TelegramError::Status(status.0));
        }
        Verdict::Good { code, length }
    }

    /// Returns the bytes held.
    fn held(&self) -> &[u8] {
        self.buffer.get(self.first..self.end).unwrap_or(&[])
    }

    /// Appends bytes. There is room: `examine` never asks for more than a telegram.
    fn hold(&mut self, bytes: &[u8]) {
        if self.end + bytes.len() > MAX_TELEGRAM {
            // bounds that the compiler can see, so that it leaves no panic in the image
            let end = self.end.min(MAX_TELEGRAM);
            let first = self.first.min(end);
            move_down(self.buffer.get_mut(..end).unwrap_or(&mut []), first);
            self.end = end - first;
            self.first = 0;
        }
        if let Some(room) = self.buffer.get_mut(self.end..self.end + bytes.len()) {
            copy(room, bytes);
            self.end += bytes.len();
        }
    }

    /// Drops the telegram that was reported.
    fn drop_complete(&mut self) {
        let length = core::mem::take(&mut self.complete);
        self.first += length;
        if length > 0 {
            self.seek_start();
        }
    }

    /// Drops the start byte at `first` and goes to the next one held.
    fn drop_start(&mut self) {
        self.first += 1;
        self.seek_start();
    }

    /// Drops the bytes before the next start byte.
    fn seek_start(&mut self) {
        self.announced = false;
        self.decide_at = 0;
        match self.held().iter().position(|&byte| byte == START) {
            Some(at) => self.first += at,
            None => self.clear(),
        }
    }
}

/// A valid telegram, borrowed from its [`TelegramDecoder`].
#[derive(Clone, Copy, Debug)]
pub struct Telegram<'a> {
    /// Code to status, at least these two.
    payload: &'a [u8],
}

impl<'a> Telegram<'a> {
    /// Returns the code, which is that of the command + 0x80; see [`command`](super::command).
    #[must_use]
    pub fn code(&self) -> u8 {
        self.payload.first().copied().unwrap_or(0)
    }

    /// Returns the bytes between the code and the status.
    #[must_use]
    pub fn data(&self) -> &'a [u8] {
        self.payload.get(1..self.payload.len() - 1).unwrap_or(&[])
    }

    /// Returns the status of the scanner, the last byte before the check word.
    #[must_use]
    pub fn status(&self) -> ScannerStatus {
        ScannerStatus(self.payload.last().copied().unwrap_or(0))
    }

    /// Returns the scan line in it, if it has one (codes 0xB0 and 0xB7).
    #[must_use]
    pub fn scan_line(&self) -> Option<ScanLine<'a>> {
        ScanLine::new(self.payload)
    }
}
