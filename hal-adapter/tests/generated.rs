//! Telegrams of an LMS 2xx as its protocol describes them, made here and by nothing of the crate, on
//! a line that loses, flips, inserts and bursts: every one that comes whole is used, and the counts
//! add up.
//!
//! Written from `reference/protocols.md` of the project's shared facts.

use crate::noisy_line::{Random, across_the_line};
use scanseg_hal::lms2xx::{Event, TelegramDecoder};
use std::collections::BTreeSet;

/// At all rates of faults together.
const TELEGRAMS: usize = 100_000;

/// The check word: shift left by one bit, reduce by 0x8005, add this byte and the one before.
fn check(bytes: &[u8]) -> u16 {
    let (mut sum, mut before) = (0u16, 0u8);
    for &byte in bytes {
        let carry = sum & 0x8000 != 0;
        sum <<= 1;
        if carry {
            sum ^= 0x8005;
        }
        sum ^= u16::from_be_bytes([before, byte]);
        before = byte;
    }
    sum
}

/// 02 80, length of code to status, these, check word; the lower byte first.
fn telegram(code_to_status: &[u8]) -> Vec<u8> {
    let length = code_to_status.len() as u16;
    let mut bytes = vec![0x02, 0x80, length as u8, (length >> 8) as u8];
    bytes.extend(code_to_status);
    let sum = check(&bytes);
    bytes.extend([sum as u8, (sum >> 8) as u8]);
    bytes
}

/// A scan, a partial scan, a part of one, or an answer.
fn any_telegram(random: &mut Random) -> Vec<u8> {
    let status = 0x10 | random.below(5) as u8;
    let unit = (random.below(3) as u16) << 14;
    let mut payload = Vec::new();
    let count = match random.below(8) {
        0 => {
            payload = vec![0xA0, random.below(3) as u8];
            0
        }
        1 => {
            let first = 1 + random.below(300) as u16;
            let count = 1 + random.below(60) as u16;
            payload.push(0xB7);
            for word in [first, first + count - 1, count | unit] {
                payload.extend(word.to_le_bytes());
            }
            count
        }
        kind => {
            // a whole turn, or one that begins at 0.00, 0.25, 0.50, 0.75 deg
            let (count, partial) = match kind {
                2 => [(181, 0x2000), (180, 0x3000), (101, 0x2000), (100, 0x2800), (100, 0x3000), (100, 0x3800)]
                    [random.below(6)],
                _ => ([101, 181, 201, 361, 401][random.below(5)], 0),
            };
            payload.push(0xB0);
            payload.extend((count | partial | unit).to_le_bytes());
            count
        }
    };
    for _ in 0..count {
        // some look like the beginning of a telegram
        let word = if random.is(0.02) { 0x8002 } else { random.next() as u16 };
        payload.extend(word.to_le_bytes());
    }
    payload.push(status);
    telegram(&payload)
}

/// How many telegrams were sent, came whole, were found, and were found though they were not sent.
#[derive(Debug, Default)]
struct Counts {
    sent: usize,
    whole: usize,
    found: usize,
    false_ones: usize,
    hidden: usize,
    rejected: usize,
}

/// So many telegrams on a line with so many faults for each byte.
fn send(telegrams: usize, rate: f64, seed: u64) -> Counts {
    let mut random = Random(seed);
    let mut counts = Counts { sent: telegrams, ..Counts::default() };
    // where a telegram came whole, and what was sent there
    let (mut stream, mut whole) = (Vec::new(), Vec::new());
    for _ in 0..telegrams {
        if random.is(0.1) {
            stream.push(0x06);
        }
        let sent = any_telegram(&mut random);
        let (came, is_whole) = across_the_line(&sent, rate, &mut random);
        if is_whole {
            whole.push((stream.len() + came.len() - sent.len(), sent.len()));
        }
        stream.extend(came);
    }
    counts.whole = whole.len();
    // what a false head at the end claims
    stream.extend([0; 812]);

    let mut decoder = TelegramDecoder::new();
    let (mut found, mut used, mut at) = (BTreeSet::new(), 0, 0);
    while used < stream.len() {
        let piece = used + (1 + random.below(600)).min(stream.len() - used);
        loop {
            let fed = decoder.feed(&stream[used..piece]);
            used += fed.used;
            match fed.event {
                Event::NeedMore => break,
                Event::Start { bytes_ago } => at = used - 1 - usize::from(bytes_ago),
                Event::Rejected(_) => counts.rejected += 1,
                Event::Telegram { code } => {
                    let length = 6 + decoder.telegram().map_or(0, |telegram| telegram.data().len() + 2);
                    // it is one by its check word, and its own bytes
                    let bytes = &stream[at..at + length];
                    assert_eq!(bytes[..2], [0x02, 0x80]);
                    assert_eq!((bytes[4], u16::from_le_bytes([bytes[2], bytes[3]])), (code, length as u16 - 6));
                    assert_eq!(bytes[length - 2..], check(&bytes[..length - 2]).to_le_bytes());
                    assert!(found.insert((at, length)));
                }
                _ => {}
            }
        }
    }
    counts.found = found.len();
    counts.false_ones = found.iter().filter(|telegram| whole.binary_search(telegram).is_err()).count();
    for (at, length) in whole.iter().filter(|telegram| !found.contains(telegram)) {
        // only what is a telegram by its check word as well, and began before, can hide one
        let hides = |&(other, its): &(usize, usize)| other < *at && other + its > *at;
        assert!(found.iter().any(hides), "{length} bytes at {at} came whole, and are lost");
        counts.hidden += 1;
    }
    counts
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn whole_telegrams_are_used() {
    for (seed, rate) in [0.0, 1e-4, 3e-4, 1e-3, 3e-3, 1e-2].into_iter().enumerate() {
        let counts = send(TELEGRAMS / 6, rate, seed as u64);
        println!("{rate}: {counts:?}");
        let Counts { sent, whole, found, false_ones, hidden, rejected } = counts;
        assert_eq!(found, whole - hidden + false_ones);
        // a check word of 16 bits takes one damaged telegram in some thousands for a good one
        assert!(1000 * false_ones <= sent + 2000 && hidden <= false_ones, "{counts:?}");
        if rate == 0.0 {
            assert_eq!([whole, found, rejected], [sent, sent, 0], "{counts:?}");
        }
    }
}
