//! Edges in a bearing-angle image (paper section 4).
//!
//! Roof edges: the 3 x 3 Sobel operator on each image separately, thresholded: |Gx| + |Gy| >= 4 x the roof angle. A
//! neighbour without a bearing angle, or outside of the image, takes the centre's value. Sobel works on eighths of the
//! image's resolution (pi / 8192, 0.02 deg), which 16-bit arithmetic holds exactly.
//!
//! Step edges: a bearing angle near 0 or pi, where the range changes by more than the noise.

use crate::beam::round;
use crate::bearing::{COUNTS_PER_RAD, Pairs};
use crate::bits::{CHUNK, pack};
use crate::config::Config;

/// Thresholds in the units of the images.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thresholds {
    /// Of |Gx| + |Gy|, eighths.
    roof: u16,
    /// Of the bearing angle, counts.
    step: i32,
    /// Of the change of range, metres.
    step_range_m: f32,
}

impl Thresholds {
    pub fn new(config: &Config) -> Self {
        Self {
            roof: round(config.roof_angle_rad * (COUNTS_PER_RAD / 2.0)) as u16,
            step: round(config.step_angle_rad * COUNTS_PER_RAD),
            step_range_m: config.step_range_m(),
        }
    }
}

/// A bearing angle as Sobel takes it: 1 to 8192 for counts of 1 to 65535, 0 for none.
#[inline(always)]
fn eighth(count: i32) -> u16 {
    ((count + 7) >> 3) as u16
}

/// Eighths of a chunk with one more column at either side: index 0 is the column to the left of the chunk.
pub(crate) type Halo = [u16; CHUNK + 2];

/// Roof edges of a chunk, packed, from three rows.
#[inline(always)]
pub(crate) fn roofs(above: &Halo, centre: &Halo, below: &Halo, thresholds: &Thresholds) -> u32 {
    let mut least = u16::MAX;
    for i in 0..CHUNK + 2 {
        least = least.min(above[i]).min(centre[i]).min(below[i]);
    }
    if least > 0 {
        sobel::<false>(above, centre, below, thresholds)
    } else {
        sobel::<true>(above, centre, below, thresholds)
    }
}

/// `GAPS`: some of the eighths may be 0, none.
#[inline(always)]
fn sobel<const GAPS: bool>(above: &Halo, centre: &Halo, below: &Halo, thresholds: &Thresholds) -> u32 {
    let mut edges = [false; CHUNK];
    for i in 0..CHUNK {
        let own = centre[i + 1];
        let tap = |eighth: u16| if GAPS && eighth == 0 { own } else { eighth };
        let (nw, n, ne) = (tap(above[i]), tap(above[i + 1]), tap(above[i + 2]));
        let (w, e) = (tap(centre[i]), tap(centre[i + 2]));
        let (sw, s, se) = (tap(below[i]), tap(below[i + 1]), tap(below[i + 2]));
        // sums of four wrap at 16 bits, their differences fit: 4 x 8191 at most
        let four = |a: u16, b: u16, c: u16| a.wrapping_add(b << 1).wrapping_add(c);
        let gx = four(ne, e, se).wrapping_sub(four(nw, w, sw)) as i16;
        let gy = four(sw, s, se).wrapping_sub(four(nw, n, ne)) as i16;
        let strength = gx.unsigned_abs() + gy.unsigned_abs();
        edges[i] = (strength >= thresholds.roof) & (!GAPS | (own != 0));
    }
    pack(&edges)
}

/// Bearing angles of a chunk in eighths; returns its step edges, packed.
// A function of its own: what it is given cannot overlap what it writes, and the compiler knows.
#[inline(never)]
pub(crate) fn bearings(pairs: &Pairs, config: &Config, thresholds: &Thresholds, eighths: &mut [u16; CHUNK]) -> u32 {
    let (config, thresholds) = (*config, *thresholds);
    let mut steps = [false; CHUNK];
    for i in 0..CHUNK {
        let (range_m, previous_range_m, count) = pairs.get(i, &config);
        let near = (2 * count - 65535).abs() >= 65535 - 2 * thresholds.step;
        let jump = (range_m - previous_range_m).abs() > thresholds.step_range_m;
        steps[i] = near & jump & (count != 0);
        eighths[i] = eighth(count);
    }
    pack(&steps)
}
