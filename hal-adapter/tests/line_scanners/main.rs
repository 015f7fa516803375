//! LD06 and RPLIDAR: recorded bytes, rows, and wires with faults.

mod faults;

use std::path::Path;

use scanseg_hal::ld06::{BEAMS, LENGTH, Ld06, Model, PacketError};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Rows, Session, Settings, TelegramError, Unit, Variant};
use scanseg_hal::pairing::BeamAges;
use scanseg_hal::rplidar::{Command, Format, Rplidar};
use scanseg_hal::scanner::{LineEvent, LineScanner, Row, RowMemory, View};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};
use scanseg_virtual_rig::{VirtualLd06, VirtualRplidar, WireFaults, Wires, behind_q3};

const MOST: usize = 5000;

/// A row of its own.
#[derive(Clone, Debug, PartialEq)]
struct Kept {
    angles_rad: Vec<f32>,
    ranges_m: Vec<f32>,
    end_us: u64,
    mirror_turn_us: f32,
}

/// Memory for rows that lives as long as the test.
fn memory(beams: usize) -> RowMemory<'static> {
    RowMemory { angles_rad: vec![0.0; beams].leak(), ranges_m: vec![0.0; beams].leak() }
}

/// Feeds bytes in pieces of these sizes over and over. Returns rows and errors.
fn feed<S: LineScanner>(scanner: &mut S, bytes: &[u8], pieces: &[usize]) -> (Vec<Kept>, Vec<S::Error>) {
    let (mut rows, mut errors) = (vec![], vec![]);
    let (mut at, mut sizes) = (0, pieces.iter().cycle());
    while at < bytes.len() {
        let end = (at + sizes.next().unwrap()).min(bytes.len());
        while let (used, event) = scanner.feed(&bytes[at..end], 0)
            && note(event, scanner, &mut rows, &mut errors)
        {
            at += used;
        }
        at = end;
    }
    (rows, errors)
}

/// Notes an event. Returns whether there may be more.
fn note<S: LineScanner>(
    event: LineEvent<S::Error>,
    scanner: &S,
    rows: &mut Vec<Kept>,
    errors: &mut Vec<S::Error>,
) -> bool {
    match event {
        LineEvent::NeedMore => return false,
        LineEvent::Row => {
            let row = scanner.row().expect("a row");
            let (angles_rad, ranges_m) = (row.angles_rad.to_vec(), row.ranges_m.to_vec());
            rows.push(Kept { angles_rad, ranges_m, end_us: row.end_us, mirror_turn_us: row.mirror_turn_us });
        }
        LineEvent::Rejected(error) => {
            assert_eq!(scanner.row(), None);
            errors.push(error);
        }
    }
    true
}

fn recorded(file: &str) -> Option<Vec<u8>> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/data/ld06-uart").join(file);
    let bytes = std::fs::read(&path).ok();
    if bytes.is_none() {
        println!("skipped: no {}", path.display());
    }
    bytes
}

/// The ranges of the recorded packets, read by their places in the file.
#[test]
#[cfg_attr(miri, ignore = "reads a file")]
fn recorded_ld06() {
    let Some(bytes) = recorded("ld06_example3.bin") else { return };
    let mut scanner = Ld06::new(Model::Ld06, View::FULL, memory(MOST));
    let (rows, errors) = feed(&mut scanner, &bytes, &[61, 7, 300]);
    let counters = scanner.counters();
    assert_eq!((counters.packets, counters.lost, counters.dropped_beams, errors.len()), (863, 0, 0, 0));
    assert_eq!(counters.rows as usize, rows.len());
    let packets = bytes[30..].chunks_exact(LENGTH);
    let ranges_m = packets.flat_map(|packet| {
        (0..BEAMS).map(|beam| f32::from(u16::from_le_bytes([packet[6 + 3 * beam], packet[7 + 3 * beam]])) / 1000.0)
    });
    let in_rows: Vec<f32> = rows.iter().flat_map(|row| row.ranges_m.clone()).collect();
    assert!(ranges_m.take(in_rows.len()).eq(in_rows.iter().copied()), "every beam, in order");
    // 22.8 turns from 311 degrees on; the last, which is not over, is no row yet
    assert_eq!(rows.len(), 23);
    for row in &rows[1..] {
        assert!((453..=457).contains(&row.ranges_m.len()), "{}", row.ranges_m.len());
        assert!(row.angles_rad.is_sorted_by(|a, b| a > b));
        assert!((row.mirror_turn_us - 100_000.0).abs() < 500.0);
    }
}

