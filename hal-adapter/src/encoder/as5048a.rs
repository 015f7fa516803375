//! AS5048A: magnetic encoder, 14 bits a turn, on SPI (mode 1, at most 10 MHz).
//!
//! A frame has 16 bits. A command has even parity in bit 15, "read" in bit 14, and a register in
//! bits 13 to 0. The answer comes **in the next frame**: even parity in bit 15, the error flag in
//! bit 14, data in bits 13 to 0. Chip select must rise between frames, so each frame is an
//! [`SpiDevice`] transaction of its own. Source: ams' data sheet of the AS5048. Drivers disagree
//! about the place of the diagnostic flags; bits 8 to 11 are taken, as SimpleFOC does.

use embedded_hal::spi::SpiDevice;

use super::position::{Encoder, Position};
use crate::clock::Clock;

/// Registers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[repr(u16)]
pub enum Register {
    /// No operation. Sent to fetch the answer to the previous command.
    Nop = 0x0000,
    /// Reading it returns and clears the [`Faults`] behind the error flag.
    ClearError = 0x0001,
    /// [`Diagnostics`].
    Diagnostics = 0x3FFD,
    /// Strength of the field, 14 bits.
    Magnitude = 0x3FFE,
    /// Angle, 14 bits a turn.
    Angle = 0x3FFF,
}

/// Returns the frame that reads a register; 0 for [`Register::Nop`].
#[must_use]
pub const fn read_command(register: Register) -> u16 {
    let word = match register {
        Register::Nop => 0,
        register => 0x4000 | register as u16,
    };
    word | ((word.count_ones() as u16 & 1) << 15)
}

/// Returns the 14 data bits of an answer.
///
/// A line stuck low reads as a valid 0. Only [`Diagnostics::ready`] distinguishes a dead sensor
/// from one at position 0.
///
/// # Errors
/// [`FrameError`]: the parity is odd, or the error flag is set. A line stuck high reads as
/// `Flagged`.
pub const fn answer(word: u16) -> Result<u16, FrameError> {
    if word.count_ones() & 1 != 0 {
        Err(FrameError::Parity(word))
    } else if word & 0x4000 != 0 {
        Err(FrameError::Flagged)
    } else {
        Ok(word & 0x3FFF)
    }
}

/// Why an answer is not valid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum FrameError {
    /// Odd parity: the frame was damaged.
    Parity(u16),
    /// The error flag is set: an earlier command was faulty.
    Flagged,
}

impl core::fmt::Display for FrameError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Parity(word) => write!(f, "answer {word:#06x} has odd parity"),
            Self::Flagged => write!(f, "error flag is set"),
        }
    }
}

impl core::error::Error for FrameError {}

/// Why the sensor set its error flag: three bits of [`Register::ClearError`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Faults(
    /// The register: bit 0 framing, bit 1 invalid command, bit 2 parity.
    pub u16,
);

impl Faults {
    /// Returns whether a frame did not have 16 bits.
    #[must_use]
    pub const fn framing(self) -> bool {
        self.0 & 1 != 0
    }

    /// Returns whether a command was invalid.
    #[must_use]
    pub const fn invalid_command(self) -> bool {
        self.0 & 2 != 0
    }

    /// Returns whether a command arrived with odd parity.
    #[must_use]
    pub const fn parity(self) -> bool {
        self.0 & 4 != 0
    }
}

/// State of sensor and magnet, [`Register::Diagnostics`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Diagnostics(
    /// The register.
    pub u16,
);

impl Diagnostics {
    /// Returns the gain, 0 (strong field) to 255 (weak field).
    #[must_use]
    pub const fn gain(self) -> u8 {
        self.0 as u8
    }

    /// Returns whether the offset compensation has finished. False also when no sensor answers.
    #[must_use]
    pub const fn ready(self) -> bool {
        self.0 & 0x0100 != 0
    }

    /// Returns whether the angle computation overflowed: the angle is not valid.
    #[must_use]
    pub const fn overflow(self) -> bool {
        self.0 & 0x0200 != 0
    }

    /// Returns whether the field is too strong.
    #[must_use]
    pub const fn too_strong(self) -> bool {
        self.0 & 0x0400 != 0
    }

