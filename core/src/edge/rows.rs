//! The rows that the edge-based segmenter keeps, and how they lie in its memory.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::edge::trace::Trace;
use crate::row::bits::{CHUNK, words};
use crate::scan::MAX_LATENCY_ROWS;

/// Rows between the row pushed and the row whose labels it decides: none of the approaches has
/// more.
pub(crate) const LATENCY_ROWS: usize = MAX_LATENCY_ROWS;

/// Length of a row of bearing angles: whole chunks, with room for one column more.
pub(crate) const fn padded_row(columns: usize) -> usize {
    (columns / CHUNK + 1) * CHUNK
}

/// Rows of ranges kept: as far back as a trace reaches, and until the labels are known.
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
