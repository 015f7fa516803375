//! Packets in a stream of bytes, and rows of their beams.

use super::packet::{Capsule, DESCRIPTOR, Format, LONGEST, Node, PacketError};
use crate::scanner::{
    BACK, Cut, Cutter, FULL_TURN, LineEvent, LineScanner, Row, RowMemory, ScannerCounters, View, Window, count,
};

/// Bytes of a node, and of two and the beginning of a third.
const NODE: usize = 5;
const NODES: usize = 2 * NODE + 3;
/// Bytes without a node after which the next one may lie anywhere.
const ASTRAY: u32 = 40;

/// An RPLIDAR whose bytes become rows: one turn of the mirror each, cut to the field of view. Some
/// 350 bytes beside the memory for one row.
///
/// A turn has as many beams as the scanner measures in its time: 360 by a standard scan of an A1 at
/// 5.5 turns a second, 720 by its express scan, 3200 by an S2 at 10 turns.
///
/// The beams of a capsule lie between its angle and that of the next one; where the next one is
/// lost, the usual angle is taken. So a capsule comes into a row when the next one has come, and a
/// node with the second after it. Lost capsules are counted by the angles between the others, and
/// by the clock where a turn or more is missing. Lost nodes are counted by the bytes that were
/// received in their place, so that those of which nothing was received are not counted.
#[derive(Debug)]
pub struct Rplidar<'a> {
    bits_per_s: u32,
    format: Option<Format>,
    window: Window<{ LONGEST + 1 }>,
    cutter: Cutter<'a>,
    counters: ScannerCounters,
    /// The beams that are being taken, and the next of them.
    beams: Option<Beams>,
    next_beam: usize,
    /// The last capsule, whose beams wait for the next one.
    held: Option<Capsule>,
    /// Angle from a capsule to the next, a mean over some of the last; 0 before there are any.
    usual: f32,
    /// The last such angle, whatever was missing in it.
    last_moved: f32,
    /// Angle of the last node or capsule, and when its last byte came.
    last: Option<(u32, u64)>,
    /// A turn or more is missing before the beams.
    gap: bool,
    /// And behind the capsule whose beams they are.
    gap_behind: bool,
    /// About where the next node lies.
    expected: Option<u32>,
    /// Bytes since the last node.
    unused: u32,
    pace: Pace,
    row_end_us: u64,
}

/// The beams of a packet whose angles are known.
#[derive(Debug)]
enum Beams {
    Node(Node),
    Capsule {
        capsule: Capsule,
        /// From its first beam to the first of the next one.
        span: u32,
    },
}

impl<'a> Rplidar<'a> {
    /// Returns a scanner that waits for the descriptor of a scan. Make it before the command is
    /// sent; if the descriptor is damaged, send the command again. `bits_per_s` is the rate of its
    /// line, above 0.
    #[must_use]
    pub fn new(bits_per_s: u32, view: View, memory: RowMemory<'a>) -> Self {
        Self {
            bits_per_s: bits_per_s.max(1),
            format: None,
            window: Window::new(),
            cutter: Cutter::new(view, memory),
            counters: ScannerCounters::default(),
            beams: None,
            next_beam: 0,
            held: None,
            usual: 0.0,
            last_moved: 0.0,
            last: None,
            gap: false,
            gap_behind: false,
            expected: None,
            unused: 0,
            pace: Pace::default(),
            row_end_us: 0,
        }
    }

    /// Returns a scanner that is sending already, or whose bytes were recorded.
    #[must_use]
    pub fn listening(format: Format, bits_per_s: u32, view: View, memory: RowMemory<'a>) -> Self {
        Self { format: Some(format), ..Self::new(bits_per_s, view, memory) }
    }

    /// Returns the format of the scan; `None` while its descriptor has not come.
    #[must_use]
    pub fn format(&self) -> Option<Format> {
        self.format
    }

    /// Gives the beams to the row. Returns whether a row has ended.
    fn take_beams(&mut self) -> bool {
        let Some(beams) = &self.beams else { return false };
        if core::mem::take(&mut self.gap) && self.cutter.missing() == Cut::RowEnds {
            self.row_ends();
            return true;
        }
        let count = match beams {
            Beams::Node(_) => 1,
            Beams::Capsule { capsule, .. } => capsule.beams(),
        };
        while self.next_beam < count {
            let (angle, range_m) = match beams {
                Beams::Node(node) => (node.angle, node.range_m),
                Beams::Capsule { capsule, span } => {
                    let (behind, range_m) = capsule.beam(self.next_beam);
                    let along = (u64::from(*span) * self.next_beam as u64).checked_div(count as u64).unwrap_or(0);
                    (capsule.start.wrapping_add(along as u32).wrapping_sub(behind), range_m)
                }
            };
            if self.cutter.beam(angle, range_m, &mut self.counters) == Cut::RowEnds {
                self.row_ends();
                return true;
            }
            self.next_beam += 1;
        }
        self.beams = None;
        false
    }

