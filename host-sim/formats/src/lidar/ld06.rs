//! LDROBOT LD06, LD19, STL-27L: bytes to turns of the mirror, and turns to range images.
//!
//! Its angles go to the right. It does not know how it is turned as a whole: a geometry file of kind
//! "nodding" says that (`turn_deg`, `turn_axis`, `lever_arm_m`); without one it is taken to stand
//! upright and to be panned by a degree a turn of its mirror.

use crate::beside::Beside;
use crate::file::Cause;
use crate::geometry::{Angles, Geometry, Kind, TurnAxis};
use crate::range_image::RangeImage;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::sensors::Sensor;

/// Bytes of a packet.
pub const PACKET_BYTES: usize = 47;
/// Points of a packet.
pub const POINTS: usize = 12;
const HEAD: [u8; 2] = [0x54, 0x2C];
/// The most points of a turn: an STL-27L at 5 turns a second has 4320.
const MAX_POINTS: usize = 8192;
/// The longest file that is read: a minute of an STL-27L is 5 MB.
pub(crate) const MAX_BYTES: u64 = 1 << 28;
const FORMAT: &str = "bytes of an LD06";

/// A packet whose sum is right.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Packet {
    /// Angle of its first point, hundredths of a degree to the right.
    pub start: u16,
    /// Angle of its last point.
    pub end: u16,
    /// Distances, millimetres; 0 where there is none.
    pub ranges_mm: [u16; POINTS],
    /// Milliseconds, modulo 30 000.
    pub time_ms: u16,
}

impl Packet {
    /// Returns the packet of 47 bytes, `None` if its head or sum is wrong, or its angles are none.
    pub fn of(bytes: &[u8; PACKET_BYTES]) -> Option<Packet> {
        let word = |at: usize| u16::from_le_bytes([bytes[at], bytes[at + 1]]);
        let right = bytes.starts_with(&HEAD) && crc(&bytes[..PACKET_BYTES - 1]) == bytes[PACKET_BYTES - 1];
        let packet = Packet {
            start: word(4),
            end: word(42),
            ranges_mm: std::array::from_fn(|i| word(6 + 3 * i)),
            time_ms: word(44),
        };
        (right && packet.start <= 36000 && packet.end <= 36000).then_some(packet)
    }

    /// Angle from a point to the next, hundredths of a degree.
    fn step(&self) -> f64 {
        f64::from((36000 + u32::from(self.end) - u32::from(self.start)) % 36000) / (POINTS - 1) as f64
    }
}

/// CRC-8 with the polynomial 0x4D.
fn crc(bytes: &[u8]) -> u8 {
    bytes
        .iter()
        .fold(0, |crc, byte| (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x4D }))
}

/// Finds packets in bytes as they come.
#[derive(Debug, Default)]
pub struct Packets {
    waiting: Vec<u8>,
    /// Bytes that belong to no packet.
    pub lost_bytes: u64,
}

impl Packets {
    /// Adds bytes.
    pub fn push(&mut self, bytes: &[u8]) {
        self.waiting.extend_from_slice(bytes);
    }
}

impl Iterator for Packets {
    type Item = Packet;

    /// Returns the next packet that is complete.
    fn next(&mut self) -> Option<Packet> {
        let mut at = 0;
        let found = loop {
            let Some(bytes) = self.waiting.get(at..).and_then(|rest| rest.first_chunk()) else { break None };
            match Packet::of(bytes) {
                Some(packet) => break Some(packet),
                None => at += 1,
            }
        };
        self.lost_bytes += at as u64;
        self.waiting.drain(..at + if found.is_some() { PACKET_BYTES } else { 0 });
        found
    }
}

/// One turn of the mirror: angles in degrees to the right, 0 to less than 360, and millimetres.
pub type MirrorTurn = Vec<(f64, u16)>;

/// Puts packets together to turns of the mirror, from angle 0 on. What comes before the first 0 is
/// left out.
#[derive(Debug, Default)]
pub struct MirrorTurns {
    points: MirrorTurn,
    begun: bool,
    last_deg: f64,
    /// Packets that are missing between others, by their angles.
    pub gaps: u64,
}

