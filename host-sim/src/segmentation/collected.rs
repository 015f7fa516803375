//! What comes of a scan, collected while it is segmented.

use std::ops::ControlFlow;

use scanseg_core::{EdgeRow, Join, LabelRow, Pixel, Segment, Sink};

use crate::segmentation::found::Found;

/// Returns the segment number of each pixel, from 1, the largest; 0 for no segment and for those
/// below `min_pixels`. `segments` are sorted as by [`Collected::segments`].
pub fn numbered(labels: &[u32], segments: &[Segment], min_pixels: u32) -> Vec<u32> {
    let last = labels.iter().copied().max().unwrap_or(0);
    let mut number_of = vec![0; last as usize + 1];
    for (number, segment) in (1..).zip(segments.iter().take_while(|s| s.pixels() >= min_pixels)) {
        if let Some(place) = number_of.get_mut(segment.label.0 as usize) {
            *place = number;
        }
    }
    labels.iter().map(|&label| number_of[label as usize]).collect()
}

/// Collects what comes of a scan. At any time it tells what is known so far.
pub struct Collected {
    columns: usize,
    labels: Vec<u32>,
    pub(super) edges: Vec<bool>,
    pub(super) closed_edges: Vec<bool>,
    segments: Found,
    /// The label that each label was joined into; itself if none.
    joined_into: Vec<u32>,
}

impl Collected {
    /// Returns a collector for images of `rows` x `columns` pixels.
    pub fn new(rows: usize, columns: usize) -> Collected {
        let pixels = rows * columns;
        Collected {
            columns,
            labels: vec![0; pixels],
            edges: vec![false; pixels],
            closed_edges: vec![false; pixels],
            segments: Found::default(),
            joined_into: vec![],
        }
    }

    /// Returns the label of each pixel, with all joins so far applied; 0 in no segment, and where
    /// no row has come yet. Cost: a walk over all pixels.
    pub fn labels(&self) -> Vec<u32> {
        // joins go to smaller labels, so that these are final when a larger one asks
        let mut last = self.joined_into.clone();
        for label in 0..last.len() {
            last[label] = last[last[label] as usize];
        }
        self.labels.iter().map(|label| last.get(*label as usize).copied().unwrap_or(*label)).collect()
    }

    /// Returns the segments that are complete so far, the one with the most pixels first; where
    /// pixels are equal the lower label first.
    pub fn segments(&self) -> Vec<Segment> {
        self.segments.sorted()
    }
}

impl Sink for Collected {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        for (i, pixel) in (row.row() * self.columns..).zip(row.pixels()) {
            match pixel {
                Pixel::Segment(label) => self.labels[i] = label.0,
                Pixel::Edge => self.closed_edges[i] = true,
                Pixel::NoReturn | Pixel::Unlabelled => {}
            }
        }
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        let known = self.joined_into.len() as u32;
        self.joined_into.extend(known..=join.from.0.max(known.saturating_sub(1)));
        self.joined_into[join.from.0 as usize] = join.into.0;
        self.segments.remove(join.from);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.insert(segment);
        ControlFlow::Continue(())
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        for run in row.runs() {
            let start = row.row() * self.columns;
            self.edges[start + run.start..start + run.end].fill(true);
        }
        ControlFlow::Continue(())
    }
}
