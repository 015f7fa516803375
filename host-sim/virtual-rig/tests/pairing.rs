//! What the turn angle of each beam buys on a moving tilt: a virtual scanner on a tilt looks at a
//! floor, and the points are put together again from telegrams and latches alone.

use scanseg_hal::Latch;
use scanseg_hal::lms2xx::command::Command;
use scanseg_hal::lms2xx::{Baud, Event, MeasuringMode, Reading, Settings, TelegramDecoder, Unit, Variant};
use scanseg_hal::pairing::{BeamAges, Pairing};
use scanseg_virtual_rig::{Beam, VirtualLms};

/// The floor lies so far below the tilt axis.
const FLOOR_M: f64 = 1.0;
const FARTHEST_M: f64 = 6.0;

/// How far from the truth, root mean square over all beams, and at most: turn angles (mrad), and
/// points from the floor (mm).
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    turn_mrad: f64,
    worst_mrad: f64,
    floor_mm: f64,
    worst_mm: f64,
}

impl Errors {
    fn add(&mut self, turn_error_rad: f64, floor_error_m: f64) {
        self.turn_mrad += (1e3 * turn_error_rad).powi(2);
        self.worst_mrad = self.worst_mrad.max(1e3 * turn_error_rad.abs());
        self.floor_mm += (1e3 * floor_error_m).powi(2);
        self.worst_mm = self.worst_mm.max(1e3 * floor_error_m.abs());
    }

    fn over(mut self, count: u32) -> Self {
        self.turn_mrad = (self.turn_mrad / f64::from(count)).sqrt();
        self.floor_mm = (self.floor_mm / f64::from(count)).sqrt();
        self
    }
}

/// The tilt as the encoder says at the start byte; one turn angle for the row; one for each beam.
#[derive(Debug)]
struct Compared {
    latched: Errors,
    row: Errors,
    beam: Errors,
    beams: u32,
}

/// Direction of a beam: bearing from the right edge, turn angle downwards from level.
fn direction(bearing_deg: f64, view_deg: f64, turn_rad: f64) -> [f64; 3] {
    let bearing = (bearing_deg - view_deg / 2.0).to_radians();
    [bearing.cos() * turn_rad.cos(), bearing.sin(), -bearing.cos() * turn_rad.sin()]
}

