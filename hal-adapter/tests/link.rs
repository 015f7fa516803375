//! The frames of the link: the documented bytes, every message through any pieces, and what damage
//! does.
#![cfg(feature = "link")]

use proptest::prelude::*;
use scanseg_hal::link::{
    FrameDecoder, FrameEncoder, FrameTooLong, MAX_FRAME, Message, PlaneReport, Received, SegmentReport,
};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Counters, End, ScanFinished, ScanStarted};

fn frame(encoder: &mut FrameEncoder, message: &Message) -> Vec<u8> {
    let mut buffer = [0xAA; MAX_FRAME];
    encoder.encode(message, &mut buffer).expect("fits").to_vec()
}

fn feed(decoder: &mut FrameDecoder, bytes: &[u8], piece: usize) -> Vec<Received> {
    let mut all = vec![];
    for piece in bytes.chunks(piece) {
        decoder.feed(piece, |received| all.push(received));
    }
    all
}

fn message(lost: u16, message: Message) -> Received {
    Received::Message { lost, message }
}

const FULL: Counters = Counters {
    bytes: u64::MAX,
    telegrams: u32::MAX,
    rejected: u32::MAX,
    lost: u32::MAX,
    rows: u32::MAX,
    no_turn: u32::MAX,
    standing: u32::MAX,
    jump: u32::MAX,
    alone: u32::MAX,
    status: u32::MAX,
    columns: u32::MAX,
    stopped: u32::MAX,
    refused: u32::MAX,
    encoder_errors: u32::MAX,
    troubles: u32::MAX,
    scans: u32::MAX,
    segments: u32::MAX,
    overruns: u32::MAX,
    queue_full: u32::MAX,
};

fn segment(bits: u32) -> Message {
    let float = |i: u32| f32::from_bits(bits.wrapping_add(i));
    Message::Segment(SegmentReport {
        label: bits,
        pixels: !bits,
        first_row: bits as u16,
        last_row: u16::MAX,
        first_column: 0,
        last_column: (bits >> 16) as u16,
        centroid_m: [float(0), float(1), float(2)],
        plane: bits.is_multiple_of(3).then(|| PlaneReport {
            normal: [float(3), float(4), float(5)],
            distance_m: float(6),
            rms_m: float(7),
            covariance: std::array::from_fn(|i| float(8 + i as u32)),
        }),
    })
}

/// One of every kind.
fn messages() -> Vec<Message> {
    let finished = ScanFinished { number: 7, end: End::Pause, rows: 200, unlabelled: 0, counters: FULL };
    vec![
        Message::Hello { version: 1 },
        Message::ScanStarted(ScanStarted { number: 1, columns: 361, turn_rad: -0.5 }),
        segment(0x3F80_0001),
        segment(0x0000_0000),
        Message::Join { from: 300, into: 7 },
        Message::ScanFinished(finished),
        Message::Status(Counters::default()),
        Message::Status(FULL),
        Message::Trouble(Trouble::Refused { command: 0x3B, reason: 2 }),
        Message::Trouble(Trouble::Configuration { length: 65535 }),
    ]
}

/// CRC-32/ISO-HDLC, bit by bit.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xEDB8_8320 } else { crc >> 1 })
    })
}

/// The bytes in the documentation of the module.
#[test]
fn worked_example() {
    let mut encoder = FrameEncoder::new();
    let hello = frame(&mut encoder, &Message::Hello { version: 1 });
    assert_eq!(hello, [0x00, 0x01, 0x01, 0x06, 0x01, 0x84, 0xE9, 0x46, 0x88, 0x00]);
    (1..5).for_each(|_| _ = frame(&mut encoder, &Message::Hello { version: 1 }));
    let joined = frame(&mut encoder, &Message::Join { from: 300, into: 7 });
    assert_eq!(joined, [0x00, 0x0A, 0x05, 0x03, 0xAC, 0x02, 0x07, 0xA6, 0x84, 0x47, 0x60, 0x00]);
    assert_eq!(crc(&joined[2..7]), 0x6047_84A6);
}

