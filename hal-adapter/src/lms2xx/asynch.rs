//! The scanner on an async embedded-io port.

use core::future::{Future, poll_fn};
use core::pin::pin;
use core::task::Poll;

use embedded_hal_async::delay::DelayNs;
use embedded_io_async::{Read, Write};

use super::action::Action;
use super::settings::Baud;
use super::shell::{Error, Outbox, Scanner, ScannerEvent, Todo, to_ms};
use crate::clock::Clock;

/// A serial port whose baud rate can be changed: 8 data bits, no parity, one stop bit. Waits are
/// ended by dropping the future of `read`, so `read` must be cancel-safe: no byte may be lost then.
/// Buffered UART drivers are.
pub trait Port: Read + Write {
    /// Changes the baud rate. All bytes have been sent before this is called.
    ///
    /// # Errors
    /// The port's own.
    fn set_baud(&mut self, baud: Baud) -> Result<(), Self::Error>;
}

impl<P: Port, C: Clock, D: DelayNs> Scanner<P, C, D> {
    /// [`Scanner::next_event`] for an async port.
    ///
    /// Cancel-safe if `read` and `write` of the port are: the future may be dropped at any time. No
    /// received byte is lost, and the next call continues a command that was being sent.
    ///
    /// # Errors
    /// Only those of the port. The call may be repeated.
    pub async fn next_event_async(&mut self) -> Result<ScannerEvent, Error<P::Error>> {
        loop {
            self.send_async().await?;
            if let Some(event) = self.inbox.next(&mut self.session) {
                return Ok(event);
            }
            match self.session.poll(to_ms(self.clock.now_us())) {
                Action::SetBaud(baud) => self.port.set_baud(baud).map_err(Error::Port)?,
                Action::Send { bytes, gap_us } => self.outbox = Outbox::new(bytes, gap_us),
                Action::Wait { ms } => {
                    let read = self.port.read(self.inbox.room());
                    if let Some(count) = within(read, self.delay.delay_ms(ms)).await {
                        self.inbox.filled(count.map_err(Error::Port)?, self.clock.now_us())?;
                    }
                }
                Action::Tell(trouble) => return Ok(ScannerEvent::Trouble(trouble)),
            }
        }
    }

    async fn send_async(&mut self) -> Result<(), Error<P::Error>> {
        while let Some(todo) = self.outbox.todo() {
            match todo {
                Todo::Write(bytes) => {
                    let count = self.port.write(bytes).await.map_err(Error::Port)?;
                    self.outbox.written(count)?;
                }
                Todo::Flush => {
                    self.port.flush().await.map_err(Error::Port)?;
                    self.outbox.flushed();
                }
                Todo::Gap { us } => {
                    self.delay.delay_us(us).await;
                    self.outbox.gap_over();
                }
            }
        }
        Ok(())
    }
}

/// Returns the result of `work`; `None` if `limit` completes first.
async fn within<T>(work: impl Future<Output = T>, limit: impl Future<Output = ()>) -> Option<T> {
    let (mut work, mut limit) = (pin!(work), pin!(limit));
    poll_fn(|context| match work.as_mut().poll(context) {
        Poll::Ready(result) => Poll::Ready(Some(result)),
        Poll::Pending => limit.as_mut().poll(context).map(|()| None),
    })
    .await
}
