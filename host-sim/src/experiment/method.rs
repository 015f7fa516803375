//! What is compared: the methods, the noise, the tolerances, and the size of the scans.

use std::ops::RangeInclusive;

use scanseg_core::{AnyConfig, EdgeConfig, PlaneConfig, Ranging, RegionConfig};

/// A way to segment, as it appears in the figures.
#[derive(Clone, Copy, Debug)]
pub struct Method {
    /// In the figures and tables.
    pub name: &'static str,
    /// Its settings for a scanner of this noise, metres (one standard deviation of a range). They
    /// say which approach it is.
    pub config: fn(range_noise_m: f32) -> AnyConfig<'static>,
}

/// Name of the paper's edge-based method.
pub const EDGE: &str = "edge-based";

/// Name of the paper's region-based method.
pub const REGION: &str = "region-based";

/// Name of the default.
pub const DEFAULT: &str = "default";

/// The methods compared; one more is one entry more.
pub const METHODS: &[Method] = &[
    Method { name: DEFAULT, config: |range_noise_m| PlaneConfig::new(Ranging::new(range_noise_m)).into() },
    Method { name: EDGE, config: |range_noise_m| EdgeConfig::paper().with_ranging(papers(range_noise_m)).into() },
    Method { name: REGION, config: |range_noise_m| RegionConfig::paper().with_ranging(papers(range_noise_m)).into() },
];

/// Returns the ranges as the paper's methods are told of them. A scan without noise is a scan of 1
/// mm to them, because some change of range has to be too small to be a step.
fn papers(range_noise_m: f32) -> Ranging {
    Ranging::new(range_noise_m.max(0.001))
}

/// Levels of range noise, one standard deviation, millimetres.
pub const NOISES_MM: [u32; 3] = [0, 5, 10];

/// Tolerances T, in percent.
pub const TOLERANCES: RangeInclusive<u32> = 51..=100;

/// Truth regions and segments of fewer pixels are left out.
pub const MIN_PIXELS: u32 = 30;

/// Rows and columns of the scans: the paper's scanner, 0.5 degrees apart.
pub const SIZE: (usize, usize) = (200, 361);

/// The tolerance at which methods are compared, percent: Hoover's customary one.
pub const COMPARED_AT: u32 = 80;
