//! The rows that the edge-based segmenter keeps, and how they lie in its memory.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::edge::trace::Trace;
use crate::row::bits::{CHUNK, words};
use crate::row::fan::RowBeam;
use crate::row::within::{part, part_mut, split, split_mut};
use crate::row_beams::{ColumnTurns, RowBeams};
use crate::scan::MAX_LATENCY_ROWS;

/// Rows between the row pushed and the row whose labels it decides: none of the approaches has
/// more.
pub(crate) const LATENCY_ROWS: usize = MAX_LATENCY_ROWS;

/// Length of a row of bearing angles: whole chunks, with room for one column more.
pub(crate) const fn padded_row(columns: usize) -> usize {
    (columns / CHUNK + 1) * CHUNK
}

/// Rows kept: as far back as a trace reaches, and until the labels are known.
pub(crate) const fn stored_rows(traces: &[Trace]) -> usize {
    let mut rows = LATENCY_ROWS;
    let mut i = 0;
    while i < traces.len() {
        if traces[i].rows as usize > rows {
            rows = traces[i].rows as usize;
        }
        i += 1;
    }
    rows
}

/// Numbers of a row that is kept: ranges, where its beams point, and directions if they are free.
pub(crate) const fn stored_row(columns: usize, free: bool) -> usize {
    columns + BEAMS + if free { 3 * columns } else { 0 }
}

/// Numbers that say where the beams of a row point, beside their directions.
const BEAMS: usize = 6;

/// Ranges of the last rows, 0 for no return, and where their beams point. Row q is at q % rows.
#[derive(Debug)]
pub(crate) struct StoredRows<'a> {
    numbers: &'a mut [f32],
    columns: usize,
    stride: usize,
}

impl<'a> StoredRows<'a> {
    /// `numbers` is whole rows of `stride`, at least one.
    pub fn new(numbers: &'a mut [f32], columns: usize, stride: usize) -> Self {
        Self { numbers, columns, stride }
    }

    fn place(&self, row: usize) -> Range<usize> {
        // neither is 0, which the compiler does not know
        let rows = self.numbers.len() / self.stride.max(1);
        let start = row % rows.max(1) * self.stride;
        start..start + self.stride
    }

    /// Keeps a row.
    pub fn keep(&mut self, at: &RowBeam, ranges_m: impl Iterator<Item = f32>) {
        let (place, columns) = (self.place(at.row), self.columns);
        let (ranges, rest) = split_mut(part_mut(self.numbers, place), columns);
        for (to, range_m) in ranges.iter_mut().zip(ranges_m) {
            *to = range_m;
        }
        let (beams, directions) = split_mut(rest, BEAMS);
        let RowBeams { turn_rad, offset_rad, lever_arm_m, column_turns, .. } = at.beams;
        let ColumnTurns { step_rad, sets, set_rad } = column_turns;
        let numbers = [turn_rad, offset_rad, lever_arm_m, step_rad, f32::from(sets), set_rad];
        for (to, number) in beams.iter_mut().zip(numbers) {
            *to = number;
        }
        for (to, direction) in directions.as_chunks_mut().0.iter_mut().zip(at.beams.directions) {
            *to = *direction;
        }
    }

    /// The ranges of a row that was kept, and its beams.
    pub fn row(&self, row: usize) -> (&[f32], RowBeam<'_>) {
        let (ranges, rest) = split(part(self.numbers, self.place(row)), self.columns);
        let (beams, directions) = split(rest, BEAMS);
        let [turn_rad, offset_rad, lever_arm_m, step_rad, sets, set_rad] =
            beams.first_chunk().copied().unwrap_or_default();
        let column_turns = ColumnTurns { step_rad, sets: sets as u8, set_rad };
        let directions = directions.as_chunks().0;
        (ranges, RowBeam { row, beams: RowBeams { turn_rad, offset_rad, column_turns, lever_arm_m, directions } })
    }
}

/// Packed rows in the memory; see [`BitRows`].
pub(crate) const BIT_ROWS: usize = 10;

/// The rows of a ring of three, from row `row` on.
pub(crate) fn ring<T>(rows: [T; 3], row: usize) -> [T; 3] {
    let [a, b, c] = rows;
    match row % 3 {
        0 => [a, b, c],
        1 => [b, c, a],
        _ => [c, a, b],
    }
}

/// Packed rows, as they are used when row r arrives.
pub(crate) struct BitRows<'a> {
    /// Step edges of row r - 1, then of row r.
    pub steps: &'a mut [u32],
    /// Edges of rows r - 1, r - 2, r - 3; row q at q % 3.
    pub edges: [&'a mut [u32]; 3],
    /// Dilated edges of rows r - 2, r - 3, r - 4; row q at q % 3.
    pub dilated: [&'a mut [u32]; 3],
    /// Pixels of row r - 3 with a return.
    pub returns: &'a mut [u32],
    /// Area pixels of rows r - 3 and r - 4; row q at q % 2.
    pub areas: [&'a mut [u32]; 2],
}

impl<'a> BitRows<'a> {
    pub fn of(bits: &'a mut [u32], columns: usize) -> Self {
        let mut rows = bits.chunks_exact_mut(words(columns).max(1));
        let mut row = || rows.next().unwrap_or_default();
        Self {
            steps: row(),
            edges: [row(), row(), row()],
            dilated: [row(), row(), row()],
            returns: row(),
            areas: [row(), row()],
        }
    }
}
