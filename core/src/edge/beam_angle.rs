//! The angle between two beams (paper section 3: the "laser beam angular step in the direction of
//! the trace").
//!
//! A beam is a rotation s about an axis and an angle p within the plane that holds the axis. With
//! vers x = 1 - cos x = 2 sin^2(x / 2), two beams are apart by Phi with
//!
//! ```text
//! vers Phi = vers(p1 - p2) + cos p1 cos p2 vers(s1 - s2)
//! ```
//!
//! for every trace: sums of small positive terms, so that nothing cancels. A nodding scanner has p
//! per column and s per row, a spinning one p per row (elevation) and s per column (azimuth). For a
//! pinhole camera the same comes from the cross product of the two directions. The turn step is
//! never taken for Phi.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{cos_sin, cross, dot, inverse_sqrt, less, plus};
use crate::beam::{Beams, Columns};
use crate::edge::trace::Trace;
use crate::row::bits::CHUNK;
use crate::row::fan::{Fan, Lane, RowBeam};
use crate::row_beams::ColumnTurns;

/// Two beams closer than this have no bearing angle, radians: near the turning axis of a nodding
/// scanner the beams of neighbouring rows coincide.
pub const MIN_BEAM_ANGLE_RAD: f32 = 1e-5;

/// The angle Phi between two beams, as the two numbers that the bearing angle needs.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct BeamAngle {
    /// sin Phi, 0 to 1.
    pub sin: f32,
    /// vers Phi = 1 - cos Phi, 0 to 2.
    pub vers: f32,
}

impl BeamAngle {
    /// From Phi in radians, 0 to pi.
    #[must_use]
    pub fn from_rad(phi_rad: f32) -> BeamAngle {
        BeamAngle { sin: cos_sin(phi_rad).1, vers: vers(phi_rad) }
    }

    fn from_vers(vers: f32) -> BeamAngle {
        BeamAngle { sin: sin_from_vers(vers), vers }
    }
}

/// vers x = 1 - cos x, without cancellation.
fn vers(x_rad: f32) -> f32 {
    let (_, s) = cos_sin(0.5 * x_rad);
    2.0 * s * s
}

/// The same, of turns up to 16 deg by its series, to 1e-9 of it.
#[inline(always)]
fn vers_of_turn(x_rad: f32) -> f32 {
    let square = x_rad * x_rad;
    if square < 4.0 * MAX_HALF_SIN * MAX_HALF_SIN {
        square * (0.5 - square * (1.0 / 24.0 - square * (1.0 / 720.0)))
    } else {
        vers(x_rad)
    }
}

/// sin x for vers x within 0 to 2.
#[inline(always)]
fn sin_from_vers(vers: f32) -> f32 {
    let square = vers * (2.0 - vers);
    square * inverse_sqrt(square)
}

/// Up to here the series of [`Fan::angles`] for cos(Phi / 2) is exact to 1e-8: turns of 16 deg.
const MAX_HALF_SIN: f32 = 0.14;

/// What the angles between a trace's beams depend on, for one row.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Pair {
    /// The same for all columns.
    Same(BeamAngle),
    /// Rows of a nodding scanner, same column, less than [`MAX_HALF_SIN`] apart.
    Tilted { turn_half_sin: f32 },
    /// Rows of a nodding scanner; vers of the difference of the column angles if they are even.
    Nodding { offset: isize, turn_vers: f32, column_vers: Option<f32> },
    /// Rows of a nodding scanner with even columns that go on turning, this one and the one before on the
    /// trace; `turn_rad` is the difference of their turns.
    Turning { offset: isize, turn_rad: f32, column_turns: [ColumnTurns; 2], column_vers: f32 },
    /// Listed column angles: vers Phi = rows_vers + scale * vers of their difference.
    Listed { offset: isize, rows_vers: f32, scale: f32 },
    /// (u, v) of a pixel, less (du, dv), is that of the previous one.
    Pinhole { v: f32, du: f32, dv: f32 },
    /// Rows that are not plain: from the directions of both beams.
    Rays { offset: isize },
}

impl Pair {
    pub fn same(&self) -> BeamAngle {
        match *self {
            Pair::Same(angle) => angle,
            _ => BeamAngle { sin: 0.0, vers: 0.0 },
        }
    }
}