/// A piece of nonsense that passes its CRC, but not what it says.
#[test]
#[cfg_attr(miri, ignore = "reads a file")]
fn nonsense_ld06() {
    let Some(bytes) = recorded("ld06_bad_data.bin") else { return };
    let mut scanner = Ld06::new(Model::Ld06, View::FULL, memory(MOST));
    let (rows, errors) = feed(&mut scanner, &bytes, &[64]);
    assert_eq!((rows.len(), scanner.counters().packets), (0, 0));
    let refused: Vec<_> = errors.iter().filter(|error| !matches!(error, PacketError::Check { .. })).collect();
    assert_eq!(refused, [&PacketError::Speed(8202)]);
    assert_eq!(scanner.counters().rejected as usize, errors.len());
}

/// The packet printed in the manual.
#[test]
fn manual_ld06() {
    let words = "54 2C 68 08 AB 7E E0 00 E4 DC 00 E2 D9 00 E5 D5 00 E3 D3 00 E4 D0 00 E9 CD 00 E4 CA 00 E2 C7 00 E9 \
                 C5 00 E5 C2 00 E5 C0 00 E5 BE 82 3A 1A 50";
    let bytes: Vec<u8> = words.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect();
    let mut scanner = Ld06::new(Model::Ld06, View::FULL, memory(MOST));
    feed(&mut scanner, &bytes, &[1]);
    let packet = scanner.last_packet().expect("a packet");
    assert_eq!((packet.speed_deg_per_s(), packet.start_cdeg(), packet.end_cdeg()), (2152, 32_427, 33_470));
    assert_eq!((packet.time_ms(), packet.beam(0), packet.beam(11)), (6714, (224, 228), (192, 229)));
    assert_eq!(packet.beam(12), (0, 0));
}

/// What is fed in one piece or in many is the same.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn pieces_do_not_matter() {
    let mut ld06 = VirtualLd06::new(Model::Ld06, 10.0, |bearing_deg, _| 1000 + bearing_deg as u16);
    let mut wires = wires(EVERY_HUNDREDTH);
    let bytes: Vec<u8> = (0..500).flat_map(|_| ld06.next_packet().1).flat_map(|byte| wires.damage(byte)).collect();
    let run = |pieces: &[usize]| feed(&mut Ld06::new(Model::Ld06, VIEW, memory(MOST)), &bytes, pieces);
    assert_eq!(run(&[1]).1, run(&[4096]).1);
    assert_eq!(run(&[1]).0.len(), run(&[33, 2, 90]).0.len());
    for format in [Format::Node, Format::Express, Format::Dense] {
        let (bytes, _) = rplidar(format, 300, &mut wires);
        let run = |pieces: &[usize]| feed(&mut Rplidar::new(115_200, VIEW, memory(MOST)), &bytes, pieces);
        assert_eq!(run(&[1]).1, run(&[4096]).1);
        assert_eq!(run(&[1]).0.len(), run(&[33, 2, 90]).0.len());
    }
}

fn wires(faults: WireFaults) -> Wires {
    let mut wires = Wires::default();
    wires.faults = faults;
    wires
}

const EVERY_HUNDREDTH: WireFaults =
    WireFaults { drop_one_in: 300, flip_one_in: 300, insert_one_in: 300, burst_one_in: 0 };
/// 135 degrees to the left to 45 to the right.
const VIEW: View = View { left_rad: 135.0 * RAD, width_rad: 180.0 * RAD };
const RAD: f32 = std::f32::consts::PI / 180.0;

/// A square room, 3 m by 3 m about the scanner.
fn room_mm(bearing_deg: f64) -> f64 {
    let (sin, cos) = bearing_deg.to_radians().sin_cos();
    1500.0 / sin.abs().max(cos.abs())
}

