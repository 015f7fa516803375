//! Properties of frames that both ends of the link use.

use crc::{CRC_32_ISO_HDLC, Crc, NoTable};

/// Length of the longest frame, both boundaries included.
pub const MAX_FRAME: usize = 128;

/// The check of a frame.
pub(super) static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// The same bit by bit, for who sends: the table takes a kilobyte of a board's flash.
pub(super) static CRC_BITWISE: Crc<u32, NoTable> = Crc::<u32, NoTable>::new(&CRC_32_ISO_HDLC);

/// The memory for a frame is too small. [`MAX_FRAME`] bytes are enough for every message.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameTooLong;

impl core::fmt::Display for FrameTooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "frame does not fit its memory; {MAX_FRAME} bytes are enough")
    }
}

impl core::error::Error for FrameTooLong {}
