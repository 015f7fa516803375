//! When beams were measured, and which turn angle they get.

use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Baud, Event, MeasuringMode, Settings, TelegramDecoder, Unit, Variant};
use scanseg_hal::pairing::{BeamAges, MIRROR_TURN_US, Pairing};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

/// The ages of the beams of a scan line with this code, what stands before the count word, and this
/// count word.
fn beam_ages(head: &[u8], count_word: u16, variant: Variant) -> BeamAges {
    let values = vec![0; usize::from(count_word & 0x3FF)];
    let bytes = frame(&scan_payload(head, count_word, &values, &[], 0x10));
    let mut decoder = TelegramDecoder::new();
    let begun = decoder.feed(&bytes);
    let done = decoder.feed(&bytes[begun.used..]);
    assert_eq!(done.event, Event::Telegram { code: head[0] });
    BeamAges::of(&decoder.telegram().expect("telegram").scan_line().expect("scan"), variant)
}

fn close(found: f32, expected: f32) {
    assert!((found - expected).abs() < 1e-3 * expected.abs().max(1e-3), "{found}, not {expected}");
}

#[test]
fn ages() {
    // One turn: the last beam is new, the first half a turn old, and the row a quarter.
    let one = beam_ages(&[0xB0], 181, Variant::Deg180Step1);
    assert_eq!((one.age_us(180), one.columns()), (0.0, 181));
    close(one.age_us(0), MIRROR_TURN_US / 2.0);
    close(one.mean_age_us(), MIRROR_TURN_US / 4.0);
    // Two turns: even columns are of the first, so one turn older.
    let two = beam_ages(&[0xB0], 361, Variant::Deg180Step05);
    close(two.age_us(360), MIRROR_TURN_US);
    close(two.age_us(359), MIRROR_TURN_US * 0.5 / 360.0);
    close(two.age_us(0), MIRROR_TURN_US * 1.5);
    close(two.mean_age_us(), MIRROR_TURN_US * 0.7514);
    // Four turns.
    let four = beam_ages(&[0xB0], 401, Variant::Deg100Step025);
    close(four.age_us(400), MIRROR_TURN_US * 3.0);
    close(four.age_us(397), MIRROR_TURN_US * (2.0 + 0.75 / 360.0));
    close(four.age_us(399), MIRROR_TURN_US * 0.25 / 360.0);
    // The half turns of an interlaced scan.
    let whole_degrees = beam_ages(&[0xB0], 181 | 0x2000, Variant::Deg180Step05);
    let half_degrees = beam_ages(&[0xB0], 180 | 0x2000 | 2 << 11, Variant::Deg180Step05);
    assert_eq!(whole_degrees.age_us(180), 0.0);
    close(half_degrees.age_us(179), MIRROR_TURN_US * 0.5 / 360.0);
    close(half_degrees.age_us(0), MIRROR_TURN_US * 179.5 / 360.0);
    // A sub-range counts its columns from its own first: here 90 to 99, of which 89 and 90 from
    // zero.
    let part = beam_ages(&[0xB7, 90, 0, 99, 0], 10, Variant::Deg180Step05);
    assert_eq!(part.age_us(0), two.age_us(89));
    assert_eq!(part.age_us(1), two.age_us(90));
}

/// Of a sub-range of columns that the variant does not have, the age of the row is still the mean
/// of those of its columns.
#[test]
fn ages_of_a_telegram_that_is_not_of_the_variant() {
    let beyond = beam_ages(&[0xB7, 0x49, 0x01, 0x4A, 0x01], 2, Variant::Deg100Step05);
    close(beyond.mean_age_us(), (beyond.age_us(0) + beyond.age_us(1)) / 2.0);
}

const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step05,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};

fn latch(turn_rad: f32, time_us: u64) -> Latch {
    Latch { turn_rad, time_us }
}