/// Checks beams against the room. Their angles are right to `off_rad`.
fn check_room(row: &Kept, off_rad: f64) {
    for (&angle_rad, &range_m) in row.angles_rad.iter().zip(&row.ranges_m) {
        let ranges = [-off_rad, 0.0, off_rad].map(|off| room_mm(-(f64::from(angle_rad) + off).to_degrees()) / 1000.0);
        let (low, high) = ranges.iter().fold((f64::MAX, 0.0f64), |(low, high), &r| (low.min(r), high.max(r)));
        assert!((low - 0.0015..=high + 0.0015).contains(&f64::from(range_m)), "{range_m} at {angle_rad} of {ranges:?}");
    }
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn rows_are_cut_to_the_view() {
    for (model, turns_per_s) in [(Model::Ld06, 10.0), (Model::Ld06, 6.1), (Model::Stl27l, 10.0)] {
        let mut virtual_scanner = VirtualLd06::new(model, turns_per_s, |bearing_deg, _| room_mm(bearing_deg) as u16);
        let mut scanner = Ld06::new(model, VIEW, memory(MOST));
        let mut rows = vec![];
        for _ in 0..4 * model.beams_per_s() / 12 {
            let (time_us, bytes) = virtual_scanner.next_packet();
            let mut rest = &bytes[..];
            while let (used, event) = scanner.feed(rest, time_us)
                && note(event, &scanner, &mut rows, &mut vec![])
            {
                rest = &rest[used..];
            }
        }
        assert!(rows.len() as f64 >= 4.0 * turns_per_s - 2.0, "{}", rows.len());
        for (number, row) in rows.iter().enumerate().skip(1) {
            let beams = f64::from(model.beams_per_s()) / turns_per_s / 2.0;
            assert!((row.angles_rad.len() as f64 - beams).abs() <= 1.5, "{} of {beams}", row.angles_rad.len());
            assert!(row.angles_rad.iter().all(|angle| (-45.01 * RAD..=135.01 * RAD).contains(angle)));
            check_room(row, 0.0003);
            // the mirror looked 45 degrees to the right for the first time after 1/8 of a turn
            let end_us = (number as f64 + 0.125) / turns_per_s * 1e6;
            let beam_us = 1e6 / f64::from(model.beams_per_s());
            assert!((row.end_us as f64 - end_us).abs() < 1.5 * beam_us + 50.0, "{} {end_us}", row.end_us);
        }
    }
}

/// Beams in one column, columns without a beam, beams beside the columns.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn rows_become_columns() {
    let bytes: Vec<u8> = {
        let mut scanner = VirtualLd06::new(Model::Ld06, 10.0, |bearing_deg, _| room_mm(bearing_deg) as u16);
        (0..100).flat_map(|_| scanner.next_packet().1).collect()
    };
    let mut scanner = Ld06::new(Model::Ld06, VIEW, memory(MOST));
    let (rows, _) = feed(&mut scanner, &bytes, &[100]);
    let Kept { angles_rad, ranges_m, end_us, mirror_turn_us } = &rows[1];
    let (end_us, mirror_turn_us) = (*end_us, *mirror_turn_us);
    let row = Row { angles_rad, ranges_m, end_us, mirror_turn_us, merged_turns: 1, first_turn: 0 };
    assert!((row.beam_age_us(0) - 50_000.0).abs() < 300.0);
    for (step_deg, columns) in [(0.8f32, 226), (-0.8, 226), (0.4, 451), (1.0, 181), (1.0, 90)] {
        let start_rad = if step_deg > 0.0 { -45.0 * RAD } else { 135.0 * RAD };
        let (mut angles_rad, mut ranges_m) = (vec![0.0; columns], vec![0.0; columns]);
        row.to_columns(start_rad, step_deg * RAD, &mut angles_rad, &mut ranges_m);
        let taken = ranges_m.iter().filter(|range_m| **range_m > 0.0).count();
        let most = columns.min(row.ranges_m.len());
        assert!(taken >= most - 2 && taken <= most, "{taken} of {most} at {step_deg}");
        for column in 0..columns {
            let off_rad = angles_rad[column] - (start_rad + column as f32 * step_deg * RAD);
            assert!(off_rad.abs() <= 0.5001 * step_deg.abs() * RAD);
            let at = row.angles_rad.iter().position(|angle| *angle == angles_rad[column]);
            assert_eq!(ranges_m[column], at.map_or(0.0, |at| row.ranges_m[at]));
        }
    }
}

