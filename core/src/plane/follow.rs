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

use crate::arithmetic::dot;
use crate::config::Ranging;
use crate::plane::areas::Areas;
use crate::plane::config::PlaneConfig;
use crate::plane::rules::Rules;
use crate::plane::scanline::{Along, Lanes, Scanline};
use crate::plane::work::count;
use crate::row::bits::{CHUNK, pack};
use crate::row::slots::NONE;
use crate::row::within::{at, part, part_mut, put};

/// Squared error that stands for no plane at all.
const FAR: f32 = 1e6;

/// A plane that is met farther away than so many times the range is not seen there.
const MOST_SHARE: f32 = 20.0;

/// The noise of a row beside that of its ranges.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RowNoise {
    /// Variance of the direction of a beam.
    pub beam_rad2: f32,
    /// Variance of a surface across its plane.
    pub flat_m2: f32,
    /// Variance of the turn that is left after its correction.
    pub turn_rad2: f32,
}

/// Of the variance of the turn what is left after its correction.
const LEFT_OF_TURN: f32 = 0.25;

impl RowNoise {
    /// What is stated, and the variance of the turn that the scan tells.
    pub fn new(config: &PlaneConfig, told_rad2: f32) -> RowNoise {
        let Ranging { beam_noise_rad, turn_noise_rad, flatness_m, .. } = config.ranging;
        let beam_rad = config.rules.least_beam_rad.max(beam_noise_rad);
        RowNoise {
            beam_rad2: beam_rad * beam_rad,
            flat_m2: flatness_m * flatness_m,
            turn_rad2: LEFT_OF_TURN * told_rad2 + turn_noise_rad * turn_noise_rad,
        }
    }
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

/// Finds for each pixel of a row the slot whose plane it goes on with, or [`NONE`]. `above` are the
/// slots above the row.
pub(crate) fn follow(
    line: &Scanline,
    above: &[u16],
    areas: &Areas,
    noise: &RowNoise,
    bits: &mut Followed,
    slots: &mut [u16],
) {
    let columns = above.len();
    let rules = areas.rules;
    let mut lanes = Lanes::EMPTY;
    // how much better the best way to be on a plane is than the best way to have left
    let mut ahead = rules.leave_price;
    for (word, from) in (0..columns).step_by(CHUNK).enumerate() {
        line.lanes(from, &mut lanes);
        let width = CHUNK.min(columns - from);
        let best = Best::of_chunk(line, &lanes, from, above, areas, noise);
        let some = lanes.range_m.map(|range_m| range_m > 0.0);
        let (mut gains, mut near) = ([0.0; CHUNK], [false; CHUNK]);
        for i in 0..CHUNK {
            let error = best.errors[i];
            near[i] = (error < rules.off_plane) & some[i];
            let price = if (error < rules.off_plane) | (error == FAR) { error } else { rules.off_plane };
            gains[i] = if some[i] { (rules.left_price - price) / line.alike_px } else { 0.0 };
        }
        let aheads = aheads(&mut ahead, &gains, width, rules.leave_price);
        put(bits.was_left, word, pack(&aheads.map(|ahead| ahead < 0.0)));
        put(bits.was_on, word, pack(&aheads.map(|ahead| ahead > rules.leave_price)));
        let returned = pack(&some);
        put(bits.returns, word, returned);
        put(bits.free, word, returned & !pack(&near));
        for (slot, best) in part_mut(slots, from..from + width).iter_mut().zip(best.slots) {
            *slot = best;
        }
    }
    walk_back(ahead >= 0.0, bits, slots);
}

/// Of each pixel of a chunk how much being on a plane is ahead before it.
fn aheads(ahead: &mut f32, gains: &[f32; CHUNK], width: usize, leave: f32) -> [f32; CHUNK] {
    let mut aheads = [0.0; CHUNK];
    if width == CHUNK && *ahead >= leave && gains.iter().all(|&gain| gain >= 0.0) {
        // nothing leaves here
        aheads[0] = *ahead;
        for i in 1..CHUNK {
            aheads[i] = gains[i - 1] + leave;
        }
        *ahead = gains[CHUNK - 1] + leave;
        return aheads;
    }
    for i in 0..width {
        aheads[i] = *ahead;
        let least = if *ahead > 0.0 { *ahead } else { 0.0 };
        *ahead = gains[i] + if least < leave { least } else { leave };
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
    /// Of the planes of the neighbours above.
    fn of_chunk(line: &Scanline, lanes: &Lanes, from: usize, above: &[u16], areas: &Areas, noise: &RowNoise) -> Best {
        let columns = above.len();
        let mut best = Best { errors: [FAR; CHUNK], slots: [NONE; CHUNK] };
        let width = CHUNK.min(columns - from);
        let rules = areas.rules;
        let mut add = |slot: u16, start: usize, end: usize| {
            if let Some(plane) = areas.plane(slot) {
                best.add(slot, plane, start..end, line, lanes, noise, rules);
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
        best
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
        noise: &RowNoise,
        rules: &Rules,
    ) {
        count(pixels.len());
        let Along { a, b, k, turned } = line.along(plane);
        let a_now = a + line.turned_rad * turned;
        let RowNoise { turn_rad2, beam_rad2, flat_m2 } = *noise;
        let variance = line.variance;
        let steep = dot(plane, plane);
        let least = |a: f32, b: f32| if a < b { a } else { b };
        let errors = part_mut(&mut self.errors, pixels.clone());
        let slots = part_mut(&mut self.slots, pixels.clone());
        let [range_m, cos, sin] = [&lanes.range_m, &lanes.cos, &lanes.sin].map(|lane| part(lane, pixels.clone()));
        let beams = range_m.iter().zip(cos).zip(sin);
        for ((known, best), ((&range_m, &cos), &sin)) in errors.iter_mut().zip(slots).zip(beams) {
            // p . m, and how the range error changes with the turn angle
            let range_m = range_m - line.offset_m;
            let q = range_m * (cos * a_now + sin * b + k);
            let error_m = range_m * (q - 1.0);
            let square_m2 = range_m * range_m;
            let slope = square_m2 * cos * turned;
            // tan(incidence), squared
            let tan_square = square_m2 * steep - 1.0;
            let tan_square = least(if tan_square > 0.0 { tan_square } else { 0.0 }, rules.max_tan_square);
            let range_m2 = variance.at(range_m);
            let variance_m2 = range_m2
                + least(slope * slope * turn_rad2, rules.most_turn * range_m2)
                + square_m2 * tan_square * beam_rad2
                + flat_m2 * (1.0 + tan_square);
            let square = error_m * error_m / variance_m2;
            let square = if q > 1.0 / MOST_SHARE { square } else { FAR };
            let better = square < *known;
            *known = if better { square } else { *known };
            *best = if better { slot } else { *best };
        }
    }
}
