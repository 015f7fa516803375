//! Beams that go round become rows.

use core::f32::consts::TAU;

use super::counters::{ScannerCounters, count};
use super::row::{RowMemory, View};

/// A full turn in the unit of this module's angles, 2^-32 of a turn: their arithmetic wraps as
/// angles do.
pub(crate) const FULL_TURN: f32 = 4_294_967_296.0;
/// A beam lies at most so far behind the last one, 15 degrees: those of triangulating scanners go
/// back where something is near. One that lies farther behind has gone on to the next turn.
pub(crate) const BACK: u32 = (FULL_TURN / 24.0) as u32;

/// What becomes of a beam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[must_use]
pub(crate) enum Cut {
    /// It is taken, or lies outside of the field of view.
    Done,
    /// The row is complete without it. Give out the row, then give the beam again.
    RowEnds,
}

/// Cuts the beams of a scanner that turns clockwise into rows.
#[derive(Debug)]
pub(crate) struct Cutter<'a> {
    memory: RowMemory<'a>,
    left_rad: f32,
    /// The scanner's angle of the left edge, and from there to the right edge.
    left: u32,
    width: u32,
    /// Beams in the row.
    beams: usize,
    /// The last beam, from the left edge.
    last: Option<u32>,
    /// The last beam in the row.
    last_in_row: u32,
    /// The row has been given out.
    complete: bool,
}

impl<'a> Cutter<'a> {
    pub fn new(view: View, memory: RowMemory<'a>) -> Self {
        // whole turns do not fit 32 bits and vanish
        let left = (-view.left_rad / TAU * FULL_TURN) as i64;
        let width = view.width_rad / TAU * FULL_TURN;
        Self {
            memory,
            left_rad: view.left_rad,
            left: left as u32,
            width: width as u32,
            beams: 0,
            last: None,
            last_in_row: 0,
            complete: false,
        }
    }

    /// Drops the row that was given out. Call it before anything else is taken.
    pub fn next_row(&mut self) {
        if core::mem::take(&mut self.complete) {
            self.beams = 0;
        }
    }

    /// Takes a beam at the scanner's own angle, clockwise from ahead.
    pub fn beam(&mut self, angle: u32, range_m: f32, counters: &mut ScannerCounters) -> Cut {
        let position = angle.wrapping_sub(self.left);
        let inside = position <= self.width;
        if let Some(last) = self.last {
            let forward = position.wrapping_sub(last) < u32::MAX - BACK;
            if forward && (position < last || !inside) && self.beams > 0 {
                return self.end();
            }
            if !forward && position > last {
                // back over the left edge, into the row before
                count(&mut counters.dropped_beams, u32::from(inside));
                return Cut::Done;
            }
        }
        self.last = Some(position);
        if inside {
            let memory = (self.memory.angles_rad.get_mut(self.beams), self.memory.ranges_m.get_mut(self.beams));
            if let (Some(to_rad), Some(to_m)) = memory {
                *to_rad = self.left_rad - position as f32 * (TAU / FULL_TURN);
                *to_m = range_m;
                self.last_in_row = position;
                self.beams += 1;
            } else {
                count(&mut counters.dropped_beams, 1);
            }
        }
        Cut::Done
    }

    /// Ends the row because a turn or more is missing.
    pub fn missing(&mut self) -> Cut {
        if self.beams > 0 { self.end() } else { Cut::Done }
    }

    fn end(&mut self) -> Cut {
        self.complete = true;
        self.last = None;
        Cut::RowEnds
    }

    /// Returns angles and ranges of the row that has ended, until `next_row`.
    pub fn row(&self) -> Option<(&[f32], &[f32])> {
        let angles_rad = self.memory.angles_rad.get(..self.beams)?;
        let ranges_m = self.memory.ranges_m.get(..self.beams)?;
        self.complete.then_some((angles_rad, ranges_m))
    }

    /// Returns the part of a turn from the last beam of the row to this angle of the scanner.
    pub fn turns_since_row(&self, angle: u32) -> f32 {
        angle.wrapping_sub(self.left).wrapping_sub(self.last_in_row) as f32 / FULL_TURN
    }
}