fn compare(variant: Variant, interlaced: bool, tilt: fn(f64) -> f64) -> Compared {
    let view_deg = f64::from(variant.view_deg());
    // What the scanner sees: the floor, in millimetres, at the turn angle that holds when the beam
    // is measured.
    let ranges = move |beam: Beam| {
        let down = -direction(beam.bearing_deg, view_deg, tilt(beam.time_us))[2];
        let range_m = FLOOR_M / down;
        if down > 0.0 && range_m < FARTHEST_M { (range_m * 1000.0).round() as u16 } else { 8191 }
    };
    let settings = Settings {
        baud: Baud::B500000,
        variant,
        unit: Unit::Centimetre,
        mode: MeasuringMode::Range8Fields,
        interlaced,
    };
    let mut lms = VirtualLms::new(ranges).running(Baud::B500000, variant);
    if interlaced {
        let mut now_us = 1000;
        for byte in Command::StartInterlaced.encode().as_slice() {
            now_us = lms.write(now_us, &[*byte], Baud::B500000) + 60;
        }
    }
    let (mut decoder, mut pairing) = (TelegramDecoder::new(), Pairing::new(&settings));
    let (mut latched, mut row, mut beam) = (Errors::default(), Errors::default(), Errors::default());
    let mut beams = 0;
    let (mut latch_rad, mut start_us) = (0.0, 0);
    let step_us = 20;
    for now_us in (0..4_000_000u64).step_by(step_us) {
        let bytes = lms.read(now_us, Baud::B500000);
        let mut rest = &bytes[..];
        loop {
            let fed = decoder.feed(rest);
            rest = &rest[fed.used..];
            match fed.event {
                Event::NeedMore => break,
                Event::Start { .. } => {
                    // The encoder is read 100 us after the start byte, to 14 bits.
                    start_us = now_us;
                    let exact = tilt((now_us + 100) as f64);
                    let bits = std::f64::consts::TAU / 16384.0;
                    latch_rad = (exact / bits).round() * bits;
                    pairing.sample(Latch { turn_rad: latch_rad as f32, time_us: now_us + 100 });
                    pairing.start(now_us);
                }
                Event::Telegram { .. } => {
                    let Some(scan) = decoder.telegram().and_then(|telegram| telegram.scan_line()) else { continue };
                    let Some(turns) = pairing.row(BeamAges::of(&scan, variant)) else { continue };
                    let step_deg = if interlaced { 1.0 } else { f64::from(variant.step_cdeg()) / 100.0 };
                    let first_deg = f64::from(scan.partial_quarter().unwrap_or(0)) / 4.0;
                    for (column, measured) in (0u16..).zip(scan.beams(MeasuringMode::Range8Fields)) {
                        // The scene counts millimetres, whatever unit the scanner believes in.
                        let Reading::Range(mm) = measured.reading else { continue };
                        let range_m = f64::from(mm) / 1000.0;
                        let bearing_deg = first_deg + f64::from(column) * step_deg;
                        // When it was really measured, from the definition of the sweep and not
                        // from the code under test.
                        let turns_ago = if interlaced {
                            0.0
                        } else {
                            f64::from(variant.mirror_turns() - 1 - column % variant.mirror_turns())
                        };
                        let age_us = (turns_ago + (view_deg - bearing_deg) / 360.0) * 40_000.0 / 3.0;
                        let truth_rad = tilt(start_us as f64 - age_us);
                        for (errors, turn_rad) in [
                            (&mut latched, latch_rad),
                            (&mut row, f64::from(turns.turn_rad())),
                            (&mut beam, f64::from(turns.beam_turn_rad(column))),
                        ] {
                            let height_m = range_m * direction(bearing_deg, view_deg, turn_rad)[2];
                            errors.add(turn_rad - truth_rad, height_m + FLOOR_M);
                        }
                        beams += 1;
                    }
                }
                _ => {}
            }
        }
    }
    Compared { latched: latched.over(beams), row: row.over(beams), beam: beam.over(beams), beams }
}

/// 0.5 rad/s, between 10 and 70 degrees down, back and forth.
fn steady(time_us: f64) -> f64 {
    let phase = (time_us / 1e6 * 0.5).rem_euclid(2.0);
    0.2 + if phase < 1.0 { phase } else { 2.0 - phase }
}

/// A nod of the same span in 4 s: at most 0.79 rad/s.
fn nod(time_us: f64) -> f64 {
    0.7 - 0.5 * (time_us / 4e6 * std::f64::consts::TAU).cos()
}

/// The figures that the documentation of `pairing` states.
#[test]
fn complete_scan_of_two_turns() {
    for (tilt, latched_mm, row_mm, beam_mm) in [(steady as fn(f64) -> f64, 10.1, 5.6, 0.21), (nod, 10.9, 6.1, 0.26)] {
        let found = compare(Variant::Deg180Step05, false, tilt);
        println!("{found:#?}");
        assert!(found.beams > 30_000);
        assert!((found.latched.floor_mm - latched_mm).abs() < 0.06);
        assert!((found.row.floor_mm - row_mm).abs() < 0.06);
        assert!((found.beam.floor_mm - beam_mm).abs() < 0.006);
        assert!(found.latched.worst_mm > 30.0 && found.row.worst_mm > 14.0 && found.beam.worst_mm < 1.1);
        assert!(found.latched.worst_mrad > 10.0 && found.row.worst_mrad > 4.9 && found.beam.worst_mrad < 0.25);
        assert!(found.latched.turn_mrad > found.row.turn_mrad && found.row.turn_mrad > 20.0 * found.beam.turn_mrad);
    }
}

/// Each mirror turn on its own: only the sweep and the time since it are left to correct.
#[test]
fn interlaced_turns() {
    let found = compare(Variant::Deg180Step05, true, steady);
    println!("{found:#?}");
    assert!(found.beams > 30_000);
    assert!((found.latched.floor_mm - 3.0).abs() < 0.06);
    assert!((found.row.floor_mm - 1.1).abs() < 0.06);
    assert!((found.beam.floor_mm - 0.20).abs() < 0.006);
    assert!(found.latched.turn_mrad > found.row.turn_mrad && found.row.turn_mrad > 5.0 * found.beam.turn_mrad);
}
