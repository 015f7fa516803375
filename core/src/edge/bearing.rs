//! Bearing angles (paper section 3): the angle between the laser beam and the line through two
//! returns of a trace.
//!
//! ```text
//! BA = arccos((r1 - r0 cos Phi) / sqrt(r1^2 + r0^2 - 2 r1 r0 cos Phi))    the paper's form
//!    = atan2(r0 sin Phi, (r1 - r0) + r0 vers Phi)                         without its cancellation
//! ```
//!
//! with r1 the range at this pixel, r0 that of the previous pixel on the trace and Phi the angle
//! between their beams. In f32 the second form errs by less than [`MAX_ERROR_RAD`]; the first by up
//! to 0.35 deg, and it gives NaN.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::round;
use crate::beam::Beams;
use crate::config::Ranging;
use crate::edge::beam_angle::{BeamAngle, MIN_BEAM_ANGLE_RAD, Pair, rays};
use crate::edge::trace::Trace;
use crate::error::ConfigError;
use crate::row::bits::{CHUNK, load};
use crate::row::fan::{Fan, RowBeam};
use crate::row::within::at;
use crate::row_beams::RowBeams;

/// Bearing angles in images are whole counts of pi / 65535; 0 means none.
pub const COUNTS_PER_RAD: f32 = 65535.0 / core::f32::consts::PI;

/// Error bound of [`bearing_angle_rad`] for the ranges and the beam angle given, radians: 0.001 deg
/// (measured at most 0.00012 deg; with the feature `micromath` 0.17 deg, measured at most 0.162
/// deg).
#[cfg(not(feature = "micromath"))]
pub const MAX_ERROR_RAD: f32 = 1.75e-5;
/// Error bound of [`bearing_angle_rad`] for the ranges and the beam angle given, radians: 0.17 deg.
#[cfg(feature = "micromath")]
pub const MAX_ERROR_RAD: f32 = 2.97e-3;

/// Bearing angle in radians, 0 to pi (paper equation 1).
///
/// `range_m` and `previous_range_m`: positive and finite, in any common unit (scaling both changes
/// nothing); `angle` as [`BeamAngle`] describes it. Other values give a meaningless angle, never a
/// panic. About 25 operations and one division; no branch, so that a loop over a row vectorises.
///
/// ```
/// use scanseg_core::{BeamAngle, bearing_angle_rad};
/// // a wall seen straight on, two beams 1 deg apart: the line is perpendicular to the beam between
/// let half_deg = 0.5_f32.to_radians();
/// let range_m = 2.0 / half_deg.cos();
/// let ba = bearing_angle_rad(range_m, range_m, BeamAngle::from_rad(2.0 * half_deg));
/// assert!((ba.to_degrees() - 89.5).abs() < 1e-3);
/// ```
#[inline(always)]
#[must_use]
pub fn bearing_angle_rad(range_m: f32, previous_range_m: f32, angle: BeamAngle) -> f32 {
    let y = previous_range_m * angle.sin;
    let x = (range_m - previous_range_m) + previous_range_m * angle.vers;
    atan2(y, x)
}

/// atan2 for y >= 0, by the smaller of y / x and x / y. The polynomial is the minimax fit of atan
/// on -1 to 1 of its degree: 1.7e-6 rad.
#[cfg(not(feature = "micromath"))]
#[inline(always)]
fn atan2(y: f32, x: f32) -> f32 {
    use core::f32::consts::{FRAC_PI_2, PI};
    const P: [f32; 6] = [0.999_977_2, -0.332_622_83, 0.193_540_38, -0.116_426_48, 0.052_647_35, -0.011_719_135];
    // neither is negative: their bits are in the order of the numbers
    let flat = y.to_bits() < x.abs().to_bits();
    let (part, of) = if flat { (y, x) } else { (x, y) };
    let a = part / of;
    let t = a * a;
    let r = a * (P[0] + t * (P[1] + t * (P[2] + t * (P[3] + t * (P[4] + t * P[5])))));
    let along = if x.is_sign_negative() { PI } else { 0.0 };
    if flat { along + r } else { FRAC_PI_2 - r }
}

#[cfg(feature = "micromath")]
#[inline(always)]
fn atan2(y: f32, x: f32) -> f32 {
    micromath::F32Ext::atan2(y, x)
}

/// A row of ranges and what is known of it.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Ranges in metres, one per column.
    pub ranges_m: &'a [f32],
    /// Where its beams point: most often just its turn angle or elevation.
    pub beams: RowBeams<'a>,
    /// Number of the row; used with pinhole beams only.
    pub row: usize,
}

