//! Wires with faults: what becomes of each packet.

use scanseg_hal::ld06::{Ld06, Model, Packet};
use scanseg_hal::rplidar::{Command, Format, Rplidar};
use scanseg_hal::scanner::{LineEvent, LineScanner, ScannerCounters, View};
use scanseg_virtual_rig::{VirtualLd06, VirtualRplidar, WireFaults};

use crate::{EVERY_HUNDREDTH, MOST, VIEW, feed, memory, wires};

/// A line that is cut for some time: the clock tells how many turns are missing.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn turns_are_missed() {
    let mut ld06 = VirtualLd06::new(Model::Ld06, 10.0, |_, _| 1000);
    let packets: Vec<(u64, Vec<u8>)> = (0..1000).map(|_| ld06.next_packet()).map(|(us, p)| (us, p.to_vec())).collect();
    let mut scanner = Ld06::new(Model::Ld06, VIEW, memory(MOST));
    cut(&mut scanner, &packets);
    let mut rplidar = VirtualRplidar::new(Format::Dense, 5000.0, 10.0, 460_800, |_, _| 1000);
    rplidar.command(Command::ExpressScan { mode: 1 }.encode().as_slice());
    let packets: Vec<(u64, Vec<u8>)> = (0..1000).map(|_| rplidar.next_packet().expect("it scans")).collect();
    let mut scanner = Rplidar::listening(Format::Dense, 460_800, VIEW, memory(MOST));
    cut(&mut scanner, &packets);
}

fn cut(scanner: &mut impl LineScanner, packets: &[(u64, Vec<u8>)]) {
    for (time_us, packet) in packets.iter().take(300).chain(&packets[487..]) {
        let mut rest = &packet[..];
        loop {
            let (used, event) = scanner.feed(rest, *time_us);
            rest = &rest[used..];
            if matches!(event, LineEvent::NeedMore) {
                break;
            }
            let row = scanner.row().expect("nothing is rejected");
            assert!(row.angles_rad.is_sorted_by(|a, b| a > b), "of one turn");
        }
    }
    assert_eq!(scanner.counters().lost, 187);
}

/// What a scanner made of damaged wires.
struct Outcome {
    whole: Vec<usize>,
    found: Vec<Option<usize>>,
    counters: ScannerCounters,
}

impl Outcome {
    /// Checks that whole packets are found, and lost ones counted.
    fn check(&self, name: &str, false_ones: usize, off_by_each: usize) {
        let right: Vec<usize> = self.found.iter().copied().flatten().filter(|n| self.whole.contains(n)).collect();
        let (Some(&first), Some(&last)) = (right.first(), right.last()) else { panic!("{name}: nothing found") };
        println!("{name}: {} whole, {} found, {:?}", self.whole.len(), self.found.len(), self.counters);
        let missed: Vec<_> = self.whole.iter().filter(|n| !right.contains(n)).collect();
        assert!(missed.is_empty(), "{name}: whole packets {missed:?} are not found");
        let found_false = self.found.len() - right.len();
        assert!(found_false <= false_ones, "{name}: {found_false} false");
        assert_eq!(self.counters.packets as usize, self.found.len());
        let lost = (last - first + 1).saturating_sub(self.found.len());
        let off = (self.counters.lost as usize).abs_diff(lost);
        assert!(off <= 2 * off_by_each * found_false, "{name}: {lost} lost, {} counted", self.counters.lost);
    }
}

const KINDS: [(&str, WireFaults); 4] = [
    ("loss", WireFaults { drop_one_in: 100, flip_one_in: 0, insert_one_in: 0, burst_one_in: 0 }),
    ("flip", WireFaults { drop_one_in: 0, flip_one_in: 100, insert_one_in: 0, burst_one_in: 0 }),
    ("insertion", WireFaults { drop_one_in: 0, flip_one_in: 0, insert_one_in: 100, burst_one_in: 0 }),
    ("all", EVERY_HUNDREDTH),
];

