//! A row of the table of areas: what is remembered of an area that may still grow.

use core::ops::Range;

use crate::moments::Moments;
use crate::segment::{Join, Label, Segment, SegmentSums};
use crate::weighted::fitted::Fitted;

/// Live labels that every image of this width can make do with, by the paper's two approaches; see
/// [`Memory::areas`](crate::Memory::areas).
#[must_use]
pub const fn live_labels(columns: usize) -> usize {
    columns / 2 + 1
}

/// A live area: an element of the table of live labels, 92 bytes. Opaque; made by [`Area::EMPTY`].
#[derive(Clone, Copy, Debug)]
pub struct Area {
    /// Edge, region: the second moments in two words each, then the lower words of the first ones.
    /// Plane: [`Fitted::numbers`] as bits, and counters of what is beyond the borders.
    pub(crate) store: [u32; 17],
    pub(crate) points: u32,
    /// Label; in a free slot the next free slot.
    pub(crate) label: u32,
    /// Edge, region: the upper halves of the first moments. Plane: state, and the last row that
    /// carries it on.
    pub(crate) halves: [u16; 3],
    /// What keeps it live. Edge, region: the runs of the frontier that refer to this slot itself.
    /// Plane: its last row.
    pub(crate) frontier: u16,
    pub(crate) first_row: u16,
    pub(crate) first_column: u16,
    pub(crate) last_column: u16,
    /// This slot itself for an area, else the slot that it was joined into.
    pub(crate) link: u16,
}

const _: () = assert!(size_of::<Area>() == 92);

impl Area {
    /// For the memory that a segmenter is given: `[Area::EMPTY; live_labels(COLUMNS)]`.
    pub const EMPTY: Area = Area {
        store: [0; 17],
        points: 0,
        label: 0,
        halves: [0; 3],
        frontier: 0,
        first_row: 0,
        first_column: 0,
        last_column: 0,
        link: 0,
    };

    /// A new area whose first pixel is this one; `slot` is where it stands in its table.
    pub(crate) fn begin(label: u32, row: u16, column: u16, slot: u16) -> Area {
        Area { label, first_row: row, first_column: column, last_column: column, link: slot, ..Area::EMPTY }
    }

    /// Takes the bounds of a run of a row.
    pub(crate) fn reach(&mut self, run: &Range<usize>) {
        self.first_column = self.first_column.min(run.start as u16);
        self.last_column = self.last_column.max(run.end as u16 - 1);
    }

    /// Takes label and bounds of another area that is one with it. The smaller label stays.
    pub(crate) fn unite(&mut self, other: &Area) -> Join {
        let join = Join { from: Label(self.label.max(other.label)), into: Label(self.label.min(other.label)) };
        self.label = join.into.0;
        self.first_row = self.first_row.min(other.first_row);
        self.first_column = self.first_column.min(other.first_column);
        self.last_column = self.last_column.max(other.last_column);
        join
    }

    pub(crate) fn segment(&self, last_row: u16, sums: SegmentSums) -> Segment {
        Segment {
            label: Label(self.label),
            first_row: self.first_row,
            last_row,
            first_column: self.first_column,
            last_column: self.last_column,
            sums,
        }
    }

    /// Edge, region: its sums.
    pub(crate) fn moments(&self) -> Moments {
        let [a, b, c, d, e, f, g, h, i, j, k, l, x, y, z, _, _] = self.store;
        let [high_x, high_y, high_z] = self.halves;
        let long = |(low, high): (u32, u32)| (u64::from(high) << 32 | u64::from(low)) as i64;
        let second = [(a, b), (c, d), (e, f), (g, h), (i, j), (k, l)].map(long);
        let first = [(x, high_x), (y, high_y), (z, high_z)].map(|(low, high)| long((low, high as i16 as u32)));
        Moments { points: self.points, first, second }
    }

    /// Edge, region: adds to its sums. `exact` is the number of points up to which none can
    /// overflow.
    pub(crate) fn add(&mut self, more: &Moments, exact: u32) {
        let mut sum = self.moments();
        if sum.points.saturating_add(more.points) <= exact {
            sum.merge_exact(more);
        } else {
            sum.merge(more);
        }
        self.points = sum.points;
        for (pair, sum) in self.store.as_chunks_mut().0.iter_mut().zip(sum.second) {
            *pair = [sum as u32, (sum >> 32) as u32];
        }
        for ((low, high), sum) in self.store.iter_mut().skip(12).zip(&mut self.halves).zip(sum.first) {
            *low = sum as u32;
            *high = (sum >> 32) as u16;
        }
    }

    /// Plane: its plane with its sums.
    pub(crate) fn fitted(&self) -> Fitted {
        let [numbers @ .., _, _] = self.store;
        Fitted::from_numbers(numbers.map(f32::from_bits))
    }

    /// Plane: changes it. Called on a microcontroller: each copy is 80 bytes.
    #[cfg_attr(not(target_os = "none"), inline)]
    #[cfg_attr(target_os = "none", inline(never))]
    pub(crate) fn set_fitted(&mut self, fitted: &Fitted) {
        for (to, number) in self.store.iter_mut().zip(fitted.numbers()) {
            *to = number.to_bits();
        }
    }

    /// Plane: that of [`Area::fitted`] alone.
    pub(crate) fn m(&self) -> [f32; 3] {
        let [.., x, y, z, _, _, _] = self.store;
        [x, y, z].map(f32::from_bits)
    }

    /// Plane: the chi-square of [`Area::fitted`] alone.
    pub(crate) fn squares(&self) -> f32 {
        let [.., squares, _, _] = self.store;
        f32::from_bits(squares)
    }
}
