//! What both boards have besides their pins: settings, memory, and the frames on their way to the link.

use embassy_sync::blocking_mutex::raw::ThreadModeRawMutex;
use embassy_sync::pipe::Pipe;
use embassy_time::{Delay, Instant};
use embedded_hal::spi::SpiDevice;
use embedded_io_async::{ErrorType, Read, Write};
use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, buffers};
use scanseg_hal::encoder::as5048a::As5048a;
use scanseg_hal::encoder::{Calibration, Direction, Tilt};
use scanseg_hal::lms2xx::asynch::Port;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Scanner, Settings, Unit, Variant};
use scanseg_hal::rig::{Rig, TiltLimits, beams};
use static_cell::ConstStaticCell;

/// 361 columns, a row every 26.7 ms.
const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
const COLUMNS: usize = SETTINGS.variant.columns() as usize;

/// The default segmenter.
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::SICK_LMS200);
type Buffers = buffers!(COLUMNS, CONFIG);

/// The tilt nods at 0.4 rad/s, give or take a half; a scan ends where it turns back.
const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.2, max_rate_rad_per_s: 0.6, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };

/// Encoder on the tilt axis, zero ahead.
const AHEAD: Calibration = match Calibration::new(0, Direction::Same, 1.0) {
    Ok(calibration) => calibration,
    Err(_) => unreachable!(),
};

/// Segments of fewer pixels are not reported.
const MIN_PIXELS: u32 = 20;

static BUFFERS: ConstStaticCell<Buffers> = ConstStaticCell::new(Buffers::EMPTY);
static ROWS_M: ConstStaticCell<[f32; 2 * COLUMNS]> = ConstStaticCell::new([0.0; 2 * COLUMNS]);

/// Bytes of the queue behind the scanner's port: 10 ms at 500 000 Bd.
pub const QUEUE: usize = 512;

/// Baud rate of the link.
pub const LINK_BAUD: u32 = 1_000_000;

/// Frames for the host that wait for the DMA; a task takes them from here. One for which there is no
/// room is dropped whole, which the host sees by the numbers.
pub static LINK: Pipe<ThreadModeRawMutex, 8192> = Pipe::new();

/// The scanner's port: a buffered UART, and how its baud rate is set, bit/s.
pub struct ScannerPort<U, F> {
    /// Receives by interrupt.
    pub uart: U,
    /// Sets the baud rate.
    pub set_baud: F,
}

impl<U: ErrorType, F> ErrorType for ScannerPort<U, F> {
    type Error = U::Error;
}

impl<U: Read, F> Read for ScannerPort<U, F> {
    async fn read(&mut self, bytes: &mut [u8]) -> Result<usize, U::Error> {
        self.uart.read(bytes).await
    }
}

impl<U: Write, F> Write for ScannerPort<U, F> {
    async fn write(&mut self, bytes: &[u8]) -> Result<usize, U::Error> {
        self.uart.write(bytes).await
    }

    async fn flush(&mut self) -> Result<(), U::Error> {
        self.uart.flush().await
    }
}

impl<U: Read + Write, F: FnMut(&mut U, u32) -> Result<(), U::Error>> Port for ScannerPort<U, F> {
    fn set_baud(&mut self, baud: Baud) -> Result<(), U::Error> {
        (self.set_baud)(&mut self.uart, baud.bits_per_s())
    }
}

/// Finds the scanner, sets it up, and segments what it sends, until its port ends.
pub async fn segment(port: impl Port, encoder: impl SpiDevice) {
    let now_us = || Instant::now().as_micros();
    let mut scanner = Scanner::new(port, now_us, Delay, SETTINGS);
    let tilt = Tilt::new(As5048a::new(encoder), AHEAD);
    let segmenter = PlaneSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, BUFFERS.take().memory());
    let Ok(segmenter) = segmenter else { return };
    let Ok(mut rig) = Rig::new(SETTINGS, LIMITS, segmenter, ROWS_M.take()) else { return };
    let send = |frame: &[u8]| {
        if frame.len() <= LINK.free_capacity() {
            let _ = LINK.try_write(frame);
        }
    };
    crate::run(&mut scanner, tilt, (now_us, Delay), &mut rig, MIN_PIXELS, send).await;
}
