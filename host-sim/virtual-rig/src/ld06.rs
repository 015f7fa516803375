//! An LDROBOT LD06, LD19 or STL-27L.

use scanseg_hal::ld06::{BEAMS, LENGTH, Model};

/// A scanner that sends as soon as it has power, packet after packet.
pub struct VirtualLd06 {
    model: Model,
    turns_per_s: f64,
    ranges_mm: Box<dyn FnMut(f64, f64) -> u16>,
    /// Beams measured so far.
    beams: u64,
}

impl VirtualLd06 {
    /// Returns a scanner whose mirror turns at this speed, 5 to 13 turns a second. `ranges_mm` is
    /// asked for each beam in millimetres, 0 for no return: by its bearing, degrees clockwise from
    /// ahead, 0 to 360, and the time, microseconds since the start.
    pub fn new(model: Model, turns_per_s: f64, ranges_mm: impl FnMut(f64, f64) -> u16 + 'static) -> Self {
        Self { model, turns_per_s, ranges_mm: Box::new(ranges_mm), beams: 0 }
    }

    /// Returns the next packet, and when its last byte has been sent, microseconds.
    pub fn next_packet(&mut self) -> (u64, [u8; LENGTH]) {
        let (beams_per_s, first) = (f64::from(self.model.beams_per_s()), self.beams);
        self.beams += BEAMS as u64;
        let time_s = |beam: u64| beam as f64 / beams_per_s;
        let turns_per_s = self.turns_per_s;
        let bearing_deg = |beam: u64| (time_s(beam) * turns_per_s).fract() * 360.0;
        let cdeg = |beam: u64| ((bearing_deg(beam) * 100.0).round() as u16 % 36_000).to_le_bytes();
        let last = self.beams - 1;
        let mut bytes = vec![0x54, 0x2C];
        bytes.extend(((turns_per_s * 360.0).round() as u16).to_le_bytes());
        bytes.extend(cdeg(first));
        for beam in first..self.beams {
            let range_mm = (self.ranges_mm)(bearing_deg(beam), time_s(beam) * 1e6);
            bytes.extend(range_mm.to_le_bytes());
            bytes.push(if range_mm == 0 { 0 } else { 230 });
        }
        bytes.extend(cdeg(last));
        bytes.extend(((time_s(last) * 1e3) as u64 % 30_000).to_le_bytes().split_at(2).0);
        bytes.push(check(&bytes));
        let sent_us = time_s(last) * 1e6 + LENGTH as f64 * 1e7 / f64::from(self.model.bits_per_s());
        (sent_us as u64, bytes.try_into().expect("47 bytes"))
    }
}

/// CRC-8 of polynomial 0x4D, by long division.
fn check(bytes: &[u8]) -> u8 {
    let mut rest = 0u16;
    for bit in bytes.iter().chain([&0]).flat_map(|byte| (0..8).rev().map(move |bit| byte >> bit & 1)) {
        rest = rest << 1 | u16::from(bit);
        if rest & 0x100 != 0 {
            rest ^= 0x14D;
        }
    }
    rest as u8
}
