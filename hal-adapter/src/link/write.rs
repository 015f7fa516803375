//! From messages to frames.

use cobs::CobsEncoder;
use crc::{Digest, NoTable};

use super::frame::{CRC_BITWISE, FrameTooLong};
use super::message::{Message, PlaneReport, SegmentReport};
use crate::lms2xx::Trouble;
use crate::rig::{Counters, ScanFinished, ScanStarted};

/// Makes frames of messages and numbers them.
#[derive(Clone, Debug, Default)]
pub struct FrameEncoder {
    sequence: u16,
}

impl FrameEncoder {
    /// Returns an encoder whose next frame has number 0. It should be a [`Message::Hello`].
    #[must_use]
    pub const fn new() -> Self {
        Self { sequence: 0 }
    }

    /// Writes a frame to the beginning of `buffer` and returns it.
    ///
    /// # Errors
    /// [`FrameTooLong`]. The frame is not counted.
    pub fn encode<'b>(&mut self, message: &Message, buffer: &'b mut [u8]) -> Result<&'b [u8], FrameTooLong> {
        let (first, rest) = buffer.split_first_mut().ok_or(FrameTooLong)?;
        *first = 0;
        let mut frame = Frame { crc: CRC_BITWISE.digest(), cobs: CobsEncoder::new(rest) };
        frame.numbers(&[self.sequence.into()])?;
        frame.message(message)?;
        let length = frame.finish()?;
        // COBS only counts zeros: room for the boundary shows that there was room for all of them
        *rest.get_mut(length).ok_or(FrameTooLong)? = 0;
        self.sequence = self.sequence.wrapping_add(1);
        buffer.get(..1 + length + 1).ok_or(FrameTooLong)
    }
}

/// Writes a frame in postcard's format. postcard's own writer can panic.
struct Frame<'b> {
    crc: Digest<'static, u32, NoTable>,
    cobs: CobsEncoder<'b>,
}

impl Frame<'_> {
    fn message(&mut self, message: &Message) -> Result<(), FrameTooLong> {
        match *message {
            Message::Hello { version } => {
                self.numbers(&[0])?;
                self.bytes(&[version])
            }
            Message::ScanStarted(ScanStarted { number, columns, turn_rad }) => {
                self.numbers(&[1, number, columns.into()])?;
                self.floats(&[turn_rad])
            }
            Message::Segment(segment) => {
                self.numbers(&[2])?;
                self.segment(&segment)
            }
            Message::Join { from, into } => self.numbers(&[3, from, into]),
            Message::ScanFinished(ScanFinished { number, end, rows, unlabelled, counters }) => {
                self.numbers(&[4, number, end as u32, rows.into(), unlabelled])?;
                self.counters(&counters)
            }
            Message::Status(counters) => {
                self.numbers(&[5])?;
                self.counters(&counters)
            }
            Message::Trouble(trouble) => {
                self.numbers(&[6])?;
                self.trouble(trouble)
            }
        }
    }

    fn segment(&mut self, segment: &SegmentReport) -> Result<(), FrameTooLong> {
        let SegmentReport { label, pixels, first_row, last_row, first_column, last_column, centroid_m, plane } =
            *segment;
        self.numbers(&[label, pixels])?;
        self.numbers(&[first_row, last_row, first_column, last_column].map(u32::from))?;
        self.floats(&centroid_m)?;
        let Some(PlaneReport { normal, distance_m, rms_m, covariance }) = plane else { return self.numbers(&[0]) };
        self.numbers(&[1])?;
        self.floats(&normal)?;
        self.floats(&[distance_m, rms_m])?;
        self.floats(&covariance)
    }

    fn counters(&mut self, counters: &Counters) -> Result<(), FrameTooLong> {
        let Counters {
            bytes,
            telegrams,
            rejected,
            lost,
            rows,
            no_turn,
            standing,
            jump,
            alone,
            status,
            columns,
            stopped,
            refused,
            encoder_errors,
            troubles,
            scans,
            segments,
            overruns,
            queue_full,
        } = *counters;
        self.number(bytes)?;
        self.numbers(&[telegrams, rejected, lost, rows, no_turn, standing, jump, alone])?;
        self.numbers(&[status, columns, stopped, refused, encoder_errors, troubles, scans, segments])?;
        self.numbers(&[overruns, queue_full])
    }

    fn trouble(&mut self, trouble: Trouble) -> Result<(), FrameTooLong> {
        match trouble {
            Trouble::NotFound => self.numbers(&[0]),
            Trouble::NoAnswer { command } => self.bytes(&[1, command]),
            Trouble::NotAcknowledged { command } => self.bytes(&[2, command]),
            Trouble::Refused { command, reason } => self.bytes(&[3, command, reason]),
            Trouble::Configuration { length } => self.numbers(&[4, length.into()]),
            Trouble::Silent => self.numbers(&[5]),
            Trouble::Restarted => self.numbers(&[6]),
        }
    }

    fn numbers(&mut self, numbers: &[u32]) -> Result<(), FrameTooLong> {
        numbers.iter().try_for_each(|&number| self.number(number.into()))
    }

    /// As a varint.
    fn number(&mut self, mut number: u64) -> Result<(), FrameTooLong> {
        while number >= 0x80 {
            self.bytes(&[number as u8 | 0x80])?;
            number >>= 7;
        }
        self.bytes(&[number as u8])
    }

    fn floats(&mut self, floats: &[f32]) -> Result<(), FrameTooLong> {
        floats.iter().try_for_each(|float| self.bytes(&float.to_le_bytes()))
    }

    fn bytes(&mut self, bytes: &[u8]) -> Result<(), FrameTooLong> {
        self.crc.update(bytes);
        self.cobs.push(bytes).map_err(|_| FrameTooLong)
    }

    /// Adds the CRC; returns the length of what COBS made.
    fn finish(mut self) -> Result<usize, FrameTooLong> {
        let crc = self.crc.clone().finalize().to_le_bytes();
        self.bytes(&crc)?;
        Ok(self.cobs.finalize())
    }
}
