//! Which pixels of a row go on with the planes of the row above (paper section 4: what is within a
//! distance of the growing region belongs to it).
//!
//! A pixel may go on with the plane of one of its three neighbours above: the one whose range error
//! is least. Or it leaves them all. To leave costs [`Rules::leave_price`], and each pixel out there
//! [`Rules::left_price`], in squared errors in units of the noise; the row is cut so that the sum
//! is least (Viterbi's recursion with two states, one bit each per pixel). So one pixel that noise
//! throws off leaves nothing, and a row of small errors to one side does.
//!
//! Above a pixel means in the row above, or up to two rows further up where there is no return.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::{below, dot};
use crate::plane::areas::Areas;
use crate::plane::rules::Rules;
use crate::plane::scanline::{Along, Scanline};
use crate::plane::work::count;
use crate::row::bits::{CHUNK, VECTORS, pack_where};
use crate::row::fan::Lanes;
use crate::row::slots::NONE;
use crate::row::within::{at, part, part_mut, put};

/// Squared error that stands for no plane at all.
const FAR: f32 = 1e6;

/// A plane that is met farther away than so many times the range is not seen there.
const MOST_SHARE: f32 = 20.0;

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
/// slots above the row; `left2` is the variance of what the row is off by that is left after its
/// correction: rad^2 of its turn, m^2 of the offset of its ring.
#[inline(never)]
pub(crate) fn follow(
    line: &Scanline,
    above: &[u16],
    areas: &Areas,
    left2: f32,
    bits: &mut Followed,
    slots: &mut [u16],
) {
    let columns = above.len();
    // copies: read once a row, not once a pixel
    let Rules { off_plane, left_price, leave_price, .. } = *areas.rules;
    let prices = Prices { off_plane, left: left_price, leave: leave_price, share: 1.0 / line.alike_px };
    let (mut lanes, mut best) = (Lanes::EMPTY, Best::EMPTY);
    // how much better the best way to be on a plane is than the best way to have left
    let mut ahead = leave_price;
    for (word, from) in (0..columns).step_by(CHUNK).enumerate() {
        line.lanes(from, &mut lanes);
        let width = CHUNK.min(columns - from);
        best.of_chunk(line, &lanes, from, above, areas, left2);
        let chunk = if VECTORS { side_by_side } else { one_by_one };
        let [was_left, was_on, returned, far] = chunk(&mut ahead, &best.errors, &lanes.range_m, width, &prices);
        put(bits.was_left, word, was_left);
        put(bits.was_on, word, was_on);
        put(bits.returns, word, returned);
        put(bits.free, word, far);
        for (slot, best) in part_mut(slots, from..from + width).iter_mut().zip(best.slots) {
            *slot = best;
        }
    }
    walk_back(ahead >= 0.0, bits, slots);
}

/// What it costs to leave.
struct Prices {
    /// Squared error beyond which a pixel has left.
    off_plane: f32,
    /// Of each pixel out there.
    left: f32,
    /// Of leaving.
    leave: f32,
    /// Pixels that are alike count as one.
    share: f32,
}

impl Prices {
    /// What a return gains by being on a plane at this squared error.
    #[inline(always)]
    fn gain(&self, error: f32) -> f32 {
        let price =
            if below(error, self.off_plane) | (error.to_bits() == FAR.to_bits()) { error } else { self.off_plane };
        (self.left - price) * self.share
    }

    /// How much being on a plane is ahead behind a pixel, by what it gains and how much it was
    /// ahead before it.
    #[inline(always)]
    fn ahead(&self, before: f32, gain: f32) -> f32 {
        let least = if below(0.0, before) { before } else { 0.0 };
        gain + if below(least, self.leave) { least } else { self.leave }
    }
}