/// The bytes of a scan: descriptor, then packets. Ranges tell the beam.
fn rplidar(format: Format, count: usize, wires: &mut Wires) -> (Vec<u8>, Vec<Vec<u8>>) {
    let (beams_per_s, express) = match format {
        Format::Node => (2000.0, Format::Express),
        Format::Express => (4000.0, Format::Express),
        Format::Dense => (32_000.0, Format::Dense),
    };
    let mut scanner =
        VirtualRplidar::new(express, beams_per_s, 8.0, 115_200, |bearing_deg, _| room_mm(bearing_deg) as u16);
    let command = if format == Format::Node { Command::Scan } else { Command::ExpressScan { mode: 0 } };
    assert!(scanner.next_packet().is_none());
    assert!(scanner.command(Command::Stop.encode().as_slice()).is_empty());
    let mut bytes = scanner.command(command.encode().as_slice());
    let packets: Vec<Vec<u8>> = (0..count).map(|_| scanner.next_packet().expect("it scans").1).collect();
    bytes.extend(packets.concat().into_iter().flat_map(|byte| wires.damage(byte)));
    (bytes, packets)
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn rplidar_rows() {
    for (format, packets, off_rad) in
        [(Format::Node, 3000, 0.0003), (Format::Express, 200, 0.0025), (Format::Dense, 800, 0.0004)]
    {
        let (bytes, _) = rplidar(format, packets, &mut Wires::default());
        let mut scanner = Rplidar::new(115_200, VIEW, memory(MOST));
        let (rows, errors) = feed(&mut scanner, &bytes, &[50]);
        let counters = scanner.counters();
        assert_eq!(scanner.format(), Some(format));
        // the last nodes wait for more
        let taken = packets - if format == Format::Node { 2 } else { 0 };
        assert_eq!((counters.packets as usize, counters.lost, errors.len()), (taken, 0, 0), "{format:?}");
        assert_eq!(counters.dropped_beams, 0);
        assert!(rows.len() >= 6, "{format:?}: {} rows", rows.len());
        for row in &rows[1..] {
            if format == Format::Express {
                // beams are measured at their own angles, and the room is seen at those of even beams
                let even: Vec<f32> = row
                    .angles_rad
                    .iter()
                    .zip(&row.ranges_m)
                    .map(|(angle_rad, range_m)| {
                        angle_rad - f32::from(behind_q3((range_m * 1000.0).round() as u16)) / 8.0 * RAD
                    })
                    .collect();
                check_room(&Kept { angles_rad: even, ..row.clone() }, off_rad);
            } else {
                check_room(row, off_rad);
            }
        }
    }
}

/// The descriptor of something else is refused, and that of the scan found behind it.
#[test]
fn descriptors() {
    let mut scanner = Rplidar::new(115_200, VIEW, memory(10));
    let health = [0xA5, 0x5A, 3, 0, 0, 0, 6, 0, 0, 0];
    let dense = [0xA5, 0x5A, 84, 0, 0, 0x40, 0x85];
    let (_, errors) = feed(&mut scanner, &[&health[..], &[0xA5], &dense].concat(), &[3]);
    assert_eq!(errors.len(), 1);
    assert_eq!(scanner.format(), Some(Format::Dense));
    assert_eq!(Command::ExpressScan { mode: 0 }.encode().as_slice(), [0xA5, 0x82, 5, 0, 0, 0, 0, 0, 0x22]);
}

/// The scan lines of an LMS 2xx as rows: angles, ages and ranges of their beams.
#[test]
fn lms2xx_rows() {
    let settings = |variant, interlaced| Settings {
        baud: Baud::B500000,
        variant,
        unit: Unit::Millimetre,
        mode: MeasuringMode::Range32Field,
        interlaced,
    };
    let word = |count: u16, partial: u16| count | partial | 1 << 14;
    for (variant, interlaced, head, count_word, first_deg, step_deg) in [
        (Variant::Deg180Step05, false, vec![0xB0], word(361, 0), -90.0, 0.5),
        (Variant::Deg180Step1, true, vec![0xB0], word(181, 0x2000), -90.0, 1.0),
        (Variant::Deg100Step025, false, vec![0xB0], word(401, 0), -50.0, 0.25),
    ]
    .into_iter()
    .take(if cfg!(miri) { 2 } else { 3 })
    {
        let settings = settings(variant, interlaced);
        let values: Vec<u16> = (1000..1000 + (count_word & 0x3FF)).collect();
        let bytes = frame(&scan_payload(&head, count_word, &values, &[], 0x10));
        let mut rows = Rows::new(Session::listening(settings), memory(401));
        let mut damaged = bytes.clone();
        damaged[100] ^= 1;
        let (found, errors) = feed(&mut rows, &damaged, &[90]);
        assert!(found.is_empty() && matches!(errors[..], [TelegramError::CheckWord { .. }, ..]), "{errors:?}");
        let (used, event) = rows.feed(&bytes, 5_000_000);
        assert_eq!((used, event), (bytes.len(), LineEvent::Row));
        let row = rows.row().expect("a row");
        let line = rows.session.scan_line().expect("a scan line");
        let ages = BeamAges::of(&line, variant);
        let start_us = 5_000_000 - u64::from(settings.baud.line_time_us(bytes.len() as u32 - 1));
        for (column, value) in values.iter().enumerate() {
            let angle_deg = first_deg + step_deg * column as f32;
            assert!((row.angles_rad[column] - angle_deg * RAD).abs() < 1e-6);
            assert_eq!(row.ranges_m[column], f32::from(*value) / 1000.0);
            let age_us = (start_us - row.end_us) as f32 + row.beam_age_us(column);
            assert!((age_us - ages.age_us(column as u16)).abs() < 1.5, "{column}: {age_us}");
        }
        assert_eq!((rows.counters().packets, rows.counters().rows, rows.counters().lost), (1, 1, 0));
    }
}