    /// Takes note of a row that ends before or within the beams.
    fn row_ends(&mut self) {
        count(&mut self.counters.rows, 1);
        let Some((angle, time_us)) = self.last else { return };
        let turn_us = self.pace.row_ends(time_us);
        // the time is that of the last beam of a capsule, the angle that of its first
        let ago = self.cutter.turns_since_row(angle) + self.usual / FULL_TURN;
        self.row_end_us = time_us.saturating_sub((ago * turn_us) as u64);
    }

    /// Takes a node or a capsule at this angle, of which the last byte came at `now_us`. Returns the
    /// angle from the one before, 2^-32 of a turn, without whole turns.
    fn went_on(&mut self, angle: u32, now_us: u64) -> Option<(u32, u64)> {
        count(&mut self.counters.packets, 1);
        let Some((last, last_us)) = self.last.replace((angle, now_us)) else {
            self.pace.begin(now_us);
            return None;
        };
        Some((angle.wrapping_sub(last), now_us.saturating_sub(last_us)))
    }

    fn take_node(&mut self, node: Node, now_us: u64) {
        // rounded: an inserted byte is no node, one that lost a byte or two is
        count(&mut self.counters.lost, (self.unused + 2) / NODE as u32);
        // one node with a wrong angle does not lead astray
        self.expected = Some(match self.expected {
            Some(expected) if self.unused < ASTRAY => {
                let off = node.angle.wrapping_sub(expected) as i32;
                expected.wrapping_add((off / 4) as u32)
            }
            _ => node.angle,
        });
        self.unused = 0;
        if let Some((moved, time_us)) = self.went_on(node.angle, now_us) {
            self.gap = self.pace.turn_us > 0.0 && time_us as f32 > self.pace.turn_us;
            self.pace.turned(moved as i32 as f32 / FULL_TURN);
        }
        (self.beams, self.next_beam) = (Some(Beams::Node(node)), 0);
    }

    fn take_capsule(&mut self, capsule: Capsule, now_us: u64) {
        let went_on = self.went_on(capsule.start, now_us);
        let held = self.held.replace(capsule);
        let (Some((moved, time_us)), Some(before), false) = (went_on, held, capsule.first) else { return };
        let moved = moved as f32;
        let last_moved = core::mem::replace(&mut self.last_moved, moved);
        // two in a row that agree have nothing missing between them
        let agree = (moved - last_moved).abs() < 0.1 * moved;
        if agree && (self.usual == 0.0 || moved < 0.75 * self.usual) {
            self.usual = moved;
        }
        let usual = if self.usual > 0.0 { self.usual } else { moved };
        let turns =
            if self.pace.turn_us > 0.0 { rounded(time_us as f32 / self.pace.turn_us - moved / FULL_TURN) } else { 0 };
        let moved = moved + turns as f32 * FULL_TURN;
        let packets = rounded(moved / usual).max(1);
        count(&mut self.counters.lost, packets - 1);
        self.pace.turned(moved / FULL_TURN);
        self.gap = core::mem::replace(&mut self.gap_behind, moved >= FULL_TURN);
        let span = moved / packets as f32;
        if self.usual > 0.0 {
            self.usual += (span - self.usual) / 16.0;
        }
        let span = if packets == 1 { span } else { self.usual };
        (self.beams, self.next_beam) = (Some(Beams::Capsule { capsule: before, span: span as u32 }), 0);
    }

    /// Drops bytes of the window, and those behind them with which no packet can begin.
    fn drop(&mut self, bytes: usize) {
        let format = self.format;
        let dropped = self.window.drop(bytes, |byte| format.map_or(byte == 0xA5, |format| format.begins(byte)));
        self.unused = self.unused.saturating_add(dropped as u32);
    }

    /// Returns when the beams of a packet were measured, behind which so many bytes have come: it is
    /// sent as soon as its last beam has been.
    fn sent_us(&self, behind: usize, now_us: u64) -> u64 {
        let bytes = behind + self.format.map_or(0, Format::length);
        now_us.saturating_sub(bytes as u64 * 10_000_000 / u64::from(self.bits_per_s))
    }

    /// Looks for a packet in the window.
    fn examine(&self) -> Verdict {
        let held = self.window.held();
        match self.format {
            None => match held {
                [] => Verdict::Need(1),
                [0xA5] => Verdict::Need(2),
                [0xA5, 0x5A, ..] => match held.first_chunk::<DESCRIPTOR>() {
                    None => Verdict::Need(DESCRIPTOR),
                    Some(descriptor) => match Format::of_descriptor(descriptor) {
                        Ok(format) => Verdict::Descriptor(format),
                        Err(error) => Verdict::Bad(error),
                    },
                },
                _ => Verdict::Nothing,
            },
            Some(Format::Node) => self.examine_node(held),
            Some(format) => match held.first_chunk() {
                _ if !Capsule::begins(held) => Verdict::Nothing,
                None if held.len() < 2 => Verdict::Need(held.len() + 1),
                None => Verdict::Need(LONGEST),
                // the first byte of the next capsule may stand in the place of one that was lost
                Some(_) if held.len() == LONGEST && held.last().is_some_and(|&last| format.begins(last)) => {
                    Verdict::Need(LONGEST + 1)
                }
                Some(bytes) => match Capsule::new(bytes, format) {
                    Ok(_) if held.get(LONGEST - 1..).is_some_and(|end| end.len() == 2 && Capsule::begins(end)) => {
                        Verdict::Bad(PacketError::Length)
                    }
                    Ok(capsule) => Verdict::Capsule(capsule),
                    Err(error) => Verdict::Bad(error),
                },
            },
        }
    }

