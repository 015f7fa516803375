//! What encoders say, on a bus that says anything; quadrature, calibration, and the turn angle of
//! rows.
#![no_main]

use arbitrary::Arbitrary;
use embedded_hal::{i2c, spi};
use libfuzzer_sys::fuzz_target;
use scanseg_hal::encoder::as5048a::{As5048a, Error as SpiError, answer};
use scanseg_hal::encoder::as5600::{As5600, Error as I2cError, raw_angle};
use scanseg_hal::encoder::quadrature::{EdgeCounter, Quadrature, turn};
use scanseg_hal::encoder::{Calibration, Direction, Encoder, Tilt};
use std::collections::VecDeque;

#[derive(Debug, Arbitrary)]
struct Input {
    zero_turn: u32,
    opposite: bool,
    gear: Gear,
    words: Vec<Option<u16>>,
    counts: Vec<i32>,
    counts_per_turn: u32,
    edges: Vec<(bool, bool)>,
}

#[derive(Debug, Arbitrary)]
enum Gear {
    One,
    Bits(f32),
}

/// A bus that answers with these words, and fails where there is none.
#[derive(Debug)]
struct Bus(VecDeque<Option<u16>>);

#[derive(Debug, PartialEq)]
struct BusError;

impl Bus {
    fn answer(&mut self) -> Result<[u8; 2], BusError> {
        self.0.pop_front().flatten().map(u16::to_be_bytes).ok_or(BusError)
    }
}

impl spi::Error for BusError {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl spi::ErrorType for Bus {
    type Error = BusError;
}

impl spi::SpiDevice for Bus {
    fn transaction(&mut self, operations: &mut [spi::Operation<'_, u8>]) -> Result<(), BusError> {
        let [spi::Operation::TransferInPlace(bytes)] = operations else { panic!("one frame at a time") };
        assert!(u16::from_be_bytes([bytes[0], bytes[1]]).count_ones().is_multiple_of(2), "a command of even parity");
        bytes.copy_from_slice(&self.answer()?);
        Ok(())
    }
}

impl i2c::Error for BusError {
    fn kind(&self) -> i2c::ErrorKind {
        i2c::ErrorKind::Other
    }
}

impl i2c::ErrorType for Bus {
    type Error = BusError;
}

impl i2c::I2c for Bus {
    fn transaction(&mut self, address: u8, operations: &mut [i2c::Operation<'_>]) -> Result<(), BusError> {
        assert_eq!(address, 0x36);
        let [i2c::Operation::Write([0x0B | 0x0C]), i2c::Operation::Read(bytes)] = operations else {
            panic!("a register")
        };
        let answer = self.answer()?;
        bytes.copy_from_slice(&answer[..bytes.len()]);
        Ok(())
    }
}

fuzz_target!(|input: Input| {
    let Input { zero_turn, opposite, gear, words, counts, counts_per_turn, edges } = input;
    let gear = match gear {
        Gear::One => 1.0,
        Gear::Bits(gear) => gear,
    };
    let direction = if opposite { Direction::Opposite } else { Direction::Same };
    let Ok(calibration) = Calibration::new(zero_turn, direction, gear) else { return };
    let words: VecDeque<_> = words.into();
    let all = words.len();

    let mut encoder = As5048a::new(Bus(words.clone()));
    for _ in 0..all {
        let next: Vec<_> = encoder_words(&mut encoder, 2);
        match (encoder.read(&mut || 5), &next[..]) {
            (Ok(position), [Some(_), Some(word)]) => assert_eq!(u32::from(answer(*word).unwrap()) << 18, position.turn),
            (Err(SpiError::Bus(BusError)), _) => {}
            (Err(SpiError::Parity(word)), _) => assert_eq!(word.count_ones() % 2, 1),
            (Err(SpiError::Sensor(faults)), _) => assert!(faults.0 < 8),
            other => panic!("{other:?}"),
        }
        _ = encoder.diagnostics();
    }

    let mut encoder = As5600::new(Bus(words.clone()));
    let mut rest = words.iter();
    for _ in 0..all {
        let read = encoder.read(&mut || 5);
        let angle = rest.next().copied().flatten();
        let status = angle.and_then(|_| rest.next().copied().flatten());
        match (read, angle, status) {
            (Err(I2cError::Bus(BusError)), None, _) | (Err(I2cError::Bus(BusError)), _, None) => {}
            (Err(I2cError::NoMagnet(magnet)), Some(_), Some(status)) => {
                assert!(!magnet.detected() && u16::from(magnet.0) == status >> 8);
            }
            (Ok(position), Some(angle), Some(_)) => {
                assert_eq!(position.turn, u32::from(raw_angle(angle.to_be_bytes())) << 20);
            }
            other => panic!("{other:?}"),
        }
    }

    let mut lines = EdgeCounter::default();
    let (mut now, mut sum, mut missed) = (0, 0, 0);
    for (a, b) in edges {
        lines.step(a, b);
        // A leads while the count rises
        let next = [[0, 3], [1, 2]][usize::from(a)][usize::from(b)];
        match (next - now) & 3 {
            2 => missed += 1,
            way => sum += [0, 1, 0, -1][way as usize],
        }
        now = next;
    }
    assert_eq!((lines.count(), lines.missed()), (sum, missed));

    let per_turn = i128::from(counts_per_turn.max(1));
    let mut of_count = counts.iter().copied();
    let mut tilt = Tilt::new(Quadrature::new(|| of_count.next().unwrap_or(0), counts_per_turn), calibration);
    let mut total: Option<i128> = None;
    for &count in &counts {
        let expected = (i128::from(count).rem_euclid(per_turn) << 32) / per_turn;
        assert_eq!(i128::from(turn(count, counts_per_turn)), expected);
        // the nearest to where it was
        let before = total.unwrap_or(0);
        let moved = (expected - i128::from(zero_turn) - before).rem_euclid(1 << 32);
        let now = before + if moved < 1 << 31 { moved } else { moved - (1 << 32) };
        total = Some(now);
        let latch = tilt.read(&mut || 7).unwrap();
        // the same but for whole turns of the tilt, of which there is a whole number of units
        let tilt_turn = (4_294_967_296.0 * gear) as i128;
        let exact = now.rem_euclid(tilt_turn) as f64 / 4_294_967_296.0 * std::f64::consts::TAU / f64::from(gear);
        let exact = if opposite { -exact } else { exact };
        let turns = (f64::from(latch.turn_rad) - exact) / std::f64::consts::TAU;
        assert!((turns - turns.round()).abs() <= 1e-6, "{latch:?} {exact}");
        assert!(latch.turn_rad.abs() <= std::f32::consts::PI * 1.000_001, "{latch:?}");
        assert_eq!(latch.time_us, 7);
    }
});

/// The next words that the bus will give.
fn encoder_words(encoder: &mut As5048a<Bus>, count: usize) -> Vec<Option<u16>> {
    // the driver lends its bus by giving it back
    let bus = std::mem::replace(encoder, As5048a::new(Bus(VecDeque::new()))).release();
    let next = bus.0.iter().copied().take(count).collect();
    *encoder = As5048a::new(bus);
    next
}
