//! Where beams point, and the angle between two of them (paper section 3: the "laser beam angular step in the direction
//! of the trace").
//!
//! A beam is a rotation s about an axis and an angle p within the plane that holds the axis. With
//! vers x = 1 - cos x = 2 sin^2(x / 2), two beams are apart by Phi with
//!
//! ```text
//! vers Phi = vers(p1 - p2) + cos p1 cos p2 vers(s1 - s2)
//! ```
//!
//! for every trace: sums of small positive terms, so that nothing cancels. A nodding scanner has p per column and s per
//! row, a spinning one p per row (elevation) and s per column (azimuth). For a pinhole camera the same comes from the
//! cross product of the two directions. The turn step is never taken for Phi.

use crate::bits::CHUNK;
use crate::config::Trace;
use crate::error::ConfigError;

/// Two beams closer than this have no bearing angle, radians: near the turning axis of a nodding scanner the beams of
/// neighbouring rows coincide.
pub const MIN_BEAM_ANGLE_RAD: f32 = 1e-5;

/// Angles of the columns, radians.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Columns<'a> {
    /// Column `c` is at `start_rad + c * step_rad`.
    Even {
        /// Angle of column 0; within +-2 pi.
        start_rad: f32,
        /// From a column to the next; not 0, within +-pi / 2.
        step_rad: f32,
    },
    /// One angle per column, each within +-2 pi. Costs a sine and a cosine per pixel, which [`Columns::Even`] does not.
    Listed(&'a [f32]),
}

/// The axis about which a nodding scanner turns. It lies in the scan plane, at beam angles +-90 deg.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum TurnAxis {
    /// To the left: the scanner tilts. Direction = (cos b cos t, sin b, cos b sin t).
    Y,
    /// Upright: the scanner pans. Direction = (cos b cos t, cos b sin t, sin b).
    Z,
}

/// Where the beams of an image point: unit vectors, x forward, y left, z up.
///
/// The angle of a row is not here: it is given with each row, because a real encoder only knows it then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Beams<'a> {
    /// A 2D scanner whose scan plane turns about an axis in the plane. A row's angle is its turn t.
    Nodding {
        /// Beam angles b, measured in the scan plane from its middle.
        columns: Columns<'a>,
        /// The axis.
        axis: TurnAxis,
    },
    /// A spinning scanner: direction = (cos e cos a, cos e sin a, sin e). A row's angle is its elevation e.
    Spinning {
        /// Azimuths a.
        columns: Columns<'a>,
        /// Whether the last column neighbours the first. Even azimuths must then go round exactly once.
        wraps: bool,
    },
    /// A camera: direction = normalised (1, -(u - cx) / fx, -(v - cy) / fy) for column u, row v. The row's angle is
    /// not used: row v is the v-th row pushed. Ranges are along the beam.
    Pinhole {
        /// Focal length along a row, pixels; not 0.
        fx_px: f32,
        /// Focal length along a column, pixels; not 0.
        fy_px: f32,
        /// Column of the optical axis.
        cx_px: f32,
        /// Row of the optical axis.
        cy_px: f32,
    },
}

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
    pub fn from_rad(phi_rad: f32) -> BeamAngle {
        BeamAngle { sin: libm::sinf(phi_rad), vers: vers(phi_rad) }
    }

    fn from_vers(vers: f32) -> BeamAngle {
        BeamAngle { sin: sin_from_vers(vers), vers }
    }
}

/// (cos, sin) of the sum of two angles.
fn add(a: (f32, f32), b: (f32, f32)) -> (f32, f32) {
    (a.0 * b.0 - a.1 * b.1, a.1 * b.0 + a.0 * b.1)
}

fn cos_sin(x_rad: f32) -> (f32, f32) {
    let (sin, cos) = libm::sincosf(x_rad);
    (cos, sin)
}

/// vers x = 1 - cos x, without cancellation.
fn vers(x_rad: f32) -> f32 {
    let s = libm::sinf(0.5 * x_rad);
    2.0 * s * s
}

/// sin x for vers x within 0 to 2.
#[inline(always)]
fn sin_from_vers(vers: f32) -> f32 {
    let square = vers * (2.0 - vers);
    square * inverse_sqrt(square)
}

