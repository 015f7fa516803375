//! Figures of a run: instructions, stack. Without the feature `figures` there is nothing of it in
//! the image.
//!
//! A timer counts while the program has something to do and stands while it waits for a byte. Under
//! QEMU's `-icount shift=6` an instruction takes 64 ns of its time, so that the figures do not
//! depend on the host, nor on when the bytes come.

mod record;
mod timed;
#[cfg_attr(not(all(feature = "figures", target_os = "none")), path = "no_timer.rs")]
mod timer;

pub use record::{COUNT, EMPTY_WAITS, MAGIC};
pub use timed::Timed;
pub use timer::{begin, now, pause, resume, send};
#[cfg(all(feature = "figures", machine = "mps2"))]
pub use timer::{count_interrupt, in_interrupt, start_wall, telegram_came};
