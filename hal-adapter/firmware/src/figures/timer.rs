//! The timer of the machine, and the record that is sent.

use core::sync::atomic::AtomicU32;
use core::sync::atomic::Ordering::Relaxed;

use embedded_io::Write;

use super::record::{COUNT, EMPTY_WAITS, IN_SEGMENTER, IN_SINK, LATENCY, MAGIC, WORST_END, WORST_ROW, add};
use crate::register::Register;

static WAITS: AtomicU32 = AtomicU32::new(0);
static TICKS: AtomicU32 = AtomicU32::new(0);
static EMPTY_TICKS: AtomicU32 = AtomicU32::new(0);

/// Timer 0 of the MPS2 boards: 25 MHz, counts down from 2^32 - 1.
#[cfg(machine = "mps2")]
mod machine {
    use super::Register;

    // SAFETY: these are registers of the CMSDK timer 0 on the boards AN386 and AN500.
    const CONTROL: Register = unsafe { Register::at(0x4000_0000) };
    // SAFETY: as above.
    const VALUE: Register = unsafe { Register::at(0x4000_0004) };
    // SAFETY: as above.
    const RELOAD: Register = unsafe { Register::at(0x4000_0008) };

    pub fn set_up() {
        RELOAD.write(u32::MAX);
        VALUE.write(u32::MAX);
    }

    pub fn start() {
        CONTROL.write(1);
    }

    pub fn runs() -> bool {
        CONTROL.read() != 0
    }

    /// Ticks since the start; those before it are in the timer still.
    pub fn since_start() -> u32 {
        u32::MAX - VALUE.read()
    }

    /// Gives the ticks that the timer will not keep.
    pub fn stop() -> u32 {
        CONTROL.write(0);
        0
    }
}

/// TIMER0 of the nRF51: 16 MHz. QEMU's loses count when it is stopped and started again, so it runs
/// on, and is cleared at each start.
#[cfg(machine = "microbit")]
mod machine {
    use super::Register;

    const fn register(offset: usize) -> Register {
        // SAFETY: used for offsets of the nRF51's TIMER0 only.
        unsafe { Register::at(0x4000_8000 + offset) }
    }
    const START: Register = register(0x000);
    const CLEAR: Register = register(0x00C);
    const CAPTURE_0: Register = register(0x040);
    const BIT_MODE: Register = register(0x508);
    const PRESCALER: Register = register(0x510);
    const CAPTURED_0: Register = register(0x540);

    pub fn set_up() {
        BIT_MODE.write(3); // 32 bits
        PRESCALER.write(0);
        START.write(1);
    }

    pub fn start() {
        CLEAR.write(1);
    }

    pub fn since_start() -> u32 {
        CAPTURE_0.write(1);
        CAPTURED_0.read()
    }

    pub fn stop() -> u32 {
        since_start()
    }
}

/// Starts the timer.
pub fn begin() {
    machine::set_up();
    machine::start();
    for _ in 0..EMPTY_WAITS {
        pause();
        resume();
    }
    let empty = now();
    EMPTY_TICKS.store(empty, Relaxed);
    WAITS.store(0, Relaxed);
}

/// Stops the timer: a wait begins.
#[inline(always)]
pub fn pause() {
    let ticks = machine::stop();
    add(&TICKS, ticks);
    add(&WAITS, 1);
}

/// The wait is over.
#[inline(always)]
pub fn resume() {
    machine::start();
}

/// Does what of an interrupt is not to be counted. Within it, [`count_interrupt`] counts.
#[cfg(machine = "mps2")]
#[inline(always)]
pub fn in_interrupt(work: impl FnOnce()) {
    let runs = machine::runs();
    machine::stop();
    work();
    if runs {
        machine::start();
    }
}

/// Does the work of an interrupt that counts, whether the program waits or not.
#[cfg(machine = "mps2")]
#[inline(always)]
pub fn count_interrupt(work: impl FnOnce()) {
    machine::start();
    work();
    machine::stop();
}

/// Ticks so far.
#[inline(always)]
pub fn now() -> u32 {
    TICKS.load(Relaxed).wrapping_add(machine::since_start())
}

/// A timer that never stands: half of the dual timer on the boards AN386 and AN500.
#[cfg(machine = "mps2")]
mod wall {
    use super::{AtomicU32, Register, Relaxed};

    // SAFETY: a register of the dual timer.
    const VALUE: Register = unsafe { Register::at(0x4000_2004) };
    // SAFETY: as above.
    const CONTROL: Register = unsafe { Register::at(0x4000_2008) };

    /// What it had when the last byte of a telegram came.
    static TELEGRAM: AtomicU32 = AtomicU32::new(0);

    /// Starts it.
    pub fn start_wall() {
        CONTROL.write(1 << 7 | 1 << 1); // on, 32 bits, without an end
    }

    /// Takes note that the last byte of a telegram has come.
    pub fn telegram_came() {
        TELEGRAM.store(VALUE.read(), Relaxed);
    }

    /// Returns the ticks since the last byte of a telegram came.
    pub fn since_telegram() -> u32 {
        // it counts down
        TELEGRAM.load(Relaxed).wrapping_sub(VALUE.read())
    }
}
#[cfg(machine = "mps2")]
pub use wall::{since_telegram, start_wall, telegram_came};

/// Ticks since the last byte of a telegram came: not measured where the port is polled.
#[cfg(not(machine = "mps2"))]
pub fn since_telegram() -> u32 {
    0
}

/// Sends the record, see [`COUNT`], with what it has of the queue.
pub fn send(mut link: impl Write, [deepest, overruns, queue_full]: [u32; 3]) {
    let ticks = now() - EMPTY_TICKS.load(Relaxed);
    let (used, there_are) = stack();
    let [segmenter, sink, waits, empty, row, end, latency] =
        [&IN_SEGMENTER, &IN_SINK, &WAITS, &EMPTY_TICKS, &WORST_ROW, &WORST_END, &LATENCY]
            .map(|word| word.load(Relaxed));
    let words: [u32; COUNT] =
        [ticks, segmenter, sink, waits, empty, used, there_are, deepest, overruns, queue_full, row, end, latency];
    for word in [MAGIC].into_iter().chain(words) {
        let _ = link.write_all(&word.to_le_bytes());
    }
}

/// Bytes of stack that have ever been written, and bytes there are. cortex-m-rt has painted them
/// before the program began.
fn stack() -> (u32, u32) {
    unsafe extern "C" {
        static _stack_end: u32;
        static _stack_start: u32;
    }
    let (low, high) = (&raw const _stack_end, &raw const _stack_start);
    let mut untouched = low;
    // SAFETY: words of RAM between the two symbols of the linker script; the ones read here lie
    // below all that is in use.
    while untouched < high && unsafe { untouched.read_volatile() } == cortex_m_rt::STACK_PAINT_VALUE {
        untouched = untouched.wrapping_add(1);
    }
    ((high as usize - untouched as usize) as u32, (high as usize - low as usize) as u32)
}
