//! The scanner's port for an async loop.

use core::cell::RefCell;
use core::future::poll_fn;
use core::task::Poll;

use embedded_hal_async::delay::DelayNs;
use embedded_io_async::{ErrorType, Read, Write};
use scanseg_hal::lms2xx::Baud;
use scanseg_hal::lms2xx::asynch::Port;

use crate::run::{LineClock, PIECE};

/// Bytes of a scanner to which nothing is sent, in the pieces of [`run`](crate::run::run); they move
/// the clock.
#[derive(Debug)]
pub struct Pieces<'a, R> {
    /// The bytes. A read waits until all that it asks for are there.
    pub bytes: R,
    /// The time.
    pub clock: &'a RefCell<LineClock>,
}

impl<R: ErrorType> ErrorType for Pieces<'_, R> {
    type Error = R::Error;
}

impl<R: Read> Read for Pieces<'_, R> {
    /// Reads a piece.
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, R::Error> {
        let (_, to_come) = self.clock.borrow().telegram();
        let count = PIECE.min(to_come as usize).min(bytes.len());
        let count = self.bytes.read(bytes.get_mut(..count).unwrap_or(&mut [])).await?;
        self.clock.borrow_mut().received(count as u32);
        Ok(count)
    }
}

impl<R: Read> Write for Pieces<'_, R> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, R::Error> {
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), R::Error> {
        Ok(())
    }
}

impl<R: Read> Port for Pieces<'_, R> {
    fn set_baud(&mut self, _: Baud) -> Result<(), R::Error> {
        Ok(())
    }
}

/// A delay by the time of the bytes. It wakes nobody: the bytes do.
#[derive(Debug)]
pub struct LineDelay<'a>(pub &'a RefCell<LineClock>);

impl DelayNs for LineDelay<'_> {
    async fn delay_ns(&mut self, ns: u32) {
        let end_us = self.0.borrow().now_us() + u64::from(ns / 1000);
        let now_us = || self.0.borrow().now_us();
        poll_fn(|_| if now_us() < end_us { Poll::Pending } else { Poll::Ready(()) }).await;
    }
}
