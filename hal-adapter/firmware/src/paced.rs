//! A scanner and an encoder in flash, for figures that repeat to the instruction: the scanner's
//! bytes come by a timer, whether the program is ready for them or not.

use embedded_hal::spi::{ErrorType, Operation, SpiDevice};
use scanseg_hal::lms2xx::Settings;

use crate::figures;
use crate::receive::Input;
use crate::register::Register;
use crate::wire::WireError;

/// All that the scanner sends: telegrams, without the pauses between them.
static STREAM: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/stream.bin"));
/// The encoder's answers, two bytes each.
static ANSWERS: &[u8] = include_bytes!(concat!(env!("OUT_DIR"), "/answers.bin"));

/// Times of a byte after the last one, within which all frames go out.
const AFTER: u32 = 5_000;

// SAFETY: these are registers of the CMSDK timer 1 on the boards AN386 and AN500.
const CONTROL: Register = unsafe { Register::at(0x4000_1000) };
// SAFETY: as above.
const VALUE: Register = unsafe { Register::at(0x4000_1004) };
// SAFETY: as above.
const RELOAD: Register = unsafe { Register::at(0x4000_1008) };
// SAFETY: as above.
const INTERRUPT: Register = unsafe { Register::at(0x4000_100C) };

/// Number of the interrupt of timer 1.
pub const IRQ: usize = 9;

/// The scanner, and the register of its port, which holds one byte.
#[derive(Debug)]
pub struct Tape {
    rest: core::slice::Iter<'static, u8>,
    /// Times of a byte from telegram to telegram, and how many of them have a byte.
    period: u32,
    telegram: u32,
    at: u32,
    after: u32,
    port: Option<u8>,
    deepest: usize,
}

impl Tape {
    /// A scanner with these settings.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let byte_us = settings.baud.line_time_us(1);
        let (period, telegram) = (settings.period_us() / byte_us, settings.telegram_bytes());
        Self { rest: STREAM.iter(), period, telegram, at: 0, after: 0, port: None, deepest: 0 }
    }

    /// Starts the timer: a byte's time is so many of its ticks, 2 or more.
    pub fn start(ticks: u32) {
        figures::start_wall();
        RELOAD.write(ticks - 1);
        VALUE.write(ticks - 1);
        CONTROL.write(1 << 3 | 1);
    }

    /// The timer's interrupt, or one raised by the program. Returns true once, when all is over.
    #[inline(always)]
    pub fn interrupted(&mut self, input: &mut Input<'_>) -> bool {
        let mut overrun = false;
        if INTERRUPT.read() != 0 {
            INTERRUPT.write(1);
            if self.at < self.telegram {
                match self.rest.next() {
                    Some(&byte) => overrun = self.port.replace(byte).is_some(),
                    None => self.after += 1,
                }
            }
            self.at += 1;
            if self.at == self.telegram {
                figures::telegram_came();
            }
            if self.at == self.period {
                self.at = 0;
            }
        }
        if let Some(byte) = self.port {
            let port = &mut self.port;
            figures::count_interrupt(|| {
                input.take(overrun, || {
                    *port = None;
                    byte
                });
            });
            self.deepest = self.deepest.max(input.bytes.len());
        }
        let over = self.after == AFTER;
        if over {
            CONTROL.write(0);
        }
        over
    }

    /// The most bytes that were in the queue.
    #[must_use]
    pub fn deepest(&self) -> u32 {
        self.deepest as u32
    }
}

/// The encoder.
#[derive(Debug)]
pub struct Answers(core::slice::Iter<'static, [u8; 2]>);

impl Answers {
    /// With its first answer to come.
    #[allow(clippy::new_without_default)]
    #[must_use]
    pub fn new() -> Self {
        Self(ANSWERS.as_chunks().0.iter())
    }
}

impl ErrorType for Answers {
    type Error = WireError;
}

impl SpiDevice for Answers {
    /// Only transfers in place, which is what the encoder's driver does.
    fn transaction(&mut self, operations: &mut [Operation<'_, u8>]) -> Result<(), WireError> {
        for operation in operations {
            let Operation::TransferInPlace(bytes) = operation else { return Err(WireError) };
            let answer = self.0.next().ok_or(WireError)?;
            bytes.iter_mut().zip(answer).for_each(|(byte, answer)| *byte = *answer);
        }
        Ok(())
    }
}