/// 1 / sqrt(x) to 2e-7 relative for normal x, finite (not infinite) for 0. Without a branch or a call, so that loops
/// over columns vectorise, and no slower than a division on a Cortex-M4F.
#[inline(always)]
fn inverse_sqrt(x: f32) -> f32 {
    let half = 0.5 * x;
    let mut y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
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
    beams: Beams<'a>,
    /// (cos, sin) of the angle of column 0.
    start: (f32, f32),
    /// (cos, sin) of 2^i column steps.
    steps: [(f32, f32); STEPS],
    /// Cosines and sines of 0 to 7 column steps.
    base: ([f32; 8], [f32; 8]),
}

/// Enough for every column number.
const STEPS: usize = crate::MAX_COLUMNS.trailing_zeros() as usize + 1;

type Lane = [f32; CHUNK];

impl<'a> Fan<'a> {
    pub fn new(beams: Beams<'a>, columns: usize) -> Result<Fan<'a>, ConfigError> {
        check(&beams, columns)?;
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

    /// Cosines and sines of the column angles of a chunk that starts at column `from`, which may lie outside.
    fn cos_sin(&self, columns: &Columns, from: isize, cos: &mut Lane, sin: &mut Lane) {
        match *columns {
            Columns::Even { .. } => {
                // no sine or cosine per row: the addition theorem, along the binary digits of the chunk's first column,
                // then to eight columns at a time
                let mut first = self.start;
                let mut digits = from.unsigned_abs();
                while let Some(&(ck, sk)) = self.steps.get(digits.trailing_zeros() as usize) {
                    first = add(first, (ck, if from < 0 { -sk } else { sk }));
                    digits &= digits - 1;
                }
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

    /// What the angles between the beams of a trace's two pixels depend on besides the column.
    pub fn pair(&self, trace: Trace, now: RowBeam, before: RowBeam) -> Pair {
        let offset = isize::from(trace.columns);
        let (columns, rows_vers, scale) = match &self.beams {
            Beams::Nodding { columns, .. } if trace.rows == 0 => (columns, 0.0, 1.0),
            Beams::Nodding { columns, .. } => {
                let turn_rad = now.turn_rad - before.turn_rad;
                let turn_half_sin = libm::sinf(0.5 * turn_rad).abs();
                if offset == 0 && turn_half_sin < MAX_HALF_SIN {
                    return Pair::Tilted { turn_half_sin };
                }
                let turn_vers = vers(turn_rad);
                return Pair::Nodding { offset, turn_vers, column_vers: even_vers(columns, offset) };
            }
            Beams::Spinning { columns, .. } => {
                let scale = libm::cosf(now.turn_rad) * libm::cosf(before.turn_rad);
                (columns, vers(now.turn_rad - before.turn_rad), scale)
            }
            &Beams::Pinhole { fx_px, fy_px, cy_px, .. } => {
                let v = -(now.row as f32 - cy_px) / fy_px;
                return Pair::Pinhole { v, du: -(offset as f32) / fx_px, dv: -f32::from(trace.rows) / fy_px };
            }
        };
        match even_vers(columns, offset) {
            Some(column_vers) => Pair::Same(BeamAngle::from_vers(rows_vers + scale * column_vers)),
            None => Pair::Listed { offset, rows_vers, scale },
        }
    }

    /// sin Phi and vers Phi for the chunk that starts at column `from`, of an image of `count` columns. What lies outside
    /// of the image gets values of no meaning. [`Pair::Same`] leaves them as they are.
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

    /// Cosine and sine of the beams of a chunk within their row: the direction of a beam is cos p + sin q + r of its
    /// [`Frame`].
    #[inline]
    pub fn row_lanes(&self, frame: &Frame, from: usize, cos: &mut Lane, sin: &mut Lane) {
        match &self.beams {
            Beams::Nodding { columns, .. } | Beams::Spinning { columns, .. } => {
                self.cos_sin(columns, from as isize, cos, sin);
            }
            &Beams::Pinhole { fx_px, cx_px, .. } => {
                let v = frame.p[2];
                for i in 0..CHUNK {
                    let u = -((from + i) as f32 - cx_px) / fx_px;
                    cos[i] = inverse_sqrt(1.0 + u * u + v * v);
                    sin[i] = u * cos[i];
                }
            }
        }
    }

    /// The axis about which rows turn as their angle grows, a unit vector; 0 where rows do not turn.
    pub fn axis(&self) -> [f32; 3] {
        match self.beams {
            Beams::Nodding { axis: TurnAxis::Y, .. } => [0.0, -1.0, 0.0],
            Beams::Nodding { axis: TurnAxis::Z, .. } => [0.0, 0.0, 1.0],
            _ => [0.0; 3],
        }
    }

    /// The points that the beams of a chunk hit, in units of [`POINT_UNIT_M`], rounded. `range_m` is 0 where there is no
    /// return.
    #[inline]
    pub fn points(&self, frame: &Frame, from: usize, range_m: &Lane, out: &mut [[i32; CHUNK]; 3]) {
        self.points_as(round, frame, from, range_m, out);
    }

    /// The points that the beams of a chunk hit, in units of [`POINT_UNIT_M`], each coordinate as `number` makes it.
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
    /// Listed column angles: vers Phi = rows_vers + scale * vers of their difference.
    Listed { offset: isize, rows_vers: f32, scale: f32 },
    /// (u, v) of a pixel, less (du, dv), is that of the previous one.
    Pinhole { v: f32, du: f32, dv: f32 },
}

impl Pair {
    pub fn same(&self) -> BeamAngle {
        match *self {
            Pair::Same(angle) => angle,
            _ => BeamAngle { sin: 0.0, vers: 0.0 },
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

/// vers of the difference of two column angles `offset` columns apart, if it is the same everywhere.
fn even_vers(columns: &Columns, offset: isize) -> Option<f32> {
    match *columns {
        _ if offset == 0 => Some(0.0),
        Columns::Even { step_rad, .. } => Some(vers(offset as f32 * step_rad)),
        Columns::Listed(_) => None,
    }
}

/// vers of the difference of listed column angles, of each column and the one `offset` to its left.
fn listed_vers(columns: &Columns, from: usize, offset: isize, count: usize, out: &mut Lane) {
    let Columns::Listed(list) = *columns else { return };
    for (i, out) in out.iter_mut().enumerate() {
        let before = ((from + i) as isize - offset).checked_rem_euclid(count as isize).unwrap_or(0) as usize;
        let pair = list.get(from + i).zip(list.get(before));
        *out = pair.map_or(0.0, |(a, b)| vers(a - b));
    }
}

/// Points are kept as whole multiples of this, metres (0.24 mm): sums of them are exact, whatever their order.
pub const POINT_UNIT_M: f32 = 1.0 / 4096.0;

/// Nearest integer of |x| < 2^22, without a call: adding 1.5 * 2^23 leaves it in the low bits.
#[inline(always)]
pub(crate) fn round(x: f32) -> i32 {
    const MAGIC: f32 = 12_582_912.0;
    ((x + MAGIC).to_bits() as i32).wrapping_sub(MAGIC.to_bits() as i32)
}

fn check(beams: &Beams, count: usize) -> Result<(), ConfigError> {
    use core::f32::consts::{FRAC_PI_2, TAU};
    let value = |field, value| Err(ConfigError::Value { field, value });
    if count == 0 || count > crate::MAX_COLUMNS {
        return Err(ConfigError::Count { field: "columns", value: count as i32 });
    }
    let angles = |columns: &Columns| match *columns {
        Columns::Even { start_rad, .. } if !(-TAU..=TAU).contains(&start_rad) => value("start_rad", start_rad),
        Columns::Even { step_rad, .. } if step_rad == 0.0 || !(-FRAC_PI_2..=FRAC_PI_2).contains(&step_rad) => {
            value("step_rad", step_rad)
        }
        Columns::Even { .. } => Ok(()),
        Columns::Listed(list) if list.len() != count => Err(ConfigError::Listed { columns: count, got: list.len() }),
        Columns::Listed(list) => match list.iter().find(|&a| !(-TAU..=TAU).contains(a)) {
            Some(&a) => value("columns", a),
            None => Ok(()),
        },
    };
    match beams {
        Beams::Nodding { columns, .. } => angles(columns),
        Beams::Spinning { columns, wraps } => {
            angles(columns)?;
            match *columns {
                // the angle across the seam is that of any other pair of neighbours, to 1 % of it
                Columns::Even { step_rad, .. }
                    if *wraps && libm::fabsf(libm::fabsf(step_rad) * count as f32 - TAU) > 0.01 * step_rad.abs() =>
                {
                    value("wraps: step_rad", step_rad)
                }
                _ => Ok(()),
            }
        }
        &Beams::Pinhole { fx_px, fy_px, cx_px, cy_px } => {
            let far = 1e6;
            for (field, v) in [("fx_px", fx_px), ("fy_px", fy_px)] {
                if !(0.1..=far).contains(&v.abs()) {
                    return value(field, v);
                }
            }
            for (field, v) in [("cx_px", cx_px), ("cy_px", cy_px)] {
                if !(-far..=far).contains(&v) {
                    return value(field, v);
                }
            }
            Ok(())
        }
    }
}
