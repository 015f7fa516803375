//! Velodyne and Ouster: each firing is a row, each turn a scan that goes round.

use scanseg_core::{AnyConfig, PlaneSegmenter, RowBeams, Segmenter};
use scanseg_formats::lidar::{FiringRows, Metadata};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams};

use crate::command::live::packets::Packets;
use crate::command::live::report::Report;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::Failure;

/// A turn has fewer rows than the core takes.
const MOST_ROWS: usize = 60_000;

pub fn run(
    packets: &mut Packets,
    metadata: Option<&Metadata>,
    options: &Options,
    report: &mut Report,
) -> Result<(), Failure> {
    let Some(first) = packets.next() else { return Ok(()) };
    let mut rows = FiringRows::of(&first.content, metadata)?;
    let geometry = rows.geometry();
    let refused = |e| in_terms_of_options("live", e);
    let columns = rows.columns();
    let beams = ScanBeams::new(&geometry, 1, columns).map_err(|e| refused(e.into()))?;
    let AnyConfig::Plane(config) = options.config(&geometry)? else {
        return Err("live: turns without an end are segmented by the default approach only".into());
    };
    let config = config.with_full_turns();
    let mut memory = OwnedMemory::new(config, columns, options.max_labels());
    let mut segmenter =
        PlaneSegmenter::new(config, beams.beams(), columns, memory.memory()).map_err(|e| refused(e.into()))?;
    let mut next = Some(first);
    let mut of_turn = 0;
    while let Some(packet) = next {
        let mut came = vec![];
        rows.push(&packet.content, |row| came.push((row.turn_deg, row.begins_turn, row.range_m.to_vec())));
        for (turn_deg, begins_turn, range_m) in came {
            if (begins_turn || of_turn == MOST_ROWS) && of_turn > 0 {
                segmenter.finish(report);
                of_turn = 0;
                if !report.turn_done(&lost(&rows, packets))? {
                    return Ok(());
                }
            }
            let row = RowBeams::from(turn_deg.to_radians() as f32).with_lever_arm_m(geometry.beside.lever_arm_m as f32);
            segmenter.push_row(&range_m, row, report).map_err(|e| refused(e.into()))?;
            of_turn += 1;
        }
        report.packet_done(packet.came);
        next = packets.next();
    }
    segmenter.finish(report);
    report.turn_done(&lost(&rows, packets)).map(|_| ())
}

/// Returns what is missing, in words.
fn lost(rows: &FiringRows, packets: &Packets) -> String {
    format!("lost {} rows, {} packets too slow, {} strange", rows.lost, packets.dropped(), rows.other_packets)
}
