//! The tests of this folder in one program: what they share is built once.

mod encoders;
mod faults;
mod lms2xx_bench;
mod lms2xx_commands;
mod lms2xx_recovery;
mod lms2xx_session;
mod lms2xx_shells;
mod moving;
mod pairing;
mod panned;
mod rig;
mod soak;
mod tilted;
