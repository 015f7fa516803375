//! A segmented scan as pictures.

use scanseg_core::{AnyConfig, Approach};
use scanseg_formats::RangeImage;
use scanseg_sim::overview::{Line, Panel, Segments, View, overlay, overview, segments};
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
    /// Returns the pictures with their names, of bearing angles along rows and along columns where
    /// the approach uses them.
    pub fn pictures(&self, [rows, columns]: [&[u16]; 2], lines: &[Line]) -> Vec<(&'static str, Vec<u8>)> {
        let (scan, segmentation) = (self.scan, self.segmentation);
        let shown = Segments {
            scan,
            view: View::of(&self.input.geometry, scan.rows, scan.columns),
            labels: self.labels,
            // what else has edges does not leave them out of segments
            edges: if self.config.approach() == Approach::Edge { Some(&segmentation.closed_edges) } else { None },
        };
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
        vec![
            ("overview.png", overview(&shown, &panels).to_png()),
            ("segments.png", segments(&shown, lines).to_png()),
            ("overlay.png", overlay(&shown, lines).to_png()),
        ]
    }
}
