//! The interrupt controller of a Cortex-M.

use core::cell::UnsafeCell;
use core::mem::MaybeUninit;

use crate::register::Register;

// SAFETY: every Cortex-M has these registers, for interrupts 0 to 31.
const ENABLE: Register = unsafe { Register::at(0xE000_E100) };
// SAFETY: as above.
const PEND: Register = unsafe { Register::at(0xE000_E200) };

/// Enables an interrupt, below 32, whose handler is in place.
pub fn enable(irq: usize) {
    ENABLE.write(1 << irq);
}

/// Raises an interrupt, below 32, as if its device had.
pub fn raise(irq: usize) {
    PEND.write(1 << irq);
}

/// What the handler of one interrupt has to itself.
#[allow(missing_debug_implementations)] // not to be looked at by others
pub struct Own<T>(UnsafeCell<MaybeUninit<T>>);

// SAFETY: `put` and `get` are promised that only one context uses it at a time.
unsafe impl<T> Sync for Own<T> {}

impl<T> Own<T> {
    /// Nothing yet.
    #[allow(clippy::new_without_default)] // for a static
    #[must_use]
    pub const fn new() -> Self {
        Self(UnsafeCell::new(MaybeUninit::uninit()))
    }

    /// Gives it what it is to have.
    ///
    /// # Safety
    /// The interrupt is not enabled yet.
    pub unsafe fn put(&self, own: T) {
        // SAFETY: the handler does not run yet, and nothing else uses it.
        unsafe { (*self.0.get()).write(own) };
    }

    /// Returns what the handler has.
    ///
    /// # Safety
    /// Called once in the handler, which does not interrupt itself, after `put`.
    #[allow(clippy::mut_from_ref)]
    pub unsafe fn get(&self) -> &mut T {
        // SAFETY: as promised, it has been written and this is the only reference.
        unsafe { (*self.0.get()).assume_init_mut() }
    }
}
