//! An LD06 or RPLIDAR that stands upright on a panning servo, as PiLiDAR has it: the origin of the
//! beams lies 37.5 mm beside the axis, the servo goes half a turn to and fro, and an encoder tells
//! where it is. The room is a box.

use std::collections::BTreeMap;
use std::f64::consts::{PI, TAU};
use std::ops::ControlFlow;

use scanseg_core::{Join, LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Sink, TurnAxis, buffers};
use scanseg_hal::Latch;
use scanseg_hal::ld06::{Ld06, Model};
use scanseg_hal::rig::{Counters, End, Mount, Rig, RigSink, ScanFinished, TiltLimits};
use scanseg_hal::rplidar::{Command, Format, Rplidar};
use scanseg_hal::scanner::{LineScanner, RowMemory, View};
use scanseg_virtual_rig::{VirtualLd06, VirtualRplidar, WireFaults, Wires};

const COLUMNS: usize = 450;
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::LD06);
const LEVER_ARM_M: f64 = 0.0375;
/// Radians a second, half a turn each way.
const RATE: f64 = 0.15;
const LIMITS: TiltLimits =
    TiltLimits { min_rate_rad_per_s: 0.05, max_rate_rad_per_s: 0.3, sweep_rad: 3.2, pause_us: 1_000_000 };
const ALL: WireFaults = WireFaults { drop_one_in: 100, flip_one_in: 100, insert_one_in: 100, burst_one_in: 0 };
const FEW: WireFaults = WireFaults { drop_one_in: 1000, flip_one_in: 1000, insert_one_in: 1000, burst_one_in: 0 };

/// Normals of the walls, outward, and their distances from the axis, metres.
const WALLS: [([f64; 3], f64); 6] = [
    ([0.955_336, 0.295_520, 0.0], 2.5),
    ([-0.955_336, -0.295_520, 0.0], 2.0),
    ([-0.295_520, 0.955_336, 0.0], 1.6),
    ([0.295_520, -0.955_336, 0.0], 1.9),
    ([0.0, 0.0, 1.0], 1.3),
    ([0.0, 0.0, -1.0], 1.1),
];

/// Where the servo is.
fn pan_rad(time_us: f64) -> f64 {
    let phase = (time_us * 1e-6 * RATE / PI).rem_euclid(2.0);
    PI * if phase < 1.0 { phase } else { 2.0 - phase }
}

/// What the scanner measures, clockwise from ahead, which is level; millimetres with noise of 5 mm.
fn room() -> impl FnMut(f64, f64) -> u16 + 'static {
    let mut random = 1u64;
    let mut even = move || {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as f64 / (1u64 << 31) as f64 - 0.5
    };
    move |bearing_deg, time_us| {
        let ((sin, cos), (turn_sin, turn_cos)) = ((-bearing_deg).to_radians().sin_cos(), pan_rad(time_us).sin_cos());
        let beam = [cos * turn_cos, cos * turn_sin, sin];
        let origin = [LEVER_ARM_M * turn_cos, LEVER_ARM_M * turn_sin, 0.0];
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let to_wall = WALLS.map(|(normal, distance_m)| (distance_m - dot(normal, origin)) / dot(normal, beam));
        let range_m = to_wall.into_iter().filter(|&range_m| range_m > 0.0).fold(f64::MAX, f64::min);
        let noise_m = 0.005 * 2.0 * (even() + even() + even());
        ((range_m + noise_m) * 1000.0).round() as u16
    }
}

/// The segments of each scan, joined.
#[derive(Default)]
struct Scans {
    segments: BTreeMap<u32, Segment>,
    scans: Vec<(ScanFinished, Vec<Segment>)>,
}

impl Sink for Scans {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.segments.remove(&join.from.0);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.insert(segment.label.0, *segment);
        ControlFlow::Continue(())
    }
}

impl RigSink for Scans {
    fn scan_finished(&mut self, scan: &ScanFinished) {
        let segments = std::mem::take(&mut self.segments);
        self.scans.push((*scan, segments.into_values().collect()));
    }
}

