//! The whole chain on simulated wires: every whole telegram is used, no row gets a turn angle that
//! is not its own, what is lost is counted, and the next scan is clean.

use std::rc::Rc;

use scanseg_core::{Finished, MAX_ROWS, PushError, RowBeams, Segmenter, Sink, Status};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::crc::check_word;
use scanseg_hal::lms2xx::{Baud, Session, Settings, Trouble, Variant};
use scanseg_hal::rig::{Counters, Dropped, End, Rig, TiltLimits};
use scanseg_virtual_rig::{Chain, EncoderFault, Mishap, Motion, WireFaults, scanner_on_tilt};

use crate::tilted::*;

/// Rows of a sweep of 1.2 rad at 75 rows a second.
const SWEEP_ROWS: u16 = (1.2 / RATE * 75.0) as u16;
/// A telegram of 181 values.
const TELEGRAM: usize = 372;
/// What is left where nothing is wrong: ranges of a millimetre, an encoder of 14 bits, and a tilt
/// that turns back within a row.
const EXACT_RAD: f64 = 0.001;

/// Until so many more scans are over.
fn run_scans(bench: &mut Bench, scans: usize) {
    let (goal, begin_us) = (bench.seen.finished.len() + scans, bench.chain.now_us());
    while bench.seen.finished.len() < goal {
        bench.step();
        let took_s = (bench.chain.now_us() - begin_us) / 1_000_000;
        assert!(took_s < 30 + 10 * scans as u64, "{:?}", bench.chain.rig.counters());
    }
}

/// [`check_rows`], and the counters agree with what was seen.
fn check(counters: &Counters, notes: &Notes, seen: &Seen, within_rad: f64) {
    assert_eq!(check_rows(notes, within_rad), 0);
    assert_eq!(counters.rows as usize, notes.0.borrow().iter().map(Vec::len).sum::<usize>());
    assert_eq!(counters.scans as usize, seen.started.len());
    assert_eq!(counters.dropped() as usize, seen.dropped.len());
    assert_eq!(counters.troubles as usize, seen.troubles.len());
    let under_way = |counters: &Counters| counters.telegrams - counters.rows - counters.dropped();
    assert!(under_way(counters) <= 1, "{counters:?}");
    for scan in &seen.finished {
        let expected = match scan.end {
            // the row held, and the one that agrees with it
            End::Turned => 2,
            End::Covered => 1,
            End::Pause | End::Trouble | End::Asked => 0,
        };
        assert_eq!(under_way(&scan.counters), expected, "{scan:?}");
    }
}

fn check_bench(bench: &Bench, within_rad: f64) {
    check(&bench.counters(), &bench.notes, &bench.seen, within_rad);
}

#[test]
fn sweeps_become_scans() {
    let mut bench = Bench::new();
    run_scans(&mut bench, 4);
    let counters = bench.counters();
    println!("{counters:?}");
    assert_eq!((counters.telegrams, counters.no_turn), (counters.rows + 1, 1), "the first has no rate yet");
    assert_eq!((counters.rejected, counters.lost, counters.encoder_errors), (0, 0, 0));
    for scan in &bench.seen.finished[1..] {
        assert_eq!((scan.end, scan.rows), (End::Turned, SWEEP_ROWS));
    }
    check_bench(&bench, EXACT_RAD);
}

/// The session on damaged wires, commands and all, and then on good ones.
#[test]
fn damage_and_after() {
    for one_in in [100, 300, 1000, 10_000] {
        let mut bench = Bench::new();
        run_scans(&mut bench, 2);
        let before = bench.counters();
        bench.chain.lms.wires.faults = WireFaults {
            drop_one_in: one_in,
            flip_one_in: one_in,
            insert_one_in: 2 * one_in,
            burst_one_in: 60 * one_in,
        };
        bench.run_ms(20_000);
        let during = bench.counters();
        bench.chain.lms.wires.faults = WireFaults::default();
        run_scans(&mut bench, 3);
        println!("1 of {one_in}: {during:?}");
        assert!(during.rejected > before.rejected + 10);
        let after = bench.counters();
        assert!(after.lost > before.lost || after.troubles > before.troubles);
        let scan = bench.seen.finished.last().unwrap();
        assert_eq!((scan.end, scan.rows), (End::Turned, SWEEP_ROWS), "the next scan is clean");
        check_bench(&bench, EXACT_RAD);
    }
}

