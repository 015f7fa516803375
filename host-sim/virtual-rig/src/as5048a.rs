//! An AS5048A on a simulated SPI bus.

use core::convert::Infallible;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};

/// An AS5048A encoder on the shaft whose position `shaft` gives, in turns of any number. Each
/// transaction is one frame; the answer to a command comes in the next one.
#[derive(Debug)]
pub struct VirtualAs5048a<F> {
    shaft: F,
    answer: u16,
    faults: u16,
    /// What [`scanseg_hal::encoder::as5048a::Register::Diagnostics`] gives; 0x0180 for a
    /// well-placed magnet.
    pub diagnostics: u16,
    /// Bits flipped in the next frame to the sensor.
    pub flip: u16,
}

impl<F: FnMut() -> f64> VirtualAs5048a<F> {
    /// A sensor that has just been switched on.
    pub const fn new(shaft: F) -> Self {
        Self { shaft, answer: 0, faults: 0, diagnostics: 0x0180, flip: 0 }
    }

    /// Takes the frame to the sensor and returns the frame from it.
    fn frame(&mut self, sent: u16) -> u16 {
        let received = sent ^ core::mem::take(&mut self.flip);
        let answer = self.answer;
        if !received.count_ones().is_multiple_of(2) {
            self.faults |= 4;
        }
        let flagged = self.faults != 0;
        let data = match received & 0x7FFF {
            0x0000 => 0,
            0x4001 => core::mem::take(&mut self.faults),
            0x7FFD => self.diagnostics,
            0x7FFE => 2000,
            0x7FFF => ((self.shaft)().rem_euclid(1.0) * 16384.0) as u16 & 0x3FFF,
            _ => {
                self.faults |= 2;
                0
            }
        };
        let word = data | if flagged { 0x4000 } else { 0 };
        self.answer = word | ((word.count_ones() as u16 & 1) << 15);
        answer
    }
}

impl<F> ErrorType for VirtualAs5048a<F> {
    type Error = Infallible;
}

impl<F: FnMut() -> f64> SpiDevice for VirtualAs5048a<F> {
    /// A transaction of anything but one frame of two bytes counts as a framing fault.
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        match operations {
            [Operation::TransferInPlace(words)] if words.len() == 2 => {
                let answer = self.frame(u16::from_be_bytes([words[0], words[1]]));
                words.copy_from_slice(&answer.to_be_bytes());
            }
            _ => self.faults |= 1,
        }
        Ok(())
    }
}
