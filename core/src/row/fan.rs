//! The beams of a row: cosines and sines of its columns, and the points that its ranges are.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{inverse_sqrt, round};
use crate::beam::{Beams, Columns, MAX_COLUMNS, TurnAxis};
use crate::error::ConfigError;
use crate::moments::POINT_UNIT_M;
use crate::row::bits::CHUNK;

/// (cos, sin) of the sum of two angles.
fn add(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0 * b.0 - a.1 * b.1, a.1 * b.0 + a.0 * b.1)
}

fn cos_sin(x_rad: f32) -> (f32, f32) {
    let (sin, cos) = libm::sincosf(x_rad);
    (cos, sin)
}

/// Cosine and sine within its row of the beam of a pinhole's column; `v` is the height of the row.
#[inline(always)]
fn pinhole(fx_px: f32, cx_px: f32, v: f32, column: usize) -> (f32, f32) {
    let u = -(column as f32 - cx_px) / fx_px;
    let cos = inverse_sqrt(1.0 + u * u + v * v);
    (cos, u * cos)
}

/// What is known of one row: its number and its angle.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct RowBeam {
    pub row: usize,
    pub turn_rad: f32,
}

/// The beams of an image, ready for use row by row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fan<'a> {
    pub beams: Beams<'a>,
    /// (cos, sin) of the angle of column 0.
    start: (f32, f32),
    /// (cos, sin) of 2^i column steps.
    steps: [(f32, f32); STEPS],
    /// Cosines and sines of 0 to 7 column steps.
    base: ([f32; 8], [f32; 8]),
}

/// Enough for every column number.
const STEPS: usize = MAX_COLUMNS.trailing_zeros() as usize + 1;

/// A number for each column of a chunk.
pub(crate) type Lane = [f32; CHUNK];

impl<'a> Fan<'a> {
    pub fn new(beams: Beams<'a>, columns: usize) -> Result<Fan<'a>, ConfigError> {
        beams.check(columns)?;
        let (start_rad, step_rad) = match beams {
            Beams::Nodding { columns: Columns::Even { start_rad, step_rad }, .. }
            | Beams::Spinning { columns: Columns::Even { start_rad, step_rad }, .. } => (start_rad, step_rad),
            _ => (0.0, 0.0),
        };
        let steps = core::array::from_fn(|i| cos_sin(step_rad * (1 << i) as f32));
        let base: [_; 8] = core::array::from_fn(|i| cos_sin(step_rad * i as f32));
        Ok(Fan { beams, start: cos_sin(start_rad), steps, base: (base.map(|b| b.0), base.map(|b| b.1)) })
    }

    /// Whether the last column neighbours the first.
    pub fn wraps(&self) -> bool {
        matches!(self.beams, Beams::Spinning { wraps: true, .. })
    }

    /// Whether rows turn about an axis, as those of a nodding scanner.
    pub fn turns(&self) -> bool {
        matches!(self.beams, Beams::Nodding { .. })
    }

    /// Whether rows are the rings of a spinning scanner.
    pub fn spins(&self) -> bool {
        matches!(self.beams, Beams::Spinning { .. })
    }

    /// Cosine and sine of an evenly spaced column, which may lie outside: the addition theorem along
    /// the binary digits of its number.
    fn first(&self, column: isize) -> (f32, f32) {
        let mut first = self.start;
        let mut digits = column.unsigned_abs();
        while let Some(&(ck, sk)) = self.steps.get(digits.trailing_zeros() as usize) {
            first = add(first, (ck, if column < 0 { -sk } else { sk }));
            digits &= digits - 1;
        }
        first
    }

    /// Cosine and sine of a beam within its row: just those of [`Fan::row_lanes`], for one that is
    /// needed alone.
    pub fn row_beam(&self, frame: &Frame, column: usize) -> (f32, f32) {
        match &self.beams {
            Beams::Nodding { columns: Columns::Even { .. }, .. }
            | Beams::Spinning { columns: Columns::Even { .. }, .. } => {
                let i = column % CHUNK;
                let mut first = self.first((column - i) as isize);
                for _ in 0..i / 8 {
                    first = add(first, self.steps[3]);
                }
                add(first, (self.base.0[i % 8], self.base.1[i % 8]))
            }
            Beams::Nodding { columns: Columns::Listed(list), .. }
            | Beams::Spinning { columns: Columns::Listed(list), .. } => {
                list.get(column).map_or((1.0, 0.0), |&angle_rad| cos_sin(angle_rad))
            }
            &Beams::Pinhole { fx_px, cx_px, .. } => pinhole(fx_px, cx_px, frame.p[2], column),
        }
    }

    /// Cosines and sines of the column angles of a chunk that starts at column `from`, which may
    /// lie outside.
    pub fn cos_sin(&self, columns: &Columns, from: isize, cos: &mut Lane, sin: &mut Lane) {
        match *columns {
            Columns::Even { .. } => {
                // no sine or cosine per row: the addition theorem, eight columns at a time
                let mut first = self.first(from);
                for eight in cos.as_chunks_mut::<8>().0.iter_mut().zip(sin.as_chunks_mut::<8>().0) {
                    for i in 0..8 {
                        eight.0[i] = first.0 * self.base.0[i] - first.1 * self.base.1[i];
                        eight.1[i] = first.1 * self.base.0[i] + first.0 * self.base.1[i];
                    }
                    first = add(first, self.steps[3]);
                }
            }
            Columns::Listed(list) => {
                for i in 0..CHUNK {
                    let angle = from.checked_add_unsigned(i).and_then(|c| list.get(usize::try_from(c).ok()?));
                    (sin[i], cos[i]) = angle.map_or((0.0, 1.0), |&a| libm::sincosf(a));
                }
            }
        }
    }

    /// What the points of a row depend on besides the column.
    pub fn frame(&self, at: RowBeam) -> Frame {
        let (s, c) = libm::sincosf(at.turn_rad);
        match &self.beams {
            Beams::Nodding { axis: TurnAxis::Y, .. } => Frame { p: [c, 0.0, s], q: [0.0, 1.0, 0.0], r: [0.0; 3] },
            Beams::Nodding { axis: TurnAxis::Z, .. } => Frame { p: [c, s, 0.0], q: [0.0, 0.0, 1.0], r: [0.0; 3] },
            Beams::Spinning { .. } => Frame { p: [c, 0.0, 0.0], q: [0.0, c, 0.0], r: [0.0, 0.0, s] },
            &Beams::Pinhole { fy_px, cy_px, .. } => {
                let v = -(at.row as f32 - cy_px) / fy_px;
                Frame { p: [1.0, 0.0, v], q: [0.0, 1.0, 0.0], r: [0.0; 3] }
            }
        }
    }

    /// Cosine and sine of the beams of a chunk within their row: the direction of a beam is cos p +
    /// sin q + r of its [`Frame`].
    #[inline]
    pub fn row_lanes(&self, frame: &Frame, from: usize, cos: &mut Lane, sin: &mut Lane) {
        match &self.beams {
            Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. } => {
                self.cos_sin(columns, from as isize, cos, sin);
            }
            &Beams::Pinhole { fx_px, cx_px, .. } => {
                let v = frame.p[2];
                for i in 0..CHUNK {
                    (cos[i], sin[i]) = pinhole(fx_px, cx_px, v, from + i);
                }
            }
        }
    }