/// At any point of a telegram; back at the rate that the session has, or at another one.
#[test]
fn scanner_restarts_within_a_scan() {
    for (ms, permanent_baud) in (0..14).flat_map(|ms| [(ms, Baud::B9600), (ms, Baud::B500000)]) {
        let mut bench = Bench::new();
        bench.chain.lms.permanent_baud = permanent_baud;
        run_scans(&mut bench, 2);
        bench.run_ms(1000 + ms);
        bench.chain.lms.power_cycle(bench.chain.now_us());
        run_scans(&mut bench, 3);
        assert!(bench.seen.troubles.contains(&Trouble::Silent) || bench.seen.troubles.contains(&Trouble::Restarted));
        let ends: Vec<_> = bench.seen.finished.iter().map(|scan| scan.end).collect();
        assert!(matches!(ends[2], End::Trouble | End::Pause), "{ends:?}");
        run_scans(&mut bench, 1);
        let scan = bench.seen.finished.last().unwrap();
        assert_eq!((scan.end, scan.rows), (End::Turned, SWEEP_ROWS), "the next scan is clean");
        check_bench(&bench, EXACT_RAD);
    }
}

/// Scans come, but not the scanner's answer that they will: the first of them does not take the
/// last start byte from before the restart for its own.
#[test]
fn the_answer_to_the_start_is_lost() {
    for ms in 0..14 {
        let mut bench = Bench::new();
        bench.chain.lms.permanent_baud = Baud::B500000;
        run_scans(&mut bench, 1);
        bench.run_ms(500 + ms);
        bench.chain.lms.power_cycle(bench.chain.now_us());
        bench.run_ms(1000);
        // stop, variant, configuration, start
        bench.chain.lms.commands.clear();
        bench.chain.lms.mishaps.extend([Mishap::None, Mishap::None, Mishap::None, Mishap::NoAnswer]);
        run_scans(&mut bench, 1);
        assert_eq!(bench.chain.lms.commands, [0x20, 0x3B, 0x74, 0x20]);
        let counters = bench.counters();
        assert_eq!((counters.lost, counters.no_turn), (0, 2), "{counters:?}");
        check_bench(&bench, EXACT_RAD);
    }
}

#[test]
fn encoder_stuck_and_dead() {
    for (fault, ms) in [(EncoderFault::Stuck, 600), (EncoderFault::Dead, 600), (EncoderFault::Dead, 1500)] {
        let mut bench = Bench::new();
        run_scans(&mut bench, 2);
        bench.run_ms(100);
        bench.chain.encoder_fault = fault;
        bench.run_ms(ms);
        bench.chain.encoder_fault = EncoderFault::None;
        run_scans(&mut bench, 3);
        let counters = bench.counters();
        println!("{fault:?} for {ms} ms: {counters:?}");
        let (flagged, rows) = match fault {
            EncoderFault::Stuck => (counters.standing, ms * 75 / 1000),
            _ => (counters.no_turn, ms * 75 / 1000),
        };
        assert!((rows as u32 - 2..=rows as u32 + 2).contains(&flagged), "{rows} rows");
        assert_eq!(counters.encoder_errors > 0, fault == EncoderFault::Dead);
        // A pause of more than a second ends the scan.
        let ends: Vec<_> = bench.seen.finished.iter().map(|scan| scan.end).collect();
        assert_eq!(ends[2], if ms > 1000 { End::Pause } else { End::Turned });
        assert_eq!(bench.seen.finished.last().unwrap().rows, SWEEP_ROWS, "the next scan is clean");
        check_bench(&bench, EXACT_RAD);
    }
}

