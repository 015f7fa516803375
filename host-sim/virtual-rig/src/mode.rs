//! What the scanner does between commands, and the command that changes it.

use scanseg_hal::lms2xx::Baud;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Idle,
    Install,
    Complete,
    Interlaced,
    /// Columns, 1-based.
    SubRange {
        first: u16,
        last: u16,
    },
    /// One complete scan.
    Once,
}

/// What the command to change the mode asks for.
#[derive(Clone, Copy, Debug)]
pub(crate) enum ModeChange {
    Mode(Mode),
    /// The mode stays, the rate of the line changes.
    Rate(Baud),
}

impl ModeChange {
    /// Reads the data of the command, for a scanner of so many columns. None if it is not
    /// understood.
    pub(crate) fn parse(data: &[u8], columns: u16) -> Option<ModeChange> {
        Some(ModeChange::Mode(match *data {
            [0x00, b'S', b'I', b'C', b'K', b'_', b'L', b'M', b'S'] => Mode::Install,
            [0x24] => Mode::Complete,
            [0x25] => Mode::Idle,
            [0x2A] => Mode::Interlaced,
            [0x27, a, b, c, d] => {
                let (first, last) = (u16::from_le_bytes([a, b]), u16::from_le_bytes([c, d]));
                if first == 0 || first > last || last > columns {
                    return None;
                }
                Mode::SubRange { first, last }
            }
            [0x40] => return Some(ModeChange::Rate(Baud::B38400)),
            [0x41] => return Some(ModeChange::Rate(Baud::B19200)),
            [0x42] => return Some(ModeChange::Rate(Baud::B9600)),
            [0x48] => return Some(ModeChange::Rate(Baud::B500000)),
            _ => return None,
        }))
    }
}
