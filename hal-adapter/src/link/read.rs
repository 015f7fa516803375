//! From frames to messages.

use super::frame::{CRC, MAX_FRAME};
use super::message::Message;

/// What a [`FrameDecoder`] has found.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Received {
    /// A message.
    Message {
        /// Number of frames missing before this one, modulo 65536.
        lost: u16,
        /// The message.
        message: Message,
    },
    /// Bytes between two boundaries that are not a valid frame. If they were one, the next message
    /// counts it as lost.
    Damaged {
        /// Their number.
        bytes: usize,
    },
}

/// Finds messages in bytes.
#[derive(Clone, Debug)]
pub struct FrameDecoder {
    buffer: [u8; MAX_FRAME],
    /// Bytes since the last boundary; the first of them are in the buffer.
    count: usize,
    expected: Option<u16>,
}

impl Default for FrameDecoder {
    fn default() -> Self {
        Self::new()
    }
}

impl FrameDecoder {
    /// Returns a decoder without bytes. Its first message has `lost` 0.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], count: 0, expected: None }
    }

    /// Takes bytes in pieces of any size, and calls `received` for all that they complete.
    pub fn feed(&mut self, bytes: &[u8], mut received: impl FnMut(Received)) {
        for &byte in bytes {
            if byte != 0 {
                if let Some(free) = self.buffer.get_mut(self.count) {
                    *free = byte;
                }
                self.count = self.count.saturating_add(1);
            } else if self.count > 0 {
                received(self.frame());
                self.count = 0;
            }
        }
    }

    /// Decodes the frame in the buffer.
    fn frame(&mut self) -> Received {
        let damaged = Received::Damaged { bytes: self.count };
        let Some(frame) = self.buffer.get_mut(..self.count) else { return damaged };
        let Ok(length) = cobs::decode_in_place(frame) else { return damaged };
        let decoded = postcard::de_flavors::crc::take_from_bytes_u32(frame.get(..length).unwrap_or(&[]), CRC.digest());
        let Ok(((sequence, message), [])) = decoded else { return damaged };
        let expected = self.expected.replace(u16::wrapping_add(sequence, 1));
        let lost = match (message, expected) {
            (Message::Hello { .. }, _) | (_, None) => 0,
            (_, Some(expected)) => sequence.wrapping_sub(expected),
        };
        Received::Message { lost, message }
    }
}
