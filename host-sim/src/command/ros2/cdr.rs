//! Messages of DDS as they are, without a look at what they hold.

use std::convert::Infallible;

use ros2_client::dds::rustdds::RepresentationIdentifier;
use ros2_client::dds::rustdds::no_key::{Decode, DefaultDecoder, DeserializerAdapter};

/// Makes CDR of a message, with the four bytes before it that tell its encoding.
#[derive(Clone, Copy)]
pub struct AsItIs;

impl DeserializerAdapter<Vec<u8>> for AsItIs {
    type Error = Infallible;
    type Decoded = Vec<u8>;

    fn supported_encodings() -> &'static [RepresentationIdentifier] {
        &[RepresentationIdentifier::CDR_LE, RepresentationIdentifier::CDR_BE]
    }

    fn transform_decoded(decoded: Vec<u8>) -> Vec<u8> {
        decoded
    }
}

impl DefaultDecoder<Vec<u8>> for AsItIs {
    type Decoder = AsItIs;
    const DECODER: AsItIs = AsItIs;
}

impl Decode<'_, Vec<u8>> for AsItIs {
    type Error = Infallible;

    fn decode_bytes(self, bytes: &[u8], encoding: RepresentationIdentifier) -> Result<Vec<u8>, Infallible> {
        let little = u8::from(encoding == RepresentationIdentifier::CDR_LE);
        Ok([&[0, little, 0, 0], bytes].concat())
    }
}
