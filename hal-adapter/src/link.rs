//! The results on a serial line to a host: messages in frames, numbered, checked, and found again after any garbage.
//!
//! # Frames
//!
//! ```text
//! 00 | COBS of (sequence, message, CRC) | 00
//! ```
//!
//! - **00** stands at both ends of a frame and nowhere else. Two in a row are one boundary. The one in front saves a frame
//!   whose predecessor has lost its end, or that follows on other output of the board.
//! - **COBS** (Cheshire and Baker) keeps zeros out of what lies between. It is a row of blocks; the first byte of a block, n,
//!   is its length with itself, so n - 1 bytes follow. They stand for themselves, and a zero comes behind them, except
//!   behind the last block. (A block of FF, 254 bytes without a zero, would have no zero behind it; frames are shorter.)
//! - **sequence**: counts the frames of a sender, 0 to 65535 and round again; `num`. A gap is what was lost.
//! - **message**: as below.
//! - **CRC**: CRC-32/ISO-HDLC (that of zlib, Ethernet and PNG) of sequence and message, 4 bytes, lowest first. A flipped bit
//!   in a plane cannot be seen otherwise.
//!
//! A frame has at most [`MAX_FRAME`] bytes.
//!
//! # Messages
//!
//! A message is the number of its kind, then its fields, one right behind the other, in
//! [postcard](https://postcard.jamesmunns.com/wire-format)'s format:
//!
//! - `num`: a whole number of any size as a varint: seven bits a byte, the lowest first, bit 7 set in all bytes but the
//!   last. 300 is AC 02.
//! - `u8`: one byte.
//! - `f32`: IEEE 754 single precision, 4 bytes, lowest first. It arrives bit for bit.
//! - `f32 x 3`: three of them.
//!
//! | number (`num`) | message | fields |
//! |---|---|---|
//! | 0 | [`Message::Hello`] | version `u8` |
//! | 1 | [`Message::ScanStarted`] | number `num`, columns `num`, turn_rad `f32` |
//! | 2 | [`Message::Segment`] | label `num`, pixels `num`, first_row `num`, last_row `num`, first_column `num`, last_column `num`, centroid_m `f32 x 3`, then `u8`: 0, or 1 and plane: normal `f32 x 3`, distance_m `f32`, rms_m `f32`, covariance `f32 x 10` |
//! | 3 | [`Message::Join`] | from `num`, into `num` |
//! | 4 | [`Message::ScanFinished`] | number `num`, end `num`, rows `num`, unlabelled `num`, counters |
//! | 5 | [`Message::Status`] | counters |
//! | 6 | [`Message::Trouble`] | trouble `num`, and what that has |
//!
//! - **counters** ([`Counters`]), all `num`: bytes, telegrams, rejected, lost, rows, no_turn, standing, jump, alone, status,
//!   columns, stopped, refused, encoder_errors, troubles, scans, segments. The first goes to 2^64 - 1, the others to
//!   2^32 - 1.
//! - **end** ([`End`](crate::rig::End)): 0 turned, 1 covered, 2 pause, 3 trouble, 4 asked.
//! - **trouble** ([`Trouble`]): 0 not found; 1 no answer: command `u8`; 2 not acknowledged: command `u8`; 3 refused: command
//!   `u8`, reason `u8`; 4 configuration: length `num`; 5 silent; 6 restarted.
//!
//! What the fields mean and their units stand at the types. A host that wants final labels applies the joins:
//! [`Message::Join`].
//!
//! # Examples
//!
//! Frame 0 of a sender, saying hello, and frame 5, saying that area 300 has joined area 7:
//!
//! ```text
//! 00                          boundary
//! 01                          COBS: a zero, which is sequence 0
//! 01                          COBS: a zero, which is message 0
//! 06                          COBS: 5 bytes, and no zero behind the last
//!    01                       version 1
//!    84 E9 46 88              CRC 0x8846E984
//! 00                          boundary
//!
//! 00                          boundary
//! 0A                          COBS: 9 bytes
//!    05                       sequence 5
//!    03 AC 02 07              message 3; from 300 = 2 * 128 + 44; into 7
//!    A6 84 47 60              CRC 0x604784A6
//! 00                          boundary
//! ```

