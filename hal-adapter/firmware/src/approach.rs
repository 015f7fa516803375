//! The approach of an image. The features choose it here and nowhere else.

use scanseg_core::{EdgeConfig, PlaneConfig, Ranging, RegionConfig};

/// What is known of the ranges. Nearer ones are those of the robot's own frame.
const RANGING: Ranging = Ranging::new(0.01).with_limits(0.48, 100.0);

/// Settings of the edge-based approach.
pub const EDGE: EdgeConfig<'static> = EdgeConfig::paper().with_ranging(RANGING);

/// Settings of the region-based approach.
pub const REGION: RegionConfig = RegionConfig::paper().with_ranging(RANGING);

/// Settings of the default approach, by planes.
pub const PLANE: PlaneConfig = PlaneConfig::new(RANGING);

#[cfg(feature = "plane")]
mod image {
    pub use super::PLANE as CONFIG;
    pub use scanseg_core::PlaneSegmenter as ImageSegmenter;
}

#[cfg(all(feature = "region", not(feature = "plane")))]
mod image {
    pub use super::REGION as CONFIG;
    pub use scanseg_core::RegionSegmenter as ImageSegmenter;
}

#[cfg(not(any(feature = "plane", feature = "region")))]
mod image {
    pub use super::EDGE as CONFIG;
    pub use scanseg_core::EdgeSegmenter as ImageSegmenter;
}

pub use image::{CONFIG, ImageSegmenter};
