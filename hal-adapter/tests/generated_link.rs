//! Frames of the link as its page describes them, made here and by nothing of the crate, on a line
//! that loses, flips, inserts and bursts: every one that comes whole is used, and the counts add up.
#![cfg(feature = "link")]

use crate::noisy_line::{Random, across_the_line};
use scanseg_hal::link::{FrameDecoder, Message, Received};

/// At all rates of faults together.
const FRAMES: usize = 100_000;

fn varint(mut number: u64) -> Vec<u8> {
    let mut bytes = Vec::new();
    while number >= 0x80 {
        bytes.push(0x80 | (number & 0x7F) as u8);
        number >>= 7;
    }
    bytes.push(number as u8);
    bytes
}

/// CRC-32/ISO-HDLC, bit by bit.
fn crc32(bytes: &[u8]) -> u32 {
    let mut sum = u32::MAX;
    for &byte in bytes {
        sum ^= u32::from(byte);
        for _ in 0..8 {
            sum = if sum & 1 == 1 { sum >> 1 ^ 0xEDB8_8320 } else { sum >> 1 };
        }
    }
    !sum
}

/// COBS of fewer than 254 bytes, without the boundaries.
fn cobs(bytes: &[u8]) -> Vec<u8> {
    let blocks = bytes.split(|&byte| byte == 0);
    blocks.flat_map(|block| [&[block.len() as u8 + 1][..], block].concat()).collect()
}

/// A message that a scan brings, in bytes and as the crate has it.
fn any_message(random: &mut Random) -> (Vec<u8>, Message) {
    let [from, into] = [0, 1].map(|_| (random.next() >> (32 + random.below(32))) as u32);
    let bytes = [varint(3), varint(from.into()), varint(into.into())].concat();
    if random.is(0.5) {
        return (bytes, Message::Join { from, into });
    }
    let (number, columns, turn_rad) = (from, random.next() as u16, into as f32 / 1e9);
    let bytes = [varint(1), varint(number.into()), varint(columns.into()), turn_rad.to_le_bytes().to_vec()].concat();
    (bytes, Message::ScanStarted(scanseg_hal::rig::ScanStarted { number, columns, turn_rad }))
}

/// Sends so many frames with so many faults for each byte; gives how many were used.
fn send(frames: usize, rate: f64, seed: u64) -> usize {
    let mut random = Random(seed);
    let (mut stream, mut sent) = (Vec::new(), Vec::new());
    for sequence in 0..frames {
        let (message, as_sent) = any_message(&mut random);
        let mut checked = [varint((sequence % 65536) as u64), message].concat();
        checked.extend(crc32(&checked).to_le_bytes());
        let frame = cobs(&checked);
        let (came, _) = across_the_line(&[&[0], &frame[..], &[0]].concat(), rate, &mut random);
        stream.extend(came);
        sent.push((frame, as_sent));
    }
    // what lies between two boundaries is a frame that was sent, in its place, or damaged
    let (mut expected, mut next, mut damaged) = (Vec::new(), 0, 0);
    let last = stream.iter().rposition(|&byte| byte == 0).unwrap_or(0);
    for piece in stream[..last].split(|&byte| byte == 0).filter(|piece| !piece.is_empty()) {
        // a frame is lost at most some hundred frames long
        let ahead = sent[next..].iter().take(300).position(|(frame, _)| frame == piece);
        match ahead {
            Some(ahead) => {
                expected.push((next + ahead, sent[next + ahead].1));
                next += ahead + 1;
            }
            None => damaged += 1,
        }
    }

    let (mut decoder, mut received, mut lost_in_all, mut refused) = (FrameDecoder::new(), Vec::new(), 0, 0);
    let mut rest = &stream[..];
    while !rest.is_empty() {
        let (piece, after) = rest.split_at((1 + random.below(100)).min(rest.len()));
        rest = after;
        decoder.feed(piece, |found| match found {
            Received::Message { lost, message } => {
                lost_in_all += usize::from(lost);
                received.push(message);
            }
            Received::Damaged { .. } => refused += 1,
        });
    }
    assert_eq!(received, expected.iter().map(|&(_, message)| message).collect::<Vec<_>>());
    assert_eq!(refused, damaged);
    let [(first, _), .., (last, _)] = expected[..] else { panic!("too few frames") };
    assert_eq!(received.len() + lost_in_all, last - first + 1);
    if rate == 0.0 {
        assert_eq!([received.len(), refused], [frames, 0]);
    }
    received.len()
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn whole_frames_are_used() {
    for (seed, rate) in [0.0, 1e-4, 1e-3, 1e-2].into_iter().enumerate() {
        println!("{rate}: {} of {}", send(FRAMES / 4, rate, seed as u64), FRAMES / 4);
    }
}
