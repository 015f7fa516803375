//! Which pixels of a row go on with the planes of the row above (paper section 4: what is within a distance of the growing
//! region belongs to it).
//!
//! A pixel may go on with the plane of one of its three neighbours above: the one whose range error is least. Or it leaves
//! them all. To leave costs [`LEAVE`], and each pixel out there [`LEFT`], in squared errors in units of the noise; the row
//! is cut so that the sum is least (Viterbi's recursion with two states, one bit each per pixel). So one pixel that noise
//! throws off leaves nothing, and a row of small errors to one side does.

use crate::bits::{CHUNK, load};
use crate::scanline::Scanline;
use crate::surface::{NONE, Surfaces};

/// Squared error at which a pixel lies on no plane, in units of the noise: 3.2 standard deviations.
const OFF: f32 = 12.0;

/// Price of a pixel that has left, and price of leaving.
const LEFT: f32 = 3.0;
const LEAVE: f32 = 12.0;

/// Variance of the direction of a beam, rad^2: 0.02 deg. It tells where a surface is seen at a grazing angle.
const BEAM_RAD2: f32 = 1.2e-7;

/// Surfaces seen at less than 4 deg are taken for seen at 4 deg.
const MAX_TAN_SQUARE: f32 = 200.0;

const MOST: f32 = 9.0;

/// What stands for no plane at all.
const FAR: f32 = 1e6;

/// Turn of the row beyond what was reported, and the noise, as they are known when the row comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowNoise {
    pub range_m2: f32,
    pub turn_rad: f32,
    /// Variance of the turn that is left after its correction.
    pub turn_rad2: f32,
}

/// Finds for each pixel of a row the slot whose plane it goes on with, or [`NONE`]. `above` are the slots of the row above;
/// `back` is scratch, two packed rows.
pub(crate) fn follow(
    line: &Scanline,
    above: &[u16],
    surfaces: &Surfaces,
    noise: &RowNoise,
    back: [&mut [u32]; 2],
    slots: &mut [u16],
) {
    let columns = above.len();
    let [was_left, was_on] = back;
    // cost of the best way to each state
    let (mut on, mut left) = (0.0, LEAVE);
    for from in (0..columns).step_by(CHUNK) {
        let lanes = line.lanes(from);
        let mut errors = [FAR; CHUNK];
        let mut best = [NONE; CHUNK];
        let width = CHUNK.min(columns - from);
        let mut one = |slot: u16, start: usize, end: usize| {
            let Some(plane) = surfaces.plane(slot) else { return };
            let [a, b, k, turned] = line.along(plane);
            let a_now = a + noise.turn_rad * turned;
            let steep = plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2];
            for i in start..end {
                let (range_m, along) = (lanes.range_m[i], lanes.cos[i] * turned);
                // p . m, and how it changes with the turn angle
                let q = range_m * (lanes.cos[i] * a_now + lanes.sin[i] * b + k);
                let error = range_m * (q - 1.0);
                let slope = range_m * range_m * along;
                // r tan(incidence), squared
                let graze = range_m * range_m * (range_m * range_m * steep - 1.0).clamp(0.0, MAX_TAN_SQUARE);
                let variance_m2 =
                    noise.range_m2 + (slope * slope * noise.turn_rad2).min(MOST * noise.range_m2) + graze * BEAM_RAD2;
                let square = error * error / variance_m2;
                let square = if q > 0.05 { square } else { FAR };
                let better = square < errors[i];
                errors[i] = if better { square } else { errors[i] };
                best[i] = if better { slot } else { best[i] };
            }
        };
        if line.wraps && from == 0 {
            one(above[columns - 1], 0, 1);
        }
        let mut start = from.saturating_sub(1);
        let end = columns.min(from + CHUNK + 1);
        while start < end {
            let slot = above[start];
            let stop = start + above[start..end].iter().take_while(|&&s| s == slot).count();
            one(slot, start.saturating_sub(1).max(from) - from, (stop + 1).min(from + width) - from);
            start = stop;
        }
        if line.wraps && from + CHUNK >= columns {
            one(above[0], width - 1, width);
        }
        let (mut left_bits, mut on_bits) = (0, 0);
        for i in 0..width {
            let some = lanes.range_m[i] > 0.0;
            let error = if errors[i] < OFF || errors[i] == FAR { errors[i] } else { OFF };
            let (on_price, left_price) = if some { (error, LEFT) } else { (0.0, 0.0) };
            let back_on = left < on;
            let leave = on + LEAVE < left;
            let next_on = if back_on { left } else { on } + on_price;
            let next_left = if leave { on + LEAVE } else { left } + left_price;
            let least = if next_on < next_left { next_on } else { next_left };
            (on, left) = (next_on - least, next_left - least);
            left_bits |= u32::from(back_on) << i;
            on_bits |= u32::from(leave) << i;
            slots[from + i] = if some & (errors[i] < OFF) { best[i] } else { NONE };
        }
        was_left[from / CHUNK] = left_bits;
        was_on[from / CHUNK] = on_bits;
    }
    let mut is_on = on <= left;
    for column in (0..columns).rev() {
        if !is_on {
            slots[column] = NONE;
        }
        let bits = if is_on { &*was_left } else { &*was_on };
        if bits[column / CHUNK] >> (column % CHUNK) & 1 == 1 {
            is_on = !is_on;
        }
    }
}

/// One chunk of a row.
pub(crate) struct Lanes {
    pub cos: [f32; CHUNK],
    pub sin: [f32; CHUNK],
    /// 0 for no return, and outside of the image.
    pub range_m: [f32; CHUNK],
}

impl Scanline<'_> {
    pub fn lanes(&self, from: usize) -> Lanes {
        let range_m = load(self.ranges_m, from, &mut [0.0; CHUNK]).map(|range_m| self.config.clean(range_m));
        let mut lanes = Lanes { cos: [0.0; CHUNK], sin: [0.0; CHUNK], range_m };
        self.fan.row_lanes(&self.frame, from, &mut lanes.cos, &mut lanes.sin);
        lanes
    }
}
