//! Telegrams as a scanner sends them, and what the decoder makes of a stream of them: for tests of
//! drivers.

use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Event, ScanLineFormat, TelegramDecoder};

/// Returns the telegram of a payload, which goes from the code to the status.
#[must_use]
pub fn frame(payload: &[u8]) -> Vec<u8> {
    let mut frame = vec![0x02, 0x80];
    frame.extend((payload.len() as u16).to_le_bytes());
    frame.extend(payload);
    frame.extend(check_word(&frame).to_le_bytes());
    frame
}

/// Returns the payload of a scan. `head` is its code and, for a sub-range, its columns.
#[must_use]
pub fn scan_payload(head: &[u8], count_word: u16, values: &[u16], index_bytes: &[u8], status: u8) -> Vec<u8> {
    let mut payload = head.to_vec();
    payload.extend(count_word.to_le_bytes());
    payload.extend(values.iter().flat_map(|value| value.to_le_bytes()));
    payload.extend(index_bytes);
    payload.push(status);
    payload
}

/// What came out of a stream.
#[derive(Clone, Debug, PartialEq)]
pub enum Seen {
    /// Anything but a telegram.
    Event(Event),
    /// A good telegram.
    Telegram {
        /// Where in the stream it begins.
        at: usize,
        /// Its bytes, from the start byte to the check word.
        bytes: Vec<u8>,
    },
}

/// Returns everything that a decoder finds in `bytes`, fed in pieces of these sizes over and over.
/// At the end the line falls silent.
///
/// # Panics
/// If the decoder contradicts itself, or `pieces` is empty.
#[must_use]
pub fn decode(bytes: &[u8], pieces: &[usize], format: Option<ScanLineFormat>) -> Vec<Seen> {
    let mut decoder = TelegramDecoder::new();
    decoder.expect_scan_lines(format);
    let mut seen = Vec::new();
    let mut sizes = pieces.iter().cycle();
    let mut rest = bytes;
    let (mut used, mut at) = (0, 0);
    let mut drain = |decoder: &mut TelegramDecoder, mut piece: &[u8]| {
        loop {
            let fed = decoder.feed(piece);
            piece = &piece[fed.used..];
            used += fed.used;
            match fed.event {
                Event::NeedMore => {
                    assert!(piece.is_empty());
                    return;
                }
                Event::Telegram { code } => {
                    let telegram = decoder.telegram().expect("telegram");
                    assert_eq!(telegram.code(), code);
                    let frame = frame(&[&[code][..], telegram.data(), &[telegram.status().0]].concat());
                    assert_eq!(bytes[at..][..frame.len()], frame, "it begins at the last start byte told");
                    seen.push(Seen::Telegram { at, bytes: frame });
                }
                event => {
                    if let Event::Start { bytes_ago } = event {
                        at = used - 1 - usize::from(bytes_ago);
                        assert_eq!(bytes[at], 0x02);
                    }
                    seen.push(Seen::Event(event));
                }
            }
        }
    };
    while !rest.is_empty() {
        let (piece, after) = rest.split_at((*sizes.next().expect("a size")).min(rest.len()));
        drain(&mut decoder, piece);
        rest = after;
    }
    while decoder.expire().is_some() {
        drain(&mut decoder, &[]);
    }
    seen
}

/// Returns the telegrams among it, each with the place where it begins.
#[must_use]
pub fn telegrams(seen: &[Seen]) -> Vec<(usize, Vec<u8>)> {
    let telegram = |seen: &Seen| match seen {
        Seen::Telegram { at, bytes } => Some((*at, bytes.clone())),
        Seen::Event(_) => None,
    };
    seen.iter().filter_map(telegram).collect()
}

/// Returns the good telegrams of a stream, one after the other. A telegram that is whole and good
/// by itself counts, whatever comes before it.
#[must_use]
pub fn telegrams_by_themselves(bytes: &[u8], format: Option<ScanLineFormat>) -> Vec<(usize, Vec<u8>)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        if bytes[at] != 0x02 {
            at += 1;
            continue;
        }
        let mut decoder = TelegramDecoder::new();
        decoder.expect_scan_lines(format);
        let begins =
            decoder.feed(&bytes[at..]) == scanseg_hal::lms2xx::Fed { used: 1, event: Event::Start { bytes_ago: 0 } };
        let fed = decoder.feed(&bytes[(at + 1).min(bytes.len())..]);
        if begins && let Event::Telegram { .. } = fed.event {
            found.push((at, bytes[at..][..1 + fed.used].to_vec()));
            at += 1 + fed.used;
        } else {
            at += 1;
        }
    }
    found
}