impl MirrorTurns {
    /// Adds a packet. Returns the turn that it completes.
    pub fn push(&mut self, packet: &Packet) -> Option<MirrorTurn> {
        let step = packet.step();
        let mut done = None;
        for (i, range_mm) in (0..).zip(packet.ranges_mm) {
            let deg = (f64::from(packet.start) + f64::from(i) * step) / 100.0 % 360.0;
            let moved_deg = (deg - self.last_deg).rem_euclid(360.0);
            if i == 0 && self.begun && moved_deg > 5.0 {
                self.gaps += 1;
            }
            if deg < self.last_deg || self.points.len() == MAX_POINTS {
                let whole = std::mem::take(&mut self.points);
                done = done.or(self.begun.then_some(whole).filter(|points| !points.is_empty()));
                self.begun = true;
            }
            self.last_deg = deg;
            if self.begun {
                self.points.push((deg, range_mm));
            }
        }
        done
    }
}

/// Whether packets follow each other in these bytes.
pub(crate) fn is_ld06(head: &[u8]) -> bool {
    let follow = |at: usize| {
        (0..3).all(|i| {
            head.get(at + i * PACKET_BYTES..).and_then(|rest| rest.first_chunk()).and_then(Packet::of).is_some()
        })
    };
    (0..PACKET_BYTES.min(head.len())).any(follow)
}

/// Returns the scan of raw bytes: each whole turn of the mirror is a row.
pub(crate) fn scan(name: String, bytes: &[u8], options: &ReadOptions) -> Result<Scan, Cause> {
    let (mut packets, mut turns) = (Packets::default(), MirrorTurns::default());
    packets.push(bytes);
    let rows: Vec<MirrorTurn> = packets.by_ref().filter_map(|packet| turns.push(&packet)).collect();
    if rows.is_empty() {
        return Err(ScanError::lacks(FORMAT, "a whole turn of the mirror").into());
    }
    let mut remarks = vec![];
    if turns.gaps > 0 {
        remarks.push(format!("packets are missing in {} places", turns.gaps));
    }
    let mut geometry = match &options.geometry {
        Some(path) => Geometry::read(path)?,
        None => {
            remarks.push(
                "taken as upright and panned by 1 degree a turn of its mirror: a geometry file (--geometry) says otherwise"
                    .into(),
            );
            panned()
        }
    };
    let Kind::Nodding { turn_deg, turn_axis, .. } = &geometry.kind else {
        return Err(ScanError::lacks(FORMAT, "a geometry of kind \"nodding\"").into());
    };
    let columns = points_of_a_turn(&rows);
    ScanError::check_pixels(rows.len(), columns)?;
    let step_deg = 360.0 / columns as f64;
    let mut range_m = vec![0.0; rows.len() * columns];
    let mut offsets_deg = Vec::with_capacity(rows.len());
    for (row_m, row) in range_m.chunks_exact_mut(columns).zip(&rows) {
        let offset_deg = offset_deg(row, step_deg);
        offsets_deg.push(-offset_deg);
        for (deg, range_mm) in row {
            let column = ((deg - offset_deg) / step_deg).round().rem_euclid(columns as f64) as usize;
            row_m[column % columns] = f32::from(*range_mm) / 1000.0;
        }
    }
    geometry.kind = Kind::Nodding {
        beam_deg: Angles::Even { start_deg: 0.0, step_deg: -step_deg },
        turn_deg: turn_deg.clone(),
        turn_axis: *turn_axis,
    };
    geometry.no_return = vec![];
    geometry.beside = Beside { row_offset_deg: Some(Angles::Listed(offsets_deg)), ..geometry.beside };
    geometry.fits(rows.len(), columns)?;
    let mut image = RangeImage { rows: rows.len(), columns, range_m };
    let measured = image.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    if measured == 0 {
        return Err(ScanError::NothingMeasured { pixels: image.range_m.len() }.into());
    }
    image.keep_within(&geometry);
    Ok(Scan { name, image, geometry, measured, remarks })
}

/// Upright, panned by a degree a row.
fn panned() -> Geometry {
    let mut geometry = Geometry::of(Kind::Nodding {
        beam_deg: Angles::Even { start_deg: 0.0, step_deg: -1.0 },
        turn_deg: Angles::Even { start_deg: 0.0, step_deg: 1.0 },
        turn_axis: TurnAxis::Z,
    });
    if let Some(sensor) = Sensor::named("ld06") {
        geometry.range_noise_m = Some(sensor.range_noise_m());
        geometry.noise = sensor.noise();
    }
    geometry
}

/// Points of a turn: the median.
fn points_of_a_turn(rows: &[MirrorTurn]) -> usize {
    let mut counts: Vec<usize> = rows.iter().map(Vec::len).collect();
    counts.sort_unstable();
    counts[counts.len() / 2]
}

