//! Points as a scanner sees them that turns about an axis.

use crate::angles::Angles;
use crate::beside::Beside;
use crate::cloud::fit::{Arrangement, Deviation, length, median};
use crate::geometry::{Kind, TurnAxis};

/// Points as angles, radians; NaN where nothing was measured.
pub(crate) struct Grid {
    rows: usize,
    columns: usize,
    /// Above the plane across the axis.
    lift: Vec<f64>,
    /// About the axis.
    turn: Vec<f64>,
    /// The usual step from a column to the next, and from a row to the next.
    step: [f64; 2],
}

impl Grid {
    /// Returns the angles about an axis; none of points that have no neighbours.
    pub fn of(points: &[[f32; 3]], columns: usize, axis: TurnAxis) -> Option<Grid> {
        let angles = |point: &[f32; 3]| {
            let [x, y, z] = point.map(f64::from);
            let (along, aside) = match axis {
                TurnAxis::Z => (z, y),
                TurnAxis::Y => (y, z),
            };
            let range = length(point);
            if range > 0.0 { ((along / range).clamp(-1.0, 1.0).asin(), aside.atan2(x)) } else { (f64::NAN, f64::NAN) }
        };
        let (lift, turn): (Vec<f64>, Vec<f64>) = points.iter().map(angles).unzip();
        let mut grid = Grid { rows: points.len() / columns, columns, lift, turn, step: [0.0; 2] };
        // some thousand pairs are enough
        let every = points.len() / 5000 + 1;
        for (i, back) in [1, columns].into_iter().enumerate() {
            let apart = |at: usize| {
                let along_row = back != 1 || !at.is_multiple_of(columns);
                let (a, b) = (at, at.checked_sub(back).filter(|_| along_row)?);
                let turn = wrapped(grid.turn[a] - grid.turn[b]) * grid.lift[a].cos();
                Some(turn.hypot(grid.lift[a] - grid.lift[b])).filter(|angle| angle.is_finite())
            };
            grid.step[i] = median(&mut (0..points.len()).step_by(every).filter_map(apart).collect::<Vec<_>>())?;
        }
        (grid.step[0] > 0.0 && grid.step[1] > 0.0).then_some(grid)
    }

    fn at(&self, row: usize, column: usize) -> usize {
        row * self.columns + column
    }

    /// Returns the middle of an angle over each row.
    fn of_rows(&self, angle: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        (0..self.rows).map(|row| middle((0..self.columns).map(|column| angle(row, column)))).collect()
    }

    /// Returns the middle of an angle over each column.
    fn of_columns(&self, angle: impl Fn(usize, usize) -> f64) -> Vec<f64> {
        (0..self.columns).map(|column| middle((0..self.rows).map(|row| angle(row, column)))).collect()
    }

    /// Returns an angle about the axis for each row, and one for each column, whose sums are nearest
    /// to the angles of the points. Of the columns the middle is 0, or of the rows.
    fn turns(&self, columns_around_0: bool) -> [Vec<f64>; 2] {
        let mut rows = vec![0.0; self.rows];
        let mut columns = vec![0.0; self.columns];
        // once where all pixels are there; where some are missing, each time nearer
        for _ in 0..8 {
            let before = if columns_around_0 { columns.clone() } else { rows.clone() };
            if columns_around_0 {
                rows = self.of_rows(|row, column| self.turn[self.at(row, column)] - or_0(columns[column]));
                columns = self.of_columns(|row, column| wrapped(self.turn[self.at(row, column)] - rows[row]));
            } else {
                columns = self.of_columns(|row, column| self.turn[self.at(row, column)] - or_0(rows[row]));
                rows = self.of_rows(|row, column| wrapped(self.turn[self.at(row, column)] - columns[column]));
            }
            let now = if columns_around_0 { &columns } else { &rows };
            if before.iter().zip(now).all(|(a, b)| b.is_nan() || (a - b).abs() < 1e-3 * self.step[0]) {
                break;
            }
        }
        [rows, columns]
    }

    /// Returns how the points deviate from beams of these angles.
    fn deviation(&self, lift: impl Fn(usize, usize) -> f64, turns: &[Vec<f64>; 2]) -> Deviation {
        let mut deviation = Deviation::default();
        for row in 0..self.rows {
            for column in 0..self.columns {
                let at = self.at(row, column);
                if self.lift[at].is_nan() {
                    continue;
                }
                let turn = wrapped(self.turn[at] - turns[0][row] - turns[1][column]) * self.lift[at].cos();
                let lift = self.lift[at] - lift(row, column);
                // along the row and along the column, or the other way round: the shorter step counts
                let step = self.step[0].min(self.step[1]);
                deviation.add(turn / step, lift / step);
            }
        }
        deviation
    }
}

