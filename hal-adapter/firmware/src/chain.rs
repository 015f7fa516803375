//! Temporary: the chain until `scanseg_hal::rig` is there.

use core::convert::Infallible;
use core::ops::ControlFlow;

use embedded_hal::spi::SpiDevice;
use embedded_io::{Read, Write};
use scanseg_core::{EdgeSegmenter, Join, LabelRow, Segment, Sink};
use scanseg_hal::encoder::{Calibration, Direction, Tilt, as5048a::As5048a};
use scanseg_hal::lms2xx::{Decoder, Event, MeasuringMode, Variant};
use scanseg_hal::pairing::{Pairing, Sweep};

use crate::meter::Meter;

/// Mixes all events.
pub struct Hash(pub u32);
impl Hash {
    fn mix(&mut self, value: u32) {
        self.0 = (self.0 ^ value).wrapping_mul(16_777_619).rotate_left(5);
    }
}
impl Sink for Hash {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        for (run, label) in row.runs() {
            self.mix(run.start as u32);
            self.mix(run.end as u32);
            self.mix(label.map_or(0, |l| l.0));
        }
        ControlFlow::Continue(())
    }
    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.mix(join.from.0);
        self.mix(join.into.0);
        ControlFlow::Continue(())
    }
    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.mix(segment.pixels());
        if let Some(plane) = segment.plane() {
            for n in plane.normal {
                self.mix(n.to_bits());
            }
        }
        ControlFlow::Continue(())
    }
}

/// Runs.
pub fn run<const N: usize>(
    mut scanner: impl Read<Error = Infallible>,
    encoder: impl SpiDevice<Error = Infallible>,
    mut link: impl Write<Error = Infallible>,
    mut segmenter: EdgeSegmenter<'_>,
    decoder: &mut Decoder,
    row_m: &mut [f32; N],
    variant: Variant,
    rows: u32,
    mut meter: impl Meter,
) -> ! {
    let mut pairing = Pairing::new();
    let Ok(calibration) = Calibration::new(0, Direction::Same, 1.0) else { loop {} };
    let mut tilt = Tilt::new(As5048a::new(encoder), calibration);
    let mut hash = Hash(0);
    let mut time_us = 0u64;
    let mut seen = 0;
    loop {
        let mut piece = [0; 61];
        let _ = scanner.read_exact(&mut piece);
        time_us += 20 * 61;
        meter.start();
        let mut bytes = &piece[..];
        loop {
            let fed = decoder.feed(bytes);
            bytes = &bytes[fed.used..];
            match fed.event {
                Event::NeedMore => break,
                Event::Start { .. } => {
                    meter.stop();
                    let latch = tilt.read(&mut || time_us).ok();
                    meter.start();
                    pairing.start(time_us, latch);
                }
                Event::Telegram { .. } => {
                    let Some(scan) = decoder.telegram().and_then(|t| t.scan()) else { continue };
                    seen += 1;
                    if let Some(turns) = pairing.row(Sweep::of(&scan, variant)) {
                        for (to, beam) in row_m.iter_mut().zip(scan.beams(MeasuringMode::Range32Field)) {
                            *to = beam.range_mm(scan.unit()).map_or(0.0, |mm| mm as f32 * 0.001);
                        }
                        let _ = segmenter.push_row(row_m, turns.turn_rad(), &mut hash);
                    }
                    if seen == rows {
                        segmenter.finish(&mut hash);
                        meter.stop();
                        let _ = link.write(&hash.0.to_le_bytes());
                        let _ = link.write(&meter.ticks().to_le_bytes());
                        loop {}
                    }
                }
                _ => {}
            }
        }
        meter.stop();
    }
}
