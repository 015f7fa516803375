//! A Slamtec RPLIDAR.

use scanseg_hal::rplidar::Format;

/// A scanner that sends when it has been told to, packet after packet.
pub struct VirtualRplidar {
    express: Format,
    scan: Option<Format>,
    beams_per_s: f64,
    turns_per_s: f64,
    bits_per_s: u32,
    ranges_mm: Box<dyn FnMut(f64, f64) -> u16>,
    beams: u64,
    begun: bool,
}

impl VirtualRplidar {
    /// Returns a scanner whose express scan has this format. `ranges_mm` is asked for each beam as
    /// by [`VirtualLd06`](crate::VirtualLd06).
    pub fn new(
        express: Format,
        beams_per_s: f64,
        turns_per_s: f64,
        bits_per_s: u32,
        ranges_mm: impl FnMut(f64, f64) -> u16 + 'static,
    ) -> Self {
        let ranges_mm = Box::new(ranges_mm);
        Self { express, scan: None, beams_per_s, turns_per_s, bits_per_s, ranges_mm, beams: 0, begun: false }
    }

    /// Takes a command. Returns the descriptor with which it answers; nothing to what it does not
    /// understand.
    pub fn command(&mut self, command: &[u8]) -> Vec<u8> {
        self.scan = match *command {
            [0xA5, 0x20] => Some(Format::Node),
            [0xA5, 0x82, 5, .., check] if command.len() == 9 => {
                let sum = command[..8].iter().fold(0, |sum, byte| sum ^ byte);
                if sum == check { Some(self.express) } else { self.scan }
            }
            [0xA5, 0x25] => None,
            _ => return vec![],
        };
        self.begun = false;
        let Some(format) = self.scan else { return vec![] };
        let kind = match format {
            Format::Node => 0x81,
            Format::Express => 0x82,
            Format::Dense => 0x85,
        };
        vec![0xA5, 0x5A, format.length() as u8, 0, 0, 0x40, kind]
    }

    /// Returns the next packet, and when its last byte has been sent, microseconds; `None` while it
    /// has not been told to scan.
    pub fn next_packet(&mut self) -> Option<(u64, Vec<u8>)> {
        let format = self.scan?;
        let (first, beams) = (self.beams, format.beams() as u64);
        self.beams += beams;
        let (beams_per_s, turns_per_s) = (self.beams_per_s, self.turns_per_s);
        let turns = |beam: u64| beam as f64 / beams_per_s * turns_per_s;
        let bearing_deg = |beam: u64| turns(beam).fract() * 360.0;
        let mut range_mm = |beam: u64| (self.ranges_mm)(bearing_deg(beam), beam as f64 / beams_per_s * 1e6);
        let q6 = |beam: u64| (bearing_deg(beam) * 64.0).round() as u16 % (360 << 6);
        let begins = !std::mem::replace(&mut self.begun, true);
        let mut bytes = vec![];
        if format == Format::Node {
            let new_turn = begins || turns(first).floor() > turns(first.saturating_sub(1)).floor();
            bytes.push(15 << 2 | if new_turn { 1 } else { 2 });
            bytes.extend((q6(first) << 1 | 1).to_le_bytes());
            bytes.extend((4 * range_mm(first)).to_le_bytes());
        } else {
            bytes.extend((q6(first) | if begins { 0x8000 } else { 0 }).to_le_bytes());
            for beam in (first..first + beams).step_by(if format == Format::Express { 2 } else { 1 }) {
                if format == Format::Dense {
                    bytes.extend(range_mm(beam).to_le_bytes());
                } else {
                    // the angles of a triangulating scanner: the nearer, the farther back
                    let ranges_mm = [range_mm(beam), range_mm(beam + 1)];
                    let behind_q3 = ranges_mm.map(behind_q3);
                    for (range_mm, behind_q3) in ranges_mm.into_iter().zip(behind_q3) {
                        bytes.extend((range_mm << 2 | behind_q3 >> 4).to_le_bytes());
                    }
                    bytes.push((behind_q3[0] & 15 | (behind_q3[1] & 15) << 4) as u8);
                }
            }
            let check = bytes.iter().fold(0, |sum, byte| sum ^ byte);
            bytes = [vec![0xA0 | check & 15, 0x50 | check >> 4], bytes].concat();
        }
        let sent_us =
            (first + beams - 1) as f64 / beams_per_s * 1e6 + bytes.len() as f64 * 1e7 / f64::from(self.bits_per_s);
        Some((sent_us as u64, bytes))
    }
}

/// Returns how far an express beam of this range lies behind its even place, 1/8 degree, as a
/// virtual scanner has it.
#[must_use]
pub fn behind_q3(range_mm: u16) -> u16 {
    4000u16.checked_div(range_mm).unwrap_or(0).min(63)
}
