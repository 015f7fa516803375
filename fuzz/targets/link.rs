//! Frames of the link: of any bytes, in pieces of any size; and of messages, some of them damaged.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_hal::link::{FrameDecoder, FrameEncoder, MAX_FRAME, Message, PlaneReport, Received, SegmentReport};
use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Counters, End, ScanFinished, ScanStarted};

#[derive(Debug, Arbitrary)]
enum Part {
    /// Any bytes.
    Bytes(Vec<u8>),
    /// A message.
    Message(AnyMessage),
    /// A message of which one byte is another.
    Damaged { message: AnyMessage, at: u8, flip: u8 },
    /// A message that is not sent, but counted.
    Lost(AnyMessage),
}

#[derive(Debug)]
struct AnyMessage(Message);

impl Arbitrary<'_> for AnyMessage {
    fn arbitrary(u: &mut Unstructured) -> Result<AnyMessage> {
        Ok(AnyMessage(match u.arbitrary::<u8>()? % 7 {
            0 => Message::Hello { version: u.arbitrary()? },
            1 => Message::ScanStarted(ScanStarted {
                number: u.arbitrary()?,
                columns: u.arbitrary()?,
                turn_rad: u.arbitrary()?,
            }),
            2 => Message::Segment(segment(u)?),
            3 => Message::Join { from: u.arbitrary()?, into: u.arbitrary()? },
            4 => Message::ScanFinished(ScanFinished {
                number: u.arbitrary()?,
                end: *u.choose(&[End::Turned, End::Covered, End::Pause, End::Trouble, End::Asked])?,
                rows: u.arbitrary()?,
                unlabelled: u.arbitrary()?,
                counters: counters(u)?,
            }),
            5 => Message::Status(counters(u)?),
            _ => Message::Trouble(match u.arbitrary::<u8>()? % 7 {
                0 => Trouble::NotFound,
                1 => Trouble::NoAnswer { command: u.arbitrary()? },
                2 => Trouble::NotAcknowledged { command: u.arbitrary()? },
                3 => Trouble::Refused { command: u.arbitrary()?, reason: u.arbitrary()? },
                4 => Trouble::Configuration { length: u.arbitrary()? },
                5 => Trouble::Silent,
                _ => Trouble::Restarted,
            }),
        }))
    }
}

fn segment(u: &mut Unstructured) -> Result<SegmentReport> {
    let (label, pixels) = (u.arbitrary()?, u.arbitrary()?);
    let [first_row, last_row, first_column, last_column] = u.arbitrary()?;
    let plane = u.arbitrary::<Option<([f32; 3], f32, f32, [f32; 10])>>()?;
    let plane =
        plane.map(|(normal, distance_m, rms_m, covariance)| PlaneReport { normal, distance_m, rms_m, covariance });
    Ok(SegmentReport {
        label,
        pixels,
        first_row,
        last_row,
        first_column,
        last_column,
        centroid_m: u.arbitrary()?,
        plane,
    })
}

fn counters(u: &mut Unstructured) -> Result<Counters> {
    let [telegrams, rejected, lost, rows, no_turn, standing, jump, alone]: [u32; 8] = u.arbitrary()?;
    let [status, columns, stopped, refused, encoder_errors, troubles, scans, segments]: [u32; 8] = u.arbitrary()?;
    let [overruns, queue_full]: [u32; 2] = u.arbitrary()?;
    Ok(Counters {
        bytes: u.arbitrary()?,
        telegrams,
        rejected,
        lost,
        rows,
        no_turn,
        standing,
        jump,
        alone,
        status,
        columns,
        stopped,
        refused,
        encoder_errors,
        troubles,
        scans,
        segments,
        overruns,
        queue_full,
    })
}

/// Prints as itself, NaN too.
fn same(one: &Message, other: &Message) -> bool {
    let mut frames = [[0; MAX_FRAME]; 2];
    let [a, b] = &mut frames;
    FrameEncoder::new().encode(one, a).expect("fits") == FrameEncoder::new().encode(other, b).expect("fits")
}

fuzz_target!(|input: ([u8; 2], Vec<Part>)| {
    let (chunks, parts) = input;
    let (mut encoder, mut bytes) = (FrameEncoder::new(), Vec::new());
    // what must arrive, and whether what comes before it may be anything
    let (mut expected, mut is_clean) = (Vec::new(), true);
    for part in &parts {
        let mut buffer = [0; MAX_FRAME];
        let mut frame = |message: &AnyMessage| encoder.encode(&message.0, &mut buffer).expect("fits").to_vec();
        match part {
            Part::Bytes(junk) => {
                bytes.extend(junk);
                is_clean = false;
            }
            Part::Message(message) => {
                bytes.extend(frame(message));
                expected.push(message.0);
            }
            Part::Damaged { message, at, flip } => {
                let mut frame = frame(message);
                let at = 1 + usize::from(*at) % (frame.len() - 2);
                frame[at] ^= (*flip).max(1);
                bytes.extend(frame);
            }
            Part::Lost(message) => _ = frame(message),
        }
    }
    let mut found = Vec::new();
    let mut decoder = FrameDecoder::new();
    decoder.feed(&bytes, |received| found.push(received));
    let mut messages = found.iter().filter_map(|received| match received {
        Received::Message { message, .. } => Some(message),
        Received::Damaged { .. } => None,
    });
    if is_clean {
        assert_eq!(messages.clone().count(), expected.len(), "nothing but what was sent");
    }
    for expected in &expected {
        assert!(messages.any(|message| same(message, expected)), "{expected:?} is lost");
    }

    // in pieces: NaN is not equal to itself, what is printed is
    let mut in_pieces = Vec::new();
    let mut decoder = FrameDecoder::new();
    let mut rest = &bytes[..];
    for size in chunks.into_iter().cycle().map(|size| 1 + usize::from(size)) {
        let (piece, after) = rest.split_at(size.min(rest.len()));
        decoder.feed(piece, |received| in_pieces.push(received));
        rest = after;
        if rest.is_empty() {
            break;
        }
    }
    assert_eq!(format!("{in_pieces:?}"), format!("{found:?}"));
});