/// One wrong sample, large or small: the rows about it are dropped, or it is so small that no limit
/// is broken.
#[test]
fn encoder_glitches() {
    let mut bench = Bench::new();
    run_scans(&mut bench, 1);
    let mut random = Random(7);
    let mut scans = bench.seen.finished.len();
    for _ in 0..400 {
        bench.run_ms(70 + random.below(150));
        let size_rad = 0.004 * 800f64.powf(random.below(1000) as f64 / 1000.0);
        let off_rad = if random.below(2) == 0 { size_rad } else { -size_rad };
        bench.chain.encoder_fault = EncoderFault::Off { by_rad: off_rad };
        bench.run_ms(1 + random.below(14));
        bench.chain.encoder_fault = EncoderFault::None;
        let now = bench.seen.finished.len();
        if now > scans {
            assert!(bench.seen.finished.last().unwrap().rows > 90, "a glitch does not end a scan");
            scans = now;
        }
    }
    println!("{:?}", bench.counters());
    assert!(bench.counters().jump > 300 && scans > 20);
    check_bench(&bench, GLITCH_RAD);
}

/// What a sample can be off without a rate beyond the limits: 0.3 rad/s over the 10 ms between
/// samples, and the rows lie up to 7 ms beyond.
const GLITCH_RAD: f64 = 0.3 * 0.017;

/// The encoder slips on its shaft: rows before and after are never in one scan.
#[test]
fn encoder_slips() {
    for off_rad in [0.03, -0.03, 0.1, -0.1, 0.5, -0.5] {
        let mut bench = Bench::new();
        run_scans(&mut bench, 1);
        bench.run_ms(900);
        bench.chain.encoder_fault = EncoderFault::Off { by_rad: off_rad };
        run_scans(&mut bench, 3);
        println!("{off_rad}: {:?}", bench.counters());
        assert!(bench.counters().jump > 0);
        assert_eq!(bench.seen.dropped[0], Dropped::NoTurn);
        assert!(
            bench.seen.dropped[1..].iter().all(|why| matches!(why, Dropped::Jump | Dropped::Standing | Dropped::Alone))
        );
        for rows in bench.notes.0.borrow().iter().filter(|rows| !rows.is_empty()) {
            let off_rad: Vec<f64> = rows.iter().map(|row| row.turn_rad - row.truth_rad).collect();
            let most = off_rad.iter().copied().fold(f64::MIN, f64::max);
            let least = off_rad.iter().copied().fold(f64::MAX, f64::min);
            assert!(most - least < 2.0 * EXACT_RAD, "{off_rad:?}");
        }
        check_bench(&bench, off_rad.abs() + EXACT_RAD);
    }
}

fn rig(motion: fn(f64) -> f64, limits: TiltLimits, segmenter: impl Segmenter + 'static) -> Seen {
    let motion: Motion = Rc::new(motion);
    let lms = scanner_on_tilt(SETTINGS, &motion, telling).running(Baud::B500000, SETTINGS.variant);
    let mut rows_m = vec![0.0; 2 * COLUMNS];
    let rig = Rig::new(SETTINGS, limits, segmenter, &mut rows_m).unwrap();
    let mut chain = Chain::new(SETTINGS, lms, motion, rig);
    let mut seen = Seen::default();
    while chain.now_us() < 20_000_000 {
        chain.step(&mut seen);
    }
    chain.rig.finish(&mut seen);
    seen
}

/// A scanner that goes round and round: every half turn is a scan, and no row is lost between them.
#[test]
fn round_and_round() {
    let notes = Notes::default();
    let limits = TiltLimits { sweep_rad: std::f32::consts::PI, ..LIMITS };
    let seen = rig(|time_us| -RATE * time_us * 1e-6, limits, notes.clone());
    let rows: Vec<u16> = seen.finished.iter().map(|scan| scan.rows).collect();
    println!("{rows:?}");
    // pi / 0.6 * 75 = 392.7
    assert!(rows.len() == 4 && rows[..3].iter().all(|rows| (392..=394).contains(rows)));
    assert!(seen.finished[..3].iter().all(|scan| scan.end == End::Covered) && seen.finished[3].end == End::Asked);
    assert_eq!(seen.finished[3].counters.telegrams, rows.iter().sum::<u16>() as u32 + 1);
    for pair in seen.started.windows(2) {
        let step_rad = (pair[0].turn_rad - pair[1].turn_rad).rem_euclid(std::f32::consts::TAU);
        assert!((step_rad - std::f32::consts::PI).abs() < 0.02, "{step_rad}");
    }
}

