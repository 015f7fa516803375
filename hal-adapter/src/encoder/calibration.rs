//! From encoder positions to turn angles of the scanner.

use super::position::Encoder;
use crate::clock::Clock;
use crate::latch::Latch;

/// Sense of rotation of the encoder relative to the tilt.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Direction {
    /// The angle rises with the position.
    Same,
    /// The angle falls as the position rises.
    Opposite,
}

/// How the encoder is mounted on the tilt: zero, sense of rotation, gear.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration {
    zero_turn: u32,
    rad_per_unit: f32,
    /// One turn of the tilt, in 2^-32 turns of the encoder.
    tilt_turn: i64,
}

/// Why a calibration is refused.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[non_exhaustive]
pub enum CalibrationError {
    /// The gear ratio is not within 0.001 to 1 000 000.
    Gear(f32),
}

impl core::fmt::Display for CalibrationError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let Self::Gear(gear) = self;
        write!(f, "gear ratio must be from 0.001 to 1000000, is {gear}")
    }
}

impl core::error::Error for CalibrationError {}

impl Calibration {
    /// Returns a calibration. `zero_turn` is the position of the encoder, in 2^-32 turns, at which
    /// the turn angle is 0. `gear` is the number of turns of the encoder for one turn of the tilt,
    /// 0.001 to 1 000 000; 1 for an encoder on the tilt axis.
    ///
    /// # Errors
    /// [`CalibrationError::Gear`].
    pub const fn new(zero_turn: u32, direction: Direction, gear: f32) -> Result<Self, CalibrationError> {
        if !(gear >= 0.001 && gear <= 1e6) {
            return Err(CalibrationError::Gear(gear));
        }
        const ENCODER_TURN: f32 = 4_294_967_296.0;
        let rad_per_unit = core::f32::consts::TAU / ENCODER_TURN / gear;
        let rad_per_unit = match direction {
            Direction::Same => rad_per_unit,
            Direction::Opposite => -rad_per_unit,
        };
        Ok(Self { zero_turn, rad_per_unit, tilt_turn: (ENCODER_TURN * gear) as i64 })
    }
}

/// A calibrated encoder. It gives turn angles of the scanner.
///
/// The first reading is taken to lie within half an encoder turn of the zero. From then on the
/// turns of the encoder are counted, so that it may sit behind a gear. Between two readings it must
/// move by less than half a turn.
#[derive(Debug)]
pub struct Tilt<E> {
    encoder: E,
    calibration: Calibration,
    last: LastPosition,
}

/// The last position of the encoder, from the calibrated zero, in 2^-32 turns of the encoder.
#[derive(Clone, Copy, Debug)]
struct LastPosition {
    /// Within one turn of the encoder.
    encoder: u32,
    /// With the turns counted, at most half a turn of the tilt from 0.
    tilt: i64,
}

impl<E: Encoder> Tilt<E> {
    /// Returns a tilt with this encoder. The encoder is not read yet.
    pub const fn new(encoder: E, calibration: Calibration) -> Self {
        Self { encoder, calibration, last: LastPosition { encoder: 0, tilt: 0 } }
    }

    /// Reads the encoder and returns the turn angle, within -pi to pi.
    ///
    /// # Errors
    /// The encoder's. The count of turns stays right if the encoder moves by less than half a turn
    /// until the next good reading.
    pub fn read(&mut self, clock: &mut impl Clock) -> Result<Latch, E::Error> {
        let position = self.encoder.read(clock)?;
        let Calibration { zero_turn, rad_per_unit, tilt_turn } = self.calibration;
        let encoder = position.turn.wrapping_sub(zero_turn);
        let moved = encoder.wrapping_sub(self.last.encoder) as i32;
        let tilt = around_zero(self.last.tilt.wrapping_add(moved.into()), tilt_turn);
        self.last = LastPosition { encoder, tilt };
        Ok(Latch { turn_rad: tilt as f32 * rad_per_unit, time_us: position.time_us })
    }

    /// Returns the encoder.
    pub fn release(self) -> E {
        self.encoder
    }
}