/// Bearing angles of a row along one trace, in counts of pi / 65535 (see [`COUNTS_PER_RAD`]), 0
/// where there is none: no return at either pixel, a previous pixel outside of the image, or two
/// beams that coincide.
///
/// `before` is the row `trace.rows` earlier (for a trace along the row: `now` again). `out` has one
/// element per column. A return is a finite range within the configured limits. Cost: linear in the
/// columns, some 40 instructions each.
///
/// # Errors
/// [`ConfigError`] for limits or beams that no segmenter takes either, and where the three rows'
/// lengths differ.
pub fn bearing_row(
    ranging: &Ranging,
    beams: Beams<'_>,
    trace: Trace,
    now: Row<'_>,
    before: Row<'_>,
    out: &mut [u16],
) -> Result<(), ConfigError> {
    ranging.check()?;
    let columns = out.len();
    let fan = Fan::new(beams, columns)?;
    for got in [now.ranges_m.len(), before.ranges_m.len()] {
        if got != columns {
            return Err(ConfigError::Memory { field: "ranges_m", needed: columns, got });
        }
    }
    let rows = [now, before].map(|row| RowBeam { row: row.row, beams: row.beams });
    let mut lanes = TraceRow::new(&fan, trace, rows, columns);
    for (i, out) in out.chunks_mut(CHUNK).enumerate() {
        let pairs = lanes.chunk(i * CHUNK, now.ranges_m, before.ranges_m);
        for (i, out) in out.iter_mut().enumerate() {
            let pair = pairs.get(i, ranging);
            *out = if pair.missing >> 31 == 0 { pair.count as u16 } else { 0 };
        }
    }
    Ok(())
}

/// One row along one trace, chunk by chunk.
pub(crate) struct TraceRow<'a> {
    fan: &'a Fan<'a>,
    trace: Trace,
    columns: usize,
    /// This row, and the one that the trace reaches back to.
    rows: [RowBeam<'a>; 2],
    pair: Pair,
    sin: [f32; CHUNK],
    vers: [f32; CHUNK],
    /// Room for chunks that do not lie in one piece.
    copies: [[f32; CHUNK]; 2],
}

impl<'a> TraceRow<'a> {
    pub fn new(fan: &'a Fan<'a>, trace: Trace, rows: [RowBeam<'a>; 2], columns: usize) -> Self {
        let pair = fan.pair(trace, rows);
        let BeamAngle { sin, vers } = pair.same();
        Self { fan, trace, columns, rows, pair, sin: [sin; CHUNK], vers: [vers; CHUNK], copies: [[0.0; CHUNK]; 2] }
    }

    /// The chunk that starts at column `from`. `before_m` is the row that the trace reaches back
    /// to, `now_m` itself for a trace along the row.
    #[inline(always)]
    pub fn chunk<'b>(&'b mut self, from: usize, now_m: &'b [f32], before_m: &'b [f32]) -> Pairs<'b> {
        self.fan.angles(&self.pair, from, self.columns, &mut self.sin, &mut self.vers);
        let [now_copy, before_copy] = &mut self.copies;
        let now_m = load(now_m, from, now_copy);
        let first = from as isize - isize::from(self.trace.columns);
        let in_place = usize::try_from(first).ok().and_then(|first| before_m.get(first..)?.first_chunk());
        let before_m = match in_place {
            Some(chunk) => chunk,
            None => {
                gather(before_m, first, self.fan.wraps(), before_copy);
                before_copy
            }
        };
        if let Pair::Rays { offset } = self.pair {
            rays(self.fan, self.rows, offset, [from, self.columns], before_m, [&mut self.sin, &mut self.vers]);
        }
        Pairs { now_m, before_m, sin: &self.sin, vers: &self.vers }
    }
}

/// The pairs of pixels of a chunk of a trace: ranges as they were pushed, and the angles between
/// the beams. Ranges are 0 outside of the image.
pub(crate) struct Pairs<'a> {
    now_m: &'a [f32; CHUNK],
    before_m: &'a [f32; CHUNK],
    sin: &'a [f32; CHUNK],
    vers: &'a [f32; CHUNK],
}

impl Pairs<'_> {
    /// The `i`-th pair.
    #[inline(always)]
    pub fn get(&self, i: usize, ranging: &Ranging) -> Pixel {
        let (now_m, before_m) = (self.now_m[i], self.before_m[i]);
        let angle = BeamAngle { sin: self.sin[i], vers: self.vers[i] };
        Pixel {
            change_m: now_m - before_m,
            count: round(bearing_angle_rad(now_m, before_m, angle) * COUNTS_PER_RAD).max(1),
            // a difference below 0 has the highest bit
            missing: ranging.no_return(now_m)
                | ranging.no_return(before_m)
                | angle.vers.to_bits().wrapping_sub(MIN_VERS),
        }
    }
}

/// Bits of vers Phi of two beams that just have a bearing angle. Those of a smaller one are less.
const MIN_VERS: u32 = (0.5 * MIN_BEAM_ANGLE_RAD * MIN_BEAM_ANGLE_RAD).to_bits();

/// What is found of a pair of pixels.
pub(crate) struct Pixel {
    /// Change of range.
    pub change_m: f32,
    /// Bearing angle in counts, 1 at least.
    pub count: i32,
    /// The highest bit says whether the others mean nothing: a return is missing, or the beams
    /// coincide.
    pub missing: u32,
}

/// The ranges of the columns from `first` on; 0 outside of the image.
#[inline(never)]
fn gather(row_m: &[f32], first: isize, wraps: bool, out: &mut [f32; CHUNK]) {
    *out = [0.0; CHUNK];
    let columns = row_m.len() as isize;
    let (start, end) = (first.clamp(0, columns), (first + CHUNK as isize).clamp(0, columns));
    let inside = row_m.get(start as usize..end as usize).unwrap_or_default();
    for (out, &range_m) in out.iter_mut().skip((start - first) as usize).zip(inside) {
        *out = range_m;
    }
    if wraps {
        for (out, column) in out.iter_mut().zip(first..) {
            if !(0..columns).contains(&column) {
                *out = column.checked_rem_euclid(columns).map_or(0.0, |column| at(row_m, column as usize));
            }
        }
    }
}
