//! The packed rows that the region-based segmenter keeps.

use crate::row::bits::words;

/// Packed rows in the memory; see [`BitRows`].
pub(crate) const BIT_ROWS: usize = 6;

/// Packed rows, as they are used when row r arrives.
pub(crate) struct BitRows<'a> {
    /// Pixels of row r with a return.
    pub returns: &'a mut [u32],
    /// Pixels of row r where the bearing angle turns; then its breaks.
    pub turns: &'a mut [u32],
    /// Pixels of lines, and first pixels of lines, of rows r and r - 1; row q at q % 2.
    pub lines: [&'a mut [u32]; 2],
    pub starts: [&'a mut [u32]; 2],
}

impl<'a> BitRows<'a> {
    pub fn of(bits: &'a mut [u32], columns: usize) -> Self {
        let mut rows = bits.chunks_exact_mut(words(columns).max(1));
        let mut row = || rows.next().unwrap_or_default();
        Self { returns: row(), turns: row(), lines: [row(), row()], starts: [row(), row()] }
    }
}