    /// The axis about which rows turn as their angle grows, a unit vector; 0 where rows do not
    /// turn.
    pub fn axis(&self) -> [f32; 3] {
        match self.beams {
            Beams::Nodding { axis: TurnAxis::Y, .. } => [0.0, -1.0, 0.0],
            Beams::Nodding { axis: TurnAxis::Z, .. } => [0.0, 0.0, 1.0],
            _ => [0.0; 3],
        }
    }

    /// The points that the beams of a chunk hit, in units of [`POINT_UNIT_M`], rounded. `range_m`
    /// is 0 where there is no return.
    #[inline]
    pub fn points(&self, frame: &Frame, from: usize, range_m: &Lane, out: &mut [[i32; CHUNK]; 3]) {
        self.points_as(round, frame, from, range_m, out);
    }

    /// The points that the beams of a chunk hit, in units of [`POINT_UNIT_M`], each coordinate as
    /// `number` makes it.
    #[inline]
    pub fn points_as<T>(
        &self,
        number: impl Fn(f32) -> T,
        frame: &Frame,
        from: usize,
        range_m: &Lane,
        out: &mut [[T; CHUNK]; 3],
    ) {
        let (mut cos, mut sin) = ([0.0; CHUNK], [0.0; CHUNK]);
        self.row_lanes(frame, from, &mut cos, &mut sin);
        for (axis, out) in out.iter_mut().enumerate() {
            let [p, q, r] = [frame.p, frame.q, frame.r].map(|along| along[axis] / POINT_UNIT_M);
            for i in 0..CHUNK {
                out[i] = number(range_m[i] * (cos[i] * p + sin[i] * q + r));
            }
        }
    }
}

/// Direction of a beam = a p + b q + r, with a and b of its column.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub p: [f32; 3],
    pub q: [f32; 3],
    pub r: [f32; 3],
}
