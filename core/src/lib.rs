//! Range-image segmentation that runs while the scanner is still scanning: the method of *Fast range image segmentation
//! for indoor 3D-SLAM* (Harati, Gaechter, Siegwart 2006), one scan row at a time, in fixed memory and linear time.
//!
//! ```text
//! ranges of a row, its turn angle; by the default
//!    -> turn of the row beyond that angle      turn
//!    -> pixels that follow a plane from above  follow
//!    -> lines in what follows none             piece
//!    -> planar surfaces, joined where they fit surface, fit
//!
//! or, by the paper's edge-based approach,
//!    -> bearing angles along the traces        bearing, with the angles between beams from beam     (paper section 3)
//!    -> roof and step edges, OR                edge                                                 (section 4)
//!    -> closing, on packed bits                closing
//!    -> labels, joins, complete segments       label
//!    -> their planes                           plane
//!
//! or, by the paper's region-based approach,
//!    -> lines of the row, by bearing angle     line                                                 (section 4)
//!    -> growing planar regions                 region, label
//! ```
//!
//! [`PlaneSegmenter`], the default, [`EdgeSegmenter`] and [`RegionSegmenter`] tie the stages together. They are used alike, with
//! the same [`Config`] and [`Memory`]: [`Config::new`] for the default, [`Config::paper`] for the paper's settings. A [`Sink`] takes
//! the results.
//!
//! # Panics
//! None. Optimised for a microcontroller, no panic routine is linked: so it was with rustc 1.95.0 for thumbv6m, thumbv7em and
//! riscv32imc, and `tests/no_panic.sh` looks again. With debug assertions an index that is out of bounds panics; that would be
//! a bug.
//!
//! # Features
//! - `micromath`: a coarse arc tangent (0.17 deg instead of 0.001 deg) for processors without floating point.
//! - `defmt`: `defmt::Format` on the public plain types.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]

#[cfg(test)]
extern crate std;

mod beam;
mod bearing;
mod bits;
mod closing;
mod config;
mod edge;
mod error;
mod event;
mod fit;
mod follow;
mod label;
mod line;
mod memory;
mod piece;
mod plane;
mod plane_segmenter;
mod region;
mod region_segmenter;
mod scanline;
mod segmenter;
mod surface;
mod turn;
mod within;

pub use beam::{BeamAngle, Beams, Columns, MIN_BEAM_ANGLE_RAD, POINT_UNIT_M, TurnAxis};
pub use bearing::{COUNTS_PER_RAD, MAX_ERROR_RAD, Row, bearing_angle_rad, bearing_row};
pub use config::{Config, Element, MAX_RANGE_M, MAX_TRACE_ROWS, MAX_TRACES, Trace};
pub use error::{ConfigError, PushError};
pub use event::{EdgeRow, Join, Label, LabelRow, Pixel, Segment, Sink};
pub use label::{Area, live_labels};
pub use memory::{Buffers, Memory, Sizes};
pub use plane::{Moments, Plane};
pub use plane_segmenter::PlaneSegmenter;
pub use region_segmenter::RegionSegmenter;
pub use segmenter::{EdgeSegmenter, Finished, LATENCY_ROWS, MAX_COLUMNS, MAX_ROWS, Status};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
