//! Traces: the directions along which bearing angles are taken (paper section 3).

/// The largest row offset of a [`Trace`].
pub const MAX_TRACE_ROWS: u8 = 16;

/// A direction through the range image, as the offset from a pixel back to the previous pixel on
/// the trace.
///
/// The paper takes any trace (section 3); an offset of more than one pixel is the same trace with a
/// longer baseline, which divides the noise of the bearing angle by its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Trace {
    /// The previous pixel is so many rows earlier, 0 to [`MAX_TRACE_ROWS`].
    pub rows: u8,
    /// The previous pixel is so many columns to the left; negative (only with `rows` above 0) is to
    /// the right.
    pub columns: i8,
}

impl Trace {
    /// Along a row: previous pixel to the left. The paper's horizontal trace.
    pub const ROW: Trace = Trace { rows: 0, columns: 1 };
    /// Along a column: previous pixel above. The paper's vertical trace.
    pub const COLUMN: Trace = Trace { rows: 1, columns: 0 };
    /// Previous pixel above and to the left.
    pub const DIAGONAL: Trace = Trace { rows: 1, columns: 1 };
    /// Previous pixel above and to the right.
    pub const ANTIDIAGONAL: Trace = Trace { rows: 1, columns: -1 };

    /// The same direction with a baseline `k` times as long. Saturates.
    #[must_use]
    pub const fn times(self, k: u8) -> Trace {
        let columns = self.columns as i16 * k as i16;
        let columns = if columns > 127 {
            127
        } else if columns < -128 {
            -128
        } else {
            columns as i8
        };
        Trace { rows: self.rows.saturating_mul(k), columns }
    }
}
