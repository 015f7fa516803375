//! The frames of the link: the documented bytes, every message through any pieces, and what damage does.

use proptest::prelude::*;
use scanseg_hal::link::{Decoder, Encoder, FrameTooLong, MAX_FRAME, Message, PlaneReport, Received, SegmentReport};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Counters, End, ScanFinished, ScanStarted};

fn frame(encoder: &mut Encoder, message: &Message) -> Vec<u8> {
    let mut buffer = [0xAA; MAX_FRAME];
    encoder.encode(message, &mut buffer).expect("fits").to_vec()
}

fn feed(decoder: &mut Decoder, bytes: &[u8], piece: usize) -> Vec<Received> {
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
    let mut encoder = Encoder::new();
    let hello = frame(&mut encoder, &Message::Hello { version: 1 });
    assert_eq!(hello, [0x00, 0x01, 0x01, 0x06, 0x01, 0x84, 0xE9, 0x46, 0x88, 0x00]);
    (1..5).for_each(|_| _ = frame(&mut encoder, &Message::Hello { version: 1 }));
    let joined = frame(&mut encoder, &Message::Join { from: 300, into: 7 });
    assert_eq!(joined, [0x00, 0x0A, 0x05, 0x03, 0xAC, 0x02, 0x07, 0xA6, 0x84, 0x47, 0x60, 0x00]);
    assert_eq!(crc(&joined[2..7]), 0x6047_84A6);
}

#[test]
fn every_message_in_pieces_of_any_size() {
    let mut encoder = Encoder::new();
    let bytes: Vec<u8> = messages().iter().flat_map(|message| frame(&mut encoder, message)).collect();
    for piece in [1, 2, 3, 7, 50, 128, bytes.len()] {
        let all = feed(&mut Decoder::new(), &bytes, piece);
        assert_eq!(all, messages().into_iter().map(|m| message(0, m)).collect::<Vec<_>>());
    }
}

#[test]
fn longest_frames_fit() {
    // Sequence numbers of three bytes.
    let mut encoder = Encoder::new();
    (0..20_000).for_each(|_| _ = frame(&mut encoder, &Message::Hello { version: 1 }));
    let finished =
        ScanFinished { number: u32::MAX, end: End::Asked, rows: u16::MAX, unlabelled: u32::MAX, counters: FULL };
    let longest = Message::ScanFinished(finished);
    let length = frame(&mut encoder, &longest).len();
    println!("longest frame: {length}");
    assert!(length > 100 && length <= MAX_FRAME);
    let mut small = vec![0; length - 1];
    let mut before = encoder.clone();
    assert_eq!(encoder.encode(&longest, &mut small), Err(FrameTooLong));
    assert_eq!(encoder.encode(&longest, &mut []), Err(FrameTooLong));
    assert_eq!(frame(&mut encoder, &longest), frame(&mut before, &longest), "what did not fit was not counted");
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn lost_frames_are_counted_across_the_wrap() {
    let (mut encoder, mut decoder) = (Encoder::new(), Decoder::new());
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
    let bytes = frame(&mut Encoder::new(), &Message::Hello { version: 1 });
    assert_eq!(feed(&mut decoder, &bytes, 5), [message(0, Message::Hello { version: 1 })]);
}

#[test]
fn garbage_before_between_and_instead() {
    let mut encoder = Encoder::new();
    let [a, b, c] = [1, 2, 3].map(|from| frame(&mut encoder, &Message::Join { from, into: 0 }));
    let long = [0x55; 3 * MAX_FRAME];
    // The end of b is lost.
    let bytes = [b"boot v1\r\n", &a[..], &long, &b[..b.len() - 3], &c, &[0, 0, 1, 0, 3, 1, 0]].concat();
    for piece in [1, 4, 1000] {
        let found = feed(&mut Decoder::new(), &bytes, piece);
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
        let bytes = frame(&mut Encoder::new(), &sent);
        let found = feed(&mut Decoder::new(), &bytes, piece);
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
        let mut encoder = Encoder::new();
        let [before, hit, after] = [1, 2, 3].map(|from| frame(&mut encoder, &Message::Join { from, into: 0 }));
        let mut damaged = hit.clone();
        let at = 1 + at % (hit.len() - 2);
        match kind {
            0 => damaged[at] ^= flip,
            1 => _ = damaged.remove(at),
            _ => damaged.insert(at, flip),
        }
        let found = feed(&mut Decoder::new(), &[before, damaged, after].concat(), 9);
        let good: Vec<_> = found.iter().filter(|r| matches!(r, Received::Message { .. })).copied().collect();
        prop_assert_eq!(good, [
            message(0, Message::Join { from: 1, into: 0 }),
            message(1, Message::Join { from: 3, into: 0 }),
        ]);
    }

    /// Any bytes at all: no panic, no message.
    #[test]
    fn noise(bytes in proptest::collection::vec(prop_oneof![Just(0u8), any::<u8>()], 0..2000)) {
        let found = feed(&mut Decoder::new(), &bytes, 64);
        let messages = found.iter().filter(|received| matches!(received, Received::Message { .. })).count();
        prop_assert_eq!(messages, 0);
    }
}
