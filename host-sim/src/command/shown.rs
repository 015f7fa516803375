//! A segmented scan as pictures.

use scanseg_core::{AnyConfig, Approach};
use scanseg_formats::RangeImage;
use scanseg_sim::overview::{Line, Panel, Segments, View, overlay, overview, segments};
use scanseg_sim::picture::Picture;
use scanseg_sim::segmentation::Segmentation;

use crate::command::input::Input;

/// What is shown.
pub struct Shown<'a> {
    pub input: &'a Input,
    /// Its returns.
    pub scan: &'a RangeImage,
    pub config: &'a AnyConfig<'a>,
    pub segmentation: &'a Segmentation,
    /// Label of the listed segment that each pixel is in; 0 for none.
    pub labels: &'a [u32],
    /// By edges: those of the traces along rows alone, and along columns alone.
    pub along: &'a [Vec<bool>],
}

impl Shown<'_> {
    /// Returns the overview, with bearing angles along rows and along columns where the approach uses
    /// them.
    pub fn overview(&self, [rows, columns]: [&[u16]; 2]) -> Picture {
        let (scan, segmentation) = (self.scan, self.segmentation);
        let mut panels = vec![("", Panel::Ranges)];
        let outside: Vec<bool> = scan.range_m.iter().zip(self.labels).map(|(m, &n)| *m > 0.0 && n == 0).collect();
        match self.config.approach() {
            Approach::Edge => panels.extend([
                ("Segments (edges black)", Panel::Segments),
                ("Bearing angle along rows", Panel::Bearings(rows)),
                ("Bearing angle along columns", Panel::Bearings(columns)),
                ("Edges along rows", Panel::Pixels(&self.along[0])),
                ("Edges along columns", Panel::Pixels(&self.along[1])),
                ("Edges of all traces", Panel::Pixels(&segmentation.edges)),
                ("Edges after closing", Panel::Pixels(&segmentation.closed_edges)),
            ]),
            Approach::Plane => panels.extend([
                ("Segments", Panel::Segments),
                ("Segments over the range", Panel::Overlay),
                ("Returns in no listed segment", Panel::Pixels(&outside)),
            ]),
            Approach::Region => panels.extend([
                ("Segments", Panel::Segments),
                ("Where lines begin", Panel::Pixels(&segmentation.edges)),
                ("Pixels on no line", Panel::Pixels(&segmentation.closed_edges)),
            ]),
        }
        overview(&self.pixels(), &panels)
    }

    /// Returns the segments in colour, with a legend.
    pub fn segments(&self, legend: &[Line]) -> Picture {
        segments(&self.pixels(), legend)
    }

    /// Returns the segments over the ranges, with a legend.
    pub fn overlay(&self, legend: &[Line]) -> Picture {
        overlay(&self.pixels(), legend)
    }

    fn pixels(&self) -> Segments<'_> {
        let Shown { input, scan, config, segmentation, labels, .. } = *self;
        Segments {
            scan,
            view: View::of(&input.geometry, scan.rows, scan.columns),
            labels,
            // what else has edges does not leave them out of segments
            edges: if config.approach() == Approach::Edge { Some(&segmentation.closed_edges) } else { None },
        }
    }
}
