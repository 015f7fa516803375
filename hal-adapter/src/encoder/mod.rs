//! Tilt encoders: where the scanner's axis stands, and when.
//!
//! Each sensor has a frame layer of plain functions that needs no bus, and a driver that implements [`Encoder`].
//! [`Tilt`] makes turn angles of an encoder's positions.

pub mod as5048a;
pub mod as5600;
mod calibration;
pub mod quadrature;

pub use calibration::{Calibration, CalibrationError, Direction, Tilt};

/// What an encoder says.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Position {
    /// Shaft position in 2^-32 turns: adding and subtracting wrap as the shaft does.
    pub turn: u32,
    /// When it was so, by the clock given.
    pub time_us: u64,
}

/// An encoder on a shaft.
pub trait Encoder {
    /// What can go wrong.
    type Error;

    /// Reads where the shaft is, and takes the time when the sensor sampled it.
    ///
    /// # Errors
    /// The driver's own: bus, check of the answer, magnet.
    fn read(&mut self, clock: &mut impl crate::Clock) -> Result<Position, Self::Error>;
}
