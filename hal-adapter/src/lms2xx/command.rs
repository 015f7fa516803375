//! Commands to the LMS 2xx and the answers to them. A [`Session`](super::Session) sends the
//! commands that set the scanner up and start it. Use this module for other commands, or for a
//! driver of your own:
//!
//! ```
//! use scanseg_hal::lms2xx::command::{Answer, Command};
//! use scanseg_hal::lms2xx::{TelegramDecoder, Event};
//!
//! assert_eq!(Command::Type.encode().as_slice(), [0x02, 0x00, 0x01, 0x00, 0x3A, 0x1E, 0x12]); // to be sent
//! let mut received: &[u8] = b"\x06\x02\x80\x17\x00\xBALMS200;301063;V02.10 \x10\x22\x61";
//! let mut decoder = TelegramDecoder::new();
//! loop {
//!     let fed = decoder.feed(received);
//!     received = &received[fed.used..];
//!     match fed.event {
//!         Event::Telegram { .. } => break,
//!         Event::NeedMore => panic!("no answer"),
//!         _ => {}
//!     }
//! }
//! let telegram = decoder.telegram().unwrap();
//! assert_eq!(Command::Type.answer(&telegram), Some(Answer::Done));
//! assert_eq!(telegram.data(), b"LMS200;301063;V02.10 ");
//! ```

use super::crc::check_word;
use super::format::{MeasuringMode, Unit, Variant};
use super::settings::Baud;
use super::telegram::Telegram;
use crate::bytes::copy;

/// Answer to a change of the operating mode or the baud rate.
pub const MODE_ANSWER: u8 = 0xA0;
/// Sent by the scanner when it has been switched on.
pub const POWER_ON: u8 = 0x90;
/// Sent by the scanner when it has reset itself on command.
pub const RESET_ANSWER: u8 = 0x91;
/// Answer to a command that the scanner does not know.
pub const INCORRECT_COMMAND: u8 = 0x92;

/// The longest configuration block that is kept, bytes. Scanners have 32 or 34.
const MAX_CONFIGURATION: usize = 48;
/// Longest command: header, code, configuration, check word.
const MAX_COMMAND: usize = 4 + 1 + MAX_CONFIGURATION + 2;

/// A command to the scanner.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Command {
    /// Restart; answered by [`RESET_ANSWER`] and, some 10 s later, [`POWER_ON`].
    Reset,
    /// Into installation mode, with the factory password: the only mode in which the configuration
    /// can be written.
    Install,
    /// Send complete scan lines from now on.
    Start,
    /// Send a partial scan line after every mirror turn from now on.
    StartInterlaced,
    /// Send these columns only of complete scan lines from now on. They come in 0xB7 telegrams.
    StartSubRange {
        /// First column, 1-based.
        first: u16,
        /// Last column, 1-based, not below `first`, at most [`Variant::columns`].
        last: u16,
    },
    /// Stop sending scan lines. Also leaves the installation mode.
    Stop,
    /// Change the baud rate until the next power-on. The answer still comes at the old rate.
    SetBaud(Baud),
    /// Send one scan line.
    Poll,
    /// Send the state.
    Status,
    /// Send the list of errors.
    Errors,
    /// Send type and version.
    Type,
    /// Set field of view and step.
    SetVariant(Variant),
    /// Send the configuration.
    ReadConfiguration,
    /// Write the configuration into the EEPROM. Possible in installation mode only. The EEPROM
    /// wears out, so write only what differs.
    WriteConfiguration(Configuration),
}

/// The bytes of a command.
#[derive(Clone, Copy, Debug)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct CommandBytes {
    bytes: [u8; MAX_COMMAND],
    length: usize,
}

impl CommandBytes {
    pub(crate) const EMPTY: Self = Self { bytes: [0; MAX_COMMAND], length: 0 };

    /// Returns the bytes, start byte to check word.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }

    fn push(&mut self, bytes: &[u8]) {
        if let Some(room) = self.bytes.get_mut(self.length..self.length + bytes.len()) {
            copy(room, bytes);
            self.length += bytes.len();
        }
    }
}

impl Command {
    /// Returns the code byte of the command.
    #[must_use]
    pub const fn code(&self) -> u8 {
        match self {
            Self::Reset => 0x10,
            Self::Install
            | Self::Start
            | Self::StartInterlaced
            | Self::StartSubRange { .. }
            | Self::Stop
            | Self::SetBaud(_) => 0x20,
            Self::Poll => 0x30,
            Self::Status => 0x31,
            Self::Errors => 0x32,
            Self::Type => 0x3A,
            Self::SetVariant(_) => 0x3B,
            Self::ReadConfiguration => 0x74,
            Self::WriteConfiguration(_) => 0x77,
        }
    }

