//! A row of the table of areas: what is remembered of an area that may still grow.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::moments::Moments;
use crate::segment::{Join, Label, Segment};

/// Live labels that every image of this width can make do with, by the paper's two approaches; see
/// [`Memory::areas`](crate::Memory::areas).
#[must_use]
pub const fn live_labels(columns: usize) -> usize {
    columns / 2 + 1
}

/// A live area: an element of the table of live labels, 88 bytes. Opaque; made by [`Area::EMPTY`].
#[derive(Clone, Copy, Debug)]
#[repr(C, packed(4))]
pub struct Area {
    /// Sums over its points, as each approach keeps them: exact moments, or a plane with its sums.
    pub(crate) store: [u32; 16],
    pub(crate) points: u32,
    /// Label; in a free slot the next free slot.
    pub(crate) label: u32,
    /// The upper parts of the first moments, or rows and state.
    pub(crate) halves: [u16; 3],
    /// Runs of the frontier that refer to this slot itself.
    pub(crate) runs: u16,
    pub(crate) first_row: u16,
    pub(crate) first_column: u16,
    pub(crate) last_column: u16,
    /// This slot itself for an area, else the slot that it was joined into.
    pub(crate) link: u16,
}

impl Area {
    /// For the memory that a segmenter is given: `[Area::EMPTY; live_labels(COLUMNS)]`.
    pub const EMPTY: Area = Area {
        store: [0; 16],
        points: 0,
        label: 0,
        halves: [0; 3],
        runs: 0,
        first_row: 0,
        first_column: 0,
        last_column: 0,
        link: 0,
    };

    pub(crate) fn moments(&self) -> Moments {
        let (store, high) = (self.store, self.halves);
        let first = core::array::from_fn(|i| (i64::from(high[i] as i16) << 32) | i64::from(store[12 + i]));
        let second = core::array::from_fn(|i| (u64::from(store[2 * i + 1]) << 32 | u64::from(store[2 * i])) as i64);
        Moments { points: self.points, first, second }
    }

    /// A new area whose first pixel is this one; `slot` is where it stands in its table.
    pub(crate) fn begin(label: u32, row: u16, column: u16, slot: u16) -> Area {
        Area { label, first_row: row, first_column: column, last_column: column, link: slot, ..Area::EMPTY }
    }

    /// Takes a run of a row.
    pub(crate) fn take(&mut self, run: &Range<usize>, moments: &Moments, exact: u32) {
        self.first_column = self.first_column.min(run.start as u16);
        self.last_column = self.last_column.max(run.end as u16 - 1);
        self.add(moments, exact);
    }

    /// Takes all of another area. The smaller label stays.
    pub(crate) fn absorb(&mut self, other: &Area, exact: u32) -> Join {
        let join = Join { from: Label(self.label.max(other.label)), into: Label(self.label.min(other.label)) };
        self.label = join.into.0;
        self.first_row = self.first_row.min(other.first_row);
        self.first_column = self.first_column.min(other.first_column);
        self.last_column = self.last_column.max(other.last_column);
        self.add(&other.moments(), exact);
        join
    }

    pub(crate) fn segment(&self, last_row: u16) -> Segment {
        Segment {
            label: Label(self.label),
            first_row: self.first_row,
            last_row,
            first_column: self.first_column,
            last_column: self.last_column,
            moments: self.moments(),
            fitted: None,
        }
    }

    /// `exact` is the number of points up to which no sum can overflow.
    fn add(&mut self, more: &Moments, exact: u32) {
        let mut sum = self.moments();
        if sum.points.saturating_add(more.points) <= exact {
            sum.merge_exact(more);
        } else {
            sum.merge(more);
        }
        self.points = sum.points;
        let mut store = [0; 16];
        for (pair, sum) in store.as_chunks_mut().0.iter_mut().zip(sum.second) {
            *pair = [sum as u32, (sum >> 32) as u32];
        }
        for (to, sum) in store[12..15].iter_mut().zip(sum.first) {
            *to = sum as u32;
        }
        self.store = store;
        self.halves = sum.first.map(|s| (s >> 32) as u16);
    }
}
