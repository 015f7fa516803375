//! SICK LMS 2xx line scanners (LMS200, LMS211, LMS220, LMS221, LMS291) on their serial line.
//!
//! - [`TelegramDecoder`] finds telegrams in bytes. [`ScanLine`] reads the ranges in one.
//! - [`command::Command`] makes the bytes of commands and reads the answers.
//! - [`Session`] finds the scanner at any of its baud rates, sets it up, starts it and keeps it
//!   running. It takes times and bytes, and returns what to send and how long to wait. It needs no
//!   port.
//! - [`Rows`] makes the rows of a [`LineScanner`](crate::scanner::LineScanner) of a session.
//! - [`Scanner`] runs a session on a port, [`blocking`] or async ([`asynch`]).
//!
//! Sources: SICK's list of telegrams, as far as the drivers of Player, the SICK LIDAR Matlab/C++
//! Toolbox, Gearbox, RACK, Carmen, Orocos and MRPT agree on it, and the telegrams quoted in them,
//! which are tests. The LMS 2xx-S14, whose 90 degrees are fixed, is not supported: it refuses to be
//! set up ([`Trouble::Refused`]).
//!
//! At 500 000 Bd a byte comes every 20 us. Receive by interrupt or DMA into a ring buffer that holds
//! what comes while the program does something else, such as segmenting a row:
//! [`rig`](crate::rig#how-long-a-call-takes-and-the-buffer-of-the-port) has the sizes.

mod action;
pub mod asynch;
pub mod blocking;
pub mod command;
pub mod crc;
mod format;
mod rows;
mod scan_line;
mod session;
mod settings;
mod shell;
mod status;
mod step;
mod telegram;
mod trouble;

pub use action::{Action, Phase, SessionEvent};
pub use format::{MeasuringMode, ScanLineFormat, Unit, Variant};
pub use rows::Rows;
pub use scan_line::{Beam, MEANS, Reading, SCAN_LINE, SUB_RANGE, ScanLine, ScanLineError};
pub use session::Session;
pub use settings::{Baud, Settings};
pub(crate) use shell::feed;
pub use shell::{Error, Scanner, ScannerEvent};
pub use status::{ScannerStatus, Severity};
pub use telegram::{Event, Fed, MAX_TELEGRAM, Telegram, TelegramDecoder, TelegramError};
pub use trouble::Trouble;
