//! Scan after scan on the virtual rig with everything going wrong now and then: the counters agree,
//! the rig never allocates, and memory does not grow.

use std::ops::ControlFlow;

use allocation_counter::measure;
use scanseg_core::{LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Sink, buffers};
use scanseg_hal::lms2xx::{Baud, Session};
use scanseg_hal::rig::{Rig, RigSink, ScanFinished, beams};
use scanseg_virtual_rig::{EncoderFault, WireFaults};

use crate::tilted::*;

/// Samples up to 33 ms apart, between which the tilt may turn back, and half of the rate to the
/// limit.
const LIMIT_RAD: f64 = 0.3 * 0.034;
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.005));

/// Counts, and keeps nothing.
#[derive(Default)]
struct Count {
    rows: u32,
    segments: u32,
    scans: u32,
}

impl Sink for Count {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        self.rows += 1;
        ControlFlow::Continue(())
    }

    fn segment(&mut self, _: &Segment) -> ControlFlow<()> {
        self.segments += 1;
        ControlFlow::Continue(())
    }
}

impl RigSink for Count {
    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.scans += 1;
        assert_eq!((scan.number, scan.counters.segments), (self.scans, self.segments));
    }
}

/// `SOAK_SCANS=10000` for a long one.
#[test]
fn soak() {
    let scans: usize = std::env::var("SOAK_SCANS").ok().and_then(|count| count.parse().ok()).unwrap_or(30);
    let mut bench = Bench::new();
    // A second rig hears the same, with a segmenter; all of its memory is here.
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut rows_m = [0.0; 2 * COLUMNS];
    let segmenter = PlaneSegmenter::new(CONFIG, beams(SETTINGS.variant), COLUMNS, buffers.memory()).unwrap();
    let mut rig = Rig::new(SETTINGS, LIMITS, segmenter, &mut rows_m).unwrap();
    let (mut session, mut count) = (Session::listening(SETTINGS), Count::default());

    let mut random = Random(3);
    let (mut over, mut totals) = (0, Totals::default());
    let (mut held_bytes, mut most_bytes, mut most_at_half) = (0, 0, None);
    while over < scans {
        set_faults(&mut bench, &mut random);
        let end_us = bench.chain.now_us() + 1000 * (200 + random.below(800));
        let whole = measure(|| {
            while bench.chain.now_us() < end_us {
                let came = bench.step();
                let by_rig = measure(|| {
                    if !came.bytes.is_empty() {
                        rig.tilt(came.latch);
                        rig.receive(&mut session, &came.bytes, came.time_us, &mut count);
                    }
                    rig.idle(came.time_us, &mut count);
                });
                assert_eq!(by_rig.count_total, 0, "the rig allocates");
            }
            over += check_and_forget(&mut bench, &mut totals);
        });
        held_bytes += whole.bytes_current;
        most_bytes = most_bytes.max(held_bytes);
        if 2 * over >= scans {
            most_at_half.get_or_insert(most_bytes);
        }
        let counters = rig.counters();
        assert_eq!(
            (counters.rows, counters.segments, counters.scans - count.scans <= 1),
            (count.rows, count.segments, true)
        );
        assert!(counters.telegrams - counters.rows - counters.dropped() <= 1, "{counters:?}");
    }
    println!("{over} scans: {:?}\nthe rig with a segmenter: {:?}", bench.counters(), rig.counters());
    println!("{} damaged telegrams passed the check word", totals.false_rows);
    assert!(totals.false_rows <= 2 + bench.counters().rejected / 20_000);
    let most_at_half = most_at_half.unwrap();
    println!("bytes that the simulation held at most: {most_at_half} in the first half, {most_bytes} in all");
    assert!(most_bytes <= most_at_half + 32 * 1024);
}

/// Any faults at all; half of the time none on the wires.
fn set_faults(bench: &mut Bench, random: &mut Random) {
    let now_us = bench.chain.now_us();
    let lms = &mut bench.chain.lms;
    let one_in = [0, 0, 0, 20_000, 2_000, 300][random.below(6) as usize];
    lms.wires.faults =
        WireFaults { drop_one_in: one_in, flip_one_in: one_in, insert_one_in: one_in, burst_one_in: 30 * one_in };
    bench.chain.encoder_fault = match random.below(12) {
        0 => EncoderFault::Stuck,
        1 => EncoderFault::Dead,
        _ => EncoderFault::None,
    };
    if random.below(50) == 0 {
        lms.permanent_baud = [Baud::B9600, Baud::B500000][random.below(2) as usize];
        lms.power_cycle(now_us);
    }
    lms.commands.clear();
}

/// What has been told so far.
#[derive(Default)]
struct Totals {
    rows: u32,
    dropped: u32,
    troubles: u32,
    false_rows: u32,
}

/// Checks what was noted since the last time, and forgets it. Returns how many scans are over
/// since.
fn check_and_forget(bench: &mut Bench, totals: &mut Totals) -> usize {
    totals.false_rows += check_rows(&bench.notes, LIMIT_RAD);
    let mut scans = bench.notes.0.borrow_mut();
    let over = scans.len().saturating_sub(1);
    totals.rows += scans.iter().map(|rows| rows.len() as u32).sum::<u32>();
    scans.iter_mut().for_each(Vec::clear);
    scans.truncate(1);
    drop(scans);
    let counters = bench.counters();
    let seen = &mut bench.seen;
    totals.dropped += seen.dropped.len() as u32;
    totals.troubles += seen.troubles.len() as u32;
    assert_eq!((counters.rows, counters.dropped()), (totals.rows, totals.dropped));
    assert_eq!(counters.troubles, totals.troubles);
    assert!(counters.telegrams - counters.rows - counters.dropped() <= 1, "{counters:?}");
    let still = seen.started.len() - seen.finished.len();
    seen.started.drain(..seen.started.len() - still);
    seen.finished.clear();
    seen.dropped.clear();
    seen.troubles.clear();
    over
}
