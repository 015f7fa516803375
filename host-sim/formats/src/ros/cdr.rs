//! Messages as CDR, the encoding of DDS.

use byteorder::{BigEndian, LittleEndian};
use cdr_encoding::from_bytes;
use serde::Deserialize;

use crate::scan_error::ScanError;

/// Reads a message. What follows its fields is left out.
pub fn decode<'a, T: Deserialize<'a>>(kind: &'static str, bytes: &'a [u8]) -> Result<T, ScanError> {
    let (head, body) = bytes.split_at_checked(4).unwrap_or((&[], &[]));
    match head {
        [0, 0, ..] => from_bytes::<T, BigEndian>(body).map(|(message, _)| message),
        [0, 1, ..] => from_bytes::<T, LittleEndian>(body).map(|(message, _)| message),
        _ => return Err(ScanError::damaged(kind, "neither of the two encodings of CDR")),
    }
    .map_err(|e| ScanError::damaged(kind, e))
}
