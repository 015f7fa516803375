//! An SPI device on a serial line.

use embedded_hal::spi::{Error, ErrorKind, ErrorType, Operation, SpiDevice};
use embedded_io::{Read, Write};

/// A serial port in place of an SPI bus, because QEMU has no SPI device that answers: the bytes of
/// a transaction are sent as MOSI, then as many are received as MISO.
#[derive(Debug)]
pub struct SpiOver<P>(pub P);

/// The port has failed, or the transaction is none that [`SpiOver`] carries.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WireError;

impl Error for WireError {
    fn kind(&self) -> ErrorKind {
        ErrorKind::Other
    }
}

impl<P> ErrorType for SpiOver<P> {
    type Error = WireError;
}

impl<P: Read + Write> SpiDevice for SpiOver<P> {
    /// Only transfers in place, which is what the encoder's driver does.
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), WireError> {
        for operation in operations {
            let Operation::TransferInPlace(bytes) = operation else { return Err(WireError) };
            self.0.write_all(bytes).map_err(|_| WireError)?;
            self.0.read_exact(bytes).map_err(|_| WireError)?;
        }
        Ok(())
    }
}
