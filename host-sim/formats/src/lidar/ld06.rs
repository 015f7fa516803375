//! LDROBOT LD06, LD19, STL-27L: bytes as they came over the serial line, and their range image.
//!
//! Each turn of the mirror is a row. The scanner does not know how it is turned as a whole: a geometry
//! file of kind "nodding" says that (`turn_deg`, `turn_axis`, `lever_arm_m`); without one it is taken
//! to stand upright and to be panned by a degree a turn of its mirror.

use std::path::Path;

use scanseg_hal::ld06::{LENGTH, Ld06, Model, Packet};
use scanseg_hal::scanner::{LineEvent, LineScanner, Row, RowMemory, View};

use crate::angles::Angles;
use crate::file::{Cause, FileError};
use crate::geometry::{Geometry, Kind, TurnAxis};
use crate::range_image::RangeImage;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::sensors::Sensor;
use crate::streamed::scan_of;

/// The most beams of a turn: an STL-27L at 5 turns a second has 4320.
pub const MAX_BEAMS: usize = 8192;
/// The longest file that is read.
pub(crate) const MAX_BYTES: u64 = 1 << 28;
const FORMAT: &str = "bytes of an LD06";

/// Returns the scanner whose packets follow each other in these bytes.
pub fn model(bytes: &[u8]) -> Option<Model> {
    let is_packet = |at: usize, model| {
        let packet = bytes.get(at..).and_then(|rest| rest.first_chunk());
        packet.is_some_and(|packet| packet.starts_with(&[0x54, 0x2C]) && Packet::new(*packet, model).is_ok())
    };
    let follow = |model| (0..LENGTH).any(|at| (0..3).all(|i| is_packet(at + i * LENGTH, model)));
    [Model::Ld06, Model::Stl27l].into_iter().find(|model| follow(*model))
}

/// Returns where the beams of an LD06 point, in so many columns from behind on to the right, and what is
/// to be said of that. The file is a geometry file of kind "nodding": its turns, its axis and its lever
/// arm are taken.
///
/// # Errors
/// What [`Geometry::read`] says; [`ScanError::Lacks`] if the file is of another kind.
pub fn geometry(file: Option<&Path>, columns: usize) -> Result<(Geometry, Option<String>), FileError> {
    let (turn_deg, turn_axis, lever_arm_m, remark) = match file {
        Some(path) => {
            let Geometry { kind, beside, .. } = Geometry::read(path)?;
            let Kind::Nodding { turn_deg, turn_axis, .. } = kind else {
                return Err(FileError::new(
                    path,
                    ScanError::lacks("a geometry file for an LD06", "the kind \"nodding\""),
                ));
            };
            (turn_deg, turn_axis, beside.lever_arm_m, None)
        }
        None => {
            let taken = "taken as upright and panned by 1 degree a turn of its mirror; a geometry file says otherwise";
            (Angles::Even { start_deg: 0.0, step_deg: 1.0 }, TurnAxis::Z, 0.0, Some(taken.into()))
        }
    };
    let beam_deg = Angles::Even { start_deg: 180.0, step_deg: -360.0 / columns as f64 };
    let mut geometry = Geometry::of(Kind::Nodding { beam_deg, turn_deg, turn_axis });
    geometry.beside.lever_arm_m = lever_arm_m;
    if let Some(sensor) = Sensor::named("ld06") {
        geometry.range_noise_m = Some(sensor.range_noise_m());
        geometry.noise = sensor.noise();
    }
    Ok((geometry, remark))
}

/// Puts the beams of a turn of the mirror into the columns of [`geometry`], 0 where none falls. Returns
/// by how much all of them lie beside their columns, degrees: the row's offset. `angles_rad` is scratch
/// for a number per column.
pub fn to_columns(row: &Row<'_>, angles_rad: &mut [f32], range_m: &mut [f32]) -> f64 {
    let step_deg = 360.0 / range_m.len() as f64;
    let offset_deg = offset_deg(row.angles_rad, step_deg);
    let start_rad = (180.0 + offset_deg).to_radians() as f32;
    row.to_columns(start_rad, -step_deg.to_radians() as f32, angles_rad, range_m);
    offset_deg
}

