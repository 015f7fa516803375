//! Faults of which every byte and every sample is known: what becomes of each telegram.

use scanseg_core::{Finished, PushError, RowBeams, Segmenter, Sink, Status};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Baud, Session, SessionEvent};
use scanseg_hal::pairing::MIRROR_TURN_US;
use scanseg_hal::rig::{Counters, Rig};
use scanseg_virtual_rig::{BURST, Beam, VirtualLms};

use crate::tilted::*;

/// A telegram of 181 values.
const TELEGRAM: usize = 372;
const TURN_US: f64 = MIRROR_TURN_US as f64;

/// What happens to the scanner's bytes.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LineTrouble {
    Good,
    Loss,
    Flip,
    Insertion,
    Burst,
    /// Any of these.
    All,
}

/// What happens to the samples of the tilt, now and then for some milliseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EncoderTrouble {
    Good,
    Stuck,
    Jumping,
    /// It does not answer.
    Failing,
}

/// The words of a telegram: the first is the telegram's number, and some begin like a telegram,
/// short or long.
fn word(beam: Beam) -> u16 {
    let number = (beam.time_us / TURN_US) as u16;
    match beam.bearing_deg as u16 {
        0 => number,
        20 | 170 => 0x8002,
        21 => [30, 300, 700][usize::from(number % 3)],
        171 => [700, 400, 100][usize::from(number % 3)],
        22 | 172 => 0x00F4,
        column => 2000 + column,
    }
}

/// What comes from the scanner in half a minute, and when: telegram 0, 1, and so on, without a gap.
fn sent() -> Vec<(u64, Vec<u8>)> {
    let lms = VirtualLms::new(word).configured(SETTINGS.mode, SETTINGS.unit);
    let mut lms = lms.running(Baud::B500000, SETTINGS.variant);
    let pieces = (0..30_000_000).step_by(1000).map(|time_us| (time_us, lms.read(time_us, Baud::B500000)));
    pieces.filter(|(_, bytes)| !bytes.is_empty()).collect()
}

/// The start byte of a telegram leaves the scanner.
fn start_us(number: usize) -> f64 {
    (number + 1) as f64 * TURN_US
}

/// The mean turn angle of a telegram's beams.
fn truth_rad(number: usize) -> f64 {
    let beam_us = |column: usize| start_us(number) - (180 - column) as f64 / 360.0 * TURN_US;
    (0..COLUMNS).map(|column| to_and_fro(beam_us(column))).sum::<f64>() / COLUMNS as f64
}

fn sweep(time_us: f64) -> f64 {
    (time_us * 1e-6 * RATE / 1.2).floor()
}

/// What arrives, and which telegrams arrive whole.
fn damage(sent: &[(u64, Vec<u8>)], line: LineTrouble, one_in: u64) -> (Vec<(u64, Vec<u8>)>, Vec<bool>) {
    let mut random = Random(one_in);
    let (mut count, mut burst, mut whole) = (0, 0, vec![]);
    let mut damaged = |byte: u8, came: &mut Vec<u8>| {
        let (telegram, last) = (count / TELEGRAM, count % TELEGRAM == TELEGRAM - 1);
        count += 1;
        whole.resize(telegram + 1, true);
        let hit = line != LineTrouble::Good && random.below(one_in) == 0;
        let kind = match line {
            LineTrouble::All => [LineTrouble::Loss, LineTrouble::Flip, LineTrouble::Insertion, LineTrouble::Burst]
                [random.below(4) as usize],
            line => line,
        };
        // as many bytes are hit in bursts as otherwise one by one
        if hit && kind == LineTrouble::Burst && random.below(BURST.into()) == 0 {
            burst = BURST;
        }
        let before = came.len();
        match kind {
            _ if burst > 0 => {
                burst -= 1;
                came.push(random.below(256) as u8);
            }
            LineTrouble::Loss if hit => {}
            LineTrouble::Flip if hit => came.push(byte ^ 1 << random.below(8)),
            LineTrouble::Insertion if hit => {
                came.extend([byte, random.below(256) as u8]);
                // between telegrams it does no harm
                whole[telegram] &= last;
                return;
            }
            _ => came.push(byte),
        }
        whole[telegram] &= came[before..] == [byte];
    };
    let mut arrived = vec![];
    for (time_us, bytes) in sent {
        let mut came = vec![];
        bytes.iter().for_each(|&byte| damaged(byte, &mut came));
        arrived.push((*time_us, came));
    }
    whole.truncate(count / TELEGRAM);
    (arrived, whole)
}

/// Samples of the tilt, some of them wrong.
struct Samples {
    encoder: EncoderTrouble,
    random: Random,
    last_rad: f64,
    off_rad: f64,
    /// The faults so far, from when to when; the last may be yet to come.
    faults: Vec<(u64, u64)>,
}

