//! The encoder on a serial line.

use core::convert::Infallible;

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use embedded_io::{Read, Write};

/// A serial port in place of an SPI bus: what would go out on MOSI is sent, and as many bytes are received as MISO.
#[derive(Debug)]
pub struct SpiOver<P>(pub P);

impl<P> ErrorType for SpiOver<P> {
    type Error = Infallible;
}

impl<P: Read<Error = Infallible> + Write<Error = Infallible>> SpiDevice for SpiOver<P> {
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), Infallible> {
        for operation in operations {
            if let Operation::TransferInPlace(bytes) = operation {
                let _ = self.0.write(bytes)?;
                let _ = self.0.read_exact(bytes);
            }
        }
        Ok(())
    }
}
