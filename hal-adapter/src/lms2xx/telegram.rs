//! Telegrams of the LMS 2xx in a stream of bytes.
//!
//! ```text
//! 02 | 80 | LEN lo | LEN hi | CODE data ... STATUS | CRC lo | CRC hi      LEN counts CODE to STATUS
//! ```
//! Before an answer the scanner sends one bare byte, ACK or NACK.

use super::crc::check_word;
use super::scan::{Scan, ScanError, ScanFormat};
use super::status::Status;
use crate::copy;

/// Longest telegram, start byte and check word included: a scan of 401 values.
pub const MAX_TELEGRAM: usize = 812;

const START: u8 = 0x02;
const SCANNER_ADDRESS: u8 = 0x80;
pub(crate) const ACK: u8 = 0x06;
pub(crate) const NACK: u8 = 0x15;
/// Start byte, address and length.
const HEADER: usize = 4;
const CHECK: usize = 2;

/// What a call of [`Decoder::feed`] met.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// All bytes are used and nothing is complete. Feed more bytes.
    NeedMore,
    /// A byte that may begin a telegram: the moment to read the tilt encoder. It lies `bytes_ago` bytes before the last
    /// byte used: 0 in an undisturbed stream, more when the search had to go back behind a bad telegram. Whether it was a
    /// telegram shows later; each telegram is preceded by its own `Start`, and the last one before it is the true one.
    Start {
        /// Bytes between the start byte and the last byte used.
        bytes_ago: u16,
    },
    /// The byte 0x06 outside any telegram. Means something only while a command waits for its answer.
    Ack,
    /// The byte 0x15 outside any telegram. Means something only while a command waits for its answer.
    Nack,
    /// A good telegram: [`Decoder::telegram`] gives it until the next `feed`.
    Telegram {
        /// Its code: command + 0x80.
        code: u8,
    },
    /// What began like a telegram is none. The search has resumed right behind its start byte, so a good telegram within
    /// its bytes is found all the same.
    Rejected(TelegramError),
}

/// Why bytes that began like a telegram were rejected.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TelegramError {
    /// The check word differs.
    CheckWord {
        /// Computed over the bytes.
        computed: u16,
        /// Found behind them.
        found: u16,
    },
    /// The check word is right but the severity in the status byte is none of SICK's five.
    Status(u8),
    /// A scan telegram whose inner fields contradict each other, or the [`ScanFormat`] that was asked for.
    Scan(ScanError),
    /// The line fell silent within it, see [`Decoder::expire`].
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
            Self::Scan(error) => write!(f, "scan telegram: {error}"),
            Self::Unfinished { got } => write!(f, "telegram broke off after {got} bytes"),
        }
    }
}

impl core::error::Error for TelegramError {}

/// Answer of [`Decoder::feed`]: what happened, and how much of the input was used for it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub struct Fed {
    /// Bytes used; feed the rest again, even if it is empty, until [`Event::NeedMore`] comes.
    pub used: usize,
    /// What happened.
    pub event: Event,
}

/// Finds the scanner's telegrams in a stream of bytes that comes in pieces of any size.
///
/// ```
/// use scanseg_hal::lms2xx::{Decoder, Event};
///
/// let mut decoder = Decoder::new();
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
/// The sequence of events does not depend on the pieces, apart from `NeedMore`. One call does bounded work: at most one
/// check word over at most [`MAX_TELEGRAM`] bytes.
#[derive(Debug, Clone)]
pub struct Decoder {
    buffer: [u8; MAX_TELEGRAM],
    /// The bytes held are `buffer[first..end]`. If there are any, the first is a start byte.
    first: usize,
    end: usize,
    /// The start byte at `first` has been reported.
    announced: bool,
    /// Length of the good telegram at `first`, until the next `feed`.
    complete: usize,
    /// Bytes held at which there is something to decide about the start byte at `first`: nothing with fewer.
    decide_at: usize,
    format: Option<ScanFormat>,
}