/// Takes so many rows of each scan, then breaks off or says that it is full.
struct Full(usize, usize, Result<Status, PushError>);

impl Segmenter for Full {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        _: &[f32],
        _: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        self.1 += 1;
        if self.1 < self.0 { Ok(Status::Buffered) } else { self.2 }
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        Finished::Complete { rows: std::mem::take(&mut self.1), unlabelled: 3 }
    }

    fn reset(&mut self) {
        self.1 = 0;
    }

    fn latency_rows(&self) -> usize {
        0
    }
}

#[test]
fn the_sink_breaks_off_and_the_segmenter_is_full() {
    let seen = rig(to_and_fro, LIMITS, Full(50, 0, Ok(Status::Stopped)));
    for scan in &seen.finished[1..seen.finished.len() - 1] {
        assert_eq!((scan.rows, scan.end, scan.unlabelled), (50, End::Turned, 3));
    }
    let stopped = seen.dropped.iter().filter(|&&why| why == Dropped::Stopped).count() as u32;
    let last = seen.finished.last().unwrap().counters;
    assert_eq!((last.stopped, last.telegrams), (stopped, stopped + last.rows + 1));

    let seen = rig(to_and_fro, LIMITS, Full(50, 0, Err(PushError::TooManyRows { max_rows: MAX_ROWS })));
    let ends: Vec<_> = seen.finished[1..7].iter().map(|scan| (scan.rows, scan.end)).collect();
    assert!(ends.contains(&(49, End::Covered)) && ends.contains(&(3, End::Turned)), "150 = 3 x 49 + 3: {ends:?}");

    let seen = rig(to_and_fro, LIMITS, Full(50, 0, Err(PushError::RowLength { expected: 1, got: 2 })));
    let last = seen.finished.last().unwrap().counters;
    assert!(last.refused > 0 && last.rows + last.refused + 1 == last.telegrams, "{last:?}");
}

/// A telegram of 181 ranges of 257 mm.
fn telegram(status: u8) -> Vec<u8> {
    let mut telegram = vec![0x02, 0x80, 0x6E, 0x01, 0xB0, 181, 0x40];
    telegram.resize(TELEGRAM - 3, 1);
    telegram.push(status);
    telegram.extend(check_word(&telegram).to_le_bytes());
    telegram
}

/// When the last byte of a telegram comes, and the tilt's turn angle then.
fn end_of(row: u64) -> (u64, f32) {
    let time_us = 1_000_000 + row * 40_000 / 3 + 7_440;
    (time_us, (RATE * 1e-6 * time_us as f64) as f32)
}

/// A row whose telegram says that it is not to be believed.
#[test]
fn status_of_the_scanner() {
    for (status, rows) in [(0x10, 6), (0x11, 6), (0x90, 6), (0x13, 5), (0x14, 5), (0x50, 5)] {
        let mut rows_m = vec![0.0; 2 * COLUMNS];
        let mut rig = Rig::new(SETTINGS, LIMITS, Notes::default(), &mut rows_m).unwrap();
        let (mut session, mut seen) = (Session::listening(SETTINGS), Seen::default());
        for row in 0..7 {
            let (time_us, turn_rad) = end_of(row);
            rig.tilt(Some(Latch { turn_rad, time_us }));
            rig.receive(&mut session, &telegram(if row == 4 { status } else { 0x10 }), time_us, &mut seen);
        }
        rig.finish(&mut seen);
        let counters = rig.counters();
        assert_eq!((counters.rows, counters.status, counters.no_turn), (rows, 6 - rows, 1), "{status:#x}");
    }
}

