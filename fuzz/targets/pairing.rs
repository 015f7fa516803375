//! The tilt sampled at any times: whatever row gets a turn angle gets the right one, if the tilt
//! moves evenly.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_fuzz::scanner::{Piece, settings};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Settings, TelegramDecoder};
use scanseg_hal::pairing::{BeamAges, Pairing};

#[derive(Debug, Arbitrary)]
enum Event {
    /// After so many 16 us.
    Later(u16),
    /// At any time.
    At(u64),
    /// The tilt is sampled where it is.
    Sample,
    /// Or anywhere.
    Anywhere(f32),
    /// A telegram begins.
    Start,
    /// It is complete.
    Row,
}

#[derive(Debug)]
struct Input {
    settings: Settings,
    telegram: Vec<u8>,
    /// Within half a turn from sample to sample.
    rate: i8,
    from_rad: i8,
    events: Vec<Event>,
}

impl Arbitrary<'_> for Input {
    fn arbitrary(u: &mut Unstructured) -> Result<Input> {
        let settings = settings(u)?;
        let telegram = u.arbitrary::<Piece>()?.bytes(&settings);
        Ok(Input { settings, telegram, rate: u.arbitrary()?, from_rad: u.arbitrary()?, events: u.arbitrary()? })
    }
}

fuzz_target!(|input: Input| {
    let Input { settings, telegram, rate, from_rad, events } = input;
    let mut decoder = TelegramDecoder::new();
    _ = decoder.feed(&telegram);
    _ = decoder.feed(telegram.get(1..).unwrap_or(&[]));
    let Some(scan) = decoder.telegram().and_then(|telegram| telegram.scan_line()) else { return };
    let sweep = BeamAges::of(&scan, settings.variant);
    let period_us = f64::from(settings.period_us());
    let rate_rad_per_us = f64::from(rate) / 128.0 * std::f64::consts::PI / (2.5 * period_us);
    let at_rad = |time_us: f64| f64::from(from_rad) + rate_rad_per_us * time_us;

    let mut pairing = Pairing::new(&settings);
    let (mut now_us, mut start_us, mut is_even) = (1_000_000_u64, 0, true);
    for event in events {
        match event {
            Event::Later(by) => now_us = now_us.saturating_add(16 * u64::from(by)),
            Event::At(time_us) => {
                now_us = time_us;
                is_even &= time_us < 1 << 32;
            }
            Event::Sample => {
                pairing.sample(Latch { turn_rad: at_rad(now_us as f64) as f32, time_us: now_us });
            }
            Event::Anywhere(turn_rad) => {
                pairing.sample(Latch { turn_rad, time_us: now_us });
                is_even = false;
            }
            Event::Start => {
                start_us = now_us;
                pairing.start(start_us);
            }
            Event::Row => {
                let Some(row) = pairing.row(sweep) else { continue };
                let drifts = (0..sweep.columns()).map(|column| f64::from(row.drift_rad(column)));
                let drift_rad = drifts.sum::<f64>() / f64::from(sweep.columns().max(1));
                if !is_even {
                    continue;
                }
                let exact_rad = at_rad(start_us as f64 - f64::from(sweep.mean_age_us()));
                let digits_rad = f64::from(f32::EPSILON) * (10.0 + at_rad(now_us.max(start_us) as f64).abs());
                let off_rad = f64::from(row.turn_rad()) - exact_rad;
                assert!(off_rad.abs() < 100.0 * digits_rad, "{row:?} is off by {off_rad}");
                let rate_off = f64::from(row.rate_rad_per_s()) - 1e6 * rate_rad_per_us;
                assert!(rate_off.abs() < 1e6 * 10.0 * digits_rad / period_us, "{row:?}: rate off by {rate_off}");
                assert!(
                    drift_rad.abs() < 1e-6 + 1e-5 * rate_rad_per_us.abs() * period_us,
                    "{row:?}: drift {drift_rad}"
                );
            }
        }
    }
});
