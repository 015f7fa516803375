//! Drivers for a scanner on a tilt, and the path from their bytes to the segments of
//! `scanseg-core`: `no_std`, no allocation.
//!
//! - [`lms2xx`]: the SICK LMS 2xx line scanner. A telegram decoder and a session that need no port,
//!   and a scanner on an embedded-io port, blocking or async.
//! - [`ld06`]: LDROBOT LD06, LD19 and STL-27L. [`rplidar`]: Slamtec RPLIDAR A1, A2, C1 and S2.
//! - [`scanner`]: what all line scanners are to their user: bytes in, rows out.
//! - [`encoder`]: angle encoders behind one trait: AS5048A (SPI), AS5600 (I2C), quadrature; and
//!   their calibration.
//! - [`pairing`]: the turn angle of a scan line, and of each beam within it.
//! - [`rig`]: scanner, tilt and segmenter together: bytes in, segments out.
//! - `link`: the results as frames of bytes, for a serial port to a host.
//!
//! # Features
//! - `link`: the module `link`, and with it postcard, serde, cobs and crc. Not a default.
//! - `defmt`: `defmt::Format` on the public plain types.
//!
//! # Example
//! A board with a scanner and an angle encoder:
//!
//! ```
//! use embedded_hal::delay::DelayNs;
//! use scanseg_core::Segmenter;
//! use scanseg_hal::Clock;
//! use scanseg_hal::encoder::{Encoder, Tilt};
//! use scanseg_hal::lms2xx::{Error, Scanner, blocking::Port};
//! use scanseg_hal::rig::{Rig, RigSink};
//!
//! fn run<P: Port, C: Clock, D: DelayNs, E: Encoder>(
//!     mut scanner: Scanner<P, C, D>,
//!     mut tilt: Tilt<E>,
//!     mut clock: impl Clock,
//!     mut rig: Rig<impl Segmenter>,
//!     mut sink: impl RigSink,
//! ) -> Result<(), Error<P::Error>> {
//!     loop {
//!         let event = scanner.next_event()?;
//!         rig.tilt(tilt.read(&mut clock).ok());
//!         rig.handle(event, scanner.scan_line(), &mut sink);
//!         rig.idle(clock.now_us(), &mut sink);
//!     }
//! }
//! ```
#![no_std]
#![deny(missing_debug_implementations)]
// Arrays of known length are indexed by `[i]`, slices by checked access (`get`, patterns,
// iterators): no panic routine is left in an image. The core keeps the same rule.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic))]

mod bytes;
mod clock;
pub mod encoder;
mod latch;
pub mod ld06;
#[cfg(feature = "link")]
pub mod link;
pub mod lms2xx;
pub mod pairing;
pub mod rig;
pub mod rplidar;
pub mod scanner;

pub use clock::Clock;
pub use latch::Latch;

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
