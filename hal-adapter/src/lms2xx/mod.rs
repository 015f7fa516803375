//! SICK LMS 2xx line scanners (LMS200, LMS211, LMS220, LMS221, LMS291) on their serial line.
//!
//! - [`Decoder`] finds telegrams in bytes, [`Scan`] reads the ranges in one.
//! - [`command::Command`] makes the bytes of commands and judges the answers.
//! - [`Session`] finds the scanner at whatever rate it talks, sets it up, starts it and keeps it running. It takes the
//!   time and bytes, and says what to send and how long to wait; it needs no port.
//! - [`Scanner`] runs a session on a port, [`blocking`] or async ([`asynch`]).
//!
//! What is known of these scanners here is what SICK's list of telegrams says as far as the drivers of Player, the SICK
//! LIDAR Matlab/C++ Toolbox, Gearbox, RACK, Carmen, Orocos and MRPT agree on it, and telegrams quoted in them, which are
//! tests. The LMS 2xx-S14, with 90 degrees fixed, is not supported: it refuses to be set up ([`Trouble::Refused`]).
//!
//! A UART loses bytes that nobody fetches: at 500 000 Bd one comes every 20 us, so receive by interrupt or DMA into a
//! buffer of at least 64 bytes.

pub mod asynch;
pub mod blocking;
pub mod command;
pub mod crc;
mod scan;
mod session;
mod settings;
mod shell;
mod status;
mod telegram;
mod trouble;

pub use scan::{Beam, Reading, SCAN, SUB_RANGE, Scan, ScanError, ScanFormat};
pub use session::{Action, Phase, Session, SessionEvent};
pub use settings::{Baud, MeasuringMode, Settings, Unit, Variant};
pub(crate) use shell::feed;
pub use shell::{Error, Scanner, ScannerEvent};
pub use status::{Severity, Status};
pub use telegram::{Decoder, Event, Fed, MAX_TELEGRAM, Telegram, TelegramError};
pub use trouble::Trouble;
