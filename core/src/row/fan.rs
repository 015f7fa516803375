//! The beams of a row: cosines and sines of its columns, and the points that its ranges are.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{cos_sin, cross, dot, inverse_sqrt, less, lone_inverse_sqrt, plus, round};
use crate::beam::{Beams, Columns, MAX_COLUMNS, TurnAxis};
use crate::error::ConfigError;
use crate::moments::POINT_UNIT_M;
use crate::row::bits::CHUNK;
use crate::row_beams::{ColumnTurns, RowBeams};

/// (cos, sin) of the sum of two angles.
fn add(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0 * b.0 - a.1 * b.1, a.1 * b.0 + a.0 * b.1)
}

/// The middle of the least and the greatest; 0 of none.
fn middle(angles_rad: &[f32]) -> f32 {
    let Some(&first) = angles_rad.first() else { return 0.0 };
    let (least, greatest) = angles_rad.iter().fold((first, first), |(least, greatest), &angle_rad| {
        (if angle_rad < least { angle_rad } else { least }, if angle_rad > greatest { angle_rad } else { greatest })
    });
    0.5 * (least + greatest)
}

/// Turns within a row up to here, as of a tilt that moves, have few terms.
const SMALL_RAD: f32 = 0.1;

/// Cosine and sine of an angle below [`SMALL_RAD`], to 1e-8.
#[inline(always)]
fn small_cos_sin(x_rad: f32) -> (f32, f32) {
    let square = x_rad * x_rad;
    (1.0 - square * (0.5 - square * (1.0 / 24.0)), x_rad * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0))))
}

/// Cosine and sine within its row of the beam of a pinhole's column; `v` is the height of the row.
#[inline(always)]
fn pinhole(fx_px: f32, cx_px: f32, v: f32, column: usize) -> (f32, f32) {
    let u = -(column as f32 - cx_px) / fx_px;
    let cos = inverse_sqrt(1.0 + u * u + v * v);
    (cos, u * cos)
}

/// What is known of one row: its number, and where its beams point.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowBeam<'r> {
    pub row: usize,
    pub beams: RowBeams<'r>,
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
    /// Share by which columns lie farther from the middle one than [`Beams`] says.
    stretch: f32,
    /// Angle of the middle, radians.
    middle_rad: f32,
}

/// Enough for every column number.
const STEPS: usize = MAX_COLUMNS.trailing_zeros() as usize + 1;

/// A number for each column of a chunk.
pub(crate) type Lane = [f32; CHUNK];

impl<'a> Fan<'a> {
    pub fn new(beams: Beams<'a>, columns: usize) -> Result<Fan<'a>, ConfigError> {
        beams.check(columns)?;
        let middle_rad = match beams {
            Beams::Nodding { columns: angles, .. } => 0.5 * (angles.rad(0) + angles.rad(columns - 1)),
            _ => 0.0,
        };
        let (steps, base) = ([(1.0, 0.0); STEPS], ([1.0; 8], [0.0; 8]));
        let mut fan = Fan { beams, start: (1.0, 0.0), steps, base, stretch: 0.0, middle_rad };
        fan.stretch(0.0);
        Ok(fan)
    }

    /// Columns lie farther from the middle one than [`Beams`] says, by this share.
    pub fn stretch(&mut self, share: f32) {
        let (start_rad, step_rad) = match self.beams {
            Beams::Nodding { columns: Columns::Even { start_rad, step_rad }, .. }
            | Beams::Spinning { columns: Columns::Even { start_rad, step_rad }, .. } => (start_rad, step_rad),
            _ => (0.0, 0.0),
        };
        self.stretch = share;
        self.start = cos_sin(self.stretched(start_rad));
        let step_rad = step_rad + share * step_rad;
        for (i, step) in self.steps.iter_mut().enumerate() {
            *step = cos_sin(step_rad * (1 << i) as f32);
        }
        for i in 0..8 {
            (self.base.0[i], self.base.1[i]) = cos_sin(step_rad * i as f32);
        }
    }

    fn stretched(&self, angle_rad: f32) -> f32 {
        angle_rad + self.stretch * (angle_rad - self.middle_rad)
    }

    /// Angle of a column, radians; 0 where columns have none.
    pub fn column_rad(&self, column: usize) -> f32 {
        match &self.beams {
            Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. } => self.stretched(columns.rad(column)),
            _ => 0.0,
        }
    }

