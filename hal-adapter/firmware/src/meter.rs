//! Counts instructions.

use crate::register::Register;

/// A timer that runs only within measured stretches.
pub trait Meter {
    /// A stretch begins.
    fn start(&mut self);
    /// It ends.
    fn stop(&mut self);
    /// Ticks of all stretches.
    fn ticks(&mut self) -> u32;
}

/// CMSDK timer: 25 MHz on the MPS2.
#[derive(Debug)]
pub struct CmsdkTimer {
    control: Register,
    value: Register,
}

impl CmsdkTimer {
    /// The timer at `base`.
    ///
    /// # Safety
    /// There is such a timer, and nothing else uses it.
    pub unsafe fn new(base: usize) -> Self {
        // SAFETY: the registers of the timer that the caller promises.
        let [control, value, reload] =
            [0x00, 0x04, 0x08].map(|offset: usize| unsafe { Register::at(base + offset) });
        reload.write(u32::MAX);
        value.write(u32::MAX);
        Self { control, value }
    }
}

impl Meter for CmsdkTimer {
    fn start(&mut self) {
        self.control.write(1);
    }
    fn stop(&mut self) {
        self.control.write(0);
    }
    fn ticks(&mut self) -> u32 {
        u32::MAX - self.value.read()
    }
}

/// TIMER0 of the nRF51: 16 MHz.
#[derive(Debug)]
pub struct Nrf51Timer {
    start: Register,
    stop: Register,
    capture: Register,
    captured: Register,
}

impl Nrf51Timer {
    /// # Safety
    /// The program runs on an nRF51, and nothing else uses its TIMER0.
    pub unsafe fn new() -> Self {
        // SAFETY: the timer of the nRF51 that the caller promises.
        let register = |offset: usize| unsafe { Register::at(0x4000_8000 + offset) };
        for (offset, value) in [
            (0x504, 0), // MODE: timer
            (0x508, 3), // BITMODE: 32
            (0x510, 0), // PRESCALER: 16 MHz
            (0x00C, 1), // CLEAR
        ] {
            register(offset).write(value);
        }
        Self { start: register(0x000), stop: register(0x004), capture: register(0x040), captured: register(0x540) }
    }
}

impl Meter for Nrf51Timer {
    fn start(&mut self) {
        self.start.write(1);
    }
    fn stop(&mut self) {
        // QEMU counts at the capture, not at the stop
        self.capture.write(1);
        self.stop.write(1);
    }
    fn ticks(&mut self) -> u32 {
        self.captured.read()
    }
}
