//! The UART of the nRF51.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, Write};

use crate::figures;
use crate::register::Register;

/// The one UART.
#[derive(Clone, Copy, Debug)]
pub struct Uart {
    received: Register,
    sent: Register,
    rx: Register,
    tx: Register,
}

impl Uart {
    /// 8N1 at 1 000 000 bits a second, transmitter on pin 24, receiver on pin 25 (the micro:bit's
    /// USB).
    ///
    /// # Safety
    /// The program runs on an nRF51, and nothing else uses its UART.
    pub unsafe fn new() -> Self {
        // SAFETY: the UART of the nRF51 that the caller promises.
        let register = |offset: usize| unsafe { Register::at(0x4000_2000 + offset) };
        for (offset, value) in [
            (0x50C, 24),          // PSELTXD
            (0x514, 25),          // PSELRXD
            (0x524, 0x1000_0000), // BAUDRATE
            (0x500, 4),           // ENABLE
            (0x000, 1),           // STARTRX
            (0x008, 1),           // STARTTX
        ] {
            register(offset).write(value);
        }
        Self { received: register(0x108), sent: register(0x11C), rx: register(0x518), tx: register(0x51C) }
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl Read for Uart {
    /// Waits for one byte.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let Some(byte) = bytes.first_mut() else { return Ok(0) };
        figures::pause();
        while self.received.read() == 0 {}
        figures::resume();
        // before the byte is taken: the next one in the queue raises it again
        self.received.write(0);
        *byte = self.rx.read() as u8;
        Ok(1)
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for &byte in bytes {
            self.sent.write(0);
            self.tx.write(u32::from(byte));
            figures::pause();
            while self.sent.read() == 0 {}
            figures::resume();
        }
        Ok(bytes.len())
    }

    /// `write` has waited already.
    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
