//! The loop of the images: bytes of the scanner and angles of the encoder to the rig, frames to the
//! link.

use embedded_hal::spi::SpiDevice;
use embedded_io::{Read, ReadExactError, Write};
use scanseg_core::Segmenter;
use scanseg_hal::encoder::as5048a::As5048a;
use scanseg_hal::encoder::{Calibration, Direction, Tilt};
use scanseg_hal::link::Reporter;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Session, Settings, Unit, Variant};
use scanseg_hal::rig::{LmsRows, Rig, TiltLimits};

use crate::figures::Timed;

/// A scanner on 500 000 Bd, in the measuring mode of the recorded scan.
const fn settings(variant: Variant) -> Settings {
    Settings {
        baud: Baud::B500000,
        variant,
        unit: Unit::Millimetre,
        mode: MeasuringMode::Range32Field,
        interlaced: false,
    }
}

/// The scanner of the image `mps2`: 361 columns.
pub const MPS2: Settings = settings(Variant::Deg180Step05);

/// The scanner of the image `microbit`: 181 columns.
pub const MICROBIT: Settings = settings(Variant::Deg180Step1);

/// How far the tilt turns from one telegram to the next, radians: that of the recorded scan.
pub const ROW_RAD: f32 = 0.516_889 * core::f32::consts::PI / 180.0;

/// Segments of fewer pixels are not reported: they are noise, and each plane costs some 20 000
/// instructions.
pub const MIN_PIXELS: u32 = 20;

/// Bytes of the scanner that are taken together: 0.64 ms at 500 000 Bd. The last of a telegram are
/// fewer, so that it does not wait for the next one.
pub const PIECE: usize = 32;

/// A piece that asks for the figures; no scanner sends it.
pub const ASK_FOR_FIGURES: [u8; PIECE] = [0xFF; PIECE];

/// How the tilt moves: [`ROW_RAD`] per telegram, give or take a third, for the encoder's steps and
/// an uneven servo.
pub fn limits(settings: &Settings) -> TiltLimits {
    let rate_rad_per_s = ROW_RAD * 1e6 / settings.period_us() as f32;
    TiltLimits {
        min_rate_rad_per_s: 0.67 * rate_rad_per_s,
        max_rate_rad_per_s: 1.33 * rate_rad_per_s,
        sweep_rad: f32::INFINITY,
        pause_us: 4 * settings.period_us(),
    }
}

/// Time by the bytes received. A simulated port knows no rate: its bytes come as fast as they are
/// fetched. So a byte counts as come when a scanner would have sent it: telegram after telegram at
/// the scanner's period, within it byte after byte at the line's rate. A board with a real line has
/// a timer for this.
#[derive(Clone, Debug)]
pub struct LineClock {
    period_us: u32,
    byte_us: u32,
    telegram_bytes: u32,
    telegram_us: u64,
    byte: u32,
}

impl LineClock {
    /// At 0, with a scanner so set up.
    #[must_use]
    pub fn new(settings: &Settings) -> Self {
        let telegram_bytes = settings.telegram_bytes();
        let (period_us, byte_us) = (settings.period_us(), settings.baud.line_time_us(1));
        Self { period_us, byte_us, telegram_bytes, telegram_us: 0, byte: 0 }
    }

    /// More bytes have come.
    pub fn received(&mut self, bytes: u32) {
        self.byte += bytes;
        while self.byte >= self.telegram_bytes {
            self.byte -= self.telegram_bytes;
            self.telegram_us += u64::from(self.period_us);
        }
    }

    /// Bytes of the telegram under way that have come, and those that have not.
    #[must_use]
    pub fn telegram(&self) -> (u32, u32) {
        (self.byte, self.telegram_bytes - self.byte)
    }

    /// When the last byte came, microseconds.
    #[must_use]
    pub fn now_us(&self) -> u64 {
        self.telegram_us + u64::from(self.byte * self.byte_us)
    }
}

/// What is connected.
#[derive(Debug)]
pub struct Ports<R, D, W> {
    /// Bytes of the scanner, which was set up and started before.
    pub scanner: R,
    /// The AS5048A on the tilt axis. It says 0 where the scanner looks ahead, and grows as it looks
    /// up.
    pub encoder: D,
    /// To the host.
    pub link: W,
}

/// Runs until the scanner's port ends, which on a board is never. `lost` returns the bytes that the
/// port has lost by late interrupts and by a full queue. `ask` is called where
/// [`ASK_FOR_FIGURES`] comes.
pub fn run<R: Read, W: Write, K: LmsRows>(
    ports: Ports<R, impl SpiDevice, W>,
    settings: &Settings,
    session: &mut Session,
    rig: &mut Rig<'_, Timed<impl Segmenter>, K>,
    lost: impl Fn() -> (u32, u32),
    mut ask: impl FnMut(),
) -> ReadExactError<R::Error> {
    let Ports { mut scanner, encoder, mut link } = ports;
    let mut tilt = Tilt::new(As5048a::new(encoder), AHEAD);
    let mut clock = LineClock::new(settings);
    let mut reporter = Timed(Reporter::new(MIN_PIXELS, |frame| {
        let _ = link.write_all(frame);
    }));
    #[cfg(feature = "defmt")]
    let mut scans = 0;
    let mut piece = [0; PIECE];
    let mut lost_before = 0;
    loop {
        let (come, to_come) = clock.telegram();
        let piece = piece.get_mut(..PIECE.min(to_come as usize)).unwrap_or(&mut []);
        if let Err(end) = scanner.read_exact(piece) {
            return end;
        }
        clock.received(piece.len() as u32);
        if come == 0 {
            rig.tilt(tilt.read(&mut || clock.now_us()).ok());
        }
        let (overruns, queue_full) = lost();
        rig.port_lost(overruns, queue_full);
        // they took their time
        let lost_now = overruns.wrapping_add(queue_full);
        clock.received(lost_now.wrapping_sub(lost_before));
        lost_before = lost_now;
        rig.receive(session, piece, clock.now_us(), &mut reporter);
        rig.idle(clock.now_us(), &mut reporter);
        if *piece == ASK_FOR_FIGURES {
            ask();
        }
        #[cfg(feature = "defmt")]
        if rig.counters().scans != scans {
            scans = rig.counters().scans;
            defmt::info!("{}", rig.counters());
        }
    }
}

/// Encoder on the tilt axis, zero ahead.
pub const AHEAD: Calibration = match Calibration::new(0, Direction::Same, 1.0) {
    Ok(calibration) => calibration,
    Err(_) => unreachable!(),
};
