//! An LD06: each turn of its mirror is a row.

use std::path::Path;
use std::time::Instant;

use scanseg_core::{AnySegmenter, RowBeams, Segmenter};
use scanseg_formats::lidar::ld06;
use scanseg_formats::{Angles, Kind};
use scanseg_hal::ld06::{Ld06, Model};
use scanseg_hal::scanner::{LineEvent, LineScanner, Row, RowMemory, View};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams};

use crate::command::live::packets::Packets;
use crate::command::live::report::Report;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, print};

/// So many bytes tell which scanner it is.
const TELLING_BYTES: usize = 1024;
/// A mirror that turns all the way round has seen everything after half a turn of the whole.
const SWEEP_DEG: f64 = 180.0;

pub fn run(packets: &mut Packets, file: Option<&Path>, options: &Options, report: &mut Report) -> Result<(), Failure> {
    let mut begun = vec![];
    while begun.len() < TELLING_BYTES {
        let Some(packet) = packets.next() else { break };
        begun.extend(packet.content);
    }
    let (mut angles_rad, mut ranges_m) = (vec![0.0; ld06::MAX_BEAMS], vec![0.0; ld06::MAX_BEAMS]);
    let memory = RowMemory { angles_rad: &mut angles_rad, ranges_m: &mut ranges_m };
    let mut scanner = Ld06::new(ld06::model(&begun).unwrap_or(Model::Ld06), View::FULL, memory);

    // the first whole turn tells the columns
    let (mut bytes, mut came) = (begun, Instant::now());
    let first = loop {
        let (rest, found) = next_turn(&mut scanner, &bytes);
        bytes = rest.to_vec();
        if let Some(row) = found {
            break (row.angles_rad.to_vec(), row.ranges_m.to_vec());
        }
        let Some(packet) = packets.next() else { return Err("live: no turn of an LD06 came".into()) };
        (bytes, came) = (packet.content, packet.came);
    };
    let columns = first.0.len();
    let (geometry, remark) = ld06::geometry(file, columns)?;
    if let Some(remark) = remark {
        print(&format!("{remark}\n"))?;
    }
    let Kind::Nodding { turn_deg, .. } = &geometry.kind else { unreachable!("an LD06 nods") };
    let rows = rows_of_a_scan(turn_deg);
    let refused = |e| in_terms_of_options("live", e);
    let beams = ScanBeams::new(&geometry, rows, columns).map_err(|e| refused(e.into()))?;
    let config = options.config(&geometry)?;
    let mut memory = OwnedMemory::new(config, columns, options.max_labels());
    let mut segmenter =
        AnySegmenter::new(config, beams.beams(), columns, memory.memory()).map_err(|e| refused(e.into()))?;
    let (mut true_rad, mut range_m) = (vec![0.0; columns], vec![0.0; columns]);
    let mut turns = 0;
    let mut push = |found: &Row<'_>, lost: &str, report: &mut Report| -> Result<bool, Failure> {
        let offset_deg = ld06::to_columns(found, &mut true_rad, &mut range_m);
        let at = RowBeams::from(turn_deg.at(turns).to_radians() as f32)
            .with_offset_rad(offset_deg.to_radians() as f32)
            .with_lever_arm_m(geometry.beside.lever_arm_m as f32);
        segmenter.push_row(&range_m, at, report).map_err(|e| refused(e.into()))?;
        turns = (turns + 1) % rows;
        if turns > 0 {
            return Ok(true);
        }
        segmenter.finish(report);
        report.turn_done(lost)
    };
    let (angles_rad, ranges_m) = (&first.0[..], &first.1[..]);
    let first = Row { angles_rad, ranges_m, end_us: 0, mirror_turn_us: 0.0, merged_turns: 1, first_turn: 0 };
    let mut goes_on = push(&first, &lost(&scanner), report)?;
    while goes_on {
        let lost = lost(&scanner);
        let (rest, found) = next_turn(&mut scanner, &bytes);
        if let Some(row) = found {
            goes_on = push(&row, &lost, report)?;
            bytes = rest.to_vec();
            continue;
        }
        report.packet_done(came);
        let Some(packet) = packets.next() else { break };
        (bytes, came) = (packet.content, packet.came);
    }
    if !goes_on {
        return Ok(());
    }
    segmenter.finish(report);
    report.turn_done(&lost(&scanner)).map(|_| ())
}

/// Returns the first whole turn of the mirror that bytes complete, and the rest of them.
fn next_turn<'b, 's>(scanner: &'s mut Ld06<'_>, bytes: &'b [u8]) -> (&'b [u8], Option<Row<'s>>) {
    let mut rest = bytes;
    loop {
        let (used, event) = scanner.feed(rest, 0);
        rest = &rest[used..];
        match event {
            LineEvent::NeedMore => return (rest, None),
            LineEvent::Row if scanner.row().is_some_and(|row| ld06::is_turn(&row)) => break,
            LineEvent::Row | LineEvent::Rejected(_) => {}
        }
    }
    (rest, scanner.row())
}

fn rows_of_a_scan(turn_deg: &Angles) -> usize {
    match turn_deg {
        Angles::Listed(list) => list.len(),
        Angles::Even { step_deg, .. } => (SWEEP_DEG / step_deg.abs()).clamp(1.0, 60_000.0) as usize,
    }
}

/// Returns what is missing, in words.
fn lost(scanner: &Ld06<'_>) -> String {
    let counters = scanner.counters();
    format!("lost {} packets, {} damaged", counters.lost, counters.rejected)
}
