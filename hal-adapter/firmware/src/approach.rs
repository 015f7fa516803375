//! The approach of an image. The features choose it here and nowhere else.

use scanseg_core::{Approach, EdgeConfig, PlaneConfig, Ranging, RegionConfig};
use scanseg_hal::lms2xx::Settings;

/// What is known of the ranges. Nearer ones are those of the robot's own frame.
const RANGING: Ranging = Ranging::new(0.01).with_limits(0.48, 100.0);

/// Settings of the edge-based approach.
pub const EDGE: EdgeConfig<'static> = EdgeConfig::paper().with_ranging(RANGING);

/// Settings of the region-based approach.
pub const REGION: RegionConfig = RegionConfig::paper().with_ranging(RANGING);

/// Settings of the default approach, by planes.
pub const PLANE: PlaneConfig = PlaneConfig::new(RANGING);

/// Live labels of the image `microbit` by an approach: as many as fit its memory. 91 are enough for
/// every image of 181 columns by the paper's two approaches.
pub const fn microbit_areas(approach: Approach) -> usize {
    match approach {
        Approach::Plane => 62,
        Approach::Edge | Approach::Region => 48,
    }
}

#[cfg(feature = "plane")]
mod image {
    pub use super::PLANE as CONFIG;
    /// The approach.
    pub const APPROACH: scanseg_core::Approach = scanseg_core::Approach::Plane;
    pub use scanseg_core::PlaneSegmenter as ImageSegmenter;
}

#[cfg(all(feature = "region", not(feature = "plane")))]
mod image {
    pub use super::REGION as CONFIG;
    /// The approach.
    pub const APPROACH: scanseg_core::Approach = scanseg_core::Approach::Region;
    pub use scanseg_core::RegionSegmenter as ImageSegmenter;
}

#[cfg(not(any(feature = "plane", feature = "region")))]
mod image {
    pub use super::EDGE as CONFIG;
    /// The approach.
    pub const APPROACH: scanseg_core::Approach = scanseg_core::Approach::Edge;
    pub use scanseg_core::EdgeSegmenter as ImageSegmenter;
}

/// What the rig of an image knows of its scanner.
#[cfg(not(feature = "turns"))]
pub const fn of_scanner(settings: Settings) -> Settings {
    settings
}

/// What the rig of an image knows of its scanner: each beam has the turn angle of its own time.
#[cfg(feature = "turns")]
pub const fn of_scanner(settings: Settings) -> scanseg_hal::rig::OwnTurns {
    scanseg_hal::rig::OwnTurns::new(settings)
}

pub use image::{APPROACH, CONFIG, ImageSegmenter};
