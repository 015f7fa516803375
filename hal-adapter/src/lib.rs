//! Scanner and tilt-encoder drivers for the range-image segmentation of `scanseg-core`: `no_std`, no allocation.
//!
//! - [`lms2xx`]: the SICK LMS 2xx line scanner. A telegram decoder and a session that need no port (bytes and
//!   milliseconds in, bytes and waits out), and thin shells around them for embedded-io, blocking and async.
//! - [`encoder`]: tilt encoders behind one trait: AS5048A (SPI), AS5600 (I2C), quadrature counts; and their calibration.
//! - [`pairing`]: which turn angle belongs to a scan line, and to each beam within it.
//!
//! - [`rig`]: scanner, tilt and segmenter together: bytes in, segments out.
//! - [`link`]: the results as frames of bytes, for a serial line to a host.
//!
//! A board with a scanner and an encoder:
//!
//! ```
//! use embedded_hal::delay::DelayNs;
//! use scanseg_hal::Clock;
//! use scanseg_hal::encoder::{Encoder, Tilt};
//! use scanseg_hal::lms2xx::{Error, Scanner, blocking::Port};
//! use scanseg_hal::rig::{Rig, RigSink, RowSegmenter};
//!
//! fn run<P: Port, C: Clock, D: DelayNs, E: Encoder>(
//!     mut scanner: Scanner<P, C, D>,
//!     mut tilt: Tilt<E>,
//!     mut clock: impl Clock,
//!     mut rig: Rig<impl RowSegmenter>,
//!     mut sink: impl RigSink,
//! ) -> Result<(), Error<P::Error>> {
//!     loop {
//!         let event = scanner.next_event()?;
//!         rig.tilt(tilt.read(&mut clock).ok());
//!         rig.handle(event, scanner.scan(), &mut sink);
//!         rig.idle(clock.now_us(), &mut sink);
//!     }
//! }
//! ```
#![no_std]
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic))]

pub mod encoder;
pub mod link;
pub mod lms2xx;
pub mod pairing;
pub mod rig;

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

/// `copy_from_slice`, but of two lengths the shorter counts: the check of the lengths is a panic, left in the code wherever
/// the compiler does not see that they are equal.
pub(crate) fn copy(to: &mut [u8], from: &[u8]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}