    /// Angle of the middle of a turning scanner's columns, radians.
    pub fn middle_rad(&self) -> f32 {
        self.middle_rad
    }

    /// Whether the last column neighbours the first.
    pub fn wraps(&self) -> bool {
        matches!(self.beams, Beams::Spinning { wraps: true, .. } | Beams::Free { wraps: true })
    }

    /// Whether rows turn about an axis, as those of a nodding scanner.
    pub fn turns(&self) -> bool {
        matches!(self.beams, Beams::Nodding { .. })
    }

    /// Whether each row brings directions of its own.
    pub fn is_free(&self) -> bool {
        matches!(self.beams, Beams::Free { .. })
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

    /// Cosine and sine of a beam within a plain row: just those of [`Fan::lanes`], for one that is
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
            Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. } => {
                columns.listed().get(column).map_or((1.0, 0.0), |&angle_rad| cos_sin(self.stretched(angle_rad)))
            }
            &Beams::Pinhole { fx_px, cx_px, .. } => pinhole(fx_px, cx_px, frame.p[2], column),
            Beams::Free { .. } => (1.0, 0.0),
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
            Columns::Listed(list) | Columns::Beside { angles_rad: list, .. } => {
                for i in 0..CHUNK {
                    let angle = from.checked_add_unsigned(i).and_then(|c| list.get(usize::try_from(c).ok()?));
                    (cos[i], sin[i]) = angle.map_or((1.0, 0.0), |&a| cos_sin(self.stretched(a)));
                }
            }
        }
    }

    /// What the beams of a row depend on besides the column.
    pub fn frame<'r>(&self, at: RowBeam<'r>) -> Frame<'r> {
        self.frame_of(at, |_| true)
    }

    /// The same, of free beams with axes along those columns that count.
    pub fn frame_of<'r>(&self, at: RowBeam<'r>, counts: impl Fn(usize) -> bool) -> Frame<'r> {
        let middle_rad = match self.beams {
            Beams::Nodding { columns: Columns::Beside { turns_rad, .. }, .. } => middle(turns_rad),
            _ => 0.0,
        };
        let (c, s) = cos_sin(at.beams.turn_rad + middle_rad);
        let [p, q, r, t] = match &self.beams {
            Beams::Nodding { axis: TurnAxis::Y, .. } => [[c, 0.0, s], [0.0, 1.0, 0.0], [0.0; 3], [-s, 0.0, c]],
            Beams::Nodding { axis: TurnAxis::Z, .. } => [[c, s, 0.0], [0.0, 0.0, 1.0], [0.0; 3], [-s, c, 0.0]],
            Beams::Spinning { .. } => [[c, 0.0, 0.0], [0.0, c, 0.0], [0.0, 0.0, s], [0.0; 3]],
            &Beams::Pinhole { fy_px, cy_px, .. } => {
                let v = -(at.row as f32 - cy_px) / fy_px;
                [[1.0, 0.0, v], [0.0, 1.0, 0.0], [0.0; 3], [0.0; 3]]
            }
            Beams::Free { .. } => free(at.beams.directions, counts),
        };
        Frame { p, q, r, t, plain: self.is_plain(&at.beams), middle_rad, beams: at.beams }
    }

    /// Whether columns lie where [`Beams`] and the turn angle alone say.
    pub fn is_plain(&self, row: &RowBeams) -> bool {
        let beside = matches!(self.beams, Beams::Nodding { columns: Columns::Beside { .. }, .. } | Beams::Free { .. });
        !beside && row.is_plain()
    }

    /// The beams of a chunk within their row: see [`Lanes`]. The ranges are there already.
    #[inline]
    pub fn lanes(&self, frame: &Frame, from: usize, lanes: &mut Lanes) {
        match &self.beams {
            Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. } => {
                self.cos_sin(columns, from as isize, &mut lanes.cos, &mut lanes.sin);
            }
            &Beams::Pinhole { fx_px, cx_px, .. } => {
                let v = frame.p[2];
                for i in 0..CHUNK {
                    (lanes.cos[i], lanes.sin[i]) = pinhole(fx_px, cx_px, v, from + i);
                }
            }
            Beams::Free { .. } => {}
        }
        if !frame.plain {
            self.bend(frame, from, lanes);
        }
    }

    /// The beams of a chunk of a row that is not plain, from those of a plain one.
    #[inline(never)]
    fn bend(&self, frame: &Frame, from: usize, lanes: &mut Lanes) {
        let Lanes { cos, sin, beside, range_m } = lanes;
        if let Beams::Free { .. } = self.beams {
            for i in 0..CHUNK {
                let known = frame.beams.directions.get(from + i).filter(|u| is_unit(**u));
                let u = less(known.copied().unwrap_or(frame.p), frame.r);
                [cos[i], sin[i], beside[i]] = [frame.p, frame.q, frame.t].map(|axis| dot(axis, u));
            }
            return;
        }
        let RowBeams { offset_rad, lever_arm_m, .. } = frame.beams;
        if offset_rad != 0.0 {
            let offset = cos_sin(offset_rad);
            for i in 0..CHUNK {
                (cos[i], sin[i]) = add((cos[i], sin[i]), offset);
            }
        }
        if lever_arm_m != 0.0 {
            for i in 0..CHUNK {
                cos[i] += if range_m[i] > 0.0 { lever_arm_m / range_m[i] } else { 0.0 };
            }
        }
        let Beams::Nodding { columns, .. } = &self.beams else {
            *beside = [0.0; CHUNK];
            return;
        };
        if let Columns::Beside { .. } = columns {
            for i in 0..CHUNK {
                let turned = self.turned(frame, from + i);
                (cos[i], beside[i]) = (cos[i] * turned.0, cos[i] * turned.1);
            }
            return;
        }
        // in turns of a tilt that moves there is no sine, and no division by the number of sets
        let ColumnTurns { step_rad, sets, set_rad } = frame.beams.column_turns;
        let sets = usize::from(sets);
        let (mut set, mut turn_rad) = (from.checked_rem(sets).unwrap_or(0), from as f32 * step_rad);
        let most_rad = turn_rad.abs() + CHUNK as f32 * step_rad.abs() + sets as f32 * set_rad.abs();
        let small = most_rad < SMALL_RAD;
        for i in 0..CHUNK {
            let more_rad = turn_rad + set as f32 * set_rad;
            let turned = if small { small_cos_sin(more_rad) } else { cos_sin(more_rad) };
            (cos[i], beside[i]) = (cos[i] * turned.0, cos[i] * turned.1);
            turn_rad += step_rad;
            set = if set + 1 < sets { set + 1 } else { 0 };
        }
    }

    /// Cosine and sine of how much more than the [`Frame`] of its row a column is turned.
    fn turned(&self, frame: &Frame, column: usize) -> (f32, f32) {
        match &self.beams {
            Beams::Nodding { columns, .. } => {
                cos_sin(columns.turn_rad(column) - frame.middle_rad + frame.beams.column_turns.of(column))
            }
            _ => (1.0, 0.0),
        }
    }

    /// The direction of a beam of any row, a unit vector, and the origin that it starts from, metres.
    pub fn ray(&self, frame: &Frame, column: usize) -> [[f32; 3]; 2] {
        if let Beams::Free { .. } = self.beams {
            return [frame.beams.directions.get(column).copied().unwrap_or(frame.p), [0.0; 3]];
        }
        let (c, s) = add(self.row_beam(frame, column), cos_sin(frame.beams.offset_rad));
        let turned = self.turned(frame, column);
        let Frame { p, q, r, t, .. } = *frame;
        let out = |by: f32| plus(p.map(|x| by * turned.0 * x), by * turned.1, t);
        [plus(plus(out(c), s, q), 1.0, r), out(frame.beams.lever_arm_m)]
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
        let mut lanes = Lanes { range_m: *range_m, ..Lanes::EMPTY };
        self.lanes(frame, from, &mut lanes);
        let Lanes { cos, sin, beside, .. } = &lanes;
        for (axis, out) in out.iter_mut().enumerate() {
            let [p, q, r, t] = [frame.p, frame.q, frame.r, frame.t].map(|along| along[axis] / POINT_UNIT_M);
            for i in 0..CHUNK {
                out[i] = number(range_m[i] * (cos[i] * p + sin[i] * q + beside[i] * t + r));
            }
        }
    }
}

