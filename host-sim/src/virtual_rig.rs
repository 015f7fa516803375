//! A scanner and an encoder that answer on simulated wires, for tests and demonstrations without hardware.

mod as5048a;
mod as5600;
mod chain;
mod lms2xx;
mod wires;

pub use as5048a::VirtualAs5048a;
pub use as5600::{NoAcknowledge, VirtualAs5600};
pub use chain::{Came, Chain, EncoderFault, Motion, scanner_on_tilt};
pub use lms2xx::{Beam, Mishap, VirtualLms};
pub use wires::{BURST, Faults, Wires};
