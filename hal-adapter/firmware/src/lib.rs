//! What the images share.
#![no_std]

pub mod chain;
pub mod meter;
pub mod mux;
mod register;
pub mod uart;
pub mod wire;

/// A panic would be a bug; there is nobody to tell.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}
