//! Tilt encoders on simulated buses.

use core::cell::Cell;
use core::convert::Infallible;
use std::rc::Rc;

use embedded_hal::spi::SpiDevice;
use scanseg_hal::encoder::as5048a::{self, As5048a, Faults};
use scanseg_hal::encoder::as5600::{self, As5600};
use scanseg_hal::encoder::quadrature::{EdgeCounter, Quadrature};
use scanseg_hal::encoder::{Calibration, Direction, Encoder, Position, Tilt};
use scanseg_virtual_rig::{NoAcknowledge, VirtualAs5048a, VirtualAs5600};

fn clock() -> impl FnMut() -> u64 {
    let mut now_us = 0;
    move || {
        now_us += 1;
        now_us
    }
}

#[test]
fn as5048a_reads_and_checks() {
    let shaft = Rc::new(Cell::new(0.0));
    let seen = shaft.clone();
    let mut encoder = As5048a::new(VirtualAs5048a::new(move || seen.get()));
    let mut clock = clock();
    for step in 0..16384u32 {
        shaft.set(f64::from(step) / 16384.0 + 1e-6);
        // Not the value of the reading before: each one asks for its own.
        assert_eq!(encoder.read(&mut clock).map(|position| position.turn), Ok(step << 18));
    }
    assert_eq!(encoder.read(&mut clock), Ok(Position { turn: 16383 << 18, time_us: 16385 }));

    assert!(encoder.diagnostics().is_ok_and(|diagnostics| diagnostics.ready() && !diagnostics.too_weak()));
    let mut sensor = encoder.release();
    sensor.diagnostics = 0x0980;
    let mut encoder = As5048a::new(sensor);
    assert!(encoder.diagnostics().is_ok_and(|diagnostics| diagnostics.too_weak()));

    // A bit flipped on the way there: the sensor flags it, and after that all is well again.
    let mut sensor = encoder.release();
    sensor.flip = 0x0010;
    let mut encoder = As5048a::new(sensor);
    assert_eq!(encoder.read(&mut clock), Err(as5048a::Error::Sensor(Faults(6))), "odd parity and no such register");
    assert!(encoder.read(&mut clock).is_ok());
    // A bit flipped on the way back is seen whichever it is; the first frame's answer is not used.
    for bit in 0..16 {
        encoder = As5048a::new(FlipSecond { sensor: encoder.release(), frame: 0, bits: 1 << bit }.run(&mut clock));
        assert!(encoder.read(&mut clock).is_ok());
    }
    // The bus given back works in a new driver.
    assert!(As5048a::new(encoder.release()).read(&mut clock).is_ok());
}

/// Flips bits in the second answer of a reading.
struct FlipSecond<S> {
    sensor: S,
    frame: u32,
    bits: u16,
}

impl<S: SpiDevice<Error = Infallible>> FlipSecond<S> {
    fn run(self, clock: &mut impl scanseg_hal::Clock) -> S {
        let mut encoder = As5048a::new(self);
        assert!(matches!(encoder.read(clock), Err(as5048a::Error::Parity(_))));
        encoder.release().sensor
    }
}

impl<S> embedded_hal::spi::ErrorType for FlipSecond<S> {
    type Error = Infallible;
}