impl Samples {
    fn at(&mut self, time_us: u64) -> Option<Latch> {
        if self.faults.last().is_none_or(|&(_, until_us)| until_us <= time_us) {
            let from_us = time_us + 1000 * (100 + self.random.below(300));
            self.faults.push((from_us, from_us + 1000 * (1 + self.random.below(80))));
            let size_rad = 0.004 * 800f64.powf(self.random.below(1000) as f64 / 1000.0);
            self.off_rad = if self.random.below(2) == 0 { size_rad } else { -size_rad };
        }
        let wrong = self.faults.last().is_some_and(|&(from_us, _)| from_us <= time_us);
        let right_rad = to_and_fro(time_us as f64);
        self.last_rad = match self.encoder {
            EncoderTrouble::Failing if wrong => return None,
            EncoderTrouble::Stuck if wrong => self.last_rad,
            EncoderTrouble::Jumping if wrong => right_rad + self.off_rad,
            _ => right_rad,
        };
        Some(Latch { turn_rad: self.last_rad as f32, time_us })
    }

    fn wrong(&self, from_us: f64, until_us: f64) -> bool {
        self.faults.iter().any(|&(from, until)| (from as f64) < until_us && until as f64 > from_us)
    }

    /// Nothing was wrong with the samples that tell the turn angle of this telegram, and the tilt
    /// did not turn back.
    fn fine(&self, number: usize) -> bool {
        let (from_us, until_us) = (start_us(number) - 50_000.0, start_us(number) + 20_000.0);
        let good = self.encoder == EncoderTrouble::Good || !self.wrong(from_us, until_us);
        good && sweep(from_us) == sweep(until_us)
    }
}

/// The rows of each scan as the segmenter got them: number of the telegram, turn angle.
#[derive(Default)]
struct Numbered {
    scans: Vec<Vec<(usize, f64)>>,
    under_way: bool,
}

