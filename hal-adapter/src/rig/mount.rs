//! The rig of any other line scanner: each beam at its own angles.

use core::f32::consts::TAU;

use scanseg_core::{Beams, RowBeams, Segmenter, TurnAxis};

use super::counters::{Dropped, count};
use super::limits::{RigError, TiltLimits};
use super::pipeline::{Rig, Turns};
use super::sink::RigSink;
use crate::scanner::{LineEvent, LineScanner, Row};

/// How a line scanner sits on a turning axis, and the columns into which its beams are put.
///
/// The axis lies in the plane in which the mirror turns, or beside it in parallel. A beam at the
/// scanner's angle 0 leaves at a right angle to the axis. Column `c` has the beam that is nearest to
/// `start_rad + c * step_rad`. Its direction is the true one, by the angle that the scanner tells
/// and by the turn angle at the time of the beam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mount {
    /// The axis: [`TurnAxis::Z`] pans, [`TurnAxis::Y`] tilts.
    pub axis: TurnAxis,
    /// Columns, 1 to [`MAX_COLUMNS`](scanseg_core::MAX_COLUMNS).
    pub columns: u16,
    /// Angle of column 0, radians, within a turn to either side.
    pub start_rad: f32,
    /// From a column to the next, radians, not 0, at most a turn: the step of the scanner, or a
    /// little more, so that no column is left without a beam.
    pub step_rad: f32,
    /// Distance of the scanner's origin from the axis, along the beam at angle 0, metres, within
    /// +-10.
    pub lever_arm_m: f32,
    /// Usual time of a turn of the mirror, microseconds, above 0.
    pub row_us: u32,
}

impl Mount {
    /// Returns the beams for the segmenter. Where the columns go all around, to 1 %, the last one
    /// neighbours the first.
    #[must_use]
    pub fn beams(&self) -> Beams<'static> {
        let around_rad = self.step_rad.abs() * f32::from(self.columns);
        Beams::Free { wraps: (around_rad - TAU).abs() < 0.01 * TAU }
    }

    fn check(&self) -> Result<(), RigError> {
        let within = |field, value: f32, most: f32, ok: bool| {
            if ok && (-most..=most).contains(&value) { Ok(()) } else { Err(RigError::Mount { field, value }) }
        };
        let columns = f32::from(self.columns);
        within("columns", columns, scanseg_core::MAX_COLUMNS as f32, self.columns > 0)?;
        within("start_rad", self.start_rad, TAU, true)?;
        within("step_rad", self.step_rad, TAU, self.step_rad != 0.0)?;
        within("lever_arm_m", self.lever_arm_m, 10.0, true)?;
        within("row_us", self.row_us as f32, f32::MAX, self.row_us > 0)
    }

    /// Puts the beams of a row into the columns. `turn_rad` is the turn angle `age_us` before the
    /// end of the row.
    fn fill(&self, row: &Row<'_>, [turn_rad, age_us, rate_rad_per_us]: [f32; 3], row_m: &mut [f32]) {
        row_m.fill(0.0);
        let Some((ranges_m, rest)) = row_m.split_at_mut_checked(self.columns.into()) else { return };
        let (directions, _) = rest.as_chunks_mut::<3>();
        for (beam, (&angle_rad, &range_m)) in row.angles_rad.iter().zip(row.ranges_m).enumerate() {
            // below 0 no column is nearest; a conversion saturates
            let place = (angle_rad - self.start_rad) / self.step_rad + 0.5;
            let column = place as usize;
            let kept = (ranges_m.get_mut(column), directions.get_mut(column));
            let (Some(kept_m), Some(kept)) = kept else { continue };
            let off = (place - column as f32 - 0.5).abs();
            // of two beams in a column the nearer one; until all are there, `kept` has angle, turn
            // and distance
            if place >= 0.0 && range_m > 0.0 && (*kept_m == 0.0 || off < kept[2]) {
                let turn_rad = turn_rad + rate_rad_per_us * (age_us - row.beam_age_us(beam));
                (*kept_m, *kept) = (range_m, [angle_rad, turn_rad, off]);
            }
        }
        for (range_m, kept) in ranges_m.iter_mut().zip(directions) {
            if *range_m > 0.0 {
                let [angle_rad, turn_rad, _] = *kept;
                (*range_m, *kept) = self.seen_from_axis(angle_rad, turn_rad, *range_m);
            }
        }
    }

    /// Returns range and direction of a point as seen from the axis.
    fn seen_from_axis(&self, angle_rad: f32, turn_rad: f32, range_m: f32) -> (f32, [f32; 3]) {
        let ((sin, cos), (turn_sin, turn_cos)) = (libm::sincosf(angle_rad), libm::sincosf(turn_rad));
        let (out_m, along_m) = (self.lever_arm_m + range_m * cos, range_m * sin);
        let range_m = libm::sqrtf(out_m * out_m + along_m * along_m);
        // nothing lies on the axis
        if range_m < f32::MIN_POSITIVE {
            return (0.0, [0.0; 3]);
        }
        let (out, along) = (out_m / range_m, along_m / range_m);
        let direction = match self.axis {
            TurnAxis::Y => [out * turn_cos, along, out * turn_sin],
            TurnAxis::Z => [out * turn_cos, out * turn_sin, along],
        };
        (range_m, direction)
    }
}

