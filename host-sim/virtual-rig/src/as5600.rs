//! An AS5600 on a simulated I2C bus.

use embedded_hal::i2c::{Error, ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use scanseg_hal::encoder::as5600::{ADDRESS, RAW_ANGLE, STATUS};

/// An AS5600 encoder on the shaft whose position `shaft` gives, in turns of any number.
#[derive(Debug)]
pub struct VirtualAs5600<F> {
    shaft: F,
    /// What [`STATUS`] gives; 0x20 for a well-placed magnet.
    pub status: u8,
    /// Its bus is broken: nobody acknowledges.
    pub dead: bool,
}

impl<F: FnMut() -> f64> VirtualAs5600<F> {
    /// A sensor with a magnet in front of it.
    pub const fn new(shaft: F) -> Self {
        Self { shaft, status: 0x20, dead: false }
    }
}

/// Nobody on the bus has acknowledged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NoAcknowledge;

impl Error for NoAcknowledge {
    fn kind(&self) -> ErrorKind {
        ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address)
    }
}

impl<F> ErrorType for VirtualAs5600<F> {
    type Error = NoAcknowledge;
}

impl<F: FnMut() -> f64> I2c for VirtualAs5600<F> {
    /// Knows the two registers that are read; all others are 0. The upper four bits of the angle
    /// are not defined.
    fn transaction(&mut self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), NoAcknowledge> {
        if address != ADDRESS || self.dead {
            return Err(NoAcknowledge);
        }
        let mut register = 0;
        for operation in operations {
            match operation {
                Operation::Write(bytes) => register = bytes.first().copied().unwrap_or(register),
                Operation::Read(bytes) => {
                    let angle = ((self.shaft)().rem_euclid(1.0) * 4096.0) as u16 & 0x0FFF;
                    let [high, low] = (angle | 0xA000).to_be_bytes();
                    for byte in bytes.iter_mut() {
                        *byte = match register {
                            STATUS => self.status,
                            RAW_ANGLE => high,
                            at if at == RAW_ANGLE + 1 => low,
                            _ => 0,
                        };
                        register += 1;
                    }
                }
            }
        }
        Ok(())
    }
}
