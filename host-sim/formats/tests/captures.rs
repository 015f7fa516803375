//! Captures as text: everything comes back, and what is no capture is refused with its line.

use scanseg_formats::capture::{Capture, CaptureError, CaptureEvent, HEAD};
use scanseg_hal::Latch;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Settings, Unit, Variant};
use scanseg_hal::rig::TiltLimits;

const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.3, max_rate_rad_per_s: 0.9, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };

fn every_settings() -> impl Iterator<Item = Settings> {
    Baud::ALL.into_iter().flat_map(|baud| {
        Variant::ALL.into_iter().flat_map(move |variant| {
            Unit::ALL.into_iter().flat_map(move |unit| {
                MeasuringMode::ALL.into_iter().flat_map(move |mode| {
                    [false, true].map(move |interlaced| Settings { baud, variant, unit, mode, interlaced })
                })
            })
        })
    })
}

#[test]
fn everything_comes_back() {
    for settings in every_settings() {
        let mut capture = Capture::new(settings, LIMITS);
        assert_eq!(Capture::parse(&capture.to_text()), Ok(capture.clone()));
        capture.events = vec![
            CaptureEvent::Tilt(Some(Latch { turn_rad: -0.1, time_us: 0 })),
            CaptureEvent::Tilt(None),
            CaptureEvent::Bytes { time_us: u64::MAX, bytes: (0..=255).collect() },
            CaptureEvent::Tilt(Some(Latch { turn_rad: f32::MIN_POSITIVE, time_us: u64::MAX })),
        ];
        assert_eq!(Capture::parse(&capture.to_text()), Ok(capture));
    }
}

#[test]
fn what_is_no_capture() {
    let good = Capture::new(every_settings().next().expect("one"), LIMITS).to_text();
    assert!(good.starts_with(HEAD) && Capture::parse(&good).is_ok());
    for (line, text) in [
        (1, format!(" {good}")),
        (2, good.replace("baud 9600", "baud 9601")),
        (2, good.replace("columns 101", "columns 100")),
        (2, good.replace("unit_mm 10", "unit_mm 11")),
        (2, good.replace("mode 0", "mode 7")),
        (2, good.replace("interlaced false", "interlaced no")),
        (2, good.replace(" interlaced false", "")),
        (3, good.replace("limits 0.3", "limits fast")),
        (4, good.clone() + "tilt 1"),
        (4, good.clone() + "tilt -1 0.5"),
        (4, good.clone() + "bytes 1 0"),
        (4, good.clone() + "bytes 1 0G"),
        (4, good.clone() + "bytes 18446744073709551616 00"),
        (5, good.clone() + "\nbyte 1 00\n"),
    ] {
        assert_eq!(Capture::parse(&text), Err(CaptureError::Line(line)), "{text}");
    }
    for version in ["2", "1.1", ""] {
        let other = good.replacen(HEAD, &format!("scanseg capture {version}"), 1);
        assert_eq!(Capture::parse(&other), Err(CaptureError::Version(version.into())));
    }
    assert_eq!(Capture::parse(HEAD), Err(CaptureError::Settings));
    assert_eq!(Capture::parse(""), Err(CaptureError::Settings));
}
