//! The UART of Arm's Cortex-M System Design Kit, as on the MPS2 boards.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadExactError, Write};

use crate::figures;
use crate::register::Register;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;

/// One UART.
#[derive(Clone, Copy, Debug)]
pub struct Uart {
    data: Register,
    state: Register,
}

impl Uart {
    /// The UART at `base`, 8N1 at `clock_hz / divider` bits a second; `divider` is at least 16.
    ///
    /// # Safety
    /// There is such a UART, and nothing else uses it.
    pub unsafe fn new(base: usize, divider: u32) -> Self {
        // SAFETY: the registers of the UART that the caller promises.
        let [data, state, control, rate] =
            [0x00, 0x04, 0x08, 0x10].map(|offset| unsafe { Register::at(base + offset) });
        rate.write(divider);
        // bits 0 and 1: transmitter and receiver on; no interrupts
        control.write(3);
        Self { data, state }
    }

    /// Waits for a byte.
    #[inline(always)]
    fn byte(&mut self) -> u8 {
        figures::pause();
        while self.state.read() & RX_FULL == 0 {}
        figures::resume();
        self.data.read() as u8
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Read for Uart {
    /// Waits for one byte.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let Some(byte) = bytes.first_mut() else { return Ok(0) };
        *byte = self.byte();
        Ok(1)
    }

    /// As `read`, without its detours for each byte.
    fn read_exact(&mut self, bytes: &mut [u8]) -> Result<(), ReadExactError<Infallible>> {
        for byte in bytes {
            *byte = self.byte();
        }
        Ok(())
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            self.flush()?;
            self.data.write(u32::from(byte));
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        figures::pause();
        while self.state.read() & TX_FULL != 0 {}
        figures::resume();
        Ok(())
    }
}
