//! Streams of telegrams in pieces of any size: what comes out does not depend on the pieces, and a
//! telegram that is good by itself is found whatever came before it.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_fuzz::scanner::{Piece, VARIANTS, settings};
use scanseg_hal::lms2xx::{Event, Settings, TelegramDecoder};
use scanseg_hal::pairing::BeamAges;
use scanseg_virtual_rig::telegrams::{decode, telegrams, telegrams_by_themselves};

/// Longer streams only take longer.
const MAX_BYTES: usize = 4000;

#[derive(Debug)]
struct Stream {
    settings: Settings,
    /// The decoder knows what scans look like.
    known: bool,
    bytes: Vec<u8>,
    chunks: Vec<usize>,
}

impl Arbitrary<'_> for Stream {
    fn arbitrary(u: &mut Unstructured) -> Result<Stream> {
        let (settings, known) = (settings(u)?, u.arbitrary()?);
        let chunks = u.arbitrary::<[u8; 4]>()?.map(|size| 1 + usize::from(size) * usize::from(size) / 64);
        let mut bytes = Vec::new();
        for piece in u.arbitrary_iter::<Piece>()? {
            bytes.extend(piece?.bytes(&settings));
        }
        bytes.truncate(MAX_BYTES);
        Ok(Stream { settings, known, bytes, chunks: chunks.to_vec() })
    }
}

fuzz_target!(|stream: Stream| {
    let Stream { settings, known, bytes, chunks } = stream;
    let format = known.then(|| settings.format());
    let whole = decode(&bytes, &[bytes.len()], format);
    assert_eq!(decode(&bytes, &chunks, format), whole);
    assert_eq!(decode(&bytes, &[1], format), whole);
    let found = telegrams(&whole);
    assert_eq!(found, telegrams_by_themselves(&bytes, format));
    for (_, bytes) in found {
        read(&bytes, &settings);
    }
});

/// Everything that can be asked of a telegram.
fn read(bytes: &[u8], settings: &Settings) {
    let mut decoder = TelegramDecoder::new();
    _ = decoder.feed(bytes);
    assert!(matches!(decoder.feed(&bytes[1..]).event, Event::Telegram { .. }));
    let Some(scan) = decoder.telegram().and_then(|telegram| telegram.scan_line()) else { return };
    assert_eq!(scan.words().len(), usize::from(scan.columns()));
    for beam in scan.beams(settings.mode) {
        _ = beam.range_mm(scan.unit());
    }
    for variant in VARIANTS {
        let sweep = BeamAges::of(&scan, variant);
        let ages_us: Vec<f32> = (0..sweep.columns()).map(|column| sweep.age_us(column)).collect();
        assert!(ages_us.iter().chain([&sweep.mean_age_us(), &sweep.age_us(u16::MAX)]).all(|age_us| age_us.is_finite()));
    }
}