    fn examine_node(&self, held: &[u8]) -> Verdict {
        let (Some(bytes), NODES..) = (held.first_chunk(), held.len()) else { return Verdict::Need(NODES) };
        let node = match Node::new(bytes) {
            Ok(node) => node,
            Err(error) => return Verdict::Bad(error),
        };
        let near = |a: u32, b: u32| a.wrapping_sub(b).wrapping_add(BACK) <= 2 * BACK;
        let next_begins = |at: usize| Node::angle(held.get(at..).unwrap_or(&[])).is_some_and(|a| near(a, node.angle));
        match self.expected {
            Some(expected) if self.unused < ASTRAY => {
                if !near(node.angle, expected) {
                    let moved_deg = (node.angle.wrapping_sub(expected) as i32 as f32 * (360.0 / FULL_TURN)) as i16;
                    return Verdict::Bad(PacketError::Elsewhere { moved_deg });
                }
            }
            // nothing to go on from: the next ones must go on from it
            _ => {
                let next = [NODE, 2 * NODE].map(|at| Node::angle(held.get(at..).unwrap_or(&[])));
                let onward = |from: u32, to: u32| from != to && to.wrapping_sub(from) < BACK;
                if !matches!(next, [Some(a), Some(b)] if onward(node.angle, a) && onward(a, b)) {
                    return Verdict::Bad(PacketError::Length);
                }
            }
        }
        if !next_begins(NODE) && (next_begins(NODE - 1) || next_begins(NODE + 1)) {
            return Verdict::Bad(PacketError::Length);
        }
        Verdict::Node(node)
    }
}

/// What the window holds.
enum Verdict {
    /// The beginning of a packet that is to be looked at when so many bytes are held.
    Need(usize),
    /// No beginning of a packet.
    Nothing,
    Bad(PacketError),
    Descriptor(Format),
    Node(Node),
    Capsule(Capsule),
}

impl LineScanner for Rplidar<'_> {
    type Error = PacketError;

    fn feed(&mut self, bytes: &[u8], now_us: u64) -> (usize, LineEvent<PacketError>) {
        self.cutter.next_row();
        let mut used = 0;
        loop {
            if self.take_beams() {
                return (used, LineEvent::Row);
            }
            match self.examine() {
                Verdict::Need(until) => {
                    let taken = self.window.fill(bytes.get(used..).unwrap_or(&[]), until);
                    if taken == 0 {
                        return (used, LineEvent::NeedMore);
                    }
                    used += taken;
                }
                Verdict::Nothing => self.drop(1),
                Verdict::Bad(error) => {
                    self.drop(1);
                    count(&mut self.counters.rejected, 1);
                    return (used, LineEvent::Rejected(error));
                }
                Verdict::Descriptor(format) => {
                    self.window.drop(DESCRIPTOR, |_| true);
                    self.format = Some(format);
                }
                Verdict::Node(node) => {
                    self.window.drop(NODE, |_| true);
                    self.take_node(node, self.sent_us(bytes.len() - used, now_us));
                }
                Verdict::Capsule(capsule) => {
                    self.window.drop(LONGEST, |_| true);
                    self.take_capsule(capsule, self.sent_us(bytes.len() - used, now_us));
                }
            }
        }
    }

    fn row(&self) -> Option<Row<'_>> {
        let (angles_rad, ranges_m) = self.cutter.row()?;
        let (end_us, mirror_turn_us) = (self.row_end_us, self.pace.turn_us);
        Some(Row { angles_rad, ranges_m, end_us, mirror_turn_us, merged_turns: 1, first_turn: 0 })
    }

    fn counters(&self) -> ScannerCounters {
        self.counters
    }
}

/// Time of a turn of the mirror, from row to row.
#[derive(Debug, Default)]
struct Pace {
    /// Turns since `since_us`.
    turns: f32,
    since_us: Option<u64>,
    /// The last known; 0 before there is one.
    turn_us: f32,
}

impl Pace {
    fn begin(&mut self, now_us: u64) {
        self.since_us = Some(now_us);
    }

    fn turned(&mut self, turns: f32) {
        self.turns += turns;
    }

    /// Takes note of the end of a row. Returns the time of a turn.
    fn row_ends(&mut self, now_us: u64) -> f32 {
        if let Some(since_us) = self.since_us.replace(now_us)
            && self.turns > 0.0
        {
            self.turn_us = now_us.saturating_sub(since_us) as f32 / self.turns;
        }
        self.turns = 0.0;
        self.turn_us
    }
}

/// Rounds to a whole number; below 0 is 0.
fn rounded(number: f32) -> u32 {
    (number + 0.5) as u32
}
