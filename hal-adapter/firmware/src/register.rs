//! A register of a peripheral.

/// A 32-bit register at a fixed address.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Register(*mut u32);

// SAFETY: an address is the same wherever it is used.
unsafe impl Send for Register {}

impl Register {
    /// # Safety
    /// There is a register at `address` on every machine that runs this, and reading or writing it
    /// does nothing to memory.
    pub const unsafe fn at(address: usize) -> Self {
        Self(address as *mut u32)
    }

    pub fn read(&self) -> u32 {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.read_volatile() }
    }

    pub fn write(&self, value: u32) {
        // SAFETY: `at` was promised a register.
        unsafe { self.0.write_volatile(value) }
    }
}
