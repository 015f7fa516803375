//! A scanner and tilt encoders that answer on simulated wires, for tests and demonstrations without
//! hardware.
//!
//! [`VirtualLms`] is a SICK LMS 2xx at the end of a serial line, [`VirtualLd06`] and
//! [`VirtualRplidar`] are scanners that send packet after packet, [`VirtualAs5048a`] and
//! [`VirtualAs5600`] are encoders on an SPI and an I2C bus. [`Chain`] puts scanner, encoder,
//! session and rig together and runs them step by step.

mod as5048a;
mod as5600;
mod chain;
mod ld06;
mod lms2xx;
mod measurement;
mod mode;
mod rplidar;
pub mod telegrams;
mod wires;

pub use as5048a::VirtualAs5048a;
pub use as5600::{NoAcknowledge, VirtualAs5600};
pub use chain::{Arrival, Chain, EncoderFault, Motion, scanner_on_tilt};
pub use ld06::VirtualLd06;
pub use lms2xx::{Mishap, VirtualLms};
pub use measurement::Beam;
pub use rplidar::{VirtualRplidar, behind_q3};
pub use wires::{BURST, WireFaults, Wires};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