use core::ops::ControlFlow;

use cobs::CobsEncoder;
use crc::{CRC_32_ISO_HDLC, Crc, Digest};
use scanseg_core::{Join, LabelRow, Segment, Sink};
use serde::{Deserialize, Serialize};

use crate::lms2xx::Trouble;
use crate::rig::{Counters, RigSink, ScanFinished, ScanStarted};

/// Version of the messages, in [`Message::Hello`].
pub const VERSION: u8 = 1;

/// Longest frame, both boundaries included.
pub const MAX_FRAME: usize = 128;

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What a board tells its host.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Message {
    /// First message of a sender that has just started; its sequence begins with it.
    Hello {
        /// [`VERSION`].
        version: u8,
    },
    /// A scan has begun. Labels count anew.
    ScanStarted(ScanStarted),
    /// A segment is complete.
    Segment(SegmentReport),
    /// Two areas of this scan are one: pixels labelled `from` in earlier rows belong to `into`. What was said of a segment
    /// `from` is void; the last report of a label counts. See [`scanseg_core::Join`].
    Join {
        /// The label that ends here.
        from: u32,
        /// The label that goes on.
        into: u32,
    },
    /// A scan is over.
    ScanFinished(ScanFinished),
    /// Sent now and then, whether there are scans or not.
    Status(Counters),
    /// Something is wrong with the scanner.
    Trouble(Trouble),
}

/// A segment, see [`Segment`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct SegmentReport {
    /// Its label.
    pub label: u32,
    /// Number of pixels.
    pub pixels: u32,
    /// First row with a pixel of it.
    pub first_row: u16,
    /// Last row with a pixel of it.
    pub last_row: u16,
    /// Leftmost column with a pixel of it.
    pub first_column: u16,
    /// Rightmost column with a pixel of it.
    pub last_column: u16,
    /// Mean of its points, metres.
    pub centroid_m: [f32; 3],
    /// Its plane, if its points make one.
    pub plane: Option<PlaneReport>,
}

/// A plane, see [`scanseg_core::Plane`].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct PlaneReport {
    /// Unit normal towards the scanner.
    pub normal: [f32; 3],
    /// Distance from the scanner, metres.
    pub distance_m: f32,
    /// Root of the mean squared distance of the points, metres.
    pub rms_m: f32,
    /// Covariance of (normal x, y, z, distance): xx, xy, xz, xd, yy, yz, yd, zz, zd, dd.
    pub covariance: [f32; 10],
}

impl From<&Segment> for SegmentReport {
    /// Computes the plane.
    fn from(segment: &Segment) -> Self {
        let plane = segment.plane().map(|plane| {
            let [[xx, xy, xz, xd], [_, yy, yz, yd], [_, _, zz, zd], [_, _, _, dd]] = plane.covariance;
            PlaneReport {
                normal: plane.normal,
                distance_m: plane.distance_m,
                rms_m: plane.rms_m,
                covariance: [xx, xy, xz, xd, yy, yz, yd, zz, zd, dd],
            }
        });
        Self {
            label: segment.label.0,
            pixels: segment.pixels(),
            first_row: segment.first_row,
            last_row: segment.last_row,
            first_column: segment.first_column,
            last_column: segment.last_column,
            centroid_m: segment.centroid_m(),
            plane,
        }
    }
}

/// The memory for a frame is too small: [`MAX_FRAME`] bytes are enough for every message.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FrameTooLong;

impl core::fmt::Display for FrameTooLong {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "frame does not fit its memory; {MAX_FRAME} bytes are enough")
    }
}

impl core::error::Error for FrameTooLong {}

/// Makes frames of messages and numbers them.
#[derive(Debug, Clone, Default)]
pub struct Encoder {
    sequence: u16,
}

