//! What a rig wants of a segmenter and of the sink.

use core::ops::ControlFlow;

use scanseg_core::{
    EdgeRow, EdgeSegmenter, Finished, Join, LabelRow, PlaneSegmenter, PushError, RegionSegmenter, Segment, Sink, Status,
};
use serde::{Deserialize, Serialize};

use super::counters::count;
use super::{Counters, Dropped};
use crate::lms2xx::Trouble;

/// A segmenter that takes a scan row by row.
pub trait RowSegmenter {
    /// Takes the next row: ranges in metres, 0 without a return, and the turn angle in radians.
    ///
    /// # Errors
    /// [`PushError`]: the row was not taken.
    fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError>;

    /// Ends the scan. The next row is the first of a new one.
    fn finish(&mut self, sink: &mut impl Sink) -> Finished;
}

macro_rules! row_segmenter {
    ($($segmenter:ident)*) => {$(
        impl RowSegmenter for $segmenter<'_> {
            fn push_row(&mut self, ranges_m: &[f32], turn_rad: f32, sink: &mut impl Sink) -> Result<Status, PushError> {
                $segmenter::push_row(self, ranges_m, turn_rad, sink)
            }

            fn finish(&mut self, sink: &mut impl Sink) -> Finished {
                $segmenter::finish(self, sink)
            }
        }
    )*};
}

row_segmenter!(PlaneSegmenter EdgeSegmenter RegionSegmenter);

/// A scan has begun.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanStarted {
    /// Number of the scan, from 1.
    pub number: u32,
    /// Columns of its rows.
    pub columns: u16,
    /// Turn angle of its first row, radians.
    pub turn_rad: f32,
}

/// Why a scan is over.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum End {
    /// The tilt turned back, or went on from somewhere else.
    Turned,
    /// The sweep was covered, or the segmenter takes no more rows.
    Covered,
    /// No row came for too long.
    Pause,
    /// Something was wrong with the scanner.
    Trouble,
    /// [`Rig::finish`](super::Rig::finish) was called.
    Asked,
}

/// A scan is over; all of its segments have been given out.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanFinished {
    /// Number of the scan, from 1.
    pub number: u32,
    /// Why it is over.
    pub end: End,
    /// Rows that it had.
    pub rows: u16,
    /// Pixels without a label because the segmenter's table of live labels was full.
    pub unlabelled: u32,
    /// All that has happened since the rig was made.
    pub counters: Counters,
}

/// Takes what a rig finds: labels, joins and segments as any [`Sink`], and what happens around them. If the sink breaks off,
/// the rest of the sweep is dropped.
pub trait RigSink: Sink {
    /// A scan begins; its rows follow.
    fn scan_started(&mut self, scan: &ScanStarted) {
        let _ = scan;
    }

    /// A good telegram did not become a row.
    fn row_dropped(&mut self, dropped: Dropped) {
        let _ = dropped;
    }

    /// A scan is over.
    fn scan_finished(&mut self, scan: &ScanFinished) {
        let _ = scan;
    }

    /// Something is wrong with the scanner. If a scan was under way it is over.
    fn trouble(&mut self, trouble: Trouble) {
        let _ = trouble;
    }
}

/// Counts the segments on their way to the sink.
pub(super) struct Counting<'a, S> {
    pub sink: &'a mut S,
    pub segments: &'a mut u32,
}

impl<S: Sink> Sink for Counting<'_, S> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.sink.row(row)
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.sink.join(join)
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        count(self.segments);
        self.sink.segment(segment)
    }

    fn edges(&mut self, row: &EdgeRow<'_>) -> ControlFlow<()> {
        self.sink.edges(row)
    }
}
