//! What the next row sees above it: the slots of this row, and where it has no return those of the
//! last few rows, so that planes go on below missing pixels.

use crate::plane::areas::Areas;
use crate::plane::areas::FULL;
use crate::row::bits::{CHUNK, mask, words};
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part, part_mut, put};

/// Slots above the next row. A slot stays for three rows without a return, and is gone with the
/// fourth.
pub(crate) struct Carried<'a> {
    pub slots: &'a mut [u16],
    /// Rows without a return so far, as packed bits: the ones, and the twos.
    pub ages: [&'a mut [u32]; 2],
}

impl Carried<'_> {
    /// Takes the row of these slots; areas that are carried on stay live.
    pub fn take(&mut self, slots: &[u16], returns: &[u32], areas: &mut Areas) {
        let columns = slots.len();
        let [ones, twos] = &mut self.ages;
        for word in 0..words(columns) {
            let (missing, one, two) = (!at(returns, word), at(ones, word), at(twos, word));
            let old = missing & one & two;
            put(ones, word, missing & !one | old);
            put(twos, word, missing & (one ^ two) | old);
            let from = word * CHUNK;
            let width = CHUNK.min(columns - from);
            let (new, kept) = (part(slots, from..from + width), part_mut(self.slots, from..from + width));
            if missing & mask(word, columns) == 0 {
                kept.iter_mut().zip(new).for_each(|(to, &slot)| *to = slot);
                continue;
            }
            for (i, (to, &slot)) in kept.iter_mut().zip(new).enumerate() {
                let kept = if old >> i & 1 == 1 { NONE } else { *to };
                *to = if missing >> i & 1 == 1 { kept } else { slot };
            }
        }
        for run in equal_runs(self.slots) {
            let slot = at(self.slots, run.start);
            if slot < FULL {
                areas.carry(slot);
            }
        }
    }
}
