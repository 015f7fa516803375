//! One row of a line scanner.

use core::f32::consts::TAU;

/// The part of a turn of the mirror that makes a row. For scanners that turn clockwise and all the
/// way round.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct View {
    /// Its left edge, where a row begins, radians: 0 is ahead, counter-clockwise is positive. Any
    /// finite angle.
    pub left_rad: f32,
    /// From its left to its right edge, radians, above 0. A full turn or more is a full turn.
    pub width_rad: f32,
}

impl View {
    /// All the way round, from behind to behind.
    pub const FULL: Self = Self { left_rad: core::f32::consts::PI, width_rad: TAU };
}

/// Memory for one row. What there is room for is the length of the shorter slice. A beam for which
/// there is no room is dropped and counted.
#[derive(Debug)]
pub struct RowMemory<'a> {
    /// Angles of the beams, radians.
    pub angles_rad: &'a mut [f32],
    /// Ranges along the beams, metres.
    pub ranges_m: &'a mut [f32],
}

/// A row: the beams of one turn of the mirror within the field of view, in the order in which they
/// were measured. Borrowed from its scanner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row<'a> {
    /// Angle of each beam, radians: 0 is ahead, counter-clockwise is positive. They rise by an LMS
    /// 2xx and fall by the scanners that turn clockwise, and they are as uneven as the scanner says.
    pub angles_rad: &'a [f32],
    /// Range along each beam, metres; 0 where there was no return. As many as angles.
    pub ranges_m: &'a [f32],
    /// When the mirror last stood at the last beam, microseconds by the clock of `feed`.
    pub end_us: u64,
    /// Time of one turn of the mirror, microseconds.
    pub mirror_turn_us: f32,
    /// Turns of the mirror merged in the row: beam `i` is of turn `(first_turn + i) % merged_turns`.
    /// 1 but for the complete scan lines of an LMS 2xx in steps of 0.5 and 0.25 degree.
    pub merged_turns: u16,
    /// The turn of the first beam: 0 but for a sub-range of such a scan line.
    pub first_turn: u16,
}

impl Row<'_> {
    /// Returns how long before [`Row::end_us`] this beam was measured, microseconds; 0 for a beam
    /// that is not there.
    #[must_use]
    pub fn beam_age_us(&self, beam: usize) -> f32 {
        let (Some(angle_rad), Some(last_rad)) = (self.angles_rad.get(beam), self.angles_rad.last()) else { return 0.0 };
        let turns = usize::from(self.merged_turns.max(1));
        let turn = (usize::from(self.first_turn) + beam).checked_rem(turns).unwrap_or(0);
        let turns_after = (turns - 1 - turn) as f32;
        (turns_after + (last_rad - angle_rad).abs() / TAU) * self.mirror_turn_us
    }

    /// Returns the mean of [`Row::beam_age_us`] over the beams; 0 if there are none.
    #[must_use]
    pub fn mean_age_us(&self) -> f32 {
        let beams = self.angles_rad.len();
        let sum_us: f32 = (0..beams).map(|beam| self.beam_age_us(beam)).sum();
        sum_us / beams.max(1) as f32
    }

    /// Puts each beam into the nearest column of an even fan, for a segmenter whose columns are
    /// [`Columns::Even`](scanseg_core::Columns::Even): column `c` is at `start_rad + c * step_rad`,
    /// there are as many as the shorter slice is long. Of two beams in one column the one nearer to
    /// its angle is kept. A column into which no beam falls has the range 0.
    ///
    /// `angles_rad` gets the true angle of each beam, or that of the column where there is none. A
    /// beam is off from its column by at most half a step.
    pub fn to_columns(&self, start_rad: f32, step_rad: f32, angles_rad: &mut [f32], ranges_m: &mut [f32]) {
        let at_rad = |column: usize| start_rad + column as f32 * step_rad;
        for (column, (angle_rad, range_m)) in angles_rad.iter_mut().zip(ranges_m.iter_mut()).enumerate() {
            (*angle_rad, *range_m) = (at_rad(column), 0.0);
        }
        for (&angle_rad, &range_m) in self.angles_rad.iter().zip(self.ranges_m) {
            // below 0 no column is nearest; a conversion saturates
            let nearest = (angle_rad - start_rad) / step_rad + 0.5;
            let column = nearest as usize;
            let (Some(kept_rad), Some(kept_m)) = (angles_rad.get_mut(column), ranges_m.get_mut(column)) else {
                continue;
            };
            let off_rad = |angle_rad: f32| (angle_rad - at_rad(column)).abs();
            if nearest >= 0.0 && range_m > 0.0 && (*kept_m == 0.0 || off_rad(angle_rad) < off_rad(*kept_rad)) {
                (*kept_rad, *kept_m) = (angle_rad, range_m);
            }
        }
    }
}
