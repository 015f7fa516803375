//! Scanner and tilt-encoder drivers for the range-image segmentation of `scanseg-core`: `no_std`, no allocation.
//!
//! - [`lms2xx`]: the SICK LMS 2xx line scanner. A telegram decoder and a session that need no port (bytes and
//!   milliseconds in, bytes and waits out), and thin shells around them for embedded-io, blocking and async.
//! - [`encoder`]: tilt encoders behind one trait: AS5048A (SPI), AS5600 (I2C), quadrature counts; and their calibration.
//! - [`pairing`]: which turn angle belongs to a scan line, and to each beam within it.
//!
//! Scanner, encoder and pairing together:
//!
//! ```
//! use embedded_hal::delay::DelayNs;
//! use scanseg_hal::encoder::{Encoder, Tilt};
//! use scanseg_hal::lms2xx::{Error, ScannerEvent, Settings, blocking::{Port, Scanner}};
//! use scanseg_hal::{Clock, pairing::{Pairing, Sweep}};
//!
//! /// Hands over the beams of each row: column, range in millimetres, turn angle in radians.
//! fn run<P: Port, C: Clock, D: DelayNs, E: Encoder>(
//!     mut scanner: Scanner<P, C, D>,
//!     settings: Settings,
//!     mut tilt: Tilt<E>,
//!     mut clock: impl Clock,
//!     mut beam: impl FnMut(u16, Option<u32>, f32),
//! ) -> Result<(), Error<P::Error>> {
//!     let mut pairing = Pairing::new();
//!     loop {
//!         match scanner.next_event()? {
//!             ScannerEvent::Start { time_us } => pairing.start(time_us, tilt.read(&mut clock).ok()),
//!             ScannerEvent::Scan => {
//!                 let Some(scan) = scanner.scan() else { continue };
//!                 let Some(turns) = pairing.row(Sweep::of(&scan, settings.variant)) else { continue };
//!                 for (column, measured) in (0..).zip(scan.beams(settings.mode)) {
//!                     beam(column, measured.range_mm(scan.unit()), turns.beam_turn_rad(column));
//!                 }
//!             }
//!             // Dealt with; a display may want to know.
//!             ScannerEvent::Rejected(_) | ScannerEvent::Trouble(_) => {}
//!         }
//!     }
//! }
//! ```
#![no_std]
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod encoder;
pub mod lms2xx;
pub mod pairing;

/// A clock that the shells read.
pub trait Clock {
    /// Microseconds since any moment, never falling.
    fn now_us(&mut self) -> u64;
}

impl<F: FnMut() -> u64> Clock for F {
    fn now_us(&mut self) -> u64 {
        self()
    }
}
