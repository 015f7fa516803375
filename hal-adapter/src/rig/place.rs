//! The turn angle of a row and its continuation.

use scanseg_core::{ColumnTurns, RowBeams};

use super::limits::TiltLimits;
use crate::pairing::{RowTurn, shorter_way};

/// A row with a plausible turn angle: its place, and how its columns go on turning.
#[derive(Clone, Copy, Debug)]
pub(super) struct Line {
    pub place: Place,
    pub column_turns: ColumnTurns,
    /// Turn angle of the row less the place's, radians: of its first beam less that of the middle.
    pub first_rad: f32,
}

impl Line {
    /// Returns a row each of whose columns has its own turn.
    pub fn new(place: Place, turn: &RowTurn) -> Self {
        let RowBeams { turn_rad, column_turns, .. } = turn.beams();
        Self { place, column_turns, first_rad: turn_rad - place.turn_rad }
    }

    /// Returns a row whose columns are all turned as its place says.
    pub fn still(place: Place) -> Self {
        Self { place, column_turns: ColumnTurns::NONE, first_rad: 0.0 }
    }

    /// Returns where its beams point.
    pub fn beams(&self) -> RowBeams<'static> {
        RowBeams::from(self.place.turn_rad + self.first_rad).with_column_turns(self.column_turns)
    }
}

/// Turn angle and direction of the tilt at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub turn_rad: f32,
    pub rising: bool,
    pub start_us: u64,
}

impl Place {
    /// Returns the angle turned since `before`, radians; `None` if both cannot belong to one sweep.
    pub fn since(&self, before: &Place, limits: &TiltLimits) -> Option<f32> {
        let moved_rad = shorter_way(self.turn_rad - before.turn_rad);
        let moved_rad = if self.rising { moved_rad } else { -moved_rad };
        let time_us = self.start_us.checked_sub(before.start_us)?;
        let time_s = 1e-6 * time_us as f32;
        let [least_rad, most_rad] = [limits.min_rate_rad_per_s, limits.max_rate_rad_per_s].map(|rate| rate * time_s);
        let goes_on = self.rising == before.rising && time_us <= u64::from(limits.pause_us);
        (goes_on && (least_rad..=most_rad).contains(&moved_rad)).then_some(moved_rad)
    }
}