/// By how much the points of a turn lie beside even angles from 0 on, within half a step.
fn offset_deg(row: &MirrorTurn, step_deg: f64) -> f64 {
    use std::f64::consts::TAU;
    let angles = row.iter().map(|(deg, _)| TAU * deg / step_deg);
    let (sines, cosines) = angles.fold((0.0, 0.0), |(s, c), a: f64| (s + a.sin(), c + a.cos()));
    f64::atan2(sines, cosines) / TAU * step_deg
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The packet of LDROBOT's manual.
    const MANUAL: [u8; PACKET_BYTES] = [
        0x54, 0x2C, 0x68, 0x08, 0xAB, 0x7E, 0xE0, 0x00, 0xE4, 0xDC, 0x00, 0xE2, 0xD9, 0x00, 0xE5, 0xD5, 0x00, 0xE3,
        0xD3, 0x00, 0xE4, 0xD0, 0x00, 0xE9, 0xCD, 0x00, 0xE4, 0xCA, 0x00, 0xE2, 0xC7, 0x00, 0xE9, 0xC5, 0x00, 0xE5,
        0xC2, 0x00, 0xE5, 0xC0, 0x00, 0xE5, 0xBE, 0x82, 0x3A, 0x1A, 0x50,
    ];

    /// A packet from an angle on, in steps of 0.8 degrees; distances are 1000 + angle in tenths.
    fn packet(start: u16) -> Vec<u8> {
        let mut bytes = vec![0x54, 0x2C, 0x10, 0x0E];
        bytes.extend((start % 36000).to_le_bytes());
        for i in 0..12 {
            bytes.extend((1000 + (start + i * 80) % 36000 / 10).to_le_bytes());
            bytes.push(200);
        }
        bytes.extend(((start + 880) % 36000).to_le_bytes());
        bytes.extend([0, 0]);
        bytes.push(crc(&bytes));
        bytes
    }

    fn stream(packets: u32) -> Vec<u8> {
        (0..packets).flat_map(|i| packet(((35000 + i * 960) % 36000) as u16)).collect()
    }

    #[test]
    fn the_packet_of_the_manual() {
        let read = Packet::of(&MANUAL).unwrap();
        assert_eq!((read.start, read.end, read.time_ms), (0x7EAB, 0x82BE, 0x1A3A));
        assert_eq!((read.ranges_mm[0], read.ranges_mm[11]), (0xE0, 0xC0));
        let mut wrong = MANUAL;
        wrong[7] ^= 1;
        assert_eq!(Packet::of(&wrong), None);
    }

    #[test]
    fn packets_are_found_among_other_bytes_however_they_come() {
        let bytes = [&[0x54, 0x2C, 0x54][..], &MANUAL, &[0x54], &MANUAL[..20], &MANUAL, &MANUAL[..46]].concat();
        for length in [1, 7, 46, 47, 48, 500] {
            let mut packets = Packets::default();
            let mut found = 0;
            for piece in bytes.chunks(length) {
                packets.push(piece);
                found += packets.by_ref().count();
            }
            assert_eq!((found, packets.lost_bytes), (2, 3 + 1 + 20), "{length}");
        }
    }

    #[test]
    fn a_turn_of_the_mirror_is_a_row() {
        let bytes = stream(38 * 4);
        assert!(is_ld06(&bytes) && is_ld06(&bytes[20..]) && !is_ld06(&bytes[..140]));
        let scan = scan("x".into(), &bytes[20..], &ReadOptions::default()).unwrap();
        assert_eq!((scan.image.rows, scan.image.columns), (4, 450));
        scan.geometry.check().unwrap();
        scan.geometry.fits(4, 450).unwrap();
        let Kind::Nodding { beam_deg, .. } = &scan.geometry.kind else { panic!() };
        for (i, range_m) in (0..).zip(&scan.image.range_m) {
            let (row, column) = (i / 450, i % 450);
            let deg = -(beam_deg.at(column) + scan.geometry.beside.row_deg(row));
            let sent_mm = 1000.0 + deg.rem_euclid(360.0) * 10.0;
            assert!((f64::from(*range_m) * 1000.0 - sent_mm).abs() <= 1.0, "{row} {column}: {range_m} {deg}");
        }
        assert_eq!(scan.remarks.len(), 1, "{:?}", scan.remarks);
    }

    #[test]
    fn what_is_missing_is_said() {
        let mut bytes = stream(38 * 3);
        bytes.drain(47 * 50..47 * 52);
        let found = scan("x".into(), &bytes, &ReadOptions::default()).unwrap();
        assert!(found.remarks[0].contains("missing in 1 place"), "{:?}", found.remarks);
        assert!(scan("x".into(), &stream(20), &ReadOptions::default()).is_err());
        assert!(scan("x".into(), &[], &ReadOptions::default()).is_err());
    }
}
