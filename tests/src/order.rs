//! What the plane approach promises of its events, where a segment that was complete may go on.

use crate::stream::{Event, Record};
use scanseg_core::{Finished, Join, Pixel, Status};
use std::collections::{BTreeMap, BTreeSet};

/// Rows without a return below which a segment goes on.
const MISSING_ROWS: usize = 3;

/// What is known of a label.
#[derive(Clone, Copy, Debug, PartialEq)]
enum State {
    Lives,
    Reported,
    Joined,
}

/// What happened to the labels of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub struct Life {
    /// Labels that began.
    pub begun: u32,
    /// Joins.
    pub joins: usize,
    /// Joins that name a segment that was reported before.
    pub resumed: usize,
    /// Segments reported, each time.
    pub reports: usize,
}

impl Record {
    /// Asserts what is promised of a scan of `rows` rows that was not broken off:
    /// - for each row pushed come its edges, its joins, the segments that it completes, its labels,
    ///   in this order; at the end come joins and segments;
    /// - labels are 1, 2, 3, ... and a row begins the next ones without a gap; new ones show in it
    ///   or are joined in it;
    /// - a join ends a greater label in favour of a smaller one; both have begun and neither was
    ///   joined before;
    /// - the labels of a row are those of areas that live: a segment that was reported lives again
    ///   only by a join of this row that names it;
    /// - a segment is complete the row after its last one, or up to three rows later where its
    ///   pixels had no return below them, lived until then, and has its pixels; what is joined of
    ///   several is complete when they are joined, or later;
    /// - reported again it has all that it had before;
    /// - in the end every label was joined or reported.
    pub fn assert_order_of_planes(&self, rows: usize) -> Life {
        let mut life = Life::default();
        let mut states: BTreeMap<u32, State> = BTreeMap::new();
        // pixels of each label by what was told so far, and of each at its last report
        let (mut pixels_of, mut reported) = (BTreeMap::<u32, u32>::new(), BTreeMap::new());
        // 0: edges are due, 1: joins, 2: segments
        let (mut stage, mut done, mut new) = (0, 0, Vec::new());
        let mut resumed = BTreeSet::new();
        for event in &self.events {
            match event {
                Event::Edges { row, .. } => {
                    assert!(*row == done && stage == 0, "edges of row {row}");
                    stage = 1;
                }
                Event::Join(Join { from, into }) => {
                    assert!(stage == 1 || (done == rows && stage == 0), "row {done}: join of {from}");
                    resumed.insert(into.0);
                    assert!(into < from);
                    life.joins += 1;
                    for label in [from.0, into.0] {
                        let state = *states.entry(label).or_insert_with(|| {
                            new.push(label);
                            State::Lives
                        });
                        assert_ne!(state, State::Joined, "row {done}: {label} was joined before");
                        life.resumed += usize::from(state == State::Reported);
                    }
                    states.insert(from.0, State::Joined);
                    states.insert(into.0, State::Lives);
                    let pixels = pixels_of.remove(&from.0).unwrap_or(0);
                    *pixels_of.entry(into.0).or_insert(0) += pixels;
                    let before = reported.remove(&from.0).unwrap_or(0);
                    *reported.entry(into.0).or_insert(0) += before;
                }
                Event::Segment(segment) => {
                    let label = segment.label.0;
                    assert!(stage == 1 || stage == 2 || done == rows, "row {done}: {segment:?}");
                    stage = if done == rows { 0 } else { 2 };
                    assert_eq!(states.insert(label, State::Reported), Some(State::Lives), "{segment:?}");
                    let late = done - usize::from(segment.last_row) - 1;
                    assert!(late <= MISSING_ROWS || resumed.contains(&label) || done == rows, "{segment:?}");
                    assert_eq!(segment.pixels(), pixels_of[&label], "{segment:?}");
                    assert!(reported.insert(label, segment.pixels()).is_none_or(|before| before <= segment.pixels()));
                    life.reports += 1;
                }
                Event::Row { row, pixels } => {
                    assert!(*row == done && stage > 0, "labels of row {row}");
                    for pixel in pixels {
                        if let Pixel::Segment(label) = pixel {
                            let state = states.entry(label.0).or_insert_with(|| {
                                new.push(label.0);
                                State::Lives
                            });
                            assert_eq!(*state, State::Lives, "row {row}: label {label}");
                            *pixels_of.entry(label.0).or_insert(0) += 1;
                        }
                    }
                    new.sort();
                    for label in new.drain(..) {
                        life.begun += 1;
                        assert_eq!(label, life.begun, "row {row}: the next label");
                    }
                    (stage, done) = (0, done + 1);
                }
            }
        }
        assert_eq!(done, rows);
        assert!(states.values().all(|&state| state != State::Lives), "{states:?}");
        assert_eq!(states.len() as u32, life.begun);
        let unlabelled = if rows > 0 { self.unlabelled(self.columns) } else { Vec::new() };
        let expected = unlabelled.iter().enumerate().map(|(row, &unlabelled)| Status::Labelled { row, unlabelled });
        assert_eq!(self.statuses, expected.collect::<Vec<_>>());
        assert_eq!(self.finished, Some(Finished::Complete { rows, unlabelled: unlabelled.iter().sum() }));
        life
    }
}
