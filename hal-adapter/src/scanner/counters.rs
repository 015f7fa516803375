//! Counts of the events of a line scanner.

/// Counts since a scanner was made. They wrap at 2^32.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ScannerCounters {
    /// Valid packets (telegrams of an LMS 2xx, nodes and capsules of an RPLIDAR).
    pub packets: u32,
    /// Rejected beginnings of packets. This is not the number of damaged packets: a damaged packet
    /// can contain several beginnings, and one whose first byte is lost contains none.
    pub rejected: u32,
    /// Packets that the scanner has sent and that did not arrive whole, by what lies between those
    /// that did.
    pub lost: u32,
    /// Rows given out.
    pub rows: u32,
    /// Beams in the field of view that are in no row: the memory for rows was full, or the angle
    /// went back over the edge of the row.
    pub dropped_beams: u32,
}

/// Adds to a count, and wraps.
pub(crate) fn count(counter: &mut u32, more: u32) {
    *counter = counter.wrapping_add(more);
}
