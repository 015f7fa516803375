//! The scanner on a blocking embedded-io port.

use embedded_hal::delay::DelayNs;
use embedded_io::{Read, ReadReady, Write};

use super::action::Action;
use super::settings::Baud;
use super::shell::{Error, Outbox, Scanner, ScannerEvent, Todo, to_ms};
use crate::clock::Clock;

/// A serial port whose baud rate can be changed: 8 data bits, no parity, one stop bit.
pub trait Port: Read + ReadReady + Write {
    /// Changes the baud rate, and drops the bytes that were received at the old one and not read
    /// yet. All bytes have been sent before this is called.
    ///
    /// Without a scanner it is called for each of the four rates, again and again.
    ///
    /// # Errors
    /// The port's own.
    fn set_baud(&mut self, baud: Baud) -> Result<(), Self::Error>;
}

impl<P: Port, C: Clock, D: DelayNs> Scanner<P, C, D> {
    /// Waits for the next event and returns it. It blocks until then: while scan lines
    /// come, for up to a period of the scanner ([`Settings::period_us`](super::Settings::period_us));
    /// without a scanner until [`ScannerEvent::Trouble`], some four seconds; of [`Scanner::listening`]
    /// until a byte comes, without end.
    ///
    /// Call it again soon. Bytes that come in between must find room in the port (how many:
    /// [`rig`](crate::rig#how-long-a-call-takes-and-the-buffer-of-the-port)), and after more than half
    /// a second without a scan line the scanner counts as stopped.
    ///
    /// # Errors
    /// Only those of the port. No received byte is lost, and the next call continues a command that
    /// was being sent.
    pub fn next_event(&mut self) -> Result<ScannerEvent, Error<P::Error>> {
        loop {
            self.send()?;
            if let Some(event) = self.inbox.next(&mut self.session) {
                return Ok(event);
            }
            let now_us = self.clock.now_us();
            match self.session.poll(to_ms(now_us)) {
                Action::SetBaud(baud) => self.port.set_baud(baud).map_err(Error::Port)?,
                Action::Send { bytes, gap_us } => self.outbox = Outbox::new(bytes, gap_us),
                Action::Wait { ms } => {
                    let until_us = now_us + u64::from(ms) * 1000;
                    while self.clock.now_us() < until_us {
                        if self.port.read_ready().map_err(Error::Port)? {
                            let count = self.port.read(self.inbox.room()).map_err(Error::Port)?;
                            self.inbox.filled(count, self.clock.now_us())?;
                            break;
                        }
                        core::hint::spin_loop();
                    }
                }
                Action::Tell(trouble) => return Ok(ScannerEvent::Trouble(trouble)),
            }
        }
    }

    fn send(&mut self) -> Result<(), Error<P::Error>> {
        while let Some(todo) = self.outbox.todo() {
            match todo {
                Todo::Write(bytes) => {
                    let count = self.port.write(bytes).map_err(Error::Port)?;
                    self.outbox.written(count)?;
                }
                Todo::Flush => {
                    self.port.flush().map_err(Error::Port)?;
                    self.outbox.flushed();
                }
                Todo::Gap { us } => {
                    self.delay.delay_us(us);
                    self.outbox.gap_over();
                }
            }
        }
        Ok(())
    }
}