/// The pixels of a chunk: packed, where the best way to have left and to be on a plane comes from;
/// returns; those of them that are far from all planes. `ahead` goes from before the chunk to
/// behind it.
fn side_by_side(
    ahead: &mut f32,
    errors: &[f32; CHUNK],
    range_m: &[f32; CHUNK],
    width: usize,
    prices: &Prices,
) -> [u32; 4] {
    let mut gains = [0.0; CHUNK];
    for i in 0..CHUNK {
        gains[i] = if range_m[i] > 0.0 { prices.gain(errors[i]) } else { 0.0 };
    }
    let aheads = aheads(ahead, &gains, width, prices);
    let returned = pack_where(|i| range_m[i] > 0.0);
    let near = pack_where(|i| errors[i] < prices.off_plane);
    [pack_where(|i| aheads[i] < 0.0), pack_where(|i| aheads[i] > prices.leave), returned, returned & !near]
}

/// The same, pixel after pixel: for targets that work on one number at a time.
fn one_by_one(
    ahead: &mut f32,
    errors: &[f32; CHUNK],
    range_m: &[f32; CHUNK],
    width: usize,
    prices: &Prices,
) -> [u32; 4] {
    let ([mut was_left, mut was_on, mut returned, mut far], mut bit) = ([0; 4], 1u32);
    for (&error, &range_m) in errors.iter().zip(range_m).take(width) {
        was_left |= if below(*ahead, 0.0) { bit } else { 0 };
        was_on |= if below(prices.leave, *ahead) { bit } else { 0 };
        let mut gain = 0.0;
        if below(0.0, range_m) {
            returned |= bit;
            far |= if below(error, prices.off_plane) { 0 } else { bit };
            gain = prices.gain(error);
        }
        *ahead = prices.ahead(*ahead, gain);
        bit <<= 1;
    }
    [was_left, was_on, returned, far]
}

/// Of each pixel of a chunk how much being on a plane is ahead before it.
fn aheads(ahead: &mut f32, gains: &[f32; CHUNK], width: usize, prices: &Prices) -> [f32; CHUNK] {
    let (leave, mut aheads) = (prices.leave, [0.0; CHUNK]);
    // the highest bit is the sign
    let gained = || gains.iter().fold(0, |bits, gain| bits | gain.to_bits()) >> 31 == 0;
    if width == CHUNK && *ahead >= leave && gained() {
        // nothing leaves here
        aheads[0] = *ahead;
        for i in 1..CHUNK {
            aheads[i] = gains[i - 1] + leave;
        }
        *ahead = gains[CHUNK - 1] + leave;
        return aheads;
    }
    for (before, &gain) in aheads.iter_mut().zip(gains).take(width) {
        *before = *ahead;
        *ahead = prices.ahead(*ahead, gain);
    }
    aheads
}

