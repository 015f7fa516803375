//! From encoder positions to turn angles of the scanner.

use super::Encoder;
use crate::Clock;
use crate::pairing::Latch;

/// Which way the angle grows with the encoder's position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Direction {
    /// Angle and position grow together.
    Same,
    /// The angle falls as the position grows.
    Opposite,
}

/// How the encoder sits on the tilt.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Calibration {
    zero_turn: u32,
    rad_per_unit: f32,
}

/// What is wrong with a calibration.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum CalibrationError {
    /// The gear ratio is none that a gear has: 0.001 to 1 000 000.
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
    /// `zero_turn`: the encoder's position, in 2^-32 turns, where the tilt is at 0. `gear`: turns of the encoder for one turn
    /// of the tilt, 0.001 to 1 000 000; 1 for an encoder on the tilt axis.
    ///
    /// # Errors
    /// [`CalibrationError::Gear`].
    pub const fn new(zero_turn: u32, direction: Direction, gear: f32) -> Result<Self, CalibrationError> {
        if !(gear >= 0.001 && gear <= 1e6) {
            return Err(CalibrationError::Gear(gear));
        }
        let rad_per_unit = core::f32::consts::TAU / 4_294_967_296.0 / gear;
        let rad_per_unit = match direction {
            Direction::Same => rad_per_unit,
            Direction::Opposite => -rad_per_unit,
        };
        Ok(Self { zero_turn, rad_per_unit })
    }
}

/// A calibrated encoder: gives the turn angle of the scanner.
///
/// The first reading is taken to lie within half an encoder turn of zero. From then on turns are counted, so that gears and
/// counters work; between two readings the encoder must move by less than half a turn.
#[derive(Debug)]
pub struct Tilt<E> {
    encoder: E,
    calibration: Calibration,
    /// Position at the last reading, from zero, with all turns, in 2^-32 turns.
    total: Option<i64>,
}

impl<E: Encoder> Tilt<E> {
    /// Touches nothing yet.
    pub const fn new(encoder: E, calibration: Calibration) -> Self {
        Self { encoder, calibration, total: None }
    }

    /// The turn angle now.
    ///
    /// # Errors
    /// The encoder's. The count of turns is kept, as long as the next good reading comes within half an encoder turn.
    pub fn read(&mut self, clock: &mut impl Clock) -> Result<Latch, E::Error> {
        let position = self.encoder.read(clock)?;
        let from_zero = position.turn.wrapping_sub(self.calibration.zero_turn);
        let before = self.total.unwrap_or(0);
        let moved = from_zero.wrapping_sub(before as u32) as i32;
        let total = before + i64::from(moved);
        self.total = Some(total);
        Ok(Latch { turn_rad: total as f32 * self.calibration.rad_per_unit, time_us: position.time_us })
    }

    /// Gives the encoder back.
    pub fn release(self) -> E {
        self.encoder
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::encoder::Position;
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
        let mut last = 0.0;
        for quarter in 0..=16u32 {
            last = read(&mut tilt, quarter.wrapping_mul(1 << 30));
            assert!((last - quarter as f32 * PI / 8.0).abs() < 1e-5);
        }
        assert!((last - 2.0 * PI).abs() < 1e-5);
    }

    #[test]
    fn bad_gears() {
        for gear in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert!(Calibration::new(0, Direction::Same, gear).is_err());
        }
    }

    /// One so small, or so large, that the turn angle would overflow, or be 0 times infinity.
    #[test]
    fn gears_that_leave_no_angle() {
        for gear in [f32::MIN_POSITIVE, 1e-40, 1e-9, 1e9, f32::MAX] {
            assert_eq!(Calibration::new(0, Direction::Same, gear), Err(CalibrationError::Gear(gear)));
        }
        for gear in [0.001, 1e6] {
            let calibration = Calibration::new(0, Direction::Same, gear).unwrap();
            let mut tilt = Tilt { encoder: Fake(0), calibration, total: Some(i64::MAX >> 1) };
            assert!(read(&mut tilt, 0).is_finite());
        }
    }
}