/// What the bytes held say.
enum Verdict {
    /// So many more are needed for the next decision.
    Need(usize),
    /// No telegram begins at this start byte, and it never looked much like one.
    NoTelegram,
    Bad(TelegramError),
    Good {
        code: u8,
        length: usize,
    },
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// A decoder that has seen nothing. `const`, so that it can be made in place in a static.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_TELEGRAM], first: 0, end: 0, announced: false, complete: 0, decide_at: 0, format: None }
    }

    /// What every scan telegram must be from now on; others are rejected. `None` (as at first) takes any scan whose fields
    /// agree among themselves. The check word is weak, so set this as soon as it is known.
    pub const fn expect_scans(&mut self, format: Option<ScanFormat>) {
        self.format = format;
    }

    /// Forgets all bytes held, for instance after a change of the baud rate.
    pub fn clear(&mut self) {
        self.first = 0;
        self.end = 0;
        self.announced = false;
        self.complete = 0;
        self.decide_at = 0;
    }

    /// Takes bytes up to the next event. Call again with the rest of the input until [`Event::NeedMore`]: several telegrams
    /// can come out of bytes already used.
    pub fn feed(&mut self, input: &[u8]) -> Fed {
        self.drop_complete();
        let mut used = 0;
        loop {
            let rest = input.get(used..).unwrap_or(&[]);
            if self.first == self.end {
                // Between telegrams: bytes are looked at one by one and not kept.
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

    /// The telegram that the last `feed` reported.
    #[must_use]
    pub fn telegram(&self) -> Option<Telegram<'_>> {
        if self.complete == 0 {
            return None;
        }
        let payload = self.held().get(HEADER..self.complete - CHECK)?;
        Some(Telegram { payload })
    }

    /// Says that the line has been silent for longer than a telegram can pause (a few milliseconds): the telegram now held,
    /// if any, will not be finished. A false start byte may have swallowed a good telegram that came after it: call
    /// `feed(&[])` after this until `NeedMore`, and again `expire` until it returns `None`.
    pub fn expire(&mut self) -> Option<TelegramError> {
        self.drop_complete();
        let got = self.held().len() as u16;
        if got == 0 {
            return None;
        }
        self.drop_start();
        Some(TelegramError::Unfinished { got })
    }

    /// Decides about the start byte at `first`. Decisions fall at fixed numbers of bytes held, whatever pieces they came in.
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
        // A scan tells early whether its length and its count agree: no need to wait for the end of a false one.
        if let Some(head_length) = Scan::head_length(code) {
            if payload_length < head_length + 1 {
                return Verdict::Bad(TelegramError::Scan(ScanError::TooShort { length: payload_length as u16 }));
            }
            let Some(head) = held.get(HEADER..HEADER + head_length) else { return need(HEADER + head_length) };
            if let Err(error) = Scan::check_head(head, payload_length, self.format.as_ref()) {
                return Verdict::Bad(TelegramError::Scan(error));
            }
        }
        let (Some(covered), Some(&[low, high])) = (held.get(..length - CHECK), held.get(length - CHECK..length)) else {
            return need(length);
        };
        let (computed, found) = (check_word(covered), u16::from_le_bytes([low, high]));
        if computed != found {
            return Verdict::Bad(TelegramError::CheckWord { computed, found });
        }
        let status = Status(covered.last().copied().unwrap_or(0));
        if status.severity().is_none() {
            return Verdict::Bad(TelegramError::Status(status.0));
        }
        Verdict::Good { code, length }
    }

    fn held(&self) -> &[u8] {
        self.buffer.get(self.first..self.end).unwrap_or(&[])
    }

    /// Appends bytes. There is room: `examine` never asks for more than a telegram.
    fn hold(&mut self, bytes: &[u8]) {
        if self.end + bytes.len() > MAX_TELEGRAM {
            // Bounds that the compiler can see, so that no panic is left in the code.
            let end = self.end.min(MAX_TELEGRAM);
            let first = self.first.min(end);
            self.buffer.copy_within(first..end, 0);
            self.end = end - first;
            self.first = 0;
        }
        if let Some(room) = self.buffer.get_mut(self.end..self.end + bytes.len()) {
            copy(room, bytes);
            self.end += bytes.len();
        }
    }

    fn drop_complete(&mut self) {
        let length = core::mem::take(&mut self.complete);
        self.first += length;
        if length > 0 {
            self.seek_start();
        }
    }

    /// Gives up the start byte at `first` and goes to the next one held.
    fn drop_start(&mut self) {
        self.first += 1;
        self.seek_start();
    }

    fn seek_start(&mut self) {
        self.announced = false;
        self.decide_at = 0;
        match self.held().iter().position(|&byte| byte == START) {
            Some(at) => self.first += at,
            None => self.clear(),
        }
    }
}

/// A good telegram, borrowed from its [`Decoder`].
#[derive(Debug, Clone, Copy)]
pub struct Telegram<'a> {
    /// CODE to STATUS, at least those two.
    payload: &'a [u8],
}

impl<'a> Telegram<'a> {
    /// Command + 0x80; [`super::command`] names them.
    #[must_use]
    pub fn code(&self) -> u8 {
        self.payload.first().copied().unwrap_or(0)
    }

    /// What stands between the code and the status byte.
    #[must_use]
    pub fn data(&self) -> &'a [u8] {
        self.payload.get(1..self.payload.len() - 1).unwrap_or(&[])
    }

    /// The scanner's state, last byte before the check word.
    #[must_use]
    pub fn status(&self) -> Status {
        Status(self.payload.last().copied().unwrap_or(0))
    }

    /// The scan in it, if it is one (codes 0xB0 and 0xB7).
    #[must_use]
    pub fn scan(&self) -> Option<Scan<'a>> {
        Scan::new(self.payload)
    }
}
