//! Range-image segmentation that runs while the scanner is still scanning: the method of *Fast
//! range image segmentation for indoor 3D-SLAM* (Harati, Gaechter, Siegwart 2006), one scan row at
//! a time, in fixed memory.
//!
//! There are three approaches. They are used alike, by the trait [`Segmenter`]:
//!
//! - [`PlaneSegmenter`], the default: planes go on from row to row. It is right at the noise of
//!   real scanners and needs nothing but that noise: [`PlaneConfig::new`].
//! - [`EdgeSegmenter`], the paper's first approach: edges in bearing-angle images.
//!   [`EdgeConfig::paper`].
//! - [`RegionSegmenter`], the paper's second approach: regions grow from the lines of each row.
//!   [`RegionConfig::paper`].
//!
//! [`AnySegmenter`] is any of them, chosen at run time. All work in a [`Memory`] that the user
//! places, made by [`buffers!`]. A [`Sink`] takes the results.
//!
//! # Example
//! ```
#![doc = include_str!("../examples/wall.rs")]
//! ```
//!
//! # Stages
//! ```text
//! a row of ranges and its turn angle
//!
//! plane    noise of the ranges, turn of the row          plane/measure, plane/turn
//!          pixels that follow a plane of the rows above  plane/follow
//!          lines in what follows none                    plane/line
//!          areas, joined where they fit                  plane/areas, plane/join, weighted
//!
//! edge     bearing angles along the traces               edge/bearing, edge/beam_angle (section 3)
//!          roof and step edges, OR                       edge/sobel (section 4)
//!          closing, on packed bits                       edge/closing
//!          labels, joins, complete segments              label
//!
//! region   lines of the row, by turning angle            region/line (section 4)
//!          growing planar regions                        region/growth, label
//! ```
//!
//! # Panics
//! None. Optimised for a microcontroller, no panic routine is linked: so it was with rustc 1.95.0
//! for thumbv6m, thumbv7em and riscv32imc, and `tests/no_panic.sh` looks again. With debug
//! assertions an index that is out of bounds panics; that would be a bug.
//!
//! # Features
//! - `micromath`: a coarse arc tangent (0.17 deg instead of 0.001 deg) for processors without
//!   floating point.
//! - `defmt`: `defmt::Format` on the public plain types.
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![deny(missing_debug_implementations)]
// Arrays of known length are indexed by `[i]`, in the modules that allow it; slices by
// `row::within`, or by `get`. The drivers keep the same rule.
#![cfg_attr(not(test), deny(clippy::indexing_slicing, clippy::unwrap_used, clippy::expect_used, clippy::panic))]

#[cfg(test)]
extern crate std;

mod any;
mod area;
mod arithmetic;
mod beam;
mod config;
mod edge;
mod error;
mod label;
mod memory;
mod moments;
mod plane;
mod plane_fit;
mod region;
mod row;
mod row_beams;
mod scan;
mod segment;
mod sensors;
mod sink;
mod weighted;

pub use any::{AnyConfig, AnySegmenter, Approach};
pub use area::{Area, live_labels};
pub use beam::{Beams, Columns, MAX_COLUMNS, TurnAxis};
pub use config::{MAX_RANGE_M, Ranging};
pub use edge::{
    BeamAngle, COUNTS_PER_RAD, EdgeConfig, EdgeSegmenter, Element, MAX_ERROR_RAD, MAX_TRACE_ROWS, MAX_TRACES,
    MIN_BEAM_ANGLE_RAD, Row, Trace, bearing_angle_rad, bearing_row,
};
pub use error::{ConfigError, PushError};
pub use memory::{Buffers, Memory, Sizes};
pub use moments::{Moments, POINT_UNIT_M};
pub use plane::{PlaneConfig, PlaneSegmenter, Rules};
pub use plane_fit::Plane;
pub use region::{RegionConfig, RegionSegmenter};
pub use row_beams::{ColumnTurns, RowBeams};
pub use scan::{Finished, MAX_LATENCY_ROWS, MAX_ROWS, Segmenter, Status};
pub use segment::{Join, Label, Segment, SegmentSums};
pub use sink::{EdgeRow, LabelRow, Pixel, Sink};
pub use weighted::Fitted;

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