/// From the end of the row back along the best way: what has left is free, and of no slot.
fn walk_back(mut is_on: bool, bits: &mut Followed, slots: &mut [u16]) {
    for (word, slots) in slots.chunks_mut(CHUNK).enumerate().rev() {
        let mut on_bits = u32::MAX;
        let (was_left, was_on, returned) = (at(bits.was_left, word), at(bits.was_on, word), at(bits.returns, word));
        if !is_on || was_left != 0 {
            for i in (0..slots.len()).rev() {
                on_bits &= !(u32::from(!is_on) << i);
                let from = if is_on { was_left } else { was_on };
                is_on ^= from >> i & 1 == 1;
            }
        }
        let free = at(bits.free, word) | returned & !on_bits;
        put(bits.free, word, free);
        let off = free | !returned;
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
    /// To be filled: all zeros, which no image has to hold.
    const EMPTY: Best = Best { errors: [0.0; CHUNK], slots: [0; CHUNK] };

    /// Of the planes of the neighbours above.
    fn of_chunk(&mut self, line: &Scanline, lanes: &Lanes, from: usize, above: &[u16], areas: &Areas, left2: f32) {
        let columns = above.len();
        self.errors.fill(FAR);
        self.slots.fill(NONE);
        let width = CHUNK.min(columns - from);
        let rules = areas.rules;
        let mut add = |slot: u16, start: usize, end: usize| {
            if let Some(plane) = areas.plane(slot) {
                self.add(slot, plane, start..end, line, lanes, left2, rules);
            }
        };
        if line.wraps && from == 0 {
            add(at(above, columns - 1), 0, 1);
        }
        let mut start = from.saturating_sub(1);
        let end = columns.min(from + CHUNK + 1);
        while start < end {
            let slot = at(above, start);
            let stop = start + part(above, start..end).iter().take_while(|&&s| s == slot).count();
            add(slot, start.saturating_sub(1).max(from) - from, (stop + 1).min(from + width) - from);
            start = stop;
        }
        if line.wraps && from + CHUNK >= columns {
            add(at(above, 0), width - 1, width);
        }
    }

    /// Tries a plane on some pixels.
    #[inline(never)]
    #[allow(clippy::too_many_arguments)]
    fn add(
        &mut self,
        slot: u16,
        plane: [f32; 3],
        pixels: Range<usize>,
        line: &Scanline,
        lanes: &Lanes,
        left2: f32,
        rules: &Rules,
    ) {
        count(pixels.len());
        let Along { a, b, k, turned } = line.along(plane);
        let a_now = a + line.turned_rad * turned;
        let (variance, spread) = (line.variance, line.spread);
        let steep = dot(plane, plane);
        let most_turn = rules.most_turn;
        let (turn_rad2, ring_m2) = if line.fan.spins() { (0.0, left2) } else { (left2, 0.0) };
        let least = |a: f32, b: f32| if below(a, b) { a } else { b };
        let errors = part_mut(&mut self.errors, pixels.clone());
        let slots = part_mut(&mut self.slots, pixels.clone());
        let Lanes { range_m, cos, sin, beside } = lanes;
        let [range_m, cos, sin, beside] = [range_m, cos, sin, beside].map(|lane| part(lane, pixels.clone()));
        let beams = range_m.iter().zip(cos).zip(sin).zip(beside);
        for ((known, best), (((&range_m, &cos), &sin), &beside)) in errors.iter_mut().zip(slots).zip(beams) {
            // p . m, and how the range error changes with the turn angle
            let q = range_m * (cos * a_now + sin * b + beside * turned + k);
            let error_m = range_m * (q - 1.0);
            let square_m2 = range_m * range_m;
            // tan(incidence), squared
            let tan_square = spread.tan_square(square_m2 * steep - 1.0);
            let range_m2 = variance.at(range_m) + ring_m2;
            let of_turn_m2 = if VECTORS || below(0.0, turn_rad2) {
                let slope = square_m2 * cos * turned;
                least(slope * slope * turn_rad2, most_turn * range_m2)
            } else {
                0.0
            };
            let variance_m2 = range_m2 + of_turn_m2 + spread.at(square_m2, tan_square);
            let square = error_m * error_m / variance_m2;
            let square = if below(1.0 / MOST_SHARE, q) { square } else { FAR };
            let better = below(square, *known);
            *known = if better { square } else { *known };
            *best = if better { slot } else { *best };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both ways through a chunk find the same, whatever comes: targets that work on one number at a
    /// time find what others do.
    #[test]
    fn one_by_one_is_side_by_side() {
        let mut random = 1u64;
        let mut below = |most: u64| {
            random = random.wrapping_mul(0x5851_f42d_4c95_7f2d).wrapping_add(0x1405_7b7e_f767_814f);
            (random >> 33) % most
        };
        let prices = Prices { off_plane: 10.0, left: 2.75, leave: 12.0, share: 0.5 };
        for rough in [2, 9, 30, 200] {
            let (mut one, mut all) = (prices.leave, prices.leave);
            for _ in 0..if cfg!(miri) { 10 } else { 100 } {
                let width = CHUNK - if below(3) == 0 { below(CHUNK as u64) as usize } else { 0 };
                let mut range_m = [0.0; CHUNK];
                range_m[..width].fill_with(|| if below(8) == 0 { 0.0 } else { 2.0 });
                let mut errors = [FAR; CHUNK];
                errors[..width].fill_with(|| if below(20) == 0 { FAR } else { below(rough) as f32 });
                let found = one_by_one(&mut one, &errors, &range_m, width, &prices);
                assert_eq!(found, side_by_side(&mut all, &errors, &range_m, width, &prices), "{errors:?} {range_m:?}");
                assert_eq!(one, all);
            }
        }
    }
}