impl<S: SpiDevice<Error = Infallible>> SpiDevice for FlipSecond<S> {
    fn transaction(&mut self, operations: &mut [embedded_hal::spi::Operation<'_, u8>]) -> Result<(), Infallible> {
        self.sensor.transaction(operations)?;
        self.frame += 1;
        if let ([embedded_hal::spi::Operation::TransferInPlace([high, low])], 2) = (operations, self.frame) {
            *high ^= (self.bits >> 8) as u8;
            *low ^= self.bits as u8;
        }
        Ok(())
    }
}

#[test]
fn as5600_reads_and_checks() {
    let mut clock = clock();
    for (angle, status) in [(0, 0x20), (1, 0x30), (2048, 0x28), (4095, 0x20)] {
        let mut sensor = VirtualAs5600::new(move || (f64::from(angle) + 0.5) / 4096.0 - 3.0);
        sensor.status = status;
        let mut encoder = As5600::new(sensor);
        assert_eq!(encoder.read(&mut clock).map(|position| position.turn), Ok((angle as u32) << 20));
        assert_eq!(encoder.magnet().map(|magnet| magnet.0), Ok(status));
    }
    let mut sensor = VirtualAs5600::new(|| 0.3);
    sensor.status = 0x10;
    let mut encoder = As5600::new(sensor);
    assert!(matches!(encoder.read(&mut clock), Err(as5600::Error::NoMagnet(magnet)) if magnet.too_weak()));
    let mut bus = encoder.release();
    bus.dead = true;
    let mut encoder = As5600::new(bus);
    assert_eq!(encoder.read(&mut clock), Err(as5600::Error::Bus(NoAcknowledge)));
    assert_eq!(encoder.magnet(), Err(as5600::Error::Bus(NoAcknowledge)));
}

/// Each encoder on its own drive, calibrated: all say the same angle, also across their own zeros.
#[test]
fn calibrated_encoders_agree() {
    let angle_deg = Rc::new(Cell::new(0.0));
    let (on_axis, on_other_end, counted) = (angle_deg.clone(), angle_deg.clone(), angle_deg.clone());
    // On the axis, zero at 300 degrees of its own, mounted the other way round.
    let sensor = VirtualAs5048a::new(move || (300.0 - on_axis.get()) / 360.0);
    let zero = (300.0 / 360.0 * 4_294_967_296.0) as u32;
    let calibration = Calibration::new(zero, Direction::Opposite, 1.0).expect("gear");
    let mut magnetic = Tilt::new(As5048a::new(sensor), calibration);
    // On the other end of the axis, zero at 10 degrees of its own: its zero is crossed on the way.
    let sensor = VirtualAs5600::new(move || (10.0 + on_other_end.get()) / 360.0);
    let zero = (10.0 / 360.0 * 4_294_967_296.0) as u32;
    let mut other_end = Tilt::new(As5600::new(sensor), Calibration::new(zero, Direction::Same, 1.0).expect("gear"));
    // 2000 counts a turn on the motor, which turns 7.5 times as fast.
    let counter = Quadrature::new(move || (counted.get() / 360.0 * 7.5 * 2000.0) as i32, 2000);
    let mut geared = Tilt::new(counter, Calibration::new(0, Direction::Same, 7.5).expect("gear"));
    let mut clock = clock();
    let there_and_back = (0..=1400).chain((-1400..1400).rev());
    for tenth_deg in there_and_back {
        let deg = f64::from(tenth_deg) / 10.0;
        angle_deg.set(deg);
        let magnetic_rad = magnetic.read(&mut clock).expect("sensor").turn_rad;
        let other_end_rad = other_end.read(&mut clock).expect("sensor").turn_rad;
        let geared_rad = geared.read(&mut clock).expect("counter").turn_rad;
        assert!((f64::from(magnetic_rad) - deg.to_radians()).abs() < 4.0e-4, "one step of 14 bits");
        assert!((f64::from(other_end_rad) - deg.to_radians()).abs() < 1.6e-3, "one step of 12 bits");
        assert!((f64::from(geared_rad) - deg.to_radians()).abs() < 4.3e-4, "one count of 15000");
    }
}

/// The two lines of an incremental encoder of 500 lines, looked at often enough: the same count as
/// the shaft's, through several turns each way.
#[test]
fn edges_of_a_turning_shaft() {
    let counted = Rc::new(Cell::new(0));
    let count = counted.clone();
    let mut tilt =
        Tilt::new(Quadrature::new(move || count.get(), 2000), Calibration::new(0, Direction::Same, 1.0).expect("gear"));
    let mut edges = EdgeCounter::new(false, false);
    let mut clock = clock();
    for step in (0..=30_000i32).chain((-20_000..30_000).rev()) {
        // A quarter of an edge at a time; line B is a quarter of a cycle behind line A.
        let shaft_turns = f64::from(step) / 8000.0;
        let cycle = (shaft_turns * 500.0).rem_euclid(1.0);
        edges.step((0.25..0.75).contains(&cycle), cycle >= 0.5);
        counted.set(edges.count());
        let off_rad = f64::from(tilt.read(&mut clock).expect("counter").turn_rad) - shaft_turns * std::f64::consts::TAU;
        let off_rad = off_rad - (off_rad / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        assert!(off_rad.abs() < 3.2e-3, "one count of 2000: {shaft_turns} {off_rad}");
    }
    assert_eq!(edges.missed(), 0);
}
