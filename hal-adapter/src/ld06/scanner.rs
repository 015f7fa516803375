//! Packets in a stream of bytes, and rows of their beams.

use super::packet::{BEAMS, LENGTH, Model, Packet, PacketError, START, VERSION_AND_BEAMS, turned_cdeg};
use crate::scanner::{
    Cut, Cutter, FULL_TURN, LineEvent, LineScanner, Row, RowMemory, ScannerCounters, View, Window, count,
};

/// A full turn, hundredths of a degree.
const TURN_CDEG: f32 = 36_000.0;

/// An LD06, LD19 or STL-27L whose bytes become rows: one turn of the mirror each, cut to the field
/// of view. Some 250 bytes beside the memory for one row.
///
/// A turn of an LD06 has 450 beams at 10 turns a second and 900 at 5; of an STL-27L 2160 and 4320.
/// A row has the part of them that lies in the view, and a few more when the mirror is slow.
///
/// The angle of a beam is interpolated between those of the first and the last of its packet, as
/// the scanner's manual says. Lost packets are counted by the angles between the others, and by the
/// clock of [`LineScanner::feed`] where a turn or more is missing. The count is exact where less
/// than a turn is missing and every packet is right; of damaged packets the CRC lets one in 256
/// pass.
#[derive(Debug)]
pub struct Ld06<'a> {
    model: Model,
    window: Window<{ LENGTH + 1 }>,
    cutter: Cutter<'a>,
    counters: ScannerCounters,
    /// The packet whose beams are being taken, the next of them, and when its last beam was
    /// measured.
    packet: Option<Packet>,
    next_beam: usize,
    packet_us: u64,
    /// A turn or more is missing before it.
    gap: bool,
    /// The last valid packet.
    last: Option<Packet>,
    /// Angle from a packet to the next, hundredths of a degree: a mean over some of the last.
    packet_cdeg: f32,
    row_end_us: u64,
    row_turn_us: f32,
}

impl<'a> Ld06<'a> {
    /// Returns a scanner that has received nothing.
    #[must_use]
    pub fn new(model: Model, view: View, memory: RowMemory<'a>) -> Self {
        Self {
            model,
            window: Window::new(),
            cutter: Cutter::new(view, memory),
            counters: ScannerCounters::default(),
            packet: None,
            next_beam: 0,
            packet_us: 0,
            gap: false,
            last: None,
            packet_cdeg: 0.0,
            row_end_us: 0,
            row_turn_us: 0.0,
        }
    }

    /// Returns the last valid packet: speed of the mirror, confidence of the beams.
    #[must_use]
    pub fn last_packet(&self) -> Option<&Packet> {
        self.last.as_ref()
    }

    /// Gives the beams of the packet to the row. Returns whether a row has ended.
    fn take_beams(&mut self) -> bool {
        let Some(packet) = self.packet else { return false };
        if core::mem::take(&mut self.gap) && self.cutter.missing() == Cut::RowEnds {
            self.row_ends(&packet);
            return true;
        }
        let (start, span) = (units(packet.start_cdeg()), units(packet.span_cdeg()));
        while self.next_beam < BEAMS {
            let angle = start.wrapping_add((u64::from(span) * self.next_beam as u64 / (BEAMS as u64 - 1)) as u32);
            let (range_mm, _) = packet.beam(self.next_beam);
            let range_m = f32::from(range_mm) / 1000.0;
            if self.cutter.beam(angle, range_m, &mut self.counters) == Cut::RowEnds {
                self.row_ends(&packet);
                return true;
            }
            self.next_beam += 1;
        }
        self.packet = None;
        false
    }

    /// Takes note of a row that ends before or within this packet.
    fn row_ends(&mut self, packet: &Packet) {
        count(&mut self.counters.rows, 1);
        self.row_turn_us = 360e6 / f32::from(packet.speed_deg_per_s());
        let ago_us = self.cutter.turns_since_row(units(packet.end_cdeg())) * self.row_turn_us;
        self.row_end_us = self.packet_us.saturating_sub(ago_us as u64);
    }