#[test]
fn rows() {
    let ages = beam_ages(&[0xB0], 361, Variant::Deg180Step05);
    let mut pairing = Pairing::new(&SETTINGS);
    pairing.start(500_000);
    assert_eq!(pairing.row(ages), None, "no sample yet");
    pairing.sample(latch(1.0, 1_000_100));
    pairing.start(1_000_000);
    assert_eq!(pairing.row(ages), None, "no rate yet");
    // A false start, and the true one after it. The sample in between is too near to the first.
    pairing.sample(latch(1.03, 1_010_100));
    pairing.start(1_010_000);
    pairing.sample(latch(1.1, 1_026_800));
    pairing.start(1_026_700);
    let row = pairing.row(ages).expect("row");
    let rate = 0.1 / 0.0267;
    close(row.rate_rad_per_s(), rate);
    // The sample was taken 100 us after the start byte.
    let sampled_late = 1e-4 * rate;
    for column in [0, 1, 180, 359, 360] {
        close(row.beam_turn_rad(column), 1.1 - sampled_late - rate * ages.age_us(column) / 1e6);
    }
    let drifts: f32 = (0..361).map(|column| row.drift_rad(column)).sum();
    assert!(drifts.abs() < 1e-3, "the row's angle is the mean of its beams'");
    assert_eq!(pairing.row(ages), None, "each row once");
    // A sample failed: the rate is taken over two periods.
    pairing.sample(latch(1.3, 1_080_200));
    pairing.start(1_080_100);
    close(pairing.row(ages).expect("row").rate_rad_per_s(), 0.2 / 0.0534);
    // Two failed: too long ago.
    pairing.sample(latch(1.6, 1_160_300));
    pairing.start(1_160_200);
    assert_eq!(pairing.row(ages), None);
    // The sample at the start byte failed: the rate does not simply go on.
    pairing.sample(latch(1.7, 1_187_000));
    pairing.start(1_213_700);
    assert_eq!(pairing.row(ages), None);
    // A clock that ran backwards.
    pairing.sample(latch(1.7, 1_000_000));
    pairing.start(1_000_000);
    assert_eq!(pairing.row(ages), None);
}

/// The tilt is sampled at each start byte, and every so often besides: on a tilt that turns evenly
/// the angle is always the true one. Also if the telegram is only found later, when the search goes
/// back.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn sampled_at_any_pace() {
    let ages = beam_ages(&[0xB0], 361, Variant::Deg180Step05);
    for every_us in [1_000, 7_300, 13_000, 26_667] {
        for found_after_us in [0, 5_000, 16_000] {
            let mut pairing = Pairing::new(&SETTINGS);
            let turn = |time_us: u64| 0.3 * time_us as f32 / 1e6;
            for start_us in (0..1_000_000u64).step_by(26_667) {
                let samples = start_us.saturating_sub(26_667) + found_after_us..=start_us + found_after_us;
                for time_us in samples.filter(|us| us % every_us == 0 || *us == start_us) {
                    pairing.sample(latch(turn(time_us), time_us));
                }
                pairing.start(start_us);
                let row = pairing.row(ages);
                assert!(row.is_some() || start_us < 110_000, "{every_us} {start_us}");
                if let Some(row) = row {
                    close(row.rate_rad_per_s(), 0.3);
                    let truth_rad = turn(start_us) - 0.3 * ages.mean_age_us() / 1e6;
                    assert!((row.turn_rad() - truth_rad).abs() < 1e-6, "{} {truth_rad}", row.turn_rad());
                }
            }
        }
    }
}

#[test]
fn across_the_seam() {
    let ages = beam_ages(&[0xB0], 361, Variant::Deg180Step05);
    for (before, now, step) in [(3.1, -3.1, 0.083_185), (-3.1, 3.1, -0.083_185), (6.2, 0.1, 0.183_185)] {
        let mut pairing = Pairing::new(&SETTINGS);
        pairing.sample(latch(before, 0));
        pairing.sample(latch(now, 50_000));
        pairing.start(50_000);
        close(pairing.row(ages).expect("row").rate_rad_per_s(), step * 20.0);
    }
}
