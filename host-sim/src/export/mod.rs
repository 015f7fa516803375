//! Segmented scans for other programs: points, outlines of the segments, recordings.
//!
//! Coordinates are metres in the scanner's frame: x forward, y left, z up.

mod convex;
#[cfg(feature = "ros")]
pub mod mcap;
#[cfg(feature = "ros")]
pub mod messages;
mod outline;
pub mod outlines;
mod planarity;
pub mod points;
#[cfg(feature = "ros")]
mod ros;
mod segmented;

pub use outline::{Outline, outlines_of};
pub use planarity::{Planarity, Verdict, planarities_of};
#[cfg(feature = "ros")]
pub use ros::{Header, MarkerArray, PointCloud2};
pub use segmented::{Segmented, point_m};