impl Turns for Mount {
    type Beams<'r> = RowBeams<'r>;

    fn beams<'r>(&self, _: f32, rest: &'r [f32]) -> RowBeams<'r> {
        RowBeams::free(rest.as_chunks().0)
    }
}

impl<'a, S: Segmenter> Rig<'a, S, Mount> {
    /// Returns the rig of a scanner that is so mounted. `segmenter` has the columns of the mount and
    /// its [`Mount::beams`]. `rows_m` is memory for two rows: 8 numbers a column.
    ///
    /// # Errors
    /// [`RigError`]: the limits or the mount cannot be used, or the memory is too short.
    pub fn mounted(mount: Mount, limits: TiltLimits, segmenter: S, rows_m: &'a mut [f32]) -> Result<Self, RigError> {
        mount.check()?;
        // a range and a direction
        let rows = (mount.columns, 4, mount.row_us, 0);
        Self::of_parts(mount, rows, limits, segmenter, rows_m)
    }

    /// Takes bytes of the scanner. The last of them came at `now_us`, microseconds. The scanner is the
    /// same in each call.
    pub fn receive(
        &mut self,
        scanner: &mut impl LineScanner,
        bytes: &[u8],
        now_us: u64,
        sink: &mut (impl RigSink + ?Sized),
    ) {
        self.counters.bytes = self.counters.bytes.wrapping_add(bytes.len() as u64);
        let mut rest = bytes;
        loop {
            let (used, event) = scanner.feed(rest, now_us);
            rest = rest.get(used..).unwrap_or(&[]);
            let found = scanner.counters();
            (self.counters.rejected, self.counters.lost) = (found.rejected, found.lost);
            match event {
                LineEvent::NeedMore => break,
                LineEvent::Rejected(_) => {}
                LineEvent::Row => {
                    if let Some(row) = scanner.row() {
                        self.line(&row, sink);
                    }
                }
            }
        }
    }

    fn line(&mut self, row: &Row<'_>, sink: &mut (impl RigSink + ?Sized)) {
        count(&mut self.counters.telegrams);
        let age_us = row.mean_age_us();
        // the samples are to lie about the middle of the row
        self.pairing.start(row.end_us.saturating_sub(age_us as u64));
        let Some((turn_rad, rate_rad_per_us)) = self.pairing.at_age(0.0) else {
            return self.drop_row(Dropped::NoTurn, sink);
        };
        match self.place(turn_rad, rate_rad_per_us * 1e6, row.end_us) {
            Err(dropped) => self.drop_row(dropped, sink),
            Ok(place) => {
                self.scanner.fill(row, [turn_rad, age_us, rate_rad_per_us], self.row_m);
                self.row(place, sink);
            }
        }
    }
}
