//! Angle encoders on the tilt axis of the scanner.
//!
//! For each sensor there are plain functions that read and make its frames, and a driver that
//! implements [`Encoder`]. [`Tilt`] converts the positions of an encoder to turn angles of the
//! scanner.

pub mod as5048a;
pub mod as5600;
mod calibration;
mod position;
pub mod quadrature;

pub use calibration::{Calibration, CalibrationError, Direction, Tilt};
pub use position::{Encoder, Position};
