//! A rig on an async port: bytes of a scanner and counts of an angle encoder in, planar segments
//! out. As `rig_blocking`, but the wait for bytes can be shared with other tasks.

mod common;

use std::convert::Infallible;

use common::{COLUMNS, COUNTS_PER_TURN, LIMITS, Print, Recording, SETTINGS};
use embedded_hal_async::delay::DelayNs;
use embedded_io_async::{ErrorType, Read, Write};
use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, buffers};
use scanseg_hal::encoder::{Calibration, Direction, Tilt, quadrature::Quadrature};
use scanseg_hal::lms2xx::{Baud, Error, Scanner, asynch::Port};
use scanseg_hal::rig::{Rig, beams};

const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));

/// On a board: its buffered UART.
struct Uart<'a>(&'a Recording);

impl ErrorType for Uart<'_> {
    type Error = Infallible;
}

impl Read for Uart<'_> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, Infallible> {
        Ok(self.0.read(bytes))
    }
}

impl Write for Uart<'_> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        Ok(bytes.len())
    }

    async fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

impl Port for Uart<'_> {
    fn set_baud(&mut self, _: Baud) -> Result<(), Infallible> {
        Ok(())
    }
}

/// On a board: that of its executor's timer.
struct NoDelay;

impl DelayNs for NoDelay {
    async fn delay_ns(&mut self, _: u32) {}
}

async fn run() -> Result<(), Box<dyn std::error::Error>> {
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
        let event = match scanner.next_event_async().await {
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

fn main() -> Result<(), Box<dyn std::error::Error>> {
    pollster::block_on(run())
}
