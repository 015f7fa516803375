//! The scanner on an async embedded-io port.

use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::Poll;

use embedded_hal_async::delay::DelayNs;
use embedded_io_async::{Read, Write};

use super::command::CommandBytes;
use super::scan::Scan;
use super::session::{Action, Phase, Session};
use super::settings::{Baud, Settings};
use super::shell::{Error, Inbox, ScannerEvent, to_ms};
use crate::Clock;

/// A serial port whose rate can be changed: 8 data bits, no parity, one stop bit. Its `read` must be cancel-safe (lose no
/// byte when its future is dropped), as buffered UART drivers are: waits are ended by dropping it.
pub trait Port: Read + Write {
    /// Changes the rate. All bytes have been sent before this is called.
    ///
    /// # Errors
    /// The port's own.
    fn set_baud(&mut self, baud: Baud) -> Result<(), Self::Error>;
}

/// An LMS 2xx on an async port.
#[derive(Debug)]
pub struct Scanner<P, C, D> {
    session: Session,
    inbox: Inbox,
    port: P,
    clock: C,
    delay: D,
    outbox: Outbox,
}

/// A command on its way out, kept here so that a dropped future does not cut it off.
#[derive(Debug)]
struct Outbox {
    bytes: CommandBytes,
    sent: usize,
    gap_us: u32,
    gap_due: bool,
}

impl<P: Port, C: Clock, D: DelayNs> Scanner<P, C, D> {
    /// Touches nothing yet: the scanner is looked for in the first calls of [`Scanner::next_event`].
    pub const fn new(port: P, clock: C, delay: D, settings: Settings) -> Self {
        let outbox = Outbox { bytes: CommandBytes::EMPTY, sent: 0, gap_us: 0, gap_due: false };
        Self { session: Session::new(settings), inbox: Inbox::new(), port, clock, delay, outbox }
    }

    /// Waits for the next event. Returns within seconds even if there is no scanner (with
    /// [`ScannerEvent::Trouble`]), and from then on as often as something happens.
    ///
    /// Cancel-safe, as far as `read` and `write` of the port are: no received byte is lost, and the next call goes on with a
    /// command that was being sent.
    ///
    /// # Errors
    /// Only those of the port. What was read before is kept, so the call may be repeated.
    pub async fn next_event(&mut self) -> Result<ScannerEvent, Error<P::Error>> {
        loop {
            let now_us = self.clock.now_us();
            if let Some(event) = self.inbox.next(&mut self.session, now_us) {
                return Ok(event);
            }
            self.send().await?;
            match self.session.poll(to_ms(now_us)) {
                Action::SetBaud(baud) => self.port.set_baud(baud).map_err(Error::Port)?,
                Action::Send { bytes, gap_us } => self.outbox = Outbox { bytes, sent: 0, gap_us, gap_due: false },
                Action::Wait { ms } => {
                    let read = self.port.read(self.inbox.room());
                    if let Some(count) = within(read, self.delay.delay_ms(ms)).await {
                        self.inbox.filled(count.map_err(Error::Port)?)?;
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

    /// Sends what is in the outbox. Every byte has left the port when this returns, so that the rate may be changed.
    async fn send(&mut self) -> Result<(), Error<P::Error>> {
        let Outbox { bytes, sent, gap_us, gap_due } = &mut self.outbox;
        while let Some(rest @ [first, ..]) = bytes.as_slice().get(*sent..) {
            if *gap_due {
                self.delay.delay_us(*gap_us).await;
                *gap_due = false;
            }
            let piece = if *gap_us > 0 { core::slice::from_ref(first) } else { rest };
            *sent += self.port.write(piece).await.map_err(Error::Port)?;
            *gap_due = *gap_us > 0;
            self.port.flush().await.map_err(Error::Port)?;
        }
        Ok(())
    }
}

/// What `work` gives, unless `limit` is over first.
async fn within<T>(work: impl Future<Output = T>, limit: impl Future<Output = ()>) -> Option<T> {
    let (mut work, mut limit) = (pin!(work), pin!(limit));
    poll_fn(|context| match work.as_mut().poll(context) {
        Poll::Ready(result) => Poll::Ready(Some(result)),
        Poll::Pending => limit.as_mut().poll(context).map(|()| None),
    })
    .await
}
