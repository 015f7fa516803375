//! Scan after scan on the virtual rig with everything going wrong now and then: the counters agree, and memory does not grow.

mod tilted;

use scanseg_sim::virtual_rig::{EncoderFault, Faults};
use tilted::*;

/// Samples up to 33 ms apart, between which the tilt may turn back, and half of the rate to the limit.
const LIMIT_RAD: f64 = 0.3 * 0.034;

/// `SOAK_SCANS=10000` for a long one.
#[test]
fn soak() {
    let scans: usize = std::env::var("SOAK_SCANS").ok().and_then(|count| count.parse().ok()).unwrap_or(30);
    let mut bench = Bench::new();
    let mut random = Random(3);
    let mut memory_at_half = None;
    let (mut over, mut rows) = (0, 0);
    while over < scans {
        let one_in = [0, 0, 0, 20_000, 2_000, 300][random.below(6) as usize];
        bench.chain.lms.wires.faults = Faults { drop_one_in: one_in, flip_one_in: one_in, insert_one_in: one_in };
        bench.chain.encoder_fault = match random.below(12) {
            0 => EncoderFault::Stuck,
            1 => EncoderFault::Dead,
            _ => EncoderFault::None,
        };
        if random.below(50) == 0 {
            bench.chain.lms.power_cycle(bench.chain.now_us());
        }
        bench.run_ms(200 + random.below(800));
        over += check_and_forget(&mut bench, &mut rows);
        if over > scans / 2 && memory_at_half.is_none() {
            memory_at_half = pages();
        }
    }
    println!("{over} scans: {:?}", bench.counters());
    if let (Some(half), Some(now)) = (memory_at_half, pages()) {
        println!("{half} pages at half time, {now} now");
        assert!(now < half + 128, "{half} pages at half time, {now} now");
    }
}

/// Pages of memory that this process has, where the system says so.
fn pages() -> Option<u64> {
    std::fs::read_to_string("/proc/self/statm").ok()?.split(' ').nth(1)?.parse().ok()
}

/// Checks what was noted since the last time, and forgets it. `rows`: how many have been so far. Returns how many scans are
/// over since.
fn check_and_forget(bench: &mut Bench, rows: &mut u32) -> usize {
    check_rows(&bench.notes, LIMIT_RAD);
    let mut scans = bench.notes.0.borrow_mut();
    let over = scans.len().saturating_sub(1);
    *rows += scans.iter().map(|rows| rows.len() as u32).sum::<u32>();
    scans.iter_mut().for_each(Vec::clear);
    scans.truncate(1);
    drop(scans);
    let counters = bench.counters();
    assert_eq!(counters.rows, *rows);
    assert!(counters.telegrams - counters.rows - counters.dropped() <= 1, "{counters:?}");
    let seen = &mut bench.seen;
    let still = seen.started.len() - seen.finished.len();
    seen.started.drain(..seen.started.len() - still);
    seen.finished.clear();
    seen.dropped.clear();
    seen.troubles.clear();
    over
}
