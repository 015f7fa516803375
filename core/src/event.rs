//! What comes out: rows of labels, joins, segments.

use core::fmt;
use core::ops::{ControlFlow, Range};

use crate::bits::{self, CHUNK};
use crate::label::{Area, Labels};
use crate::plane::{Moments, Plane};
use crate::plane_segmenter::equal_runs;
use crate::surface::{NONE, Surfaces};
use crate::within::at;

/// The label of an area: 1, 2, 3, ... in the order in which areas begin. A row begins the next ones without a gap; each
/// shows in that row, or in a join that it brings. Never used twice within a scan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Label(pub u32);

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.fmt(f)
    }
}

/// What a pixel is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Pixel {
    /// No return: the paper's outliers, windows among them.
    NoReturn,
    /// Part of an edge; region-based: on no line; by planes: a return in no area.
    Edge,
    /// Part of the area with this label, or of an area that it has joined since.
    Segment(Label),
    /// Part of an area that got no label because the table of live labels was full.
    Unlabelled,
}

/// Two areas turned out to be one: pixels labelled `from` in earlier rows belong to `into`, which lives from now on. No
/// label is joined twice.
///
/// By planes either of the two may have been reported as a [`Segment`] before, as long as the table of areas has had room
/// to remember it. What was said of a segment `from` is then void; one of `into` goes on, and is reported again.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Join {
    /// The label that ends here.
    pub from: Label,
    /// The label that goes on; always the smaller one.
    pub into: Label,
}

/// An area that is complete: the row in progress has no pixel of it.
///
/// By edges and by regions it can grow no more. By planes it may go on, on the far side of what hides a part of it: only
/// after a [`Join`] into its label. It is then reported again under this label, with more pixels than before; the last
/// report counts. A segment whose label was joined into another one afterwards counts no more. Of all that are left, each
/// has the pixels that were given its label, or one that was joined into it.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Segment {
    /// Its label; areas that were joined into it are counted in.
    pub label: Label,
    /// First row with a pixel of it.
    pub first_row: u16,
    /// Last row with a pixel of it.
    pub last_row: u16,
    /// Leftmost column with a pixel of it. An area across the seam of a wrapped image reaches from 0 to the last column.
    pub first_column: u16,
    /// Rightmost column with a pixel of it.
    pub last_column: u16,
    /// Its points.
    pub moments: Moments,
}

impl Segment {
    /// Number of pixels.
    pub fn pixels(&self) -> u32 {
        self.moments.points
    }

    /// Mean of its points, metres.
    pub fn centroid_m(&self) -> [f32; 3] {
        self.moments.centroid_m().unwrap_or_default()
    }

    /// Its plane; see [`Moments::plane`].
    pub fn plane(&self) -> Option<Plane> {
        self.moments.plane()
    }
}

/// Takes what a segmenter finds, row by row. Any method may return `ControlFlow::Break` to drop the rest of the scan.
///
/// Order of the calls for one pushed row: `edges`; then, for the row that is now decided (edge-based: a few rows earlier),
/// `join` and `segment` as they are found from left to right (by planes all joins, then all segments, in no order of
/// columns); then `row`. Each row has one `edges` and one `row`; the end of a scan has only segments left to complete, and
/// edge-based the last rows.
pub trait Sink {
    /// A row of labels. Joins that this row brought about are already applied to it.
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()>;

    /// Two areas are one; see [`Join`].
    fn join(&mut self, join: Join) -> ControlFlow<()> {
        let _ = join;
        ControlFlow::Continue(())
    }

    /// A segment is complete; see [`Segment`]. Its last row was the one before the row in progress.
    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        let _ = segment;
        ControlFlow::Continue(())
    }

    /// A row of edges before the closing, for pictures and tests. Region-based: pixels with a return that begin a line or
    /// are on none. By planes: pixels with a return in no area.
    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        let _ = row;
        ControlFlow::Continue(())
    }
}

/// A row of edges: roof and step edges of all traces, before the closing; or where lines begin, see [`Sink::edges`].
#[derive(Clone, Copy, Debug)]
pub struct EdgeRow<'a> {
    pub(crate) row: usize,
    pub(crate) columns: usize,
    pub(crate) words: &'a [u32],
}

impl<'a> EdgeRow<'a> {
    /// Number of the row.
    pub fn row(&self) -> usize {
        self.row
    }

    /// The runs of edge pixels, from the left.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + 'a {
        bits::runs(self.words, self.columns)
    }
}

/// The runs of a row and their labels, as each approach has them.
#[derive(Clone, Copy)]
pub(crate) enum RunLabels<'a> {
    /// Packed: pixels of areas, and pixels that begin a run (empty where no two runs touch); labels by run.
    Runs { areas: &'a [u32], starts: &'a [u32], labels: &'a Labels<'a> },
    /// The slot of each pixel's area.
    Slots { slots: &'a [u16], table: &'a [Area] },
}

/// A row of labels.
#[derive(Clone, Copy)]
pub struct LabelRow<'a> {
    pub(crate) row: usize,
    pub(crate) columns: usize,
    /// Packed: pixels with a return.
    pub(crate) returns: &'a [u32],
    pub(crate) labels: RunLabels<'a>,
}

impl<'a> LabelRow<'a> {
    /// Number of the row.
    pub fn row(&self) -> usize {
        self.row
    }

    /// Number of columns.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The runs of area pixels, from the left, each with its label; `None` where the table of labels was full. Of the
    /// edge-based approach no two touch; of the region-based one each is a line; of the plane approach neighbours differ.
    pub fn runs(&self) -> impl Iterator<Item = (Range<usize>, Option<Label>)> + 'a {
        let (mut by_run, mut by_slot) = (None, None);
        match self.labels {
            RunLabels::Runs { areas, starts, labels } => {
                let runs = bits::touching_runs(areas, starts, self.columns).enumerate();
                by_run = Some(runs.map(move |(i, run)| (run, labels.of_run(i))));
            }
            RunLabels::Slots { slots, table } => {
                let runs = equal_runs(slots).filter(|run| at(slots, run.start) != NONE);
                by_slot = Some(runs.map(move |run| (run.clone(), Surfaces::label(table, at(slots, run.start)))));
            }
        }
        by_run.into_iter().flatten().chain(by_slot.into_iter().flatten())
    }

    /// All pixels, from the left.
    pub fn pixels(&self) -> impl Iterator<Item = Pixel> + 'a {
        let mut runs = self.runs();
        let mut next = runs.next();
        let returns = self.returns;
        (0..self.columns).map(move |column| {
            while next.as_ref().is_some_and(|(run, _)| run.end <= column) {
                next = runs.next();
            }
            match &next {
                Some((run, label)) if run.contains(&column) => label.map_or(Pixel::Unlabelled, Pixel::Segment),
                _ if returns.get(column / CHUNK).is_some_and(|word| word >> (column % CHUNK) & 1 == 1) => Pixel::Edge,
                _ => Pixel::NoReturn,
            }
        })
    }
}
