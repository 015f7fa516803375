//! Neighbours in a row and above it: they join where they are one surface, and count what lies
//! beyond their borders.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::ControlFlow;

use crate::plane::areas::{Areas, FULL};
use crate::plane::rules::REMEMBERED_PAIRS;
use crate::plane::scanline::{At, Cached, Scanline};
use crate::plane::work::count;
use crate::row::bits::{CHUNK, load, mask, pack_where};
use crate::row::slots::NONE;
use crate::row::within::at;
use crate::sink::Sink;

/// So many pixels of a chunk are read alone.
const FEW: u32 = 4;

/// Pairs that were tried last in this row.
struct Recent {
    pairs: [(u16, u16); REMEMBERED_PAIRS],
    next: usize,
}

impl Recent {
    /// Whether a pair is none of them; it is from now on.
    fn is_new(&mut self, one: u16, other: u16) -> bool {
        let pair = (one.min(other), one.max(other));
        let new = !self.pairs.contains(&pair);
        if new {
            self.pairs[self.next % REMEMBERED_PAIRS] = pair;
            self.next += 1;
        }
        new
    }
}

/// Joins areas that are neighbours in this row, or from this row to the one above, and have a
/// common plane. Counts what is beyond the borders.
pub(crate) fn join_neighbours<S: Sink + ?Sized>(
    areas: &mut Areas,
    row: &Scanline,
    above: &[u16],
    slots: &[u16],
    cached: &mut Cached,
    sink: &mut S,
) -> ControlFlow<()> {
    let mut recent = Recent { pairs: [(NONE, NONE); REMEMBERED_PAIRS], next: 0 };
    let columns = slots.len();
    let [mut here, mut up, mut right] = [[NONE; CHUNK]; 3];
    for from in (0..columns).step_by(CHUNK) {
        let (here, up) = (load(slots, from, &mut here), load(above, from, &mut up));
        let right = load(slots, from + 1, &mut right);
        // beside the last pixel of the row may be the first one
        let last = if columns - from <= CHUNK { 1 << (columns - from - 1) } else { 0 };
        let differ = pack_where(|i| (here[i] != up[i]) | (here[i] != right[i])) | last;
        let mut bits = differ & mask(from / CHUNK, columns);
        let few = bits.count_ones() <= FEW;
        while bits != 0 {
            let column = from + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let seen = [Some(column), row.to_the_right(column, 1)].map(|column| {
                let column = column.filter(|&column| row.is_return(column))?;
                Some(if few { cached.lone(row, column) } else { cached.at(row, column) })
            });
            join_at(areas, row, column, [above, slots], seen, &mut recent, sink)?;
        }
    }
    ControlFlow::Continue(())
}

/// At a pixel that differs from the one above or the one to the right; `seen` are it and that one,
/// where they are returns.
fn join_at<S: Sink + ?Sized>(
    areas: &mut Areas,
    row: &Scanline,
    column: usize,
    [above, slots]: [&[u16]; 2],
    seen: [Option<At>; 2],
    recent: &mut Recent,
    sink: &mut S,
) -> ControlFlow<()> {
    count(1);
    let (slot, over) = (at(slots, column), at(above, column));
    let slot_ahead = |ahead: usize| row.to_the_right(column, ahead).map_or(NONE, |c| at(slots, c));
    let beside = slot_ahead(1);
    areas.look_around(slot, over, beside, seen, row);
    let Some(here) = seen[0].filter(|_| slot < FULL) else { return ControlFlow::Continue(()) };
    // the next one to the right across missing pixels
    let right = (1..=row.gap_columns + 1).map(slot_ahead).find(|&right| right < FULL).unwrap_or(NONE);
    for other in [right, over] {
        if other >= FULL || other == slot || !recent.is_new(slot, other) {
            continue;
        }
        let (one, other) = (areas.root(slot), areas.root(other));
        if one != other && areas.has_plane(one) && areas.has_plane(other) && areas.is_due(one, other) {
            areas.join_neighbour(one, other, row.beam(&here), &row.variance, sink)?;
        }
    }
    ControlFlow::Continue(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_pairs_are_remembered() {
        let mut recent = Recent { pairs: [(NONE, NONE); REMEMBERED_PAIRS], next: 0 };
        assert!((0..8).all(|slot| recent.is_new(slot, 100)));
        assert!((0..8).all(|slot| !recent.is_new(100, slot)));
        // the ninth takes the place of the first
        assert!(recent.is_new(8, 100) && recent.is_new(0, 100));
        assert!((2..9).all(|slot| !recent.is_new(slot, 100)));
    }
}