/// What is in frame 0 with this message, without COBS: sequence, message and CRC.
fn content(message: &Message) -> Vec<u8> {
    let mut frame = frame(&mut FrameEncoder::new(), message);
    let [0, coded @ .., 0] = &mut frame[..] else { panic!("no boundaries") };
    let length = cobs::decode_in_place(coded).expect("COBS");
    coded[..length].to_vec()
}

fn hex(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("hex")).collect()
}

/// Every kind of message, byte for byte as the documentation of the module says. These were made
/// from it by hand, without the code.
#[test]
fn bytes_of_every_message() {
    let counters = Counters {
        bytes: 300_000,
        telegrams: 1000,
        rejected: 1,
        lost: 2,
        rows: 3,
        no_turn: 4,
        standing: 5,
        jump: 6,
        alone: 7,
        status: 8,
        columns: 9,
        stopped: 10,
        refused: 11,
        encoder_errors: 12,
        troubles: 13,
        scans: 14,
        segments: 15,
        overruns: 16,
        queue_full: 17,
    };
    let small = SegmentReport {
        label: 7,
        pixels: 30,
        first_row: 0,
        last_row: 199,
        first_column: 17,
        last_column: 360,
        centroid_m: [1.5, -2.25, 0.0],
        plane: None,
    };
    let large = SegmentReport {
        label: 300,
        pixels: 70_000,
        first_row: 3,
        last_row: 4,
        first_column: 5,
        last_column: 6,
        centroid_m: [1.0, 2.0, 3.0],
        plane: Some(PlaneReport {
            normal: [0.0, 0.6, 0.8],
            distance_m: 2.5,
            rms_m: 0.01,
            covariance: std::array::from_fn(|i| i as f32 / 8.0),
        }),
    };
    let mut encoder = FrameEncoder::new();
    // Sequence numbers of one byte and of two.
    (0..120).for_each(|_| _ = frame(&mut encoder, &Message::Hello { version: 1 }));
    for (message, bytes) in [
        (Message::Hello { version: 1 }, "00 02 78 06 01 6C D0 A4 D2 00"),
        (
            Message::ScanStarted(ScanStarted { number: 12, columns: 361, turn_rad: -0.5 }),
            "00 06 79 01 0C E9 02 01 01 06 BF FD BC 56 A1 00",
        ),
        (
            Message::Segment(small),
            "00 05 7A 02 07 1E 06 C7 01 11 E8 02 01 03 C0 3F 01 03 10 C0 01 01 01 01 05 F1 BA 43 71 00",
        ),
        (
            Message::Segment(large),
            "00 0C 7B 02 AC 02 F0 A2 04 03 04 05 06 01 03 80 3F 01 01 02 40 01 04 40 40 01 01 01 01 09 9A 99 19 3F CD CC \
             4C 3F 01 07 20 40 0A D7 23 3C 01 01 01 01 01 01 02 3E 01 03 80 3E 01 03 C0 3E 01 01 02 3F 01 03 20 3F 01 03 \
             40 3F 01 03 60 3F 01 03 80 3F 01 07 90 3F 7D 56 58 11 00",
        ),
        (Message::Join { from: 300, into: 7 }, "00 0A 7C 03 AC 02 07 18 06 85 94 00"),
        (
            Message::ScanFinished(ScanFinished { number: 12, end: End::Pause, rows: 200, unlabelled: 129, counters }),
            "00 23 7D 04 0C 02 C8 01 81 01 E0 A7 12 E8 07 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10 11 17 2B 6C 85 00",
        ),
        (
            Message::Status(counters),
            "00 1D 7E 05 E0 A7 12 E8 07 01 02 03 04 05 06 07 08 09 0A 0B 0C 0D 0E 0F 10 11 7F 62 EB B4 00",
        ),
        (Message::Trouble(Trouble::NotFound), "00 03 7F 06 05 F9 51 B6 F6 00"),
        (Message::Trouble(Trouble::NoAnswer { command: 0x20 }), "00 0A 80 01 06 01 20 D1 4D 80 E9 00"),
        (Message::Trouble(Trouble::NotAcknowledged { command: 0x3B }), "00 0A 81 01 06 02 3B 4E FE A8 75 00"),
        (Message::Trouble(Trouble::Refused { command: 0x77, reason: 0x92 }), "00 0B 82 01 06 03 77 92 1C C1 88 86 00"),
        (Message::Trouble(Trouble::Configuration { length: 500 }), "00 0B 83 01 06 04 F4 03 66 6C 3D DF 00"),
        (Message::Trouble(Trouble::Silent), "00 09 84 01 06 05 4E C7 8D 64 00"),
        (Message::Trouble(Trouble::Restarted), "00 09 85 01 06 06 91 F1 38 45 00"),
    ] {
        assert_eq!(frame(&mut encoder, &message), hex(bytes), "{message:?}");
    }
    for (end, number) in [(End::Turned, 0), (End::Covered, 1), (End::Pause, 2), (End::Trouble, 3), (End::Asked, 4)] {
        let scan = ScanFinished { number: 1, end, rows: 1, unlabelled: 1, counters };
        assert_eq!(content(&Message::ScanFinished(scan))[..4], [0, 4, 1, number], "{end:?}");
    }
}

