//! All approaches behind one type. This is the one file that knows all three.

use crate::beam::Beams;
use crate::config::Ranging;
use crate::edge::{EdgeConfig, EdgeSegmenter};
use crate::error::{ConfigError, PushError};
use crate::memory::{Memory, Sizes};
use crate::plane::{PlaneConfig, PlaneSegmenter};
use crate::region::{RegionConfig, RegionSegmenter};
use crate::row_beams::RowBeams;
use crate::scan::{Finished, Segmenter, Status};
use crate::sink::Sink;

/// How a scan is segmented.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Approach {
    /// By planes that go on from row to row: [`PlaneSegmenter`], the default.
    #[default]
    Plane,
    /// By edges in bearing-angle images, the paper's first approach: [`EdgeSegmenter`].
    Edge,
    /// By growing regions from the lines of each row, the paper's second approach:
    /// [`RegionSegmenter`].
    Region,
}

/// The configuration of any approach.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum AnyConfig<'a> {
    /// By planes.
    Plane(PlaneConfig),
    /// By edges.
    Edge(EdgeConfig<'a>),
    /// By regions.
    Region(RegionConfig),
}

impl AnyConfig<'_> {
    /// The approach that it configures.
    #[must_use]
    pub const fn approach(&self) -> Approach {
        match self {
            AnyConfig::Plane(_) => Approach::Plane,
            AnyConfig::Edge(_) => Approach::Edge,
            AnyConfig::Region(_) => Approach::Region,
        }
    }

    /// Noise and limits of the ranges.
    #[must_use]
    pub const fn ranging(&self) -> Ranging {
        match self {
            AnyConfig::Plane(config) => config.ranging,
            AnyConfig::Edge(config) => config.ranging,
            AnyConfig::Region(config) => config.ranging,
        }
    }

    /// The memory that images of `columns` columns need.
    #[must_use]
    pub const fn sizes(&self, columns: usize) -> Sizes {
        match self {
            AnyConfig::Plane(config) => config.sizes(columns),
            AnyConfig::Edge(config) => config.sizes(columns),
            AnyConfig::Region(config) => config.sizes(columns),
        }
    }

    /// The memory that images of `columns` columns with these beams need: as [`AnyConfig::sizes`],
    /// but by edges with [`Beams::Free`] more.
    #[must_use]
    pub const fn sizes_for(&self, beams: &Beams, columns: usize) -> Sizes {
        match self {
            AnyConfig::Edge(config) => config.sizes_for(beams, columns),
            _ => self.sizes(columns),
        }
    }

    /// The memory that images of `columns` columns need with a table of so many areas.
    #[must_use]
    pub const fn sizes_with(&self, columns: usize, areas: usize) -> Sizes {
        match self {
            AnyConfig::Plane(config) => config.sizes_with(columns, areas),
            AnyConfig::Edge(config) => config.sizes_with(columns, areas),
            AnyConfig::Region(config) => config.sizes_with(columns, areas),
        }
    }
}

impl From<PlaneConfig> for AnyConfig<'_> {
    fn from(config: PlaneConfig) -> Self {
        AnyConfig::Plane(config)
    }
}

impl<'a> From<EdgeConfig<'a>> for AnyConfig<'a> {
    fn from(config: EdgeConfig<'a>) -> Self {
        AnyConfig::Edge(config)
    }
}

impl From<RegionConfig> for AnyConfig<'_> {
    fn from(config: RegionConfig) -> Self {
        AnyConfig::Region(config)
    }
}

/// A segmenter of any approach, chosen at run time. As large as the largest of them.
#[derive(Debug)]
#[allow(clippy::large_enum_variant)] // there is no heap to put the largest one on
pub enum AnySegmenter<'a> {
    /// By planes.
    Plane(PlaneSegmenter<'a>),
    /// By edges.
    Edge(EdgeSegmenter<'a>),
    /// By regions.
    Region(RegionSegmenter<'a>),
}

impl<'a> AnySegmenter<'a> {
    /// A segmenter for images of `columns` columns, 1 to [`MAX_COLUMNS`](crate::MAX_COLUMNS), by
    /// the approach of its configuration. Checks the configuration once.
    ///
    /// # Errors
    /// [`ConfigError`] names the field and value that cannot be used, or the memory that is too
    /// small.
    pub fn new(
        config: impl Into<AnyConfig<'a>>,
        beams: Beams<'a>,
        columns: usize,
        memory: Memory<'a>,
    ) -> Result<Self, ConfigError> {
        Ok(match config.into() {
            AnyConfig::Plane(config) => Self::Plane(PlaneSegmenter::new(config, beams, columns, memory)?),
            AnyConfig::Edge(config) => Self::Edge(EdgeSegmenter::new(config, beams, columns, memory)?),
            AnyConfig::Region(config) => Self::Region(RegionSegmenter::new(config, beams, columns, memory)?),
        })
    }
}

impl Segmenter for AnySegmenter<'_> {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> Result<Status, PushError> {
        match self {
            Self::Plane(segmenter) => segmenter.push_row(ranges_m, beams, sink),
            Self::Edge(segmenter) => segmenter.push_row(ranges_m, beams, sink),
            Self::Region(segmenter) => segmenter.push_row(ranges_m, beams, sink),
        }
    }

    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished {
        match self {
            Self::Plane(segmenter) => segmenter.finish(sink),
            Self::Edge(segmenter) => segmenter.finish(sink),
            Self::Region(segmenter) => segmenter.finish(sink),
        }
    }

    fn reset(&mut self) {
        match self {
            Self::Plane(segmenter) => segmenter.reset(),
            Self::Edge(segmenter) => segmenter.reset(),
            Self::Region(segmenter) => segmenter.reset(),
        }
    }

    fn latency_rows(&self) -> usize {
        match self {
            Self::Plane(segmenter) => segmenter.latency_rows(),
            Self::Edge(segmenter) => segmenter.latency_rows(),
            Self::Region(segmenter) => segmenter.latency_rows(),
        }
    }
}
