//! Packets as they come.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use crate::command::live::incoming::{Incoming, Next, Packet};

/// What comes, until there is no more or a signal asks to stop.
pub struct Packets<T = Vec<u8>> {
    pub incoming: Incoming<T>,
    pub stop: &'static AtomicBool,
}

impl<T: Send + 'static> Packets<T> {
    /// Returns the next one.
    pub fn next(&mut self) -> Option<Packet<T>> {
        while !self.stop.load(Ordering::Relaxed) {
            match self.incoming.next(Duration::from_millis(50)) {
                Next::Packet(packet) => return Some(packet),
                Next::Nothing => {}
                Next::End => return None,
            }
        }
        None
    }

    /// Packets that came faster than they could be taken.
    pub fn dropped(&self) -> u64 {
        self.incoming.dropped()
    }
}

/// Returns what a signal sets.
#[cfg(unix)]
pub fn stop() -> &'static AtomicBool {
    crate::command::signals::ask_to_stop()
}

/// Returns what nothing sets.
#[cfg(not(unix))]
pub fn stop() -> &'static AtomicBool {
    static NEVER: AtomicBool = AtomicBool::new(false);
    &NEVER
}
