//! The UART of Arm's Cortex-M System Design Kit, as on the MPS2 boards.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, ReadExactError, Write};

use crate::figures;
use crate::receive::Input;
use crate::register::Register;

const TX_FULL: u32 = 1;
const RX_FULL: u32 = 2;
const RX_OVERRUN: u32 = 8;

/// One UART.
#[derive(Clone, Copy, Debug)]
pub struct Uart {
    data: Register,
    state: Register,
    control: Register,
    interrupt: Register,
}

impl Uart {
    /// The UART at `base`, 8N1 at `clock_hz / divider` bits a second; `divider` is at least 16.
    ///
    /// # Safety
    /// There is such a UART, and nothing else uses it.
    pub unsafe fn new(base: usize, divider: u32) -> Self {
        // SAFETY: the registers of the UART that the caller promises.
        let [data, state, control, interrupt, rate] =
            [0x00, 0x04, 0x08, 0x0C, 0x10].map(|offset| unsafe { Register::at(base + offset) });
        rate.write(divider);
        // bits 0 and 1: transmitter and receiver on; no interrupts
        control.write(3);
        Self { data, state, control, interrupt }
    }

    /// Raises the interrupt for each byte that comes from now on; one that is there already has
    /// raised none.
    pub fn receive_by_interrupt(&self) {
        // bit 3 beside transmitter and receiver
        self.control.write(1 << 3 | 3);
    }

    /// Takes the byte that has raised the interrupt.
    #[inline(always)]
    pub fn interrupted(&self, input: &mut Input<'_>) {
        self.interrupt.write(1 << 1);
        let state = self.state.read();
        let overrun = state & RX_OVERRUN != 0;
        if overrun {
            self.state.write(RX_OVERRUN);
        }
        if state & RX_FULL != 0 {
            input.take(overrun, || self.data.read() as u8);
        }
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
