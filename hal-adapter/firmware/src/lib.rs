//! What the images for the microcontroller share: approach, serial ports, the loop, figures. See
//! README.md.
//!
//! ```text
//! scanner port -> LMS 2xx telegrams \
//!                                    rig: ranges and turn angle -> segmenter -> frames -> link port
//! encoder port -> AS5048A frames    /
//! ```
//!
//! All but the registers runs on a host as well, where `check` compares.
#![no_std]

pub mod approach;
pub mod asynch;
pub mod figures;
#[cfg(target_os = "none")]
pub mod interrupt;
pub mod mux;
#[cfg(all(machine = "mps2", feature = "figures"))]
pub mod paced;
pub mod receive;
#[cfg(target_os = "none")]
mod register;
pub mod run;
#[cfg(target_os = "none")]
pub mod uart;
pub mod wire;

#[cfg(all(feature = "defmt", target_os = "none"))]
use {cortex_m as _, defmt_rtt as _};

/// A panic would be a bug, and nobody would see it: the image stands still, so that a watchdog can
/// act.
#[cfg(target_os = "none")]
#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    #[cfg(feature = "defmt")]
    defmt::error!("panic");
    loop {
        core::hint::spin_loop();
    }
}