    /// Returns the code of the telegram that answers it.
    #[must_use]
    pub const fn answer_code(&self) -> u8 {
        match self {
            Self::Reset => RESET_ANSWER,
            _ => self.code() + 0x80,
        }
    }

    /// Returns the bytes to send.
    #[must_use]
    pub fn encode(&self) -> CommandBytes {
        let mut out = CommandBytes::EMPTY;
        out.push(&[0x02, 0x00, 0, 0, self.code()]);
        match self {
            Self::Install => out.push(b"\x00SICK_LMS"),
            Self::Start => out.push(&[0x24]),
            Self::StartInterlaced => out.push(&[0x2A]),
            Self::StartSubRange { first, last } => {
                let ([first_low, first_high], [last_low, last_high]) = (first.to_le_bytes(), last.to_le_bytes());
                out.push(&[0x27, first_low, first_high, last_low, last_high]);
            }
            Self::Stop => out.push(&[0x25]),
            Self::SetBaud(baud) => out.push(&[match baud {
                Baud::B38400 => 0x40,
                Baud::B19200 => 0x41,
                Baud::B9600 => 0x42,
                Baud::B500000 => 0x48,
            }]),
            Self::Poll => out.push(&[0x01]),
            Self::SetVariant(variant) => out.push(&variant_bytes(*variant)),
            Self::WriteConfiguration(configuration) => out.push(configuration.as_slice()),
            Self::Reset | Self::Status | Self::Errors | Self::Type | Self::ReadConfiguration => {}
        }
        let [low, high] = ((out.length - 4) as u16).to_le_bytes();
        let [_, _, length_low, length_high, ..] = &mut out.bytes;
        (*length_low, *length_high) = (low, high);
        out.push(&check_word(out.as_slice()).to_le_bytes());
        out
    }

    /// Reads the telegram received. `None` if it does not answer this command.
    #[must_use]
    pub fn answer(&self, telegram: &Telegram<'_>) -> Option<Answer> {
        if telegram.code() == INCORRECT_COMMAND {
            return Some(Answer::Refused(INCORRECT_COMMAND));
        }
        if telegram.code() != self.answer_code() {
            return None;
        }
        // the first byte of a success is 0 after mode changes and 1 after settings
        let good = match self.code() {
            0x20 => Some(0),
            0x3B | 0x77 => Some(1),
            _ => None,
        };
        let data = telegram.data();
        Some(match (good, data) {
            (None, _) => Answer::Done,
            (Some(good), [first, ..]) if *first != good => Answer::Refused(*first),
            (Some(_), []) => Answer::Refused(0xFF),
            (Some(_), [_, rest @ ..]) => match self {
                Self::SetVariant(variant) if rest != variant_bytes(*variant) => Answer::Refused(1),
                _ => Answer::Done,
            },
        })
    }
}

fn variant_bytes(variant: Variant) -> [u8; 4] {
    [variant.view_deg() as u8, 0, variant.step_cdeg() as u8, 0]
}

/// The answer of the scanner to a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Answer {
    /// The command was carried out.
    Done,
    /// The command was refused. The byte is the scanner's own reason (mode changes: 1 wrong
    /// password or not possible, 2 fault), [`INCORRECT_COMMAND`], or 0xFF if it gave none.
    Refused(u8),
}

/// The configuration block of the scanner. Only measuring mode and unit are changed here, the other
/// bytes are kept.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Configuration {
    bytes: [u8; MAX_CONFIGURATION],
    length: usize,
}

impl Configuration {
    const MODE: usize = 5;
    const UNIT: usize = 6;

    /// Returns the configuration in an answer to [`Command::ReadConfiguration`], data without code
    /// and status. `None` if it is too short for unit and mode, or longer than that of any known
    /// scanner.
    #[must_use]
    pub fn new(data: &[u8]) -> Option<Self> {
        let mut bytes = [0; MAX_CONFIGURATION];
        copy(bytes.get_mut(..data.len())?, data);
        (data.len() > Self::UNIT).then_some(Self { bytes, length: data.len() })
    }

    /// Returns the block.
    #[must_use]
    pub fn as_slice(&self) -> &[u8] {
        self.bytes.get(..self.length).unwrap_or(&[])
    }

    /// Returns the block with this measuring mode and unit.
    #[must_use]
    pub fn with(mut self, mode: MeasuringMode, unit: Unit) -> Self {
        for (at, code) in [(Self::MODE, mode.code()), (Self::UNIT, unit.code())] {
            if let Some(byte) = self.bytes.get_mut(at) {
                *byte = code;
            }
        }
        self
    }
}