impl Encoder {
    /// The next frame is number 0; it should be a [`Message::Hello`].
    #[must_use]
    pub const fn new() -> Self {
        Self { sequence: 0 }
    }

    /// Writes a frame to the beginning of `buffer`; returns it.
    ///
    /// # Errors
    /// [`FrameTooLong`]. The frame is not counted.
    pub fn encode<'b>(&mut self, message: &Message, buffer: &'b mut [u8]) -> Result<&'b [u8], FrameTooLong> {
        let (first, rest) = buffer.split_first_mut().ok_or(FrameTooLong)?;
        *first = 0;
        let mut frame = Frame { crc: CRC.digest(), cobs: CobsEncoder::new(rest) };
        frame.numbers(&[self.sequence.into()])?;
        frame.message(message)?;
        let length = frame.finish()?;
        // Zeros are only counted by COBS: that there is room for the boundary shows that there was room for all of them.
        *rest.get_mut(length).ok_or(FrameTooLong)? = 0;
        self.sequence = self.sequence.wrapping_add(1);
        buffer.get(..1 + length + 1).ok_or(FrameTooLong)
    }
}

/// A frame on its way into memory. It is what postcard makes of the messages, but postcard's own writer can panic.
struct Frame<'b> {
    crc: Digest<'static, u32>,
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
        } = *counters;
        self.number(bytes)?;
        self.numbers(&[telegrams, rejected, lost, rows, no_turn, standing, jump, alone])?;
        self.numbers(&[status, columns, stopped, refused, encoder_errors, troubles, scans, segments])
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

/// What a [`Decoder`] found.
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Received {
    /// A message.
    Message {
        /// Frames that are missing between the frame before and this one; 65536 are not seen.
        lost: u16,
        /// The message.
        message: Message,
    },
    /// Bytes between two boundaries that are no good frame. If they were one, the next message counts it as lost.
    Damaged {
        /// Their number.
        bytes: usize,
    },
}

/// Finds messages in bytes.
#[derive(Debug, Clone)]
pub struct Decoder {
    buffer: [u8; MAX_FRAME],
    /// Bytes since the last boundary; the first of them are in the buffer.
    count: usize,
    expected: Option<u16>,
}

impl Default for Decoder {
    fn default() -> Self {
        Self::new()
    }
}

impl Decoder {
    /// Has seen nothing. The first message that it finds has lost none before it.
    #[must_use]
    pub const fn new() -> Self {
        Self { buffer: [0; MAX_FRAME], count: 0, expected: None }
    }

    /// Takes bytes in pieces of any size; calls `received` for everything that they complete.
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

/// A sink that turns what a rig finds into frames.
#[derive(Debug)]
pub struct Reporter<F> {
    encoder: Encoder,
    min_pixels: u32,
    send: F,
}

impl<F: FnMut(&[u8])> Reporter<F> {
    /// Gives each frame to `send`, a [`Message::Hello`] at once. Segments below `min_pixels` pixels are left out, and the
    /// work for their planes with them.
    pub fn new(min_pixels: u32, send: F) -> Self {
        let mut reporter = Self { encoder: Encoder::new(), min_pixels, send };
        reporter.send(&Message::Hello { version: VERSION });
        reporter
    }

    /// Sends any message, such as a [`Message::Status`].
    pub fn send(&mut self, message: &Message) {
        let mut buffer = [0; MAX_FRAME];
        if let Ok(frame) = self.encoder.encode(message, &mut buffer) {
            (self.send)(frame);
        }
    }
}

impl<F: FnMut(&[u8])> Sink for Reporter<F> {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.send(&Message::Join { from: join.from.0, into: join.into.0 });
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if segment.pixels() >= self.min_pixels {
            self.send(&Message::Segment(segment.into()));
        }
        ControlFlow::Continue(())
    }
}

impl<F: FnMut(&[u8])> RigSink for Reporter<F> {
    fn scan_started(&mut self, scan: &ScanStarted) {
        self.send(&Message::ScanStarted(*scan));
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.send(&Message::ScanFinished(*scan));
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.send(&Message::Trouble(trouble));
    }
}
