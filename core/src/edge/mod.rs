//! The paper's edge-based approach: bearing angles, edges, closing, labels.

mod beam_angle;
mod bearing;
mod closing;
mod config;
mod rows;
mod segmenter;
mod sobel;
mod trace;

pub use beam_angle::{BeamAngle, MIN_BEAM_ANGLE_RAD};
pub use bearing::{COUNTS_PER_RAD, MAX_ERROR_RAD, Row, bearing_angle_rad, bearing_row};
pub use config::{EdgeConfig, Element, MAX_TRACES};
pub use segmenter::EdgeSegmenter;
pub use trace::{MAX_TRACE_ROWS, Trace};
