//! What both examples share: bytes of a scanner that tilts in a room, and a sink that prints.

use std::cell::Cell;
use std::ops::ControlFlow;

use scanseg_core::{LabelRow, Segment, Sink};
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, SCAN_LINE, Settings, Unit, Variant};
use scanseg_hal::rig::{RigSink, ScanFinished, ScanStarted, TiltLimits};

/// A scan line per mirror turn, in steps of 1 degree.
pub const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
pub const COLUMNS: usize = SETTINGS.variant.columns() as usize;

/// The tilt turns at 0.8 rad/s; a scan ends when no row has come for 0.1 s.
pub const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.4, max_rate_rad_per_s: 1.2, sweep_rad: f32::INFINITY, pause_us: 100_000 };

/// Counts of the quadrature encoder for one turn of the tilt.
pub const COUNTS_PER_TURN: u32 = 40_000;

const ROWS: u64 = 120;
const FIRST_TURN_RAD: f32 = -0.6;
const TURN_RAD_PER_US: f32 = 0.8e-6;
const PERIOD_US: u64 = SETTINGS.period_us() as u64;

/// The bytes of the scanner, and the time and the tilt at the last byte read.
pub struct Recording {
    bytes: Vec<u8>,
    read: Cell<usize>,
}

impl Recording {
    pub fn new() -> Self {
        Self { bytes: (0..ROWS).flat_map(telegram).collect(), read: Cell::new(0) }
    }

    /// Reads the next bytes; 0 at the end.
    pub fn read(&self, to: &mut [u8]) -> usize {
        let rest = &self.bytes[self.read.get()..];
        let count = rest.len().min(to.len());
        to[..count].copy_from_slice(&rest[..count]);
        self.read.set(self.read.get() + count);
        count
    }

    /// Time of the last byte read, microseconds.
    pub fn now_us(&self) -> u64 {
        let telegram_bytes = SETTINGS.telegram_bytes() as usize;
        let (telegrams, bytes) = (self.read.get() / telegram_bytes, self.read.get() % telegram_bytes);
        telegrams as u64 * PERIOD_US + u64::from(SETTINGS.baud.line_time_us(bytes as u32))
    }

    /// Count of the encoder at that time.
    pub fn count(&self) -> i32 {
        (turn_rad(self.now_us() as f32) / std::f32::consts::TAU * COUNTS_PER_TURN as f32) as i32
    }
}

fn turn_rad(time_us: f32) -> f32 {
    FIRST_TURN_RAD + TURN_RAD_PER_US * time_us
}

/// The telegram of a row. Its beams were measured during the half mirror turn before its start
/// byte.
fn telegram(row: u64) -> Vec<u8> {
    let row_rad = turn_rad((row * PERIOD_US) as f32 - 0.25 * PERIOD_US as f32);
    let mut bytes = vec![0x02, 0x80];
    bytes.extend((2 * COLUMNS as u16 + 4).to_le_bytes());
    bytes.push(SCAN_LINE);
    bytes.extend((COLUMNS as u16 | u16::from(SETTINGS.unit.code()) << 14).to_le_bytes());
    for column in 0..COLUMNS {
        let beam_rad = (column as f32 - 90.0).to_radians();
        bytes.extend(((range_m(beam_rad, row_rad) * 1000.0) as u16).to_le_bytes());
    }
    bytes.push(0x10); // status: no fault
    bytes.extend(check_word(&bytes).to_le_bytes());
    bytes
}

/// Range within a room that stands at 0.3 rad to the scanner: four walls, floor and ceiling.
fn range_m(beam_rad: f32, turn_rad: f32) -> f32 {
    let [x, y, z] = [beam_rad.cos() * turn_rad.cos(), beam_rad.sin(), beam_rad.cos() * turn_rad.sin()];
    let (sin, cos) = 0.3f32.sin_cos();
    let [x, y] = [cos * x + sin * y, cos * y - sin * x];
    [x / 4.0, -x / 3.0, y / 3.0, -y / 2.5, z / 1.6, -z / 0.8].into_iter().fold(0.0, f32::max).recip()
}

/// Prints the segments.
pub struct Print;

impl Sink for Print {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if let Some(plane) = segment.plane() {
            let [x, y, z] = plane.normal;
            println!(
                "segment {}: {} pixels, normal ({x:.3}, {y:.3}, {z:.3}), {:.3} m away",
                segment.label.0,
                segment.pixels(),
                plane.distance_m
            );
        }
        ControlFlow::Continue(())
    }
}

impl RigSink for Print {
    fn scan_started(&mut self, scan: &ScanStarted) {
        println!("scan {} of {} columns, from {:.3} rad", scan.number, scan.columns, scan.turn_rad);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        println!("scan {} finished: {} rows", scan.number, scan.rows);
    }
}
