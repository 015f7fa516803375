//! A scanner and an encoder that answer on simulated wires, for tests and demonstrations without hardware.

mod as5048a;
mod lms2xx;
mod wires;

pub use as5048a::VirtualAs5048a;
pub use lms2xx::{Beam, Mishap, VirtualLms};
pub use wires::{Faults, Wires};
