//! A rig on a blocking port: bytes of a scanner and counts of an angle encoder in, planar segments
//! out.

mod common;

use std::convert::Infallible;

use common::{COLUMNS, COUNTS_PER_TURN, LIMITS, Print, Recording, SETTINGS};
use embedded_hal::delay::DelayNs;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, buffers};
use scanseg_hal::encoder::{Calibration, Direction, Tilt, quadrature::Quadrature};
use scanseg_hal::lms2xx::{Baud, Error, Scanner, blocking::Port};
use scanseg_hal::rig::{Rig, beams};

const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));

/// On a board: its UART.
struct Uart<'a>(&'a Recording);

impl ErrorType for Uart<'_> {
    type Error = Infallible;
}

impl Read for Uart<'_> {
    fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        Ok(self.0.read(bytes))
    }
}

impl ReadReady for Uart<'_> {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(true)
    }
}

impl Write for Uart<'_> {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl Port for Uart<'_> {
    fn set_baud(&mut self, _: Baud) -> Result<(), Infallible> {
        Ok(())
    }
}

/// On a board: that of its HAL.
struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let recording = Recording::new();
    let mut clock = || recording.now_us();
    // the scanner of a recording takes no commands; a real one is set up and started by
    // `Scanner::new`
    let mut scanner = Scanner::listening(Uart(&recording), clock, NoDelay, SETTINGS);
    let encoder = Quadrature::new(|| recording.count(), COUNTS_PER_TURN);
    let mut tilt = Tilt::new(encoder, Calibration::new(0, Direction::Same, 1.0)?);

    // on a board: statics
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut rows_m = [0.0; 2 * COLUMNS];
    let segmenter = PlaneSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, buffers.memory())?;
    let mut rig = Rig::new(SETTINGS, LIMITS, segmenter, &mut rows_m)?;
    loop {
        let event = match scanner.next_event() {
            Ok(event) => event,
            Err(Error::Ended) => break,
            Err(error) => return Err(error.into()),
        };
        rig.tilt(tilt.read(&mut clock).ok());
        rig.handle(event, scanner.scan_line(), &mut Print);
        rig.idle(recording.now_us(), &mut Print);
    }
    rig.finish(&mut Print);
    println!("{:?}", rig.counters());
    Ok(())
}
