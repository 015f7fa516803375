//! What all line scanners are to their user: bytes in, rows out.
//!
//! - [`LineScanner`]: implemented by [`lms2xx::Rows`](crate::lms2xx::Rows), [`Ld06`](crate::ld06::Ld06)
//!   and [`Rplidar`](crate::rplidar::Rplidar).
//! - [`Row`]: the ranges of one row, each at its own angle.
//! - [`View`] and [`RowMemory`]: the part of a turn that makes a row, and where its beams are kept.

mod counters;
mod cutter;
mod row;
mod window;

pub use counters::ScannerCounters;
pub(crate) use counters::count;
pub(crate) use cutter::{BACK, Cut, Cutter, FULL_TURN};
pub use row::{Row, RowMemory, View};
pub(crate) use window::Window;

/// A line scanner whose bytes become rows. [`Rig::mounted`](crate::rig::Rig::mounted) makes segments
/// of them. It needs no port and no clock, and never waits.
///
/// ```
/// use scanseg_hal::ld06::{Ld06, Model};
/// use scanseg_hal::scanner::{LineEvent, LineScanner, RowMemory, View};
///
/// // half a turn of an LD06, 90 degrees to each side
/// let (mut angles_rad, mut ranges_m) = ([0.0; 240], [0.0; 240]);
/// let memory = RowMemory { angles_rad: &mut angles_rad, ranges_m: &mut ranges_m };
/// let view = View { left_rad: 1.5708, width_rad: 3.1416 };
/// let mut scanner = Ld06::new(Model::Ld06, view, memory);
/// # let (received, now_us): (&[u8], u64) = (&[], 0);
/// let mut rest = received;
/// loop {
///     let (used, event) = scanner.feed(rest, now_us);
///     rest = &rest[used..];
///     match event {
///         LineEvent::NeedMore => break,
///         LineEvent::Row => println!("{:?}", scanner.row()),
///         LineEvent::Rejected(error) => println!("{error}"),
///     }
/// }
/// ```
pub trait LineScanner {
    /// Why bytes that began like a packet are none.
    type Error: core::error::Error;

    /// Takes bytes up to the next event. The last of `bytes` came at `now_us`, microseconds by any
    /// clock that never falls. Returns the number of bytes used, and the event. Feed the rest
    /// again, even if it is empty, until [`LineEvent::NeedMore`].
    ///
    /// The sequence of events, except for `NeedMore`, does not depend on the pieces in which the
    /// bytes come.
    fn feed(&mut self, bytes: &[u8], now_us: u64) -> (usize, LineEvent<Self::Error>);

    /// Returns the row that the last `feed` reported; `None` if that was no [`LineEvent::Row`].
    fn row(&self) -> Option<Row<'_>>;

    /// Returns the counts so far.
    fn counters(&self) -> ScannerCounters;
}

/// What [`LineScanner::feed`] found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
#[must_use]
pub enum LineEvent<E> {
    /// All bytes are used and no event is complete. Feed more bytes.
    NeedMore,
    /// A row is complete. [`LineScanner::row`] returns it until the next call of `feed`.
    Row,
    /// Bytes that began like a packet are not a valid one. The search resumes behind their first
    /// byte, so that a valid packet among them is found.
    Rejected(E),
}