/// Bytes handed over late, several telegrams at once; and a false beginning whose end lies in a
/// later telegram, so that the search goes back across the silence between telegrams. The turn
/// angles stay the same.
#[test]
fn telegrams_in_large_pieces() {
    for (at_once, with_false_start) in [(1, false), (2, false), (3, false), (1, true)] {
        let mut rows_m = vec![0.0; 2 * COLUMNS];
        let notes = Notes::default();
        let mut rig = Rig::new(SETTINGS, LIMITS, notes.clone(), &mut rows_m).unwrap();
        let (mut session, mut seen) = (Session::listening(SETTINGS), Seen::default());
        let mut bytes = vec![];
        for row in 0..60 {
            let (time_us, turn_rad) = end_of(row);
            rig.tilt(Some(Latch { turn_rad, time_us }));
            if with_false_start && row == 30 {
                // An answer of 700 bytes that never comes.
                bytes.extend([0x02, 0x80, 0xBC, 0x02, 0xF4]);
            }
            bytes.extend(telegram(0x10));
            if row % at_once == at_once - 1 {
                rig.receive(&mut session, &bytes, time_us, &mut seen);
                bytes.clear();
            }
        }
        rig.finish(&mut seen);
        let rows = &notes.0.borrow()[0];
        println!("{at_once} at once: {:?}", rig.counters());
        assert!(rows.len() > 55);
        for row in rows {
            let number = ((row.turn_rad / RATE * 1e6 - 1_000_000.0) * 3.0 / 40_000.0).round();
            // The beams lie a quarter turn of the mirror before the start byte.
            let truth_rad = RATE * 1e-6 * (1_000_000.0 + number * 40_000.0 / 3.0 - 10_000.0 / 3.0);
            assert!((row.turn_rad - truth_rad).abs() < 1e-4, "{row:?} {truth_rad}");
        }
    }
}

#[test]
fn wrong_rigs() {
    let new = |settings, limits, memory: usize| {
        Rig::new(settings, limits, Notes::default(), &mut vec![0.0; memory]).map(|_| ()).map_err(|e| e.to_string())
    };
    assert_eq!(new(SETTINGS, LIMITS, 362), Ok(()));
    assert_eq!(new(SETTINGS, LIMITS, 361), Err("rows need memory for 362 numbers, got 361".into()));
    for (min, max) in [(0.0, 1.0), (-1.0, 1.0), (2.0, 1.0), (f32::NAN, 1.0), (0.1, f32::NAN), (0.1, 236.0)] {
        let limits = TiltLimits { min_rate_rad_per_s: min, max_rate_rad_per_s: max, ..LIMITS };
        assert_eq!(new(SETTINGS, limits, 362), Err(format!("the tilt cannot turn at {min} to {max} rad/s")));
    }
    for sweep_rad in [0.0, -1.0, f32::NAN] {
        let limits = TiltLimits { sweep_rad, ..LIMITS };
        assert_eq!(new(SETTINGS, limits, 362), Err(format!("a sweep cannot be {sweep_rad} rad")));
    }
    let limits = TiltLimits { pause_us: 39_998, ..LIMITS };
    assert_eq!(new(SETTINGS, limits, 362), Err("pause must be 39999 us or more, is 39998".into()));
    let interlaced = Settings { interlaced: true, ..SETTINGS };
    assert_eq!(new(interlaced, LIMITS, 362), Ok(()));
    let half = Settings { variant: Variant::Deg180Step05, ..interlaced };
    assert_eq!(new(half, LIMITS, 722), Ok(()));
}

/// What a board must have for the rig, besides the segmenter.
#[test]
fn size() {
    let bytes = (size_of::<Rig<'static, ()>>(), size_of::<Session>());
    println!("rig and session: {bytes:?}");
    assert!(bytes.0 <= 400 && bytes.1 < 1024);
}
