//! Which pixels of a row go on with the planes of the row above (paper section 4: what is within a distance of the growing
//! region belongs to it).
//!
//! A pixel may go on with the plane of one of its three neighbours above: the one whose range error is least. Or it leaves
//! them all. To leave costs [`LEAVE`], and each pixel out there [`LEFT`], in squared errors in units of the noise; the row
//! is cut so that the sum is least (Viterbi's recursion with two states, one bit each per pixel). So one pixel that noise
//! throws off leaves nothing, and a row of small errors to one side does.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane::areas::Areas;
use crate::plane::row::{Lanes, RowView};
use crate::plane::rules::Rules;
use crate::row::bits::{CHUNK, pack};
use crate::row::slots::NONE;
use crate::row::within::{at, part, part_mut, put};

/// Surfaces seen at less than 4 deg are taken for seen at 4 deg.
const MAX_TAN_SQUARE: f32 = 200.0;

/// Most that the turn angle may add to the variance of a range, in units of the noise.
const MOST: f32 = 9.0;

/// What stands for no plane at all.
const FAR: f32 = 1e6;

/// Turn of the row beyond what was reported, and the noise, as they are known when the row comes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowNoise {
    pub beam_rad2: f32,
    pub flat_m2: f32,
    pub turn_rad: f32,
    /// Variance of the turn that is left after its correction.
    pub turn_rad2: f32,
}

/// Packed rows that [`follow`] fills.
pub(crate) struct Followed<'a> {
    /// Pixels with a return.
    pub returns: &'a mut [u32],
    /// Those of them that follow no plane.
    pub free: &'a mut [u32],
    /// Scratch: where the best way to each state comes from.
    pub was_left: &'a mut [u32],
    pub was_on: &'a mut [u32],
}

/// Finds for each pixel of a row the slot whose plane it goes on with, or [`NONE`]. `above` are the slots of the row above.
pub(crate) fn follow(
    line: &RowView,
    above: &[u16],
    surfaces: &Areas,
    noise: &RowNoise,
    bits: &mut Followed,
    slots: &mut [u16],
) {
    let Followed { returns, free, was_left, was_on } = bits;
    let columns = above.len();
    let Rules { off, left, leave, .. } = *surfaces.rules;
    let share = 1.0 / line.alike_row;
    let mut lanes = Lanes::EMPTY;
    // how much better the best way to be on a plane is than the best way to have left
    let mut ahead = leave;
    for (word, from) in (0..columns).step_by(CHUNK).enumerate() {
        line.lanes(from, &mut lanes);
        let mut best = Best { errors: [FAR; CHUNK], slots: [NONE; CHUNK] };
        let width = CHUNK.min(columns - from);
        let mut one = |slot: u16, start: usize, end: usize| {
            if let Some(plane) = surfaces.plane(slot) {
                best.add(slot, plane, start..end, line, &lanes, noise);
            }
        };
        if line.wraps && from == 0 {
            one(at(above, columns - 1), 0, 1);
        }
        let mut start = from.saturating_sub(1);
        let end = columns.min(from + CHUNK + 1);
        while start < end {
            let slot = at(above, start);
            let stop = start + part(above, start..end).iter().take_while(|&&s| s == slot).count();
            one(slot, start.saturating_sub(1).max(from) - from, (stop + 1).min(from + width) - from);
            start = stop;
        }
        if line.wraps && from + CHUNK >= columns {
            one(at(above, 0), width - 1, width);
        }
        let (mut gains, mut aheads, mut near) = ([0.0; CHUNK], [0.0; CHUNK], [false; CHUNK]);
        let some = lanes.range_m.map(|range_m| range_m > 0.0);
        for i in 0..CHUNK {
            let error = best.errors[i];
            near[i] = (error < off) & some[i];
            let price = if (error < off) | (error == FAR) { error } else { off };
            gains[i] = if some[i] { (left - price) * share } else { 0.0 };
        }
        let none_below = gains.iter().fold(0.0f32, |least, &gain| if gain < least { gain } else { least }) == 0.0;
        if none_below && ahead >= leave && width == CHUNK {
            // nothing leaves here
            aheads[0] = ahead;
            for i in 1..CHUNK {
                aheads[i] = gains[i - 1] + leave;
            }
            ahead = gains[CHUNK - 1] + leave;
        } else {
            for i in 0..width {
                aheads[i] = ahead;
                let least = if ahead > 0.0 { ahead } else { 0.0 };
                ahead = gains[i] + if least < leave { least } else { leave };
            }
        }
        put(was_left, word, pack(&aheads.map(|ahead| ahead < 0.0)));
        put(was_on, word, pack(&aheads.map(|ahead| ahead > leave)));
        let returned = pack(&some);
        put(returns, word, returned);
        put(free, word, returned & !pack(&near));
        for (slot, best) in part_mut(slots, from..from + width).iter_mut().zip(best.slots) {
            *slot = best;
        }
    }
    let mut is_on = ahead >= 0.0;
    for (word, slots) in slots.chunks_mut(CHUNK).enumerate().rev() {
        let mut on_bits = u32::MAX;
        let (was_left, was_on, returned) = (at(was_left, word), at(was_on, word), at(returns, word));
        if !is_on || was_left != 0 {
            for i in (0..slots.len()).rev() {
                on_bits &= !(u32::from(!is_on) << i);
                let bits = if is_on { was_left } else { was_on };
                is_on ^= bits >> i & 1 == 1;
            }
        }
        let freed = at(free, word) | returned & !on_bits;
        put(free, word, freed);
        let off = freed | !returned;
        if off != 0 {
            for (i, slot) in slots.iter_mut().enumerate() {
                *slot = if off >> i & 1 == 1 { NONE } else { *slot };
            }
        }
    }
}