impl Fan<'_> {
    /// What the angles between the beams of a trace's two pixels depend on besides the column.
    pub fn pair(&self, trace: Trace, [now, before]: [RowBeam; 2]) -> Pair {
        let offset = isize::from(trace.columns);
        let turn_rad = now.beams.turn_rad - before.beams.turn_rad;
        if [now, before].iter().any(|at| !self.is_plain(&at.beams)) {
            // an offset of a ring is no more than another difference of azimuths
            if let Beams::Spinning { columns: Columns::Even { step_rad, .. }, .. } = self.beams
                && [now, before].iter().all(|at| at.beams.lever_arm_m == 0.0)
            {
                let [e1, e0] = [now, before].map(|at| cos_sin(at.beams.turn_rad).0);
                let azimuth_rad = offset as f32 * step_rad + now.beams.offset_rad - before.beams.offset_rad;
                return Pair::Same(BeamAngle::from_vers(vers(turn_rad) + e1 * e0 * vers(azimuth_rad)));
            }
            let Beams::Nodding { columns: Columns::Even { step_rad, .. }, .. } = self.beams else {
                return Pair::Rays { offset };
            };
            if [now, before].map(|at| [at.beams.offset_rad, at.beams.lever_arm_m]) != [[0.0; 2]; 2] {
                return Pair::Rays { offset };
            }
            let column_vers = vers(offset as f32 * step_rad);
            let column_turns = [now, before].map(|at| at.beams.column_turns);
            return Pair::Turning { offset, turn_rad, column_turns, column_vers };
        }
        let (columns, rows_vers, scale) = match &self.beams {
            Beams::Nodding { columns, .. } if trace.rows == 0 => (columns, 0.0, 1.0),
            Beams::Nodding { columns, .. } => {
                let turn_half_sin = cos_sin(0.5 * turn_rad).1.abs();
                if offset == 0 && turn_half_sin < MAX_HALF_SIN {
                    return Pair::Tilted { turn_half_sin };
                }
                let turn_vers = vers(turn_rad);
                return Pair::Nodding { offset, turn_vers, column_vers: even_vers(columns, offset) };
            }
            Beams::Spinning { columns, .. } => {
                let scale = cos_sin(now.beams.turn_rad).0 * cos_sin(before.beams.turn_rad).0;
                (columns, vers(turn_rad), scale)
            }
            &Beams::Pinhole { fx_px, fy_px, cy_px, .. } => {
                let v = -(now.row as f32 - cy_px) / fy_px;
                return Pair::Pinhole { v, du: -(offset as f32) / fx_px, dv: -f32::from(trace.rows) / fy_px };
            }
            Beams::Free { .. } => return Pair::Rays { offset },
        };
        match even_vers(columns, offset) {
            Some(column_vers) => Pair::Same(BeamAngle::from_vers(rows_vers + scale * column_vers)),
            None => Pair::Listed { offset, rows_vers, scale },
        }
    }

    /// sin Phi and vers Phi for the chunk that starts at column `from`, of an image of `count`
    /// columns. What lies outside of the image gets values of no meaning. [`Pair::Same`] leaves
    /// them as they are.
    #[inline]
    pub fn angles(&self, pair: &Pair, from: usize, count: usize, sin: &mut Lane, vers_phi: &mut Lane) {
        match (pair, &self.beams) {
            (&Pair::Tilted { turn_half_sin }, Beams::Nodding { columns, .. }) => {
                self.cos_sin(columns, from as isize, vers_phi, sin);
                for i in 0..CHUNK {
                    // sin(Phi / 2), its square, and cos(Phi / 2) by its series
                    let s = vers_phi[i].abs() * turn_half_sin;
                    let t = s * s;
                    let c = 1.0 - t * (0.5 + t * (0.125 + t * 0.0625));
                    sin[i] = 2.0 * s * c;
                    vers_phi[i] = 2.0 * t;
                }
            }
            (&Pair::Nodding { offset, turn_vers, column_vers }, Beams::Nodding { columns, .. }) => {
                let (mut cos, mut cos_before) = ([0.0; CHUNK], [0.0; CHUNK]);
                self.cos_sin(columns, from as isize, &mut cos, sin);
                if offset == 0 {
                    cos_before = cos;
                } else {
                    self.cos_sin(columns, from as isize - offset, &mut cos_before, sin);
                }
                match column_vers {
                    Some(vers) => *vers_phi = [vers; CHUNK],
                    None => listed_vers(columns, from, offset, count, vers_phi),
                }
                for i in 0..CHUNK {
                    vers_phi[i] = (vers_phi[i] + cos[i] * cos_before[i] * turn_vers).max(0.0);
                    sin[i] = sin_from_vers(vers_phi[i]);
                }
            }
            (&Pair::Turning { offset, turn_rad, column_turns, column_vers }, Beams::Nodding { columns, .. }) => {
                turning(self, columns, (turn_rad, column_turns, column_vers), offset, from, [sin, vers_phi]);
            }
            (
                &Pair::Listed { offset, rows_vers, scale },
                Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. },
            ) => {
                listed_vers(columns, from, offset, count, vers_phi);
                for i in 0..CHUNK {
                    vers_phi[i] = (rows_vers + scale * vers_phi[i]).max(0.0);
                    sin[i] = sin_from_vers(vers_phi[i]);
                }
            }
            (&Pair::Pinhole { v, du, dv }, &Beams::Pinhole { fx_px, cx_px, .. }) => {
                for i in 0..CHUNK {
                    let u = -((from + i) as f32 - cx_px) / fx_px;
                    let (u0, v0) = (u - du, v - dv);
                    let cross = u * dv - v * du;
                    let cross = cross * cross + du * du + dv * dv;
                    let inverse = inverse_sqrt((1.0 + u * u + v * v) * (1.0 + u0 * u0 + v0 * v0));
                    sin[i] = cross * inverse_sqrt(cross) * inverse;
                    vers_phi[i] = sin[i] * sin[i] / (1.0 + (1.0 + u * u0 + v * v0) * inverse);
                }
            }
            _ => {}
        }
    }
}