/// The writer is not postcard's, but writes the same.
#[test]
fn messages_are_postcard() {
    for message in messages() {
        let mut buffer = [0; MAX_FRAME];
        let mut expected = vec![0];
        expected.extend(postcard::to_slice(&message, &mut buffer).expect("fits").iter());
        expected.extend(crc(&expected).to_le_bytes());
        assert_eq!(content(&message), expected, "{message:?}");
    }
}

#[test]
fn every_message_in_pieces_of_any_size() {
    let mut encoder = FrameEncoder::new();
    let bytes: Vec<u8> = messages().iter().flat_map(|message| frame(&mut encoder, message)).collect();
    for piece in [1, 2, 3, 7, 50, 128, bytes.len()].into_iter().step_by(if cfg!(miri) { 3 } else { 1 }) {
        let all = feed(&mut FrameDecoder::new(), &bytes, piece);
        assert_eq!(all, messages().into_iter().map(|m| message(0, m)).collect::<Vec<_>>());
    }
}

#[test]
fn longest_frames_fit() {
    // Sequence numbers of three bytes; under Miri of two.
    let mut encoder = FrameEncoder::new();
    (0..if cfg!(miri) { 129 } else { 20_000 }).for_each(|_| _ = frame(&mut encoder, &Message::Hello { version: 1 }));
    let finished =
        ScanFinished { number: u32::MAX, end: End::Asked, rows: u16::MAX, unlabelled: u32::MAX, counters: FULL };
    let longest = Message::ScanFinished(finished);
    let length = frame(&mut encoder, &longest).len();
    println!("longest frame: {length}");
    assert!(length > 100 && length <= MAX_FRAME);
    let mut before = encoder.clone();
    for size in (0..length).step_by(if cfg!(miri) { 19 } else { 1 }) {
        assert_eq!(encoder.encode(&longest, &mut vec![0; size]), Err(FrameTooLong), "{size} of {length} bytes");
    }
    assert_eq!(frame(&mut encoder, &longest), frame(&mut before, &longest), "what did not fit was not counted");
    assert_eq!(FrameTooLong.to_string(), "frame does not fit its memory; 128 bytes are enough");
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn lost_frames_are_counted_across_the_wrap() {
    let (mut encoder, mut decoder) = (FrameEncoder::new(), FrameDecoder::new());
    let join = Message::Join { from: 2, into: 1 };
    for number in 0..65_600u32 {
        let bytes = frame(&mut encoder, &join);
        // 3 of 10 vanish, and of one the end.
        match number % 10 {
            4..=6 => {}
            8 => assert_eq!(feed(&mut decoder, &bytes[..bytes.len() - 1], 5), []),
            found => {
                let lost = if found == 7 { 3 } else { 0 };
                let expected = if found == 9 { vec![message(0, join); 2] } else { vec![message(lost, join)] };
                assert_eq!(feed(&mut decoder, &bytes, 5), expected, "frame {number}");
            }
        }
    }
    // The board restarts.
    let bytes = frame(&mut FrameEncoder::new(), &Message::Hello { version: 1 });
    assert_eq!(feed(&mut decoder, &bytes, 5), [message(0, Message::Hello { version: 1 })]);
}

#[test]
fn garbage_before_between_and_instead() {
    let mut encoder = FrameEncoder::new();
    let [a, b, c] = [1, 2, 3].map(|from| frame(&mut encoder, &Message::Join { from, into: 0 }));
    let long = [0x55; 3 * MAX_FRAME];
    // The end of b is lost.
    let bytes = [b"boot v1\r\n", &a[..], &long, &b[..b.len() - 3], &c, &[0, 0, 1, 0, 3, 1, 0]].concat();
    for piece in [1, 4, 1000] {
        let found = feed(&mut FrameDecoder::new(), &bytes, piece);
        assert_eq!(found[0], Received::Damaged { bytes: 9 });
        assert_eq!(found[1], message(0, Message::Join { from: 1, into: 0 }));
        assert_eq!(found[2], Received::Damaged { bytes: long.len() });
        assert_eq!(found[3], Received::Damaged { bytes: b.len() - 4 });
        assert_eq!(found[4], message(1, Message::Join { from: 3, into: 0 }));
        assert_eq!(found[5..], [Received::Damaged { bytes: 1 }, Received::Damaged { bytes: 2 }]);
    }
}

proptest! {
    /// Whatever the bits of a float: NaNs and denormals, too.
    #[test]
    fn floats_travel_bit_for_bit(bits: u32, piece in 1..200usize) {
        let bits = bits - bits % 3;
        let sent = segment(bits);
        let bytes = frame(&mut FrameEncoder::new(), &sent);
        let found = feed(&mut FrameDecoder::new(), &bytes, piece);
        let [Received::Message { lost: 0, message: Message::Segment(found) }] = found[..] else { panic!("{found:?}") };
        let Message::Segment(sent) = sent else { unreachable!() };
        let floats = |s: &SegmentReport| {
            let plane = s.plane.expect("plane");
            [&s.centroid_m[..], &plane.normal, &[plane.distance_m, plane.rms_m], &plane.covariance]
                .concat().iter().map(|f| f.to_bits()).collect::<Vec<_>>()
        };
        prop_assert_eq!(floats(&found), floats(&sent));
        prop_assert_eq!((found.label, found.pixels, found.last_column), (sent.label, sent.pixels, sent.last_column));
    }

    /// Damage to one frame of three: it is never taken for a message, and its neighbours arrive.
    #[test]
    fn damage_is_found(at in 0..1000usize, flip in 1..=255u8, kind in 0..3) {
        let mut encoder = FrameEncoder::new();
        let [before, hit, after] = [1, 2, 3].map(|from| frame(&mut encoder, &Message::Join { from, into: 0 }));
        let mut damaged = hit.clone();
        let at = 1 + at % (hit.len() - 2);
        match kind {
            0 => damaged[at] ^= flip,
            1 => _ = damaged.remove(at),
            _ => damaged.insert(at, flip),
        }
        let found = feed(&mut FrameDecoder::new(), &[before, damaged, after].concat(), 9);
        let good: Vec<_> = found.iter().filter(|r| matches!(r, Received::Message { .. })).copied().collect();
        prop_assert_eq!(good, [
            message(0, Message::Join { from: 1, into: 0 }),
            message(1, Message::Join { from: 3, into: 0 }),
        ]);
    }

    /// Any bytes at all: no panic, no message.
    #[test]
    fn noise(bytes in proptest::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..if cfg!(miri) { 30 } else { 2000 })) {
        let found = feed(&mut FrameDecoder::new(), &bytes, 64);
        let messages = found.iter().filter(|received| matches!(received, Received::Message { .. })).count();
        prop_assert_eq!(messages, 0);
    }
}
