//! Any bytes, and damaged packets, into each line scanner: rows are within their view, the counts
//! agree with the events, the pieces in which bytes come do not matter, and a rig takes the rows.
#![no_main]

use std::ops::ControlFlow;

use arbitrary::Arbitrary;
use libfuzzer_sys::fuzz_target;
use scanseg_core::{Finished, LabelRow, PushError, RowBeams, Segmenter, Sink, Status, TurnAxis};
use scanseg_fuzz::scanner::{self, Damage};
use scanseg_hal::Latch;
use scanseg_hal::ld06::{Ld06, Model};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Rows, SCAN_LINE, Session, Settings, Unit, Variant};
use scanseg_hal::rig::{Mount, Rig, RigSink, TiltLimits};
use scanseg_hal::rplidar::{Command, Format, Rplidar};
use scanseg_hal::scanner::{LineEvent, LineScanner, RowMemory, ScannerCounters, View};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};
use scanseg_virtual_rig::{VirtualLd06, VirtualRplidar};

#[derive(Clone, Copy, Debug, Arbitrary)]
enum Kind {
    Ld06,
    Stl27l,
    /// Waits for its descriptor.
    Rplidar,
    Node,
    Express,
    Dense,
    Lms,
    /// With partial scan lines.
    LmsInterlaced,
}

const LMS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};

const LMS_INTERLACED: Settings = Settings { variant: Variant::Deg100Step025, interlaced: true, ..LMS };

#[derive(Debug, Arbitrary)]
enum Piece {
    Bytes(Vec<u8>),
    /// So many packets of a scanner that works, the last of them damaged.
    Packets(u8, Damage),
    /// Of an LMS 2xx: sub-ranges, partial scan lines.
    Telegram(scanner::Piece),
    /// Microseconds.
    Later(u32),
}

#[derive(Debug, Arbitrary)]
struct Input {
    kind: Kind,
    room: u8,
    left_rad: i8,
    width_rad: u8,
    at_once: u8,
    pieces: Vec<Piece>,
}

/// Checks the beams of each row.
struct Checks;

impl Segmenter for Checks {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        for (range_m, u) in ranges_m.iter().zip(beams.into().directions) {
            let square: f32 = u.iter().map(|x| x * x).sum();
            assert!(*range_m == 0.0 || (*range_m > 0.0 && (square - 1.0).abs() < 1e-5), "{range_m} {u:?}");
        }
        Ok(Status::Buffered)
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        Finished::Stopped
    }

    fn reset(&mut self) {}

    fn latency_rows(&self) -> usize {
        0
    }
}

struct Nothing;

impl Sink for Nothing {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }
}

impl RigSink for Nothing {}

/// What was found: rows, rejected beginnings.
type Found = (u32, u32);

/// Feeds bytes to a scanner, so many at once. Checks rows and counts.
fn feed<S: LineScanner>(scanner: &mut S, bytes: &[(u64, Vec<u8>)], view: Option<View>, at_once: usize) -> Found {
    let (mut rows, mut rejected) = (0, 0);
    for (now_us, bytes) in bytes {
        for piece in bytes.chunks(at_once) {
            let mut rest = piece;
            loop {
                let (used, event) = scanner.feed(rest, *now_us);
                rest = &rest[used..];
                match event {
                    LineEvent::NeedMore => break,
                    LineEvent::Rejected(_) => rejected += 1,
                    LineEvent::Row => {
                        rows += 1;
                        let Some(row) = scanner.row() else { continue };
                        assert_eq!(row.angles_rad.len(), row.ranges_m.len());
                        assert!(row.ranges_m.iter().all(|range_m| (0.0..100.0).contains(range_m)));
                        let ages = (0..row.angles_rad.len()).map(|beam| row.beam_age_us(beam));
                        assert!(ages.into_iter().all(|age_us| age_us >= 0.0 && age_us.is_finite()));
                        if let Some(View { left_rad, width_rad }) = view {
                            let within = left_rad - width_rad - 0.001..=left_rad + 0.001;
                            assert!(row.angles_rad.iter().all(|angle_rad| within.contains(angle_rad)), "{row:?}");
                        }
                    }
                }
            }
            assert!(rest.is_empty());
        }
    }
    let counters = scanner.counters();
    assert_eq!((counters.rows, counters.rejected), (rows, rejected), "{counters:?}");
    (rows, rejected)
}