/// What [`Fan::angles`] gives, of rows whose columns go on turning.
#[inline(never)]
fn turning(
    fan: &Fan,
    columns: &Columns,
    (turn_rad, column_turns, column_vers): (f32, [ColumnTurns; 2], f32),
    offset: isize,
    from: usize,
    [sin, vers_phi]: [&mut Lane; 2],
) {
    let (mut cos, mut cos_before, mut turned) = ([0.0; CHUNK], [0.0; CHUNK], [[0.0; CHUNK]; 2]);
    let starts = [from as isize, from as isize - offset];
    for (cos, start) in [&mut cos, &mut cos_before].into_iter().zip(starts) {
        fan.cos_sin(columns, start, cos, sin);
    }
    for ((turns, start), turned) in column_turns.iter().zip(starts).zip(&mut turned) {
        turns.of_chunk(start, turned);
    }
    for i in 0..CHUNK {
        let turn_vers = vers_of_turn(turn_rad + turned[0][i] - turned[1][i]);
        vers_phi[i] = (column_vers + cos[i] * cos_before[i] * turn_vers).max(0.0);
        sin[i] = sin_from_vers(vers_phi[i]);
    }
}

/// What [`Fan::angles`] gives, of rows that are not plain: `rows` are this one and the one before on
/// the trace, `before_m` the ranges of the latter.
///
/// ```text
/// the line between the returns = (r1 - r0) d1 + r0 e,   e = d1 - d0 + (o1 - o0) / r0
/// ```
///
/// for directions d and origins o. So sin Phi and vers Phi stand for |d1 x e| and d1 . e, which they
/// are where both beams have one origin.
#[inline(never)]
pub(crate) fn rays(
    fan: &Fan,
    rows: [RowBeam; 2],
    offset: isize,
    [from, count]: [usize; 2],
    before_m: &Lane,
    [sin, vers_phi]: [&mut Lane; 2],
) {
    let [frame, frame_before] = rows.map(|row| fan.frame(row));
    for i in 0..CHUNK {
        let before = ((from + i) as isize - offset).checked_rem_euclid(count as isize).unwrap_or(0) as usize;
        let [d1, o1] = fan.ray(&frame, (from + i).min(count - 1));
        let [d0, o0] = fan.ray(&frame_before, before);
        let (turned, moved) = (less(d1, d0), less(o1, o0));
        let over = if before_m[i] > 0.0 { 1.0 / before_m[i] } else { 0.0 };
        let across = cross(d1, plus(turned, over, moved));
        let square = dot(across, across);
        sin[i] = square * inverse_sqrt(square);
        vers_phi[i] = 0.5 * dot(turned, turned) + over * dot(d1, moved);
    }
}

/// vers of the difference of two column angles `offset` columns apart, if it is the same
/// everywhere.
fn even_vers(columns: &Columns, offset: isize) -> Option<f32> {
    match *columns {
        _ if offset == 0 => Some(0.0),
        Columns::Even { step_rad, .. } => Some(vers(offset as f32 * step_rad)),
        Columns::Listed(_) | Columns::Beside { .. } => None,
    }
}

/// vers of the difference of listed column angles, of each column and the one `offset` to its left.
fn listed_vers(columns: &Columns, from: usize, offset: isize, count: usize, out: &mut Lane) {
    let list = columns.listed();
    for (i, out) in out.iter_mut().enumerate() {
        let before = ((from + i) as isize - offset).checked_rem_euclid(count as isize).unwrap_or(0) as usize;
        let pair = list.get(from + i).zip(list.get(before));
        *out = pair.map_or(0.0, |(a, b)| vers(a - b));
    }
}
