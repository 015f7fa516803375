//! Slots of the table of areas, as pixels and runs of a row refer to them.

use core::ops::Range;

use crate::row::within::{at, part, put};

/// No slot: a pixel that belongs to no area, or a run whose area found the table full.
pub(crate) const NONE: u16 = u16::MAX;

/// The runs of equal slots of a row with one slot per pixel, from the left.
pub(crate) fn equal_runs(slots: &[u16]) -> impl Iterator<Item = Range<usize>> + '_ {
    let mut start = 0;
    core::iter::from_fn(move || {
        let &slot = slots.get(start)?;
        let end = start + part(slots, start..slots.len()).iter().take_while(|&&s| s == slot).count();
        let run = start..end;
        start = end;
        Some(run)
    })
}

/// The slots of the runs of a row, the first at `head` of a ring with two slots a word.
#[derive(Clone, Copy)]
pub(crate) struct RunSlots<'a> {
    pub words: &'a [u32],
    pub head: usize,
}

/// Place in a ring of `words` words, `index` elements behind `head`; `index` at most its capacity.
pub(crate) fn ring_place(words: usize, head: usize, index: usize) -> usize {
    let (place, capacity) = (head + index, 2 * words);
    if place < capacity { place } else { place - capacity }
}

impl RunSlots<'_> {
    /// Slot of the `index`-th run.
    pub fn of_run(&self, index: usize) -> u16 {
        let place = ring_place(self.words.len(), self.head, index);
        (at(self.words, place / 2) >> (16 * (place % 2))) as u16
    }
}

/// Sets the slot at a place of a ring.
pub(crate) fn set_ring_slot(words: &mut [u32], place: usize, slot: u16) {
    let shift = 16 * (place % 2);
    let word = at(words, place / 2);
    put(words, place / 2, (word & !(0xffff << shift)) | (u32::from(slot) << shift));
}
