//! Where the results go: rows of labels, joins and segments, to a [`Sink`] of the user.

use core::fmt;
use core::ops::{ControlFlow, Range};

use crate::area::Area;
use crate::row::bits::{self, CHUNK};
use crate::row::slots::{NONE, RunSlots, equal_runs};
use crate::row::within::at;
use crate::segment::{Join, Label, Segment};

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

/// Takes what a segmenter finds, row by row. Any method may return `ControlFlow::Break` to drop the
/// rest of the scan.
///
/// Order of the calls for one pushed row: `edges`; then, for the row that is now decided
/// (edge-based: a few rows earlier), `join` and `segment` as they are found from left to right (by
/// planes all joins, then all segments, in no order of columns); then `row`. Each row has one
/// `edges` and one `row`; the end of a scan has only segments left to complete, by planes after the
/// last joins, and edge-based the last rows.
pub trait Sink {
    /// A row of labels. Joins that this row brought about are already applied to it.
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()>;

    /// Two areas are one; see [`Join`].
    fn join(&mut self, join: Join) -> ControlFlow<()> {
        let _ = join;
        ControlFlow::Continue(())
    }

    /// A segment is complete; see [`Segment`]. By edges and regions its last row was
    /// the one before the row in progress.
    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        let _ = segment;
        ControlFlow::Continue(())
    }

    /// A row of edges before the closing, for pictures and tests. Region-based: pixels with a
    /// return that begin a line or are on none. By planes: pixels with a return in no area.
    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        let _ = row;
        ControlFlow::Continue(())
    }
}

#[deny(clippy::missing_trait_methods)]
impl<S: Sink + ?Sized> Sink for &mut S {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        (**self).row(row)
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        (**self).join(join)
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        (**self).segment(segment)
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        (**self).edges(row)
    }
}

/// A row of edges: roof and step edges of all traces, before the closing; or where lines begin, see
/// [`Sink::edges`].
#[derive(Clone, Copy, Debug)]
pub struct EdgeRow<'a> {
    pub(crate) row: usize,
    pub(crate) columns: usize,
    pub(crate) words: &'a [u32],
}

impl<'a> EdgeRow<'a> {
    /// Number of the row.
    #[must_use]
    pub fn row(&self) -> usize {
        self.row
    }

    /// The runs of edge pixels, from the left.
    pub fn runs(&self) -> impl Iterator<Item = Range<usize>> + 'a {
        bits::runs(self.words, self.columns)
    }
}

/// Which pixels of a row are of which slot of the table of areas.
#[derive(Clone, Copy)]
pub(crate) enum RowSlots<'a> {
    /// Packed: pixels of areas, and pixels that begin a run (empty where no two runs touch); slots
    /// by run.
    Runs { areas: &'a [u32], starts: &'a [u32], slots: RunSlots<'a> },
    /// One slot per pixel; neighbours of one slot are one run.
    Pixels(&'a [u16]),
}

/// A row of labels.
#[derive(Clone, Copy)]
pub struct LabelRow<'a> {
    pub(crate) row: usize,
    pub(crate) columns: usize,
    /// Packed: pixels with a return.
    pub(crate) returns: &'a [u32],
    pub(crate) slots: RowSlots<'a>,
    pub(crate) table: &'a [Area],
}

impl fmt::Debug for LabelRow<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("LabelRow").field("row", &self.row).field("columns", &self.columns).finish_non_exhaustive()
    }
}

impl<'a> LabelRow<'a> {
    /// Number of the row.
    #[must_use]
    pub fn row(&self) -> usize {
        self.row
    }

    /// Number of columns.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// The runs of area pixels, from the left, each with its label; `None` where the table of
    /// labels was full. Of the edge-based approach no two touch; of the region-based one each is a
    /// line; of the plane approach neighbours differ.
    pub fn runs(&self) -> impl Iterator<Item = (Range<usize>, Option<Label>)> + 'a {
        let (mut by_run, mut by_pixel) = (None, None);
        match self.slots {
            RowSlots::Runs { areas, starts, slots } => {
                let runs = bits::touching_runs(areas, starts, self.columns).enumerate();
                by_run = Some(runs.map(move |(i, run)| (run, slots.of_run(i))));
            }
            RowSlots::Pixels(slots) => {
                let runs = equal_runs(slots).map(|run| (run.clone(), at(slots, run.start)));
                by_pixel = Some(runs.filter(|&(_, slot)| slot != NONE));
            }
        }
        let table = self.table;
        let runs = by_run.into_iter().flatten().chain(by_pixel.into_iter().flatten());
        runs.map(move |(run, slot)| (run, table.get(usize::from(slot)).map(|area| Label(area.label))))
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
