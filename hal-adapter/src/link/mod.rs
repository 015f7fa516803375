//! The results as frames of bytes, for a serial port to a host. Frames are numbered and checked,
//! and found again after any other bytes.
//!
//! # Frames
//!
//! ```text
//! 00 | COBS of (sequence, message, CRC) | 00
//! ```
//!
//! - **00** is at both ends of a frame and nowhere else. Two in a row are one boundary. The one in
//!   front separates a frame from other output of the board, and from a frame that has lost its
//!   end.
//! - **COBS** (Cheshire and Baker) removes zeros from the bytes between. It is a sequence of
//!   blocks. The first byte of a block, n, is its length with itself, so n - 1 bytes follow. They
//!   stand for themselves, and for a zero behind them, except in the last block. (A block FF, 254
//!   bytes without a zero, has no zero behind it. Frames are shorter.)
//! - **sequence**: the number of the frame, 0 to 65535, then again from 0; `num`. A gap shows lost
//!   frames.
//! - **message**: see below.
//! - **CRC**: CRC-32/ISO-HDLC (that of zlib, Ethernet and PNG) of sequence and message, 4 bytes,
//!   lowest first.
//!
//! A frame has at most [`MAX_FRAME`] bytes.
//!
//! # Messages
//!
//! A message is the number of its kind and then its fields, without gaps, in
//! [postcard](https://postcard.jamesmunns.com/wire-format)'s format:
//!
//! - `num`: an integer as a varint: seven bits per byte, the lowest first, bit 7 set in all bytes
//!   but the last. 300 is AC 02.
//! - `u8`: one byte.
//! - `f32`: IEEE 754 single precision, 4 bytes, lowest first.
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
//! - **counters** ([`Counters`](crate::rig::Counters)), all `num`: bytes, telegrams, rejected,
//!   lost, rows, no_turn, standing, jump, alone, status, columns, stopped, refused, encoder_errors,
//!   troubles, scans, segments, overruns, queue_full. The first goes to 2^64 - 1, the others to 2^32 - 1.
//! - **end** ([`End`](crate::rig::End)): 0 turned, 1 covered, 2 pause, 3 trouble, 4 asked.
//! - **trouble** ([`Trouble`](crate::lms2xx::Trouble)): 0 not found; 1 no answer: command `u8`; 2
//!   not acknowledged: command `u8`; 3 refused: command `u8`, reason `u8`; 4 configuration: length
//!   `num`; 5 silent; 6 restarted.
//!
//! The types document the fields and their units. For final labels, a host applies the joins:
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

mod frame;
mod message;
mod read;
mod reporter;
mod write;

pub use frame::{FrameTooLong, MAX_FRAME};
pub use message::{Message, PlaneReport, SegmentReport, VERSION};
pub use read::{FrameDecoder, Received};
pub use reporter::Reporter;
pub use write::FrameEncoder;