/// Sends packets over wires with faults, each byte on its own. `number_of` returns which packet was
/// taken last.
fn damaged<S: LineScanner>(
    faults: WireFaults,
    packets: &[Vec<u8>],
    scanner: &mut S,
    mut number_of: impl FnMut(&S) -> Option<usize>,
) -> Outcome {
    let mut wires = wires(faults);
    let (mut whole, mut found) = (vec![], vec![]);
    for (number, packet) in packets.iter().enumerate() {
        let came: Vec<Vec<u8>> = packet.iter().map(|&byte| wires.damage(byte).collect()).collect();
        let came = came.concat();
        // what is inserted behind the last byte does no harm
        if came.starts_with(packet) {
            whole.push(number);
        }
        for byte in came {
            let mut rest = &[byte][..];
            loop {
                let before = scanner.counters().packets;
                let (used, event) = scanner.feed(rest, 0);
                rest = &rest[used..];
                (before..scanner.counters().packets).for_each(|_| found.push(number_of(scanner)));
                if matches!(event, LineEvent::NeedMore) {
                    break;
                }
            }
        }
    }
    Outcome { whole, found, counters: scanner.counters() }
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn every_whole_packet_of_an_ld06_is_used() {
    for model in [Model::Ld06, Model::Stl27l] {
        let mut seed = 1u32;
        let mut virtual_scanner = VirtualLd06::new(model, 10.0, move |_, _| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // some ranges look like the beginning of a packet
            if seed >> 28 == 0 { 0x2C54 } else { (seed >> 20) as u16 }
        });
        let packets: Vec<Vec<u8>> = (0..3000).map(|_| virtual_scanner.next_packet().1.to_vec()).collect();
        let sent: Vec<Packet> =
            packets.iter().map(|packet| Packet::new(packet[..].try_into().unwrap(), model).unwrap()).collect();
        for (name, faults) in KINDS {
            let mut scanner = Ld06::new(model, VIEW, memory(MOST));
            let outcome = damaged(faults, &packets, &mut scanner, |scanner| {
                let last = scanner.last_packet()?;
                sent.iter().position(|packet| packet == last)
            });
            // of damaged packets a CRC of 8 bits lets one in 256 pass
            let packets_per_turn = model.beams_per_s() as usize / 120;
            outcome.check(&format!("{model:?} {name}"), 15, packets_per_turn);
        }
    }
}

/// The range of each beam is the number of its packet.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn every_whole_packet_of_an_rplidar_is_used() {
    for format in [Format::Node, Format::Express, Format::Dense] {
        let count = if format == Format::Node { 15_000 } else { 3000 };
        let beams = format.beams();
        let mut beam = 0;
        let mut virtual_scanner = VirtualRplidar::new(format, 4000.0, 8.0, 115_200, move |_, _| {
            beam += 1;
            ((beam - 1) / beams + 1) as u16
        });
        let command = if format == Format::Node { Command::Scan } else { Command::ExpressScan { mode: 0 } };
        virtual_scanner.command(command.encode().as_slice());
        let packets: Vec<Vec<u8>> = (0..count).map(|_| virtual_scanner.next_packet().expect("it scans").1).collect();
        for (name, faults) in KINDS {
            let mut wires = wires(faults);
            let (mut bytes, mut whole) = (vec![], vec![]);
            for (number, packet) in packets.iter().enumerate() {
                let before = bytes.len();
                bytes.extend(packet.iter().flat_map(|&byte| wires.damage(byte)));
                // behind the last byte of a capsule an inserted one does no harm; behind a node it cannot be
                // told from one within
                let came = &bytes[before..];
                if if format == Format::Node { came == packet } else { came.starts_with(packet) } {
                    whole.push(number);
                }
            }
            let mut scanner = Rplidar::listening(format, 115_200, View::FULL, memory(MOST));
            let (rows, _) = feed(&mut scanner, &bytes, &[64]);
            let counters = scanner.counters();
            println!("{format:?} {name}: {} whole of {count}, {counters:?}", whole.len());
            let mut found = vec![0; count];
            let mut false_beams = 0;
            for range_m in rows.iter().flat_map(|row| &row.ranges_m) {
                match found.get_mut(((range_m * 1000.0).round() as usize).wrapping_sub(1)) {
                    Some(found) => *found += 1,
                    None => false_beams += 1,
                }
            }
            // the last row is not over: two turns of 500 beams
            let known = count - 1000 / beams;
            let missed = whole.iter().filter(|&&number| number < known && found[number] < beams).count();
            let lost = count - counters.packets as usize;
            println!("  {missed} missed, {false_beams} beams of none, {lost} lost");
            let packets = whole.len();
            let (most_missed, lost_off) = match format {
                // where a byte is lost between two nodes, nothing tells whose it was: both are refused
                Format::Node => (packets / 100, count / 200),
                // of damaged capsules the checksum lets one in 256 pass, and of those with two flipped
                // bits one in 30; such a one may hide the one behind it
                _ => (3, lost / 50),
            };
            assert!(missed <= most_missed, "{format:?} {name}: {missed} whole packets are not used");
            assert!(false_beams <= count / 10, "{format:?} {name}");
            let counted = counters.lost as usize;
            assert!(counted.abs_diff(lost) <= lost_off, "{format:?} {name}: {lost} lost, {counted} counted");
        }
    }
}