impl Segmenter for Numbered {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        let (beams, columns) = (beams.into(), ranges_m.len());
        // of the middle beam
        let more_rad: f32 = (0..columns).map(|c| beams.column_turns.of(c)).sum();
        let turn_rad = beams.turn_rad + more_rad / columns as f32;
        if !std::mem::replace(&mut self.under_way, true) {
            self.scans.push(vec![]);
        }
        let number = (ranges_m[0] * 1000.0).round() as usize;
        self.scans.last_mut().unwrap().push((number, turn_rad.into()));
        Ok(Status::Buffered)
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        self.under_way = false;
        Finished::Complete { rows: 0, unlabelled: 0 }
    }

    fn reset(&mut self) {
        self.under_way = false;
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

struct Outcome {
    /// Numbers of the telegrams that the session took for good, as they came.
    decoded: Vec<usize>,
    scans: Vec<Vec<(usize, f64)>>,
    counters: Counters,
    seen: Seen,
    samples: Samples,
}

/// The scans that this session will find in these bytes.
fn scans_in(mut session: Session, mut bytes: &[u8], now_ms: u32) -> Vec<usize> {
    let mut numbers = vec![];
    loop {
        let (used, event) = session.feed(now_ms, bytes);
        bytes = &bytes[used..];
        match event {
            SessionEvent::NeedMore => return numbers,
            SessionEvent::ScanLine => {
                numbers.extend(session.scan_line().and_then(|scan| scan.words().next()).map(usize::from))
            }
            _ => {}
        }
    }
}

fn receive(came: &[(u64, Vec<u8>)], encoder: EncoderTrouble) -> Outcome {
    let mut rows_m = vec![0.0; 2 * COLUMNS];
    let mut rig = Rig::new(SETTINGS, LIMITS, Numbered::default(), &mut rows_m).unwrap();
    let mut session = Session::listening(SETTINGS);
    let mut samples = Samples { encoder, random: Random(5), last_rad: 0.0, off_rad: 0.0, faults: vec![] };
    let (mut decoded, mut seen) = (vec![], Seen::default());
    // at the end nothing is left in the decoder
    let flush = (30_000_000, vec![0; 1000]);
    for (time_us, bytes) in came.iter().filter(|(_, bytes)| !bytes.is_empty()).chain([&flush]) {
        rig.tilt(samples.at(*time_us));
        decoded.extend(scans_in(session.clone(), bytes, (time_us / 1000) as u32));
        rig.receive(&mut session, bytes, *time_us, &mut seen);
    }
    rig.finish(&mut seen);
    Outcome { decoded, counters: rig.counters(), scans: rig.release().scans, seen, samples }
}

/// What is left where nothing is wrong: a start byte is known to the millisecond in which its byte
/// came.
const EXACT_RAD: f64 = 0.0006;
/// What is left where a sample is wrong by so little that the rate stays within the limits, over
/// four telegrams.
const PLAUSIBLE_RAD: f64 = 0.3 * 4.0 * TURN_US * 1e-6;

fn check(line: LineTrouble, one_in: u64, encoder: EncoderTrouble, whole: &[bool], outcome: &Outcome) {
    let Outcome { decoded, scans, counters, seen, samples } = outcome;
    let rows = scans.concat();
    let numbers: Vec<usize> = (0..whole.len()).filter(|&number| whole[number]).collect();
    println!("{line:?} 1 in {one_in}, {encoder:?}: {} of {} whole; {counters:?}", numbers.len(), whole.len());
    assert!(numbers.len() >= 30);

    // Every telegram that arrived whole is found, once; of flips in two bits the check word misses
    // one pattern in a thousand.
    let is_whole = |number: usize| whole.get(number) == Some(&true);
    let found: Vec<usize> = decoded.iter().copied().filter(|&number| is_whole(number)).collect();
    assert!(found == numbers, "telegrams that arrived whole and are not found, or twice");
    let false_ones = decoded.len() - found.len();
    assert!(false_ones <= if matches!(line, LineTrouble::Flip | LineTrouble::All) { 3 } else { 0 }, "{false_ones}");

    // It becomes a row, or is dropped and counted with the reason.
    assert_eq!((counters.telegrams as usize, counters.rows as usize), (decoded.len(), rows.len()));
    assert_eq!(counters.dropped() as usize, decoded.len() - rows.len());
    assert_eq!(counters.dropped() as usize, seen.dropped.len());
    let row_numbers: Vec<usize> = rows.iter().map(|row| row.0).collect();
    assert!(row_numbers.is_sorted_by(|a, b| a < b), "each is one row, in order");
    // If nothing is wrong with its samples, nor with those of the telegram found before it or after
    // it, it is a row: only one that agrees with no other is dropped. Two that are far apart do not
    // agree if the encoder jumped in between.
    let fine = |number: usize| is_whole(number) && samples.fine(number);
    for pair in decoded.windows(2).filter(|pair| fine(pair[0]) && fine(pair[1])) {
        let [one_us, other_us] = [start_us(pair[0]), start_us(pair[1])];
        let jumped = encoder == EncoderTrouble::Jumping && pair[1] - pair[0] > 4 && samples.wrong(one_us, other_us);
        let agree = sweep(one_us) == sweep(other_us) && other_us - one_us < f64::from(LIMITS.pause_us) && !jumped;
        let are_rows = pair.iter().all(|number| row_numbers.contains(number));
        assert!(!agree || are_rows, "telegrams {pair:?} are no rows");
    }

    // Its turn angle is its own. While the encoder is off by more than can be, its rows are scans
    // of their own, and no row of another place is among them.
    for rows in scans {
        let off_rad: Vec<f64> = rows.iter().map(|&(number, turn_rad)| turn_rad - truth_rad(number)).collect();
        for (&(number, _), off_rad) in rows.iter().zip(&off_rad).filter(|(row, _)| is_whole(row.0)) {
            let elsewhere = encoder == EncoderTrouble::Jumping && rows.iter().all(|row| !samples.fine(row.0));
            let within_rad = match samples.fine(number) {
                true => EXACT_RAD,
                false if elsewhere => f64::INFINITY,
                false => PLAUSIBLE_RAD,
            };
            assert!(off_rad.abs() <= within_rad, "row {number} is off by {off_rad}");
        }
        let step_rad = |pair: &[f64]| (pair[1] - pair[0]).abs();
        assert!(off_rad.windows(2).all(|pair| step_rad(pair) <= PLAUSIBLE_RAD), "two places in a scan: {off_rad:?}");
    }

    // What is lost is counted.
    let between = decoded.last().unwrap() - decoded[0] + 1;
    assert_eq!(counters.lost as usize, between - decoded.len());
    assert_eq!((counters.rejected == 0, counters.lost == 0), (line == LineTrouble::Good, line == LineTrouble::Good));
    assert_eq!(counters.encoder_errors == 0, encoder != EncoderTrouble::Failing);
    assert_eq!((counters.scans as usize, counters.troubles), (seen.finished.len(), 0));
    assert_eq!(scans.len(), seen.finished.len());
}

#[test]
fn every_whole_telegram_is_used() {
    let sent = sent();
    for line in [
        LineTrouble::Good,
        LineTrouble::Loss,
        LineTrouble::Flip,
        LineTrouble::Insertion,
        LineTrouble::Burst,
        LineTrouble::All,
    ] {
        for one_in in [100, 1000, 10_000] {
            let (came, whole) = damage(&sent, line, one_in);
            for encoder in
                [EncoderTrouble::Good, EncoderTrouble::Stuck, EncoderTrouble::Jumping, EncoderTrouble::Failing]
            {
                check(line, one_in, encoder, &whole, &receive(&came, encoder));
            }
        }
    }
}
