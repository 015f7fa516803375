//! The paper's two approaches behind one type.

use scanseg_core::{
    Beams, Config, ConfigError, EdgeSegmenter, Finished, Memory, PushError, RegionSegmenter, Sink, Status,
};

/// Which of the paper's two approaches segments a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Approach {
    /// By edges in bearing-angle images.
    #[default]
    Edge,
    /// By growing regions from the lines of each row.
    Region,
}

/// A segmenter of either approach.
#[allow(clippy::large_enum_variant)]
pub enum Segmenter<'a> {
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
            Segmenter::Edge(segmenter) => segmenter.push_row(ranges_m, turn_rad, sink),
            Segmenter::Region(segmenter) => segmenter.push_row(ranges_m, turn_rad, sink),
        }
    }

    /// See [`EdgeSegmenter::finish`].
    pub fn finish(&mut self, sink: &mut impl Sink) -> Finished {
        match self {
            Segmenter::Edge(segmenter) => segmenter.finish(sink),
            Segmenter::Region(segmenter) => segmenter.finish(sink),
        }
    }
}