/// Whether a direction is one: of a pixel without a return it may be anything.
fn is_unit(u: [f32; 3]) -> bool {
    (0.9..1.1).contains(&dot(u, u))
}

/// Axes of the [`Frame`] of a row of free beams: p to the middle of the row, q along it, t across it. Only
/// beams that count tell.
fn free(directions: &[[f32; 3]], counts: impl Fn(usize) -> bool) -> [[f32; 3]; 4] {
    // neighbours span what the row lies in, as far as it lies in a plane
    let (mut across, mut middle, mut count) = ([0.0; 3], [0.0; 3], 0.0);
    let mut last = None;
    for (column, &u) in directions.iter().enumerate() {
        if !counts(column) || !is_unit(u) {
            continue;
        }
        if let Some(v) = last.replace(u) {
            (across, middle) = (plus(across, 1.0, cross(v, u)), plus(middle, 0.5, plus(v, 1.0, u)));
            count += 1.0;
        }
    }
    let unit = |v: [f32; 3], or: [f32; 3]| {
        let square = dot(v, v);
        let root = lone_inverse_sqrt(square);
        if square > 1e-12 { v.map(|x| x * root) } else { or }
    };
    let t = unit(across, [0.0, 0.0, 1.0]);
    let p = plus(middle, -dot(middle, t), t);
    // a row that goes all around has no middle
    let least = if t[2].abs() < 0.7 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
    let p = unit(p, unit(plus(least, -dot(least, t), t), least));
    // rings lie on a cone
    let beside = if count > 0.0 { dot(middle, t) / count } else { 0.0 };
    [p, cross(t, p), t.map(|x| beside * x), t]
}

/// One chunk of a row: the direction of a beam is cos p + sin q + beside t + r of its [`Frame`].
///
/// Where the scanner's origin is not that of the beams, what its origin is off by, divided by the
/// range, is added: range times direction is the point.
pub(crate) struct Lanes {
    pub cos: Lane,
    pub sin: Lane,
    /// 0 in a plain row: as in [`Lanes::EMPTY`], with which each row begins.
    pub beside: Lane,
    /// 0 for no return, and outside of the image.
    pub range_m: Lane,
}

impl Lanes {
    pub const EMPTY: Lanes =
        Lanes { cos: [0.0; CHUNK], sin: [0.0; CHUNK], beside: [0.0; CHUNK], range_m: [0.0; CHUNK] };
}

/// What the beams of a row have in common; see [`Lanes`].
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame<'r> {
    pub p: [f32; 3],
    pub q: [f32; 3],
    pub r: [f32; 3],
    pub t: [f32; 3],
    /// Whether no column lies beside p, q and r.
    pub plain: bool,
    /// The row is taken to be turned by this more, the middle of its columns, radians: how a line
    /// leans across its row is not known, which counts as noise the farther a beam lies beside it.
    middle_rad: f32,
    pub beams: RowBeams<'r>,
}
