//! The whole chain on simulated wires: every whole telegram is used, no row gets a turn angle that is not its own, what is
//! lost is counted, and the next scan is clean.

mod tilted;

use scanseg_hal::lms2xx::Trouble;
use scanseg_hal::rig::{Dropped, End};
use scanseg_sim::virtual_rig::EncoderFault;
use tilted::{Bench, RATE};

/// Rows of a sweep of 1.2 rad at 75 rows a second.
const SWEEP_ROWS: u16 = (1.2 / RATE * 75.0) as u16;

#[test]
fn sweeps_become_scans() {
    let mut bench = Bench::new();
    bench.run_scans(4);
    let counters = bench.chain.rig.counters();
    println!("{counters:?}");
    assert_eq!(counters.telegrams, counters.rows);
    assert_eq!((counters.rejected, counters.lost, counters.encoder_errors), (0, 0, 0));
    for scan in &bench.seen.finished[1..] {
        assert_eq!((scan.end, scan.rows), (End::Turned, SWEEP_ROWS));
    }
    bench.check_rows(0.001);
}

#[test]
fn encoder_stuck() {
    let mut bench = Bench::new();
    bench.run_scans(2);
    bench.run_ms(700);
    bench.chain.encoder_fault = EncoderFault::Stuck;
    bench.run_ms(600);
    bench.chain.encoder_fault = EncoderFault::None;
    bench.run_scans(3);
    let counters = bench.chain.rig.counters();
    println!("{counters:?} {:?}", bench.seen.finished);
    assert!((40..48).contains(&counters.standing), "600 ms of rows");
    assert!(bench.seen.dropped.iter().all(|why| matches!(why, Dropped::Standing | Dropped::Jump | Dropped::Alone)));
    assert_eq!(bench.seen.finished.last().unwrap().rows, SWEEP_ROWS, "the next scan is clean");
    bench.check_rows(0.005);
    let _ = Trouble::Silent;
}
