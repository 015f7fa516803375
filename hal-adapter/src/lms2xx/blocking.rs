//! The scanner on a blocking embedded-io port.

use embedded_hal::delay::DelayNs;
use embedded_io::{Read, ReadReady, Write};

use super::scan::Scan;
use super::session::{Action, Phase, Session};
use super::settings::{Baud, Settings};
use super::shell::{Error, Inbox, ScannerEvent, to_ms};
use crate::Clock;

/// A serial port whose rate can be changed: 8 data bits, no parity, one stop bit.
pub trait Port: Read + ReadReady + Write {
    /// Changes the rate. All bytes have been sent before this is called.
    ///
    /// # Errors
    /// The port's own.
    fn set_baud(&mut self, baud: Baud) -> Result<(), Self::Error>;
}

/// An LMS 2xx on a blocking port.
#[derive(Debug)]
pub struct Scanner<P, C, D> {
    session: Session,
    inbox: Inbox,
    port: P,
    clock: C,
    delay: D,
}

impl<P: Port, C: Clock, D: DelayNs> Scanner<P, C, D> {
    /// Touches nothing yet: the scanner is looked for in the first calls of [`Scanner::next_event`].
    pub const fn new(port: P, clock: C, delay: D, settings: Settings) -> Self {
        Self { session: Session::new(settings), inbox: Inbox::new(), port, clock, delay }
    }

    /// Waits for the next event. Returns within seconds even if there is no scanner (with
    /// [`ScannerEvent::Trouble`]), and from then on as often as something happens.
    ///
    /// # Errors
    /// Only those of the port. What was read before is kept, so the call may be repeated.
    pub fn next_event(&mut self) -> Result<ScannerEvent, Error<P::Error>> {
        loop {
            let now_us = self.clock.now_us();
            if let Some(event) = self.inbox.next(&mut self.session, now_us) {
                return Ok(event);
            }
            match self.session.poll(to_ms(now_us)) {
                Action::SetBaud(baud) => self.port.set_baud(baud).map_err(Error::Port)?,
                Action::Send { bytes, gap_us } => self.send(bytes.as_slice(), gap_us)?,
                Action::Wait { ms } => {
                    let until_us = now_us + u64::from(ms) * 1000;
                    while self.clock.now_us() < until_us {
                        if self.port.read_ready().map_err(Error::Port)? {
                            let count = self.port.read(self.inbox.room()).map_err(Error::Port)?;
                            self.inbox.filled(count)?;
                            break;
                        }
                        core::hint::spin_loop();
                    }
                }
                Action::Tell(trouble) => return Ok(ScannerEvent::Trouble(trouble)),
            }
        }
    }

    /// The scan that the last [`Scanner::next_event`] reported.
    #[must_use]
    pub fn scan(&self) -> Option<Scan<'_>> {
        self.session.scan()
    }

    /// How far the scanner is.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.session.phase()
    }

    /// Gives port, clock and delay back. The scanner is left as it is.
    pub fn release(self) -> (P, C, D) {
        (self.port, self.clock, self.delay)
    }

    /// Every byte has left the port when this returns, so that the rate may be changed right after.
    fn send(&mut self, bytes: &[u8], gap_us: u32) -> Result<(), Error<P::Error>> {
        let piece = if gap_us == 0 { bytes.len() } else { 1 };
        for piece in bytes.chunks(piece) {
            self.port.write_all(piece).map_err(Error::Port)?;
            self.port.flush().map_err(Error::Port)?;
            if gap_us > 0 {
                self.delay.delay_us(gap_us);
            }
        }
        Ok(())
    }
}
