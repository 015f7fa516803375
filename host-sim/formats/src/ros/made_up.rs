//! Messages for tests.

use byteorder::LittleEndian;
use serde::Serialize;

/// A message as it is recorded.
pub fn cdr(message: &impl Serialize) -> Vec<u8> {
    let body = cdr_encoding::to_vec::<_, LittleEndian>(message).expect("a message");
    [&[0, 1, 0, 0][..], &body].concat()
}