/// Returns the spinning scanner that fits best.
pub(crate) fn spinning(grid: &Grid) -> Option<(Deviation, Arrangement)> {
    let elevation = grid.of_rows(|row, column| grid.lift[grid.at(row, column)]);
    let turns = grid.turns(false);
    let deviation = grid.deviation(|row, _| elevation[row], &turns);
    let [offsets, azimuth] = turns;
    let azimuth = gaps_filled(unwrapped(azimuth))?;
    let (first, last) = (azimuth[0], azimuth[azimuth.len() - 1]);
    let round = (last - first).abs() * grid.columns as f64 / (grid.columns as f64 - 1.0);
    let step = round / grid.columns as f64;
    let wraps = grid.columns > 8 && (round - std::f64::consts::TAU).abs() < 1.5 * step;
    let kind = Kind::Spinning { azimuth_deg: angles(&azimuth), elevation_deg: angles(&gaps_filled(elevation)?), wraps };
    let beside = Beside { row_offset_deg: offset(&offsets, grid), ..Beside::NONE };
    Some((deviation, Arrangement { kind, beside }))
}

/// Returns the nodding scanner that fits best.
pub(crate) fn nodding(grid: &Grid, turn_axis: TurnAxis) -> Option<(Deviation, Arrangement)> {
    let beam = grid.of_columns(|row, column| grid.lift[grid.at(row, column)]);
    let turns = grid.turns(true);
    let deviation = grid.deviation(|_, column| beam[column], &turns);
    let [turn, offsets] = turns;
    let kind = Kind::Nodding {
        beam_deg: angles(&gaps_filled(beam)?),
        turn_deg: angles(&gaps_filled(unwrapped(turn))?),
        turn_axis,
    };
    let beside = Beside { column_offset_deg: offset(&offsets, grid), ..Beside::NONE };
    Some((deviation, Arrangement { kind, beside }))
}

/// Returns offsets in degrees; none where all are as good as 0.
fn offset(offsets: &[f64], grid: &Grid) -> Option<Angles> {
    let matters = offsets.iter().any(|x| x.abs() > 0.02 * grid.step[0].min(grid.step[1]));
    matters.then(|| Angles::Listed(offsets.iter().map(|x| or_0(*x).to_degrees()).collect()))
}

/// Returns angles in degrees: even ones if they are, within a fiftieth of a step.
fn angles(list: &[f64]) -> Angles {
    let count = list.len() as f64;
    let (middle, mean) = ((count - 1.0) / 2.0, list.iter().sum::<f64>() / count);
    let places = || (0..).map(|i: u32| f64::from(i) - middle);
    let step = places().zip(list).map(|(place, x)| place * (x - mean)).sum::<f64>()
        / places().take(list.len()).map(|place| place * place).sum::<f64>();
    let even = |(place, x): (f64, &f64)| (x - mean - step * place).abs() < 0.02 * step.abs();
    if step.is_finite() && places().zip(list).all(even) {
        return Angles::Even { start_deg: (mean - step * middle).to_degrees(), step_deg: step.to_degrees() };
    }
    Angles::Listed(list.iter().map(|x| x.to_degrees()).collect())
}

/// Returns the middle of some angles, of which the NaN ones do not count; NaN of none. Those across
/// the seam at 180 degrees are neighbours.
fn middle(angles: impl Iterator<Item = f64>) -> f64 {
    let mut angles: Vec<f64> = angles.filter(|x| x.is_finite()).collect();
    let (sines, cosines) = angles.iter().fold((0.0, 0.0), |(s, c), x| (s + x.sin(), c + x.cos()));
    let about = f64::atan2(sines, cosines);
    angles.iter_mut().for_each(|x| *x = wrapped(*x - about));
    median(&mut angles).map_or(f64::NAN, |x| wrapped(x + about))
}

/// Within half a turn of 0.
fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if angle.abs() <= PI { angle } else { angle - TAU * (angle / TAU).round() }
}

fn or_0(x: f64) -> f64 {
    if x.is_nan() { 0.0 } else { x }
}

/// Returns angles that go on without a jump of a turn.
fn unwrapped(mut angles: Vec<f64>) -> Vec<f64> {
    let mut before = f64::NAN;
    for x in angles.iter_mut().filter(|x| x.is_finite()) {
        if before.is_finite() {
            *x = before + wrapped(*x - before);
        }
        before = *x;
    }
    angles
}

/// Returns angles with those in place that nothing was measured of: between their neighbours, at the
/// ends going on as the nearest two.
fn gaps_filled(mut angles: Vec<f64>) -> Option<Vec<f64>> {
    let known: Vec<usize> = (0..angles.len()).filter(|&i| angles[i].is_finite()).collect();
    if known.len() < 2 {
        return None;
    }
    for i in 0..angles.len() {
        if angles[i].is_finite() {
            continue;
        }
        let after = known.partition_point(|&k| k < i).clamp(1, known.len() - 1);
        let (a, b) = (known[after - 1], known[after]);
        let step = (angles[b] - angles[a]) / (b - a) as f64;
        angles[i] = angles[a] + step * (i as f64 - a as f64);
    }
    Some(angles)
}
