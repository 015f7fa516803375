//! Bytes of the scanner, from the interrupt of its port to the loop.
//!
//! The interrupt puts each byte into a queue and never waits; the loop takes what is there. A byte
//! for which there is no room stays in the port. If another one comes before there is, it is lost:
//! the port notices, and it is counted.

use core::convert::Infallible;
use core::sync::atomic::Ordering::Relaxed;
use core::sync::atomic::{AtomicBool, AtomicU32};

use embedded_io::{ErrorType, Read, ReadExactError};
use heapless::spsc::{Consumer, Producer, Queue};

use crate::figures;

/// The queue, of [`ROOM`] bytes.
pub type Bytes = Queue<u8, { ROOM + 1 }>;

/// Bytes that come while the loop does its longest work, and a margin: 211 by the default at 168 MHz,
/// see README.md. At 500 000 Bd they are 5.1 ms.
pub const ROOM: usize = 255;

/// What the port has lost. Written by its interrupt, read by the loop.
#[derive(Debug)]
pub struct Lost {
    overruns: AtomicU32,
    queue_full: AtomicU32,
    /// A byte may have been left in the port.
    left: AtomicBool,
}

impl Lost {
    /// Nothing yet.
    #[allow(clippy::new_without_default)] // for a static
    #[must_use]
    pub const fn new() -> Self {
        Self { overruns: AtomicU32::new(0), queue_full: AtomicU32::new(0), left: AtomicBool::new(false) }
    }

    /// Bytes lost because the interrupt came too late, and because the queue was full.
    pub fn counts(&self) -> (u32, u32) {
        (self.overruns.load(Relaxed), self.queue_full.load(Relaxed))
    }
}

/// The end of the queue that belongs to the interrupt.
#[allow(missing_debug_implementations)] // the queue has none
pub struct Input<'a> {
    /// The queue.
    pub bytes: Producer<'a, u8>,
    /// What is lost.
    pub lost: &'a Lost,
}

impl Input<'_> {
    /// Takes a byte out of the port and into the queue, if there is room; else leaves it there.
    /// `overrun` says that the port has lost one before it.
    #[inline(always)]
    pub fn take(&mut self, overrun: bool, byte: impl FnOnce() -> u8) {
        let room = self.bytes.ready();
        if overrun {
            // written here alone: a load and a store do
            let count = if room { &self.lost.overruns } else { &self.lost.queue_full };
            count.store(count.load(Relaxed).wrapping_add(1), Relaxed);
        }
        if room {
            // only this end takes room
            let _ = self.bytes.enqueue(byte());
        } else {
            self.lost.left.store(true, Relaxed);
        }
    }
}

/// The end of the queue that belongs to the loop.
#[allow(missing_debug_implementations)] // the queue has none
pub struct Output<'a> {
    /// The queue.
    pub bytes: Consumer<'a, u8>,
    /// What is lost.
    pub lost: &'a Lost,
    /// Raises the interrupt of the port, for a byte that was left there.
    pub raise: fn(),
}

impl ErrorType for Output<'_> {
    type Error = Infallible;
}

impl Read for Output<'_> {
    /// Waits until a byte is there, and takes those that are.
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        let Some(first) = bytes.first_mut() else { return Ok(0) };
        self.read_exact(core::slice::from_mut(first)).map_or(Ok(0), |()| Ok(1))
    }

    /// Waits until all are there. There must be room for them in the queue.
    fn read_exact(&mut self, bytes: &mut [u8]) -> Result<(), ReadExactError<Infallible>> {
        if self.bytes.len() < bytes.len() {
            figures::pause();
            while self.bytes.len() < bytes.len() {}
            figures::resume();
        }
        for byte in bytes {
            *byte = self.bytes.dequeue().unwrap_or(0);
        }
        if self.lost.left.load(Relaxed) {
            // there is room again
            self.lost.left.store(false, Relaxed);
            (self.raise)();
        }
        Ok(())
    }
}