/// The plane that each pixel of a chunk fits best.
struct Best {
    /// Squared range errors in units of the noise.
    errors: [f32; CHUNK],
    slots: [u16; CHUNK],
}

impl Best {
    /// Tries a plane on some pixels.
    #[inline(never)]
    fn add(
        &mut self,
        slot: u16,
        plane: [f32; 3],
        pixels: core::ops::Range<usize>,
        line: &RowView,
        lanes: &Lanes,
        noise: &RowNoise,
    ) {
        let [a, b, k, turned] = line.along(plane);
        let a_now = a + noise.turn_rad * turned;
        let steep = plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2];
        let RowNoise { turn_rad2, beam_rad2, flat_m2, .. } = *noise;
        let variance = line.variance;
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let errors =
            part_mut(&mut self.errors, pixels.clone()).iter_mut().zip(part_mut(&mut self.slots, pixels.clone()));
        let [range_m, cos, sin] = [&lanes.range_m, &lanes.cos, &lanes.sin].map(|lane| part(lane, pixels.clone()));
        let beams = range_m.iter().zip(cos).zip(sin);
        for ((known, best), ((&range_m, &cos), &sin)) in errors.zip(beams) {
            // p . m, and how the range error changes with the turn angle
            let range_m = range_m - line.offset_m;
            let q = range_m * (cos * a_now + sin * b + k);
            let error = range_m * (q - 1.0);
            let square_m2 = range_m * range_m;
            let slope = square_m2 * cos * turned;
            // tan(incidence), squared
            let tan_square = square_m2 * steep - 1.0;
            let tan_square = least(if tan_square > 0.0 { tan_square } else { 0.0 }, MAX_TAN_SQUARE);
            let range_m2 = variance.at(range_m);
            let variance_m2 = range_m2
                + least(slope * slope * turn_rad2, MOST * range_m2)
                + square_m2 * tan_square * beam_rad2
                + flat_m2 * (1.0 + tan_square);
            let square = error * error / variance_m2;
            let square = if q > 0.05 { square } else { FAR };
            let better = square < *known;
            *known = if better { square } else { *known };
            *best = if better { slot } else { *best };
        }
    }
}