    /// Takes a valid packet, of which the last byte came at `now_us`.
    fn take(&mut self, packet: Packet, now_us: u64) {
        count(&mut self.counters.packets, 1);
        // it is sent as soon as its last beam has been measured
        let sending_us = LENGTH as u64 * 10_000_000 / u64::from(self.model.bits_per_s());
        let packet_us = now_us.saturating_sub(sending_us);
        self.count_lost(&packet, packet_us);
        self.packet_us = packet_us;
        (self.packet, self.next_beam, self.last) = (Some(packet), 0, Some(packet));
    }

    /// Counts the packets lost before this one, whose last beam was measured at `now_us`.
    fn count_lost(&mut self, packet: &Packet, now_us: u64) {
        let speed = f32::from(packet.speed_deg_per_s());
        let Some(last) = &self.last else {
            self.packet_cdeg = speed * 100.0 * BEAMS as f32 / self.model.beams_per_s() as f32;
            return;
        };
        let turned_cdeg = f32::from(turned_cdeg(last.start_cdeg(), packet.start_cdeg()));
        let by_time_cdeg = now_us.saturating_sub(self.packet_us) as f32 * 1e-4 * speed;
        let turns = rounded((by_time_cdeg - turned_cdeg) / TURN_CDEG);
        let turned_cdeg = turned_cdeg + turns as f32 * TURN_CDEG;
        let packets = rounded(turned_cdeg / self.packet_cdeg).max(1);
        count(&mut self.counters.lost, packets - 1);
        self.gap = turned_cdeg >= TURN_CDEG;
        self.packet_cdeg += (turned_cdeg / packets as f32 - self.packet_cdeg) / 16.0;
    }
}

impl LineScanner for Ld06<'_> {
    type Error = PacketError;

    fn feed(&mut self, bytes: &[u8], now_us: u64) -> (usize, LineEvent<PacketError>) {
        self.cutter.next_row();
        let mut used = 0;
        loop {
            if self.take_beams() {
                return (used, LineEvent::Row);
            }
            let held = self.window.held();
            let until = match held {
                [] => 1,
                [START] => 2,
                [START, VERSION_AND_BEAMS, rest @ ..] => {
                    // the first byte of the next packet may stand in the place of one that was lost
                    let last = LENGTH - 3;
                    if rest.get(last) == Some(&START) { LENGTH + 1 } else { LENGTH }
                }
                _ => {
                    self.window.drop(1, |byte| byte == START);
                    continue;
                }
            };
            if held.len() >= until
                && let Some(packet) = held.first_chunk()
            {
                let checked = match held.get(LENGTH - 1..) {
                    Some([START, VERSION_AND_BEAMS]) => Err(PacketError::Short),
                    _ => Packet::new(*packet, self.model),
                };
                match checked {
                    Ok(packet) => {
                        self.window.drop(LENGTH, |_| true);
                        let behind = (bytes.len() - used) as u64;
                        let behind_us = behind * 10_000_000 / u64::from(self.model.bits_per_s());
                        self.take(packet, now_us.saturating_sub(behind_us));
                    }
                    Err(error) => {
                        self.window.drop(1, |byte| byte == START);
                        count(&mut self.counters.rejected, 1);
                        return (used, LineEvent::Rejected(error));
                    }
                }
            } else {
                let taken = self.window.fill(bytes.get(used..).unwrap_or(&[]), until);
                if taken == 0 {
                    return (used, LineEvent::NeedMore);
                }
                used += taken;
            }
        }
    }

    fn row(&self) -> Option<Row<'_>> {
        let (angles_rad, ranges_m) = self.cutter.row()?;
        let (end_us, mirror_turn_us) = (self.row_end_us, self.row_turn_us);
        Some(Row { angles_rad, ranges_m, end_us, mirror_turn_us, merged_turns: 1, first_turn: 0 })
    }

    fn counters(&self) -> ScannerCounters {
        self.counters
    }
}

/// Returns an angle in units of 2^-32 of a turn.
fn units(cdeg: u16) -> u32 {
    (f32::from(cdeg) * (FULL_TURN / TURN_CDEG)) as u32
}

/// Rounds to a whole number; below 0 is 0.
fn rounded(number: f32) -> u32 {
    (number + 0.5) as u32
}