/// Runs a scanner twice on its own, in pieces and whole, and with a rig.
fn check<S: LineScanner>(input: &Input, view: Option<View>, bytes: &[(u64, Vec<u8>)], scanners: [S; 3]) {
    let [mut one, mut other, mut third] = scanners;
    feed(&mut one, bytes, view, usize::from(input.at_once).max(1));
    let whole = feed(&mut other, bytes, view, usize::MAX);
    let counted = |counters: ScannerCounters| (counters.packets, counters.rejected);
    assert_eq!(counted(one.counters()), counted(other.counters()));

    let mount = Mount {
        axis: if input.room & 1 == 0 { TurnAxis::Z } else { TurnAxis::Y },
        columns: u16::from(input.room) + 1,
        start_rad: f32::from(input.left_rad) / 40.0,
        step_rad: -0.01,
        lever_arm_m: f32::from(input.left_rad) / 100.0,
        row_us: 100_000,
    };
    let limits = TiltLimits { min_rate_rad_per_s: 0.1, max_rate_rad_per_s: 0.5, sweep_rad: 1.0, pause_us: 400_000 };
    let mut rows_m = vec![0.0; 8 * usize::from(mount.columns)];
    let mut rig = Rig::mounted(mount, limits, Checks, &mut rows_m).expect("a rig");
    for (now_us, bytes) in bytes {
        rig.tilt(Some(Latch { turn_rad: (*now_us as f64 * 0.2e-6 % 6.0) as f32, time_us: *now_us }));
        rig.receive(&mut third, bytes, *now_us, &mut Nothing);
        rig.idle(*now_us, &mut Nothing);
    }
    rig.finish(&mut Nothing);
    let counters = rig.counters();
    assert_eq!(counters.telegrams, counters.rows + counters.dropped(), "{counters:?}");
    assert_eq!((counters.telegrams, counters.rejected), whole);
}

fuzz_target!(|input: Input| {
    let mut ld06 = VirtualLd06::new(Model::Ld06, 10.0, |bearing_deg, _| bearing_deg as u16 * 20);
    let mut stl27l = VirtualLd06::new(Model::Stl27l, 10.0, |bearing_deg, _| bearing_deg as u16 * 20);
    let express = if matches!(input.kind, Kind::Express) { Format::Express } else { Format::Dense };
    let mut rplidar = VirtualRplidar::new(express, 4000.0, 8.0, 460_800, |bearing_deg, _| bearing_deg as u16 * 20);
    let scan = if matches!(input.kind, Kind::Node) { Command::Scan } else { Command::ExpressScan { mode: 0 } };
    let descriptor = rplidar.command(scan.encode().as_slice());
    let mut next = || match input.kind {
        Kind::Ld06 => ld06.next_packet().1.to_vec(),
        Kind::Stl27l => stl27l.next_packet().1.to_vec(),
        Kind::Lms | Kind::LmsInterlaced => frame(&scan_payload(&[SCAN_LINE], 181 | 1 << 14, &[3000; 181], &[], 0x10)),
        _ => rplidar.next_packet().expect("it scans").1,
    };
    let mut now_us = 1_000_000;
    let mut bytes = vec![];
    if matches!(input.kind, Kind::Rplidar) {
        bytes.push((now_us, descriptor));
    }
    for piece in &input.pieces {
        match piece {
            Piece::Bytes(came) => bytes.push((now_us, came.clone())),
            Piece::Telegram(telegram) => {
                let settings = if matches!(input.kind, Kind::Lms) { LMS } else { LMS_INTERLACED };
                now_us += 13_333;
                bytes.push((now_us, telegram.bytes(&settings)));
            }
            Piece::Later(us) => now_us += u64::from(*us),
            Piece::Packets(count, damage) => {
                for left in (0..*count).rev() {
                    let mut packet = next();
                    now_us += 2667;
                    if left == 0 {
                        damage.strike(&mut packet);
                    }
                    bytes.push((now_us, packet));
                }
            }
        }
    }
    let view = View { left_rad: f32::from(input.left_rad) / 40.0, width_rad: f32::from(input.width_rad) / 40.0 + 0.01 };
    let mut space = vec![0.0; 6 * 4 * usize::from(input.room)];
    let mut rows = space.chunks_exact_mut((4 * usize::from(input.room)).max(1));
    let memories = [(); 3]
        .map(|()| RowMemory { angles_rad: rows.next().unwrap_or_default(), ranges_m: rows.next().unwrap_or_default() });
    let rplidars = |format| move |memory| Rplidar::listening(format, 460_800, view, memory);
    let seen = Some(view);
    match input.kind {
        Kind::Ld06 => check(&input, seen, &bytes, memories.map(|memory| Ld06::new(Model::Ld06, view, memory))),
        Kind::Stl27l => check(&input, seen, &bytes, memories.map(|memory| Ld06::new(Model::Stl27l, view, memory))),
        Kind::Rplidar => check(&input, seen, &bytes, memories.map(|memory| Rplidar::new(460_800, view, memory))),
        Kind::Node => check(&input, seen, &bytes, memories.map(rplidars(Format::Node))),
        Kind::Express => check(&input, seen, &bytes, memories.map(rplidars(Format::Express))),
        Kind::Dense => check(&input, seen, &bytes, memories.map(rplidars(Format::Dense))),
        Kind::Lms => check(&input, None, &bytes, memories.map(|memory| Rows::new(Session::listening(LMS), memory))),
        Kind::LmsInterlaced => {
            let rows = |memory| Rows::new(Session::listening(LMS_INTERLACED), memory);
            check(&input, None, &bytes, memories.map(rows));
        }
    }
});
