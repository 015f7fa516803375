//! What lies beyond the borders of areas: something nearer, which may hide the rest of a surface,
//! or something farther.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::area::Area;
use crate::arithmetic::dot;
use crate::plane::areas::{Areas, FULL};
use crate::plane::rules::BORDER_SQUARE;
use crate::plane::scanline::{At, Scanline};

/// A border of an area.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Side {
    Top,
    Bottom,
    Left,
    Right,
}

impl Areas<'_> {
    /// Counts a pixel beyond a border.
    fn count(&mut self, slot: u16, side: Side, nearer: bool) {
        let mut marks = self.marks(slot);
        let counters = &mut marks.beyond[side as usize];
        if counters.contains(&u8::MAX) {
            *counters = counters.map(|n| n / 2);
        }
        counters[usize::from(!nearer)] += 1;
        self.set_marks(slot, &marks);
    }

    /// Counts what is seen beyond a border of an area that has a plane. Gives whether it is nearer
    /// than the plane, if either.
    fn look_beyond(&mut self, slot: u16, side: Side, pixel: &At, row: &Scanline) -> Option<bool> {
        let slot = self.root(slot);
        if !self.has_plane(slot) {
            return None;
        }
        let u = row.beam(pixel);
        let nearer = nearer(dot(u, self.m(slot)), pixel.range_m, row)?;
        self.count(slot, side, nearer);
        Some(nearer)
    }

    /// At a pixel of `slot`, or of no area: counts what is beyond the borders of the areas above
    /// and to the right, and beyond its own.
    pub fn look_around(&mut self, slot: u16, above: u16, beside: u16, [here, next]: [Option<At>; 2], row: &Scanline) {
        let known = slot < FULL;
        if let Some(pixel) = &here {
            if above < FULL && above != slot {
                let nearer = self.look_beyond(above, Side::Bottom, pixel, row);
                // a new area has no plane yet, but lies where its pixel lies
                if let Some(nearer) = nearer
                    && known
                    && self.get(slot).first_row == self.row
                {
                    self.count(slot, Side::Top, !nearer);
                }
            }
            if known && above != slot && self.get(slot).first_row < self.row {
                self.look_up(slot, above, pixel, row);
            }
            if beside < FULL && beside != slot {
                self.look_beyond(beside, Side::Left, pixel, row);
            }
        }
        if let Some(pixel) = &next
            && known
            && beside != slot
        {
            self.look_beyond(slot, Side::Right, pixel, row);
        }
    }

    /// Counts the area above beyond the top border of an area that has a plane, as if the one above
    /// went on to here.
    fn look_up(&mut self, slot: u16, above: u16, pixel: &At, row: &Scanline) {
        if above >= FULL || !self.has_plane(above) {
            return;
        }
        let (above, slot) = (self.root(above), self.root(slot));
        if above == slot {
            return;
        }
        let u = row.beam(pixel);
        let (q, inverse_m) = (dot(u, self.m(slot)), dot(u, self.m(above)));
        // 10 km
        if inverse_m > 1e-4
            && q > 1e-4
            && let Some(nearer) = nearer(q, 1.0 / inverse_m, row)
        {
            self.count(slot, Side::Top, nearer);
        }
    }

    /// Whether what lies between two areas may hide the rest of one surface.
    pub fn hidden(&self, one: u16, other: u16) -> bool {
        let (a, b) = (self.get(one), self.get(other));
        let (of_a, of_b) = (self.marks(one).beyond, self.marks(other).beyond);
        let mut sum = [0u32; 2];
        let mut add = |counters: [u8; 2]| {
            for (sum, more) in sum.iter_mut().zip(counters) {
                *sum += u32::from(more);
            }
        };
        let below = |up: &Area, down: &Area| up.frontier < down.first_row;
        let left_of = |left: &Area, right: &Area| left.last_column < right.first_column;
        let mut facing = |first: &[[u8; 2]; 4], side: Side, second: &[[u8; 2]; 4], opposite: Side| {
            add(first[side as usize]);
            add(second[opposite as usize]);
        };
        if below(a, b) {
            facing(&of_a, Side::Bottom, &of_b, Side::Top);
        } else if below(b, a) {
            facing(&of_b, Side::Bottom, &of_a, Side::Top);
        }
        if left_of(a, b) {
            facing(&of_a, Side::Right, &of_b, Side::Left);
        } else if left_of(b, a) {
            facing(&of_b, Side::Right, &of_a, Side::Left);
        }
        if !(below(a, b) || below(b, a) || left_of(a, b) || left_of(b, a)) {
            of_a.into_iter().chain(of_b).for_each(add);
        }
        16 * sum[0] >= self.rules.hidden * (sum[0] + sum[1])
    }
}

/// Whether what is seen at this range is nearer than a plane that the beam meets at 1 / q; `None`
/// if it lies on it.
fn nearer(q: f32, range_m: f32, row: &Scanline) -> Option<bool> {
    let relative = range_m * q - 1.0;
    let error_m = range_m * relative;
    (error_m * error_m > BORDER_SQUARE * row.variance.lone_at(range_m)).then_some(relative < 0.0)
}
