//! The default segmenter and the paper's two approaches behind one type.

use scanseg_core::{
    Beams, Config, ConfigError, EdgeSegmenter, Finished, Memory, PlaneSegmenter, PushError, RegionSegmenter, Sink,
    Status,
};
use scanseg_hal::rig::RowSegmenter;

/// What segments a scan: the default, or one of the paper's two approaches.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Approach {
    /// By planes that go on from row to row.
    #[default]
    Plane,
    /// By edges in bearing-angle images.
    Edge,
    /// By growing regions from the lines of each row.
    Region,
}

/// A segmenter of any approach.
#[allow(clippy::large_enum_variant)]
pub enum Segmenter<'a> {
    /// By planes.
    Plane(PlaneSegmenter<'a>),
    /// By edges.
    Edge(EdgeSegmenter<'a>),
    /// By regions.
    Region(RegionSegmenter<'a>),
}

impl<'a> Segmenter<'a> {
    /// See [`EdgeSegmenter::new`].
    ///
    /// # Errors
    /// Those of [`EdgeSegmenter::new`].
    pub fn new(
        approach: Approach,
        config: Config<'a>,
        beams: Beams<'a>,
        columns: usize,
        memory: Memory<'a>,
    ) -> Result<Segmenter<'a>, ConfigError> {
        Ok(match approach {
            Approach::Plane => Segmenter::Plane(PlaneSegmenter::new(config, beams, columns, memory)?),
            Approach::Edge => Segmenter::Edge(EdgeSegmenter::new(config, beams, columns, memory)?),
            Approach::Region => Segmenter::Region(RegionSegmenter::new(config, beams, columns, memory)?),
        })
    }

    /// See [`EdgeSegmenter::push_row`].
    ///
    /// # Errors
    /// Those of [`EdgeSegmenter::push_row`].
    pub fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
        match self {
            Segmenter::Plane(segmenter) => segmenter.push_row(ranges_m, turn_rad, sink),
            Segmenter::Edge(segmenter) => segmenter.push_row(ranges_m, turn_rad, sink),
            Segmenter::Region(segmenter) => segmenter.push_row(ranges_m, turn_rad, sink),
        }
    }

    /// See [`EdgeSegmenter::finish`].
    pub fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        match self {
            Segmenter::Plane(segmenter) => segmenter.finish(sink),
            Segmenter::Edge(segmenter) => segmenter.finish(sink),
            Segmenter::Region(segmenter) => segmenter.finish(sink),
        }
    }
}

impl RowSegmenter for Segmenter<'_> {
    fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
        Segmenter::push_row(self, ranges_m, turn_rad, sink)
    }

    fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        Segmenter::finish(self, sink)
    }
}
