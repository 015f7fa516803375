//! The whole chain on simulated wires: scanner, encoder, session and rig, step by step.

use std::cell::Cell;
use std::rc::Rc;

use scanseg_core::Segmenter;
use scanseg_hal::Latch;
use scanseg_hal::encoder::as5048a::As5048a;
use scanseg_hal::encoder::{Calibration, Direction, Tilt};
use scanseg_hal::lms2xx::{Action, Baud, Phase, Session, Settings};
use scanseg_hal::rig::{LmsRows, Rig, RigSink};

use crate::as5048a::VirtualAs5048a;
use crate::lms2xx::VirtualLms;
use crate::measurement::Beam;

/// What is wrong with the encoder.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum EncoderFault {
    /// Nothing.
    None,
    /// It does not answer.
    Dead,
    /// It says what it said last.
    Stuck,
    /// It is off.
    Off {
        /// By how much, radians.
        by_rad: f64,
    },
}

/// A tilt: turn angle in radians at a time in microseconds.
pub type Motion = Rc<dyn Fn(f64) -> f64>;

type Shaft = Box<dyn FnMut() -> f64>;

/// A virtual scanner on a virtual tilt with a virtual encoder, and the rig that reads them. Starts
/// at time 0.
pub struct Chain<'a, S, K = Settings> {
    /// The scanner.
    pub lms: VirtualLms,
    /// Its encoder's state.
    pub encoder_fault: EncoderFault,
    /// What reads both.
    pub rig: Rig<'a, S, K>,
    session: Session,
    motion: Motion,
    shaft_turns: Rc<Cell<f64>>,
    tilt: Tilt<As5048a<VirtualAs5048a<Shaft>>>,
    port: Baud,
    now_us: u64,
}

/// What came in a step of a [`Chain`].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Arrival {
    /// When.
    pub time_us: u64,
    /// Bytes from the scanner, the last of them at that time.
    pub bytes: Vec<u8>,
    /// The tilt as the encoder has it, if bytes came and it answered.
    pub latch: Option<Latch>,
}

/// Returns a scanner on a tilt that moves so, with mode and unit of these settings. `range_m` gives
/// the range at a bearing from the right edge of the field of view, in degrees, and a turn angle in
/// radians; 0 or less where nothing returns.
#[must_use]
pub fn scanner_on_tilt(
    settings: Settings,
    motion: &Motion,
    mut range_m: impl FnMut(f64, f64) -> f64 + 'static,
) -> VirtualLms {
    let motion = Rc::clone(motion);
    let max = (0xFFFF_u32 >> (16 - settings.mode.range_bits())) as u16;
    let lms = VirtualLms::new(move |beam: Beam| {
        let counts = range_m(beam.bearing_deg, motion(beam.time_us)) * 1000.0 / f64::from(settings.unit.mm());
        match counts {
            counts if counts < 0.5 => max,                      // not a valid value
            counts if counts > f64::from(max) - 9.0 => max - 8, // above the maximum
            counts => counts.round() as u16,
        }
    });
    lms.configured(settings.mode, settings.unit)
}

impl<'a, S: Segmenter, K: LmsRows> Chain<'a, S, K> {
    /// Puts the chain together; see [`scanner_on_tilt`] for the scanner.
    #[must_use]
    pub fn new(settings: Settings, lms: VirtualLms, motion: Motion, rig: Rig<'a, S, K>) -> Self {
        let shaft_turns = Rc::new(Cell::new(0.0));
        let shaft = Rc::clone(&shaft_turns);
        let sensor = VirtualAs5048a::new(Box::new(move || shaft.get()) as Shaft);
        let calibration = Calibration::new(0, Direction::Same, 1.0).expect("a gear of 1");
        Self {
            lms,
            encoder_fault: EncoderFault::None,
            rig,
            session: Session::new(settings),
            motion,
            shaft_turns,
            tilt: Tilt::new(As5048a::new(sensor), calibration),
            port: Baud::B9600,
            now_us: 0,
        }
    }

    /// Returns the time of the simulation, microseconds.
    #[must_use]
    pub fn now_us(&self) -> u64 {
        self.now_us
    }

    /// Returns how far the session is with its scanner.
    #[must_use]
    pub fn phase(&self) -> Phase {
        self.session.phase()
    }

    /// Does what the session says once. A wait is taken in steps of a millisecond. Returns what
    /// came meanwhile.
    pub fn step(&mut self, sink: &mut impl RigSink) -> Arrival {
        let mut came = Arrival::default();
        match self.session.poll((self.now_us / 1000) as u32) {
            Action::SetBaud(baud) => {
                self.lms.read(self.now_us, self.port);
                self.port = baud;
            }
            Action::Send { bytes, gap_us } => {
                for byte in bytes.as_slice() {
                    self.now_us = self.lms.write(self.now_us, &[*byte], self.port) + u64::from(gap_us);
                }
            }
            Action::Wait { .. } => {
                self.now_us += 1000;
                came.bytes = self.lms.read(self.now_us, self.port);
                if !came.bytes.is_empty() {
                    came.latch = self.sample();
                    self.rig.tilt(came.latch);
                    self.rig.receive(&mut self.session, &came.bytes, self.now_us, sink);
                }
            }
            Action::Tell(trouble) => self.rig.trouble(trouble, sink),
        }
        self.rig.idle(self.now_us, sink);
        came.time_us = self.now_us;
        came
    }

    fn sample(&mut self) -> Option<Latch> {
        let truth_turns = (self.motion)(self.now_us as f64) / std::f64::consts::TAU;
        match self.encoder_fault {
            EncoderFault::None => self.shaft_turns.set(truth_turns),
            EncoderFault::Dead => return None,
            EncoderFault::Stuck => {}
            EncoderFault::Off { by_rad } => self.shaft_turns.set(truth_turns + by_rad / std::f64::consts::TAU),
        }
        let now_us = self.now_us;
        self.tilt.read(&mut || now_us).ok()
    }
}
