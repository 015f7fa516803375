//! Which pixels of a row go on with the planes of the row above (paper section 4: what is within a
//! distance of the growing region belongs to it).
//!
//! A pixel may go on with the plane of one of its three neighbours above: the one whose range error
//! is least. Or it leaves them all. To leave costs [`Rules::leave_price`], and each pixel out there
//! [`Rules::left_price`], in squared errors in units of the noise; the row is cut so that the sum
//! is least (Viterbi's recursion with two states, one bit each per pixel). So one pixel that noise
//! throws off leaves nothing, and a row of small errors to one side does.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::dot;
use crate::plane::noise::RowNoise;
use crate::plane::rules::Rules;
use crate::plane::scanline::{Lanes, Scanline};
use crate::plane::surface::Surfaces;
use crate::row::bits::{CHUNK, pack};
use crate::row::slots::NONE;
use crate::row::within::{at, part, part_mut, put};

/// What stands for no plane at all.
const FAR: f32 = 1e6;

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

/// Finds for each pixel of a row the slot whose plane it goes on with, or [`NONE`]. `above` are the
/// slots of the row above.
pub(crate) fn follow(
    line: &Scanline,
    above: &[u16],
    surfaces: &Surfaces,
    noise: &RowNoise,
    bits: &mut Followed,
    slots: &mut [u16],
) {
    let Followed { returns, free, was_left, was_on } = bits;
    let &Rules { off_plane, left_price, leave_price, .. } = surfaces.rules;
    let columns = above.len();
    let mut lanes = Lanes::EMPTY;
    // how much better the best way to be on a plane is than the best way to have left
    let mut ahead = leave_price;
    for (word, from) in (0..columns).step_by(CHUNK).enumerate() {
        line.lanes(from, &mut lanes);
        let best = Best::of_chunk(line, &lanes, from, above, surfaces, noise);
        let (mut gains, mut aheads, mut near) = ([0.0; CHUNK], [0.0; CHUNK], [false; CHUNK]);
        let some = lanes.range_m.map(|range_m| range_m > 0.0);
        for i in 0..CHUNK {
            let error = best.errors[i];
            near[i] = (error < off_plane) & some[i];
            let price = if (error < off_plane) | (error == FAR) { error } else { off_plane };
            gains[i] = if some[i] { left_price - price } else { 0.0 };
        }
        let width = CHUNK.min(columns - from);
        for i in 0..width {
            aheads[i] = ahead;
            let least = if ahead > 0.0 { ahead } else { 0.0 };
            ahead = gains[i] + if least < leave_price { least } else { leave_price };
        }
        put(was_left, word, pack(&aheads.map(|ahead| ahead < 0.0)));
        put(was_on, word, pack(&aheads.map(|ahead| ahead > leave_price)));
        let returned = pack(&some);
        put(returns, word, returned);
        put(free, word, returned & !pack(&near));
        for (slot, best) in part_mut(slots, from..from + width).iter_mut().zip(best.slots) {
            *slot = best;
        }
    }
    leave(ahead >= 0.0, bits, slots);
}

/// Goes back along the best way through the row, and frees the pixels where it has left. `is_on`:
/// whether the way ends on a plane.
fn leave(mut is_on: bool, bits: &mut Followed, slots: &mut [u16]) {
    let Followed { returns, free, was_left, was_on } = bits;
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
    /// Tries the planes above the chunk that starts at column `from` on its pixels.
    #[inline(always)]
    fn of_chunk(
        line: &Scanline,
        lanes: &Lanes,
        from: usize,
        above: &[u16],
        surfaces: &Surfaces,
        noise: &RowNoise,
    ) -> Best {
        let (columns, reach) = (above.len(), surfaces.rules.reach_columns);
        let width = CHUNK.min(columns - from);
        let mut best = Best { errors: [FAR; CHUNK], slots: [NONE; CHUNK] };
        let mut one = |slot: u16, start: usize, end: usize| {
            if let Some(plane) = surfaces.plane(slot) {
                best.add(slot, plane, start..end, line, lanes, noise, surfaces.rules);
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
            one(slot, start.saturating_sub(reach).max(from) - from, (stop + reach).min(from + width) - from);
            start = stop;
        }
        if line.wraps && from + CHUNK >= columns {
            one(at(above, 0), width - 1, width);
        }
        best
    }

    /// Tries a plane on some pixels.
    #[inline(never)]
    #[expect(clippy::too_many_arguments, reason = "what the innermost loop reads")]
    fn add(
        &mut self,
        slot: u16,
        plane: [f32; 3],
        pixels: Range<usize>,
        line: &Scanline,
        lanes: &Lanes,
        noise: &RowNoise,
        rules: &Rules,
    ) {
        let &Rules { max_tan_square, beam_rad2, most_turn, .. } = rules;
        let [a, b, k, turned] = line.along(plane);
        let a_now = a + noise.turn_rad * turned;
        let steep = dot(plane, plane);
        let (range_m2, turn_rad2, most_m2) = (noise.range_m2, noise.turn_rad2, most_turn * noise.range_m2);
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let errors =
            part_mut(&mut self.errors, pixels.clone()).iter_mut().zip(part_mut(&mut self.slots, pixels.clone()));
        let [range_m, cos, sin] = [&lanes.range_m, &lanes.cos, &lanes.sin].map(|lane| part(lane, pixels.clone()));
        let beams = range_m.iter().zip(cos).zip(sin);
        for ((known, best), ((&range_m, &cos), &sin)) in errors.zip(beams) {
            // p . m, and how the range error changes with the turn angle
            let q = range_m * (cos * a_now + sin * b + k);
            let error = range_m * (q - 1.0);
            let square_m2 = range_m * range_m;
            let slope = square_m2 * cos * turned;
            // tan(incidence), squared
            let tan_square = square_m2 * steep - 1.0;
            let tan_square = least(if tan_square > 0.0 { tan_square } else { 0.0 }, max_tan_square);
            let variance_m2 = range_m2 + least(slope * slope * turn_rad2, most_m2) + square_m2 * tan_square * beam_rad2;
            let square = error * error / variance_m2;
            let square = if q > 0.05 { square } else { FAR };
            let better = square < *known;
            *known = if better { square } else { *known };
            *best = if better { slot } else { *best };
        }
    }
}
