//! The position of a shaft and the trait of the drivers that read it.

use crate::clock::Clock;

/// A position of a shaft.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Position {
    /// Position in 2^-32 turns: additions and subtractions that wrap are right across the zero.
    pub turn: u32,
    /// Time of the measurement, microseconds of the clock given.
    pub time_us: u64,
}

/// An angle encoder on a shaft.
pub trait Encoder {
    /// The error of the driver.
    type Error;

    /// Reads the position of the shaft, with the time at which the sensor measured it.
    ///
    /// # Errors
    /// The driver's own: the bus, the check of the answer, the magnet.
    fn read(&mut self, clock: &mut impl Clock) -> Result<Position, Self::Error>;
}
