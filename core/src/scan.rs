//! What all segmenters are to their user: one trait, what a row must satisfy, and what a call
//! reports.

use core::ops::ControlFlow;

use crate::config::Ranging;
use crate::error::PushError;
use crate::row::fan::{Fan, RowBeam};
use crate::row_beams::RowBeams;
use crate::sink::Sink;

/// The most rows of a scan.
pub const MAX_ROWS: usize = 65_535;

/// The most rows between a row pushed and the row whose labels it decides, of any approach; see
/// [`Segmenter::latency_rows`].
pub const MAX_LATENCY_ROWS: usize = 3;

/// Segments a scan while it comes in, row by row.
///
/// Nothing allocates, blocks or panics. After [`Segmenter::finish`], [`Segmenter::reset`], or a
/// sink that breaks off, the next row pushed is the first of a new scan.
pub trait Segmenter {
    /// Takes the next row: one range per column in metres, and where its beams point: most often
    /// just the row's turn angle (nodding) or elevation (spinning) in radians; pinhole beams do not
    /// use it. NaN, infinite and non-positive ranges, and those outside of the configured limits,
    /// are pixels without a return.
    ///
    /// Gives the sink the labels of the row [`Segmenter::latency_rows`] earlier, and the joins and
    /// segments that it brings.
    ///
    /// # Errors
    /// [`PushError`]: the row was not taken and the segmenter is as it was before.
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        sink: &mut S,
    ) -> Result<Status, PushError>;

    /// Ends the scan: gives out the rows that were still waiting and completes all segments.
    fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> Finished;

    /// Drops what was pushed.
    fn reset(&mut self);

    /// Rows between the row pushed and the row whose labels it decides: 0 to [`MAX_LATENCY_ROWS`].
    fn latency_rows(&self) -> usize;
}

/// What [`Segmenter::push_row`] did, and what to do next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Status {
    /// The row is stored; no labels yet. Push the next row.
    Buffered,
    /// The sink was given the labels of `row`. Push the next row, or finish.
    Labelled {
        /// The row that was given out.
        row: usize,
        /// Pixels in it that got no label because the table of live labels was full. Nothing to do
        /// for this scan; give the next one a larger table.
        unlabelled: u32,
    },
    /// The sink broke off. The scan is dropped; the next row pushed is the first of a new scan.
    Stopped,
}

/// How a scan ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Finished {
    /// All rows were given out. The next row pushed is the first of a new scan.
    Complete {
        /// Rows of the scan.
        rows: usize,
        /// Pixels that got no label because the table of live labels was full.
        unlabelled: u32,
    },
    /// The sink broke off. What was left is dropped.
    Stopped,
}

/// How far a scan has come.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Progress {
    /// Rows pushed.
    pub rows: usize,
    unlabelled: u32,
}

impl Progress {
    /// Takes note of the next row of an image of `columns` columns. Returns its number and beams.
    pub fn begin_row<'r>(
        &mut self,
        ranges_m: &[f32],
        beams: RowBeams<'r>,
        columns: usize,
        (fan, ranging): (&Fan, &Ranging),
    ) -> Result<RowBeam<'r>, PushError> {
        if ranges_m.len() != columns {
            return Err(PushError::RowLength { expected: columns, got: ranges_m.len() });
        }
        beams.check(&fan.beams, ranging, ranges_m)?;
        if self.rows == MAX_ROWS {
            return Err(PushError::TooManyRows { max_rows: MAX_ROWS });
        }
        self.rows += 1;
        Ok(RowBeam { row: self.rows - 1, beams })
    }

    /// Counts the unlabelled pixels of a row that was given out.
    pub fn labelled(&mut self, unlabelled: u32) {
        self.unlabelled = self.unlabelled.saturating_add(unlabelled);
    }

    /// What to report of the end of the scan.
    pub fn finished(&self, ended: ControlFlow<()>) -> Finished {
        match ended {
            ControlFlow::Continue(()) => Finished::Complete { rows: self.rows, unlabelled: self.unlabelled },
            ControlFlow::Break(()) => Finished::Stopped,
        }
    }
}
