//! The clock of the shells and of the angle encoders.

/// A clock, read by the scanner on its port and by the angle encoders.
pub trait Clock {
    /// Returns the time in microseconds since an arbitrary moment. It never falls.
    fn now_us(&mut self) -> u64;
}

impl<F: FnMut() -> u64> Clock for F {
    fn now_us(&mut self) -> u64 {
        self()
    }
}