impl Scans {
    /// Returns, of a scan, which part of the pixels of large segments lies on each wall. Each large
    /// segment lies on one.
    fn check(&self, scan: usize, name: &str, within: (f64, f64)) -> [u32; 6] {
        let mut of_wall = [0; 6];
        let (mut worst_mm, mut worst_deg) = (0f64, 0f64);
        for segment in self.scans[scan].1.iter().filter(|segment| segment.pixels() >= 500) {
            let plane = segment.plane().expect("a plane");
            let normal = plane.normal.map(f64::from);
            let along = |wall: [f64; 3]| (0..3).map(|i| -wall[i] * normal[i]).sum::<f64>();
            let nearest = (0..6).max_by(|&a, &b| along(WALLS[a].0).total_cmp(&along(WALLS[b].0))).unwrap();
            let cross = |a: [f64; 3], b: [f64; 3]| {
                [0, 1, 2].map(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
            };
            let off_deg = cross(WALLS[nearest].0, normal).iter().map(|x| x * x).sum::<f64>().sqrt().to_degrees();
            let off_mm = 1000.0 * (f64::from(plane.distance_m) - WALLS[nearest].1).abs();
            (worst_mm, worst_deg) = (worst_mm.max(off_mm), worst_deg.max(off_deg));
            of_wall[nearest] += segment.pixels();
        }
        println!("{name}: at most {worst_mm:.1} mm, {worst_deg:.2} deg: {of_wall:?}");
        assert!(worst_mm < within.0 && worst_deg < within.1, "{name}: {worst_mm} mm, {worst_deg} deg");
        of_wall
    }
}

/// What was sent.
#[derive(Default)]
struct Sent {
    packets: u32,
    whole: u32,
}

/// Runs a scanner for some seconds. The tilt is sampled when bytes come, to 14 bits.
fn run(
    scanner: &mut impl LineScanner,
    packets: impl Iterator<Item = (u64, Vec<u8>)>,
    faults: WireFaults,
    mount: Mount,
) -> (Scans, Counters, Sent) {
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let segmenter = PlaneSegmenter::new(CONFIG, mount.beams(), COLUMNS, buffers.memory()).expect("a segmenter");
    let mut rows_m = vec![0.0; 8 * COLUMNS];
    let mut rig = Rig::mounted(mount, LIMITS, segmenter, &mut rows_m).expect("a rig");
    let (mut scans, mut sent, mut wires) = (Scans::default(), Sent::default(), Wires::default());
    wires.faults = faults;
    for (now_us, packet) in packets {
        let came: Vec<u8> = packet.iter().flat_map(|&byte| wires.damage(byte)).collect();
        sent.packets += 1;
        sent.whole += u32::from(came.starts_with(&packet));
        let counts = (pan_rad(now_us as f64) / TAU * 16384.0).round();
        rig.tilt(Some(Latch { turn_rad: (counts / 16384.0 * TAU) as f32, time_us: now_us }));
        rig.receive(scanner, &came, now_us, &mut scans);
        rig.idle(now_us, &mut scans);
    }
    rig.finish(&mut scans);
    let counters = rig.counters();
    let found = scanner.counters();
    assert_eq!(counters.telegrams, counters.rows + counters.dropped(), "{counters:?}");
    assert_eq!((counters.telegrams, counters.lost, counters.rejected), (found.rows, found.lost, found.rejected));
    assert_eq!(found.dropped_beams, 0);
    println!("{counters:?}, {found:?}, {} of {} whole", sent.whole, sent.packets);
    assert!(found.packets >= sent.whole, "every whole packet is used");
    // one may be on its way
    let counted = found.packets + found.lost;
    assert!(counted.abs_diff(sent.packets) <= sent.packets / 200, "{counted} counted, {} sent", sent.packets);
    (scans, counters, sent)
}

/// 40 s: a sweep of half a turn takes 21 s.
const SECONDS: u64 = 40;

fn ld06(faults: WireFaults) -> (Scans, Counters, Sent) {
    let mut ld06 = VirtualLd06::new(Model::Ld06, 10.07, room());
    let packets = std::iter::from_fn(|| Some(ld06.next_packet()))
        .map(|(us, packet)| (us, packet.to_vec()))
        .take_while(|(us, _)| *us < SECONDS * 1_000_000);
    let (mut angles_rad, mut ranges_m) = ([0.0; 500], [0.0; 500]);
    let memory = RowMemory { angles_rad: &mut angles_rad, ranges_m: &mut ranges_m };
    let mut scanner = Ld06::new(Model::Ld06, View::FULL, memory);
    run(&mut scanner, packets, faults, MOUNT)
}

const MOUNT: Mount = Mount {
    axis: TurnAxis::Z,
    columns: COLUMNS as u16,
    start_rad: std::f32::consts::PI,
    step_rad: -std::f32::consts::TAU / COLUMNS as f32,
    lever_arm_m: LEVER_ARM_M as f32,
    row_us: 100_000,
};

#[test]
fn ld06_in_a_room() {
    let (scans, counters, _) = ld06(WireFaults::default());
    assert_eq!((counters.lost, counters.rejected, counters.jump, counters.standing), (0, 0, 0, 0));
    // a sweep that has covered half a turn is over when the servo turns back
    let ends: Vec<End> = scans.scans.iter().map(|(scan, _)| scan.end).collect();
    assert_eq!(ends, [End::Turned, End::Asked]);
    let (scan, _) = &scans.scans[0];
    assert!((205..=211).contains(&scan.rows), "{}", scan.rows);
    let of_wall = scans.check(0, "LD06", (1.0, 0.05));
    assert!(of_wall.iter().sum::<u32>() > 85_000, "{of_wall:?}");
    assert!(of_wall.iter().all(|&pixels| pixels > 4500), "{of_wall:?}");
}

#[test]
fn ld06_with_faults() {
    for (name, faults) in [("1 in 1000", FEW), ("1 in 100", ALL)] {
        let (scans, counters, sent) = ld06(faults);
        // the servo is known at every row
        assert_eq!((counters.no_turn, counters.dropped()), (1, 1));
        let of_wall = scans.check(0, name, (3.0, 0.2));
        let whole = f64::from(sent.whole) / f64::from(sent.packets);
        let found = f64::from(of_wall.iter().sum::<u32>()) / (206.0 * COLUMNS as f64);
        assert!(found > 0.9 * whole && of_wall.iter().all(|&pixels| pixels > 500), "{found} of {whole}: {of_wall:?}");
    }
}

#[test]
fn rplidar_in_a_room() {
    for (name, faults) in [("none", WireFaults::default()), ("1 in 1000", FEW)] {
        let mut rplidar = VirtualRplidar::new(Format::Dense, 4400.0, 9.9, 460_800, room());
        rplidar.command(Command::ExpressScan { mode: 0 }.encode().as_slice());
        let packets = std::iter::from_fn(|| rplidar.next_packet()).take_while(|(us, _)| *us < SECONDS * 1_000_000);
        let (mut angles_rad, mut ranges_m) = ([0.0; 500], [0.0; 500]);
        let memory = RowMemory { angles_rad: &mut angles_rad, ranges_m: &mut ranges_m };
        let mut scanner = Rplidar::listening(Format::Dense, 460_800, View::FULL, memory);
        let (scans, ..) = run(&mut scanner, packets, faults, MOUNT);
        let of_wall = scans.check(0, name, (1.0, 0.1));
        assert!(of_wall.iter().sum::<u32>() > 65_000, "{of_wall:?}");
    }
}

#[test]
fn wrong_mounts() {
    let error = |mount: Mount, numbers: usize| {
        let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
        let segmenter = PlaneSegmenter::new(CONFIG, MOUNT.beams(), COLUMNS, buffers.memory()).expect("a segmenter");
        Rig::mounted(mount, LIMITS, segmenter, &mut vec![0.0; numbers]).err().map(|error| error.to_string())
    };
    assert_eq!(error(MOUNT, 8 * COLUMNS), None);
    assert_eq!(error(MOUNT, 3599).as_deref(), Some("rows need memory for 3600 numbers, got 3599"));
    for (mount, says) in [
        (Mount { columns: 0, ..MOUNT }, "columns of a mount cannot be 0"),
        (Mount { start_rad: 7.0, ..MOUNT }, "start_rad of a mount cannot be 7"),
        (Mount { step_rad: 0.0, ..MOUNT }, "step_rad of a mount cannot be 0"),
        (Mount { step_rad: f32::NAN, ..MOUNT }, "step_rad of a mount cannot be NaN"),
        (Mount { lever_arm_m: -11.0, ..MOUNT }, "lever_arm_m of a mount cannot be -11"),
        (Mount { row_us: 0, ..MOUNT }, "row_us of a mount cannot be 0"),
        (Mount { row_us: 400_000, ..MOUNT }, "pause must be 1200000 us or more, is 1000000"),
    ] {
        assert_eq!(error(mount, 8 * COLUMNS).as_deref(), Some(says));
    }
}
