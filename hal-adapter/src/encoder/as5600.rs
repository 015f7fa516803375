//! AS5600: magnetic encoder, 12 bits a turn, on I2C (address 0x36, up to 1 MHz).
//!
//! The driver reads the raw angle; zero and sense of rotation are set in [`super::Calibration`].
//! The answers have no checksum or parity. The sensor's filter delays the angle by up to 2.2 ms in
//! its factory setting and by 0.29 ms with SF = 2x, so set SF = 2x for a tilt that moves. Source:
//! ams' data sheet of the AS5600.

use embedded_hal::i2c::I2c;

use super::position::{Encoder, Position};
use crate::clock::Clock;

/// The I2C address, which is fixed.
pub const ADDRESS: u8 = 0x36;
/// Register of [`MagnetStatus`], 1 byte.
pub const STATUS: u8 = 0x0B;
/// Register of the raw angle, 2 bytes.
pub const RAW_ANGLE: u8 = 0x0C;

/// Returns the angle, 0 to 4095, in the two bytes of [`RAW_ANGLE`], high byte first.
#[must_use]
pub const fn raw_angle(bytes: [u8; 2]) -> u16 {
    u16::from_be_bytes(bytes) & 0x0FFF
}

/// State of the magnet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct MagnetStatus(
    /// The register.
    pub u8,
);

impl MagnetStatus {
    /// Returns whether there is a magnet. Without one the angle is meaningless.
    #[must_use]
    pub const fn detected(self) -> bool {
        self.0 & 0x20 != 0
    }

    /// Returns whether the field is too weak.
    #[must_use]
    pub const fn too_weak(self) -> bool {
        self.0 & 0x10 != 0
    }

    /// Returns whether the field is too strong.
    #[must_use]
    pub const fn too_strong(self) -> bool {
        self.0 & 0x08 != 0
    }
}

/// An error of an AS5600.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error<E> {
    /// The bus's own error.
    Bus(E),
    /// The sensor detects no magnet.
    NoMagnet(MagnetStatus),
}

impl<E: core::fmt::Debug> core::fmt::Display for Error<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "AS5600 bus: {error:?}"),
            Self::NoMagnet(status) => write!(f, "AS5600 detects no magnet, status {:#04x}", status.0),
        }
    }
}

impl<E: core::fmt::Debug> core::error::Error for Error<E> {}

/// An AS5600.
#[derive(Debug)]
pub struct As5600<I> {
    i2c: I,
}

impl<I: I2c> As5600<I> {
    /// Returns a driver on this bus. Nothing is sent yet.
    pub const fn new(i2c: I) -> Self {
        Self { i2c }
    }

    /// Reads the state of the magnet. A weak or strong field still gives angles, with more noise.
    ///
    /// # Errors
    /// [`Error::Bus`].
    pub fn magnet(&mut self) -> Result<MagnetStatus, Error<I::Error>> {
        let mut status = [0];
        self.i2c.write_read(ADDRESS, &[STATUS], &mut status).map_err(Error::Bus)?;
        let [status] = status;
        Ok(MagnetStatus(status))
    }

    /// Returns the bus.
    pub fn release(self) -> I {
        self.i2c
    }
}

impl<I: I2c> Encoder for As5600<I> {
    type Error = Error<I::Error>;

    /// Reads the angle, then the state of the magnet. The time is that before the first
    /// transaction.
    fn read(&mut self, clock: &mut impl Clock) -> Result<Position, Self::Error> {
        let time_us = clock.now_us();
        let mut angle = [0; 2];
        self.i2c.write_read(ADDRESS, &[RAW_ANGLE], &mut angle).map_err(Error::Bus)?;
        let magnet = self.magnet()?;
        if !magnet.detected() {
            return Err(Error::NoMagnet(magnet));
        }
        Ok(Position { turn: u32::from(raw_angle(angle)) << 20, time_us })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angle_and_magnet_bits() {
        assert_eq!(raw_angle([0x0F, 0xFF]), 4095);
        assert_eq!(raw_angle([0xF1, 0x02]), 0x0102, "the upper four bits are not part of it");
        let good = MagnetStatus(0x20);
        assert!(good.detected() && !good.too_weak() && !good.too_strong());
        assert!(MagnetStatus(0x10).too_weak() && MagnetStatus(0x08).too_strong() && !MagnetStatus(0x18).detected());
    }
}