/// Returns the scan of raw bytes.
pub(crate) fn scan(name: String, bytes: &[u8], options: &ReadOptions) -> Result<Scan, Cause> {
    let (mut angles_rad, mut ranges_m) = (vec![0.0; MAX_BEAMS], vec![0.0; MAX_BEAMS]);
    let memory = RowMemory { angles_rad: &mut angles_rad, ranges_m: &mut ranges_m };
    let mut scanner = Ld06::new(model(bytes).unwrap_or(Model::Ld06), View::FULL, memory);
    let (mut rest, mut rows) = (bytes, vec![]);
    loop {
        let (used, event) = scanner.feed(rest, 0);
        rest = &rest[used..];
        match event {
            LineEvent::NeedMore => break,
            LineEvent::Row => {
                let whole = scanner.row().filter(is_turn);
                rows.extend(whole.map(|row| (row.angles_rad.to_vec(), row.ranges_m.to_vec())));
            }
            LineEvent::Rejected(_) => {}
        }
    }
    let lost = scanner.counters().lost;
    let mut beams: Vec<usize> = rows.iter().map(|(angles_rad, _)| angles_rad.len()).collect();
    beams.sort_unstable();
    let Some(&columns) = beams.get(beams.len() / 2) else {
        return Err(ScanError::lacks(FORMAT, "a whole turn of the mirror").into());
    };
    let mut range_m = vec![0.0; ScanError::check_pixels(rows.len(), columns)?];
    let (mut true_rad, mut offsets_deg) = (vec![0.0; columns], vec![]);
    for ((angles_rad, ranges_m), range_m) in rows.iter().zip(range_m.chunks_exact_mut(columns)) {
        let row = Row { angles_rad, ranges_m, end_us: 0, mirror_turn_us: 0.0, merged_turns: 1, first_turn: 0 };
        offsets_deg.push(to_columns(&row, &mut true_rad, range_m));
    }
    let (mut geometry, remark) = geometry(options.geometry.as_deref(), columns)?;
    geometry.beside.row_offset_deg = Some(Angles::Listed(offsets_deg));
    geometry.fits(rows.len(), columns)?;
    let missing = (lost > 0).then(|| format!("{lost} packets are missing"));
    let remarks = missing.into_iter().chain(remark).collect();
    scan_of(name, (RangeImage { rows: rows.len(), columns, range_m }, geometry), options, remarks)
}

/// Whether beams go round, but for a packet or two: those before the first row are a part of it.
#[must_use]
pub fn is_turn(row: &Row<'_>) -> bool {
    let angles_rad = row.angles_rad;
    let ends = angles_rad.first().zip(angles_rad.last());
    ends.is_some_and(|(first_rad, last_rad)| (first_rad - last_rad).abs() > 330f32.to_radians())
}

/// By how much the beams of a turn lie beside even angles from behind on, degrees: 0 to less than a
/// step to the right.
fn offset_deg(angles_rad: &[f32], step_deg: f64) -> f64 {
    use std::f64::consts::TAU;
    let phases = angles_rad.iter().map(|rad| TAU * (f64::from(*rad).to_degrees() - 180.0) / step_deg);
    let (sines, cosines) = phases.fold((0.0, 0.0), |(s, c), phase| (s + phase.sin(), c + phase.cos()));
    -(-f64::atan2(sines, cosines) / TAU * step_deg).rem_euclid(step_deg)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A packet from an angle on, in steps of 0.8 degrees; distances are 1000 + angle in tenths.
    fn packet(start: u16) -> Vec<u8> {
        let mut bytes = vec![0x54, 0x2C, 0x10, 0x0E];
        bytes.extend(start.to_le_bytes());
        for i in 0..12 {
            bytes.extend((1000 + (start + i * 80) % 36000 / 10).to_le_bytes());
            bytes.push(200);
        }
        bytes.extend(((start + 880) % 36000).to_le_bytes());
        bytes.extend([0, 0]);
        let sum = bytes.iter().fold(0u8, |crc, byte| {
            (0..8).fold(crc ^ byte, |crc, _| if crc & 0x80 == 0 { crc << 1 } else { crc << 1 ^ 0x4D })
        });
        bytes.push(sum);
        bytes
    }

    fn stream(packets: u32) -> Vec<u8> {
        (0..packets).flat_map(|i| packet(((35000 + i * 960) % 36000) as u16)).collect()
    }

    #[test]
    fn a_turn_of_the_mirror_is_a_row() {
        let bytes = stream(38 * 4);
        assert_eq!([&bytes[..], &bytes[20..], &bytes[..140]].map(model), [Some(Model::Ld06), Some(Model::Ld06), None]);
        let scan = scan("x".into(), &bytes[20..], &ReadOptions::default()).unwrap();
        assert_eq!(scan.image.columns, 450);
        assert!((3..=4).contains(&scan.image.rows), "{}", scan.image.rows);
        scan.geometry.check().unwrap();
        let Kind::Nodding { beam_deg, .. } = &scan.geometry.kind else { panic!() };
        for (i, range_m) in (0..).zip(&scan.image.range_m) {
            let (row, column) = (i / 450, i % 450);
            let right_deg = -(beam_deg.at(column) + scan.geometry.beside.row_deg(row));
            let sent_mm = 1000.0 + right_deg.rem_euclid(360.0) * 10.0;
            let off_mm = f64::from(*range_m) * 1000.0 - sent_mm;
            assert!(off_mm.abs() <= 1.1, "{row} {column}: {range_m} {right_deg}");
        }
        assert_eq!(scan.remarks.len(), 1, "{:?}", scan.remarks);
    }

    #[test]
    fn what_is_missing_is_said() {
        let mut bytes = stream(38 * 3);
        bytes.drain(47 * 50..47 * 52);
        let found = scan("x".into(), &bytes, &ReadOptions::default()).unwrap();
        assert_eq!(found.remarks[0], "2 packets are missing");
        for none in [&stream(20)[..], &[]] {
            let said = scan("x".into(), none, &ReadOptions::default()).unwrap_err().to_string();
            assert!(said.contains("a whole turn of the mirror"), "{said}");
        }
    }
}
