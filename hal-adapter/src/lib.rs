//! Scanner and tilt-encoder drivers for the range-image segmentation of `scanseg-core`: `no_std`, no allocation.
//!
//! - [`lms2xx`]: the SICK LMS 2xx line scanner. A telegram decoder and a session that need no port (bytes and
//!   milliseconds in, bytes and waits out), and thin shells around them for embedded-io, blocking and async.
//! - [`encoder`]: tilt encoders behind one trait: AS5048A (SPI), AS5600 (I2C), quadrature counts; and their calibration.
//! - [`pairing`]: which turn angle belongs to a scan line, and to each beam within it.
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