    /// Returns whether the field is too weak.
    #[must_use]
    pub const fn too_weak(self) -> bool {
        self.0 & 0x0800 != 0
    }
}

/// An error of an AS5048A.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum Error<E> {
    /// The bus's own error.
    Bus(E),
    /// An answer with odd parity. The next reading may be good.
    Parity(u16),
    /// The sensor flagged an error. The driver has read and cleared it.
    Sensor(Faults),
}

impl<E: core::fmt::Debug> core::fmt::Display for Error<E> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bus(error) => write!(f, "AS5048A bus: {error:?}"),
            Self::Parity(word) => write!(f, "AS5048A answer {word:#06x} has odd parity"),
            Self::Sensor(faults) => write!(f, "AS5048A flagged an error, faults {:#x}", faults.0),
        }
    }
}

impl<E: core::fmt::Debug> core::error::Error for Error<E> {}

/// An AS5048A.
#[derive(Debug)]
pub struct As5048a<S> {
    spi: S,
}

impl<S: SpiDevice> As5048a<S> {
    /// Returns a driver on this device, SPI mode 1 with chip select. Nothing is sent yet.
    pub const fn new(spi: S) -> Self {
        Self { spi }
    }

    /// Reads the state of sensor and magnet. Check it once at start: the angle does not show that
    /// the magnet or the sensor is missing.
    ///
    /// # Errors
    /// [`Error`].
    pub fn diagnostics(&mut self) -> Result<Diagnostics, Error<S::Error>> {
        self.command(Register::Diagnostics)?;
        self.fetch().map(Diagnostics)
    }

    /// Returns the device.
    pub fn release(self) -> S {
        self.spi
    }

    fn command(&mut self, register: Register) -> Result<u16, Error<S::Error>> {
        let mut frame = read_command(register).to_be_bytes();
        self.spi.transfer_in_place(&mut frame).map_err(Error::Bus)?;
        Ok(u16::from_be_bytes(frame))
    }

    /// Reads the answer to the last command.
    fn fetch(&mut self) -> Result<u16, Error<S::Error>> {
        match answer(self.command(Register::Nop)?) {
            Ok(data) => Ok(data),
            Err(FrameError::Parity(word)) => Err(Error::Parity(word)),
            Err(FrameError::Flagged) => {
                self.command(Register::ClearError)?;
                let faults = self.command(Register::Nop)?;
                Err(Error::Sensor(Faults(faults & 0x0007)))
            }
        }
    }
}

impl<S: SpiDevice> Encoder for As5048a<S> {
    type Error = Error<S::Error>;

    /// Sends two frames. The sensor measures the angle at the end of the first one, which is when
    /// the time is taken.
    fn read(&mut self, clock: &mut impl Clock) -> Result<Position, Self::Error> {
        self.command(Register::Angle)?;
        let time_us = clock.now_us();
        Ok(Position { turn: u32::from(self.fetch()?) << 18, time_us })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn command_words() {
        assert_eq!(read_command(Register::Angle), 0xFFFF);
        assert_eq!(read_command(Register::Magnitude), 0x7FFE);
        assert_eq!(read_command(Register::Diagnostics), 0x7FFD);
        assert_eq!(read_command(Register::ClearError), 0x4001);
        assert_eq!(read_command(Register::Nop), 0x0000);
    }

    #[test]
    fn every_answer() {
        for word in (0..=u16::MAX).step_by(if cfg!(miri) { 251 } else { 1 }) {
            let odd = (0..16).filter(|bit| word >> bit & 1 == 1).count() % 2 == 1;
            let expected = match (odd, word & 0x4000 != 0) {
                (true, _) => Err(FrameError::Parity(word)),
                (false, true) => Err(FrameError::Flagged),
                (false, false) => Ok(word % 0x4000),
            };
            assert_eq!(answer(word), expected);
        }
    }

    #[test]
    fn diagnostics_bits() {
        let good = Diagnostics(0x0180);
        assert!(good.ready() && !good.overflow() && !good.too_strong() && !good.too_weak());
        assert_eq!(good.gain(), 0x80);
        assert!(Diagnostics(0x0200).overflow() && Diagnostics(0x0400).too_strong() && Diagnostics(0x0800).too_weak());
        assert!(!Diagnostics(0).ready());
    }
}
