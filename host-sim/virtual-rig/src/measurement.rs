//! What the scanner measures in a turn of its mirror.

use scanseg_hal::lms2xx::Variant;

use crate::mode::Mode;

/// Time of a turn of the mirror: 75 a second.
const TURN_US: f64 = 40_000.0 / 3.0;

/// A beam as the scanner measures it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    /// Bearing from the right edge of the field of view, counter-clockwise, degrees.
    pub bearing_deg: f64,
    /// When it is measured, microseconds.
    pub time_us: f64,
}

/// A turn of the mirror that has just ended: its beams, one every degree, were measured before, the
/// leftmost last.
#[derive(Clone, Copy, Debug)]
pub(crate) struct MirrorTurn {
    pub end_us: u64,
    /// Which of the turns that make a scan of all columns, from 0.
    pub number: u64,
    pub mode: Mode,
    pub variant: Variant,
    /// Code of the unit of the ranges.
    pub unit_code: u8,
}

impl MirrorTurn {
    /// Returns whether a scan is complete with it.
    pub(crate) fn completes_scan(&self) -> bool {
        self.mode == Mode::Interlaced || self.number + 1 == self.turns()
    }

    fn turns(&self) -> u64 {
        u64::from(self.variant.mirror_turns())
    }

    /// Returns the payload of the scan that is complete with it.
    pub(crate) fn scan_payload(&self, mut range_of: impl FnMut(Beam) -> u16) -> Vec<u8> {
        let turns = self.turns();
        let interlaced = self.mode == Mode::Interlaced;
        let view_deg = f64::from(self.variant.view_deg());
        let (first, last, mut payload) = match self.mode {
            Mode::SubRange { first, last } => {
                (first, last, [&[0xB7], &first.to_le_bytes()[..], &last.to_le_bytes(), &[0, 0]].concat())
            }
            _ => (1, self.variant.columns(), vec![0xB0, 0, 0]),
        };
        let head = payload.len();
        for column in u64::from(first) - 1..u64::from(last) {
            let of_turn = column % turns;
            if interlaced && of_turn != self.number {
                continue;
            }
            let bearing_deg = column as f64 / turns as f64;
            let turns_ago = if interlaced { 0 } else { turns - 1 - of_turn };
            let time_us = self.end_us as f64 - (turns_ago as f64 + (view_deg - bearing_deg) / 360.0) * TURN_US;
            payload.extend(range_of(Beam { bearing_deg, time_us }).to_le_bytes());
        }
        let count = ((payload.len() - head) / 2) as u16;
        let partial = if interlaced { 0x2000 | ((self.number * 4 / turns) as u16) << 11 } else { 0 };
        let unit = u16::from(self.unit_code) << 14;
        payload[head - 2..head].copy_from_slice(&(count | partial | unit).to_le_bytes());
        payload.push(0x10);
        payload
    }
}
