//! Three lines over one UART, for a machine that has no more.
//!
//! ```text
//! byte 0: line in bits 7-6, count in bits 5-0 | count bytes
//! ```
//! To the machine only what it has asked for: scanner bytes after a request, which is a header with
//! their number and no bytes; encoder bytes after as many of its own. Link bytes go out unasked. So
//! nothing needs a queue.

use core::convert::Infallible;

use embedded_io::{ErrorType, Read, Write};

/// Most bytes behind one header.
pub const MAX_COUNT: usize = 63;

/// The lines.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// From the scanner.
    Scanner = 0,
    /// To and from the encoder.
    Encoder = 1,
    /// To the host.
    Link = 2,
}

/// One line of the UART `U`.
#[derive(Clone, Copy, Debug)]
pub struct Channel<U> {
    uart: U,
    line: Line,
}

impl<U: Write<Error = Infallible> + Read<Error = Infallible>> Channel<U> {
    /// A line. Its calls must not be mixed with those of other lines, which one thread without
    /// interrupts grants.
    pub const fn new(uart: U, line: Line) -> Self {
        Self { uart, line }
    }

    fn header(&self, count: usize) -> [u8; 1] {
        [(self.line as u8) << 6 | count as u8]
    }
}

impl<U> ErrorType for Channel<U> {
    type Error = Infallible;
}

impl<U: Write<Error = Infallible> + Read<Error = Infallible>> Read for Channel<U> {
    /// On the scanner's line asks for as many bytes as there is room for, up to [`MAX_COUNT`].
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let count = bytes.len().min(MAX_COUNT);
        if self.line == Line::Scanner {
            self.uart.write(&self.header(count))?;
        }
        let mut header = [0];
        let _ = self.uart.read(&mut header);
        for byte in bytes.iter_mut().take(count) {
            self.uart.read(core::slice::from_mut(byte))?;
        }
        Ok(count)
    }
}

impl<U: Write<Error = Infallible> + Read<Error = Infallible>> Write for Channel<U> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        for piece in bytes.chunks(MAX_COUNT) {
            self.uart.write(&self.header(piece.len()))?;
            self.uart.write(piece)?;
        }
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        self.uart.flush()
    }
}