/// Returns the position reduced by whole turns, at most half a turn from 0.
fn around_zero(mut position: i64, turn: i64) -> i64 {
    // of a gear of 0.001 at most 500 times; a remainder of 64 bits takes a Cortex-M0 1 KB of flash
    let half = turn / 2;
    while position > half {
        position -= turn;
    }
    while position < -half {
        position += turn;
    }
    position
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::position::Position;
    use core::f32::consts::{FRAC_PI_2, PI};

    struct Fake(u32);

    impl Encoder for Fake {
        type Error = ();
        fn read(&mut self, clock: &mut impl Clock) -> Result<Position, ()> {
            Ok(Position { turn: self.0, time_us: clock.now_us() })
        }
    }

    fn read(tilt: &mut Tilt<Fake>, turn: u32) -> f32 {
        tilt.encoder.0 = turn;
        let latch = tilt.read(&mut || 7).unwrap();
        assert_eq!(latch.time_us, 7);
        latch.turn_rad
    }

    #[test]
    fn zero_direction_and_wrap() {
        let zero = 0xF000_0000;
        let mut tilt = Tilt::new(Fake(0), Calibration::new(zero, Direction::Same, 1.0).unwrap());
        assert_eq!(read(&mut tilt, zero), 0.0);
        assert!(
            (read(&mut tilt, zero.wrapping_add(1 << 30)) - FRAC_PI_2).abs() < 1e-6,
            "across the encoder's own zero"
        );
        assert!((read(&mut tilt, zero.wrapping_sub(1 << 29)) + FRAC_PI_2 / 2.0).abs() < 1e-6);
        let mut tilt = Tilt::new(Fake(0), Calibration::new(zero, Direction::Opposite, 1.0).unwrap());
        assert!((read(&mut tilt, zero.wrapping_add(1 << 30)) + FRAC_PI_2).abs() < 1e-6);
    }

    #[test]
    fn gear_counts_turns() {
        let mut tilt = Tilt::new(Fake(0), Calibration::new(0, Direction::Same, 4.0).unwrap());
        // Quarter turns of the encoder, sixteenths of the tilt's.
        for quarter in (0..=20u32).chain((0..20).rev()) {
            let rad = read(&mut tilt, quarter.wrapping_mul(1 << 30));
            let expected = (quarter + 8) % 16;
            assert!((rad - (expected as f32 - 8.0) * PI / 8.0).abs() < 1e-5 || quarter == 8, "{quarter} {rad}");
            assert!(quarter != 8 || (rad.abs() - PI).abs() < 1e-5);
        }
    }

    /// The angle keeps its resolution and stays within pi, however many turns there were and
    /// whatever the gear.
    #[test]
    fn a_million_turns() {
        for gear in [1.0, 7.5, 0.3] {
            let mut tilt = Tilt::new(Fake(0), Calibration::new(0, Direction::Opposite, gear).unwrap());
            let step = 0x5555_5555u32;
            let mut encoder = 0u64;
            for _ in 0..if cfg!(miri) { 300 } else { 3_000_000 } {
                encoder += u64::from(step);
                let rad = read(&mut tilt, encoder as u32);
                assert!(rad.abs() <= PI + 1e-6);
            }
            let turns = encoder as f64 / 4_294_967_296.0 / f64::from(gear);
            let off_rad = (f64::from(read(&mut tilt, encoder as u32)) / f64::from(2.0 * PI) + turns).rem_euclid(1.0);
            let off_rad = (off_rad - (off_rad + 0.5).floor()) * f64::from(2.0 * PI);
            assert!(off_rad.abs() < 1e-6, "{gear}: {off_rad}");
        }
        for gear in [0.001, 1e6] {
            let mut tilt = Tilt::new(Fake(0), Calibration::new(0, Direction::Same, gear).unwrap());
            assert!((0..100u32).all(|at| read(&mut tilt, at.wrapping_mul(0x3333_3333)).is_finite()), "{gear}");
        }
    }

    #[test]
    fn bad_gears() {
        for gear in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Calibration::new(0, Direction::Same, gear).is_err());
        }
    }

    /// Ratios with which the turn angle would overflow or be 0 times infinity.
    #[test]
    fn gears_that_leave_no_angle() {
        for gear in [f32::MIN_POSITIVE, 1e-40, 1e-9, 1e9, f32::MAX] {
            assert_eq!(Calibration::new(0, Direction::Same, gear), Err(CalibrationError::Gear(gear)));
        }
    }
}
