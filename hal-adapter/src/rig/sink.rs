//! What a rig gives to its sink.

use core::ops::ControlFlow;

use super::counters::{Counters, Dropped, count};
use crate::lms2xx::Trouble;
use scanseg_core::{EdgeRow, Join, LabelRow, Segment, Sink};

/// A scan has begun.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum End {
    /// The tilt turned back, or continued elsewhere.
    Turned,
    /// The sweep has covered the angle set, or the segmenter takes no more rows.
    Covered,
    /// No row came within [`TiltLimits::pause_us`](super::TiltLimits::pause_us).
    Pause,
    /// The scanner had a [`Trouble`].
    Trouble,
    /// [`Rig::finish`](super::Rig::finish) was called.
    Asked,
}

/// A scan is over; all of its segments have been given out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "link", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScanFinished {
    /// Number of the scan, from 1.
    pub number: u32,
    /// Why it is over.
    pub end: End,
    /// Number of its rows.
    pub rows: u16,
    /// Pixels without a label because the segmenter's table of live labels was full.
    pub unlabelled: u32,
    /// Counts since the rig was made.
    pub counters: Counters,
}

/// Takes the results of a rig: labels, joins and segments as a [`Sink`], and the events of the rig.
/// If the sink breaks off, the rest of the sweep is dropped.
pub trait RigSink: Sink {
    /// A scan begins; its rows follow.
    fn scan_started(&mut self, scan: &ScanStarted) {
        let _ = scan;
    }

    /// A valid telegram did not become a row.
    fn row_dropped(&mut self, dropped: Dropped) {
        let _ = dropped;
    }

    /// A scan is over.
    fn scan_finished(&mut self, scan: &ScanFinished) {
        let _ = scan;
    }

    /// The scanner has a trouble. A scan under way has been finished before this call.
    fn trouble(&mut self, trouble: Trouble) {
        let _ = trouble;
    }
}

/// Forwards every call.
#[deny(clippy::missing_trait_methods)]
impl<S: RigSink + ?Sized> RigSink for &mut S {
    fn scan_started(&mut self, scan: &ScanStarted) {
        (**self).scan_started(scan);
    }

    fn row_dropped(&mut self, dropped: Dropped) {
        (**self).row_dropped(dropped);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        (**self).scan_finished(scan);
    }

    fn trouble(&mut self, trouble: Trouble) {
        (**self).trouble(trouble);
    }
}

/// Forwards every call and counts the segments.
pub(super) struct Counting<'a, S: ?Sized> {
    pub sink: &'a mut S,
    pub segments: &'a mut u32,
}

#[deny(clippy::missing_trait_methods)]
impl<S: Sink + ?Sized> Sink for Counting<'_, S> {
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
