//! `scanseg live`: what a scanner sends, segmented while it sends.

pub mod incoming;
pub mod packets;
mod panned;
pub mod report;
mod spinning;

use std::path::PathBuf;

use clap::Args;
use scanseg_formats::lidar::read_metadata;

use crate::command::live::incoming::Incoming;
use crate::command::live::packets::{Packets, stop};
use crate::command::live::report::Report;
use crate::command::options::Options;
use crate::command::output::{Failure, print};

/// Segment what a scanner sends, while it sends
///
/// Velodyne and Ouster over UDP, firing by firing; an LD06 over a serial line, turn by turn of its
/// mirror. Each turn prints a line: its planes, the rate, how long a packet waits from its arrival
/// until it is segmented, and what was lost. Ctrl-C ends it with the turn so far.
#[derive(Args)]
pub struct Arguments {
    /// udp:PORT or udp:ADDRESS:PORT (Velodyne: 2368, Ouster: 7502), or the serial device of an LD06, which is set
    /// up beforehand (stty -F DEVICE 230400 raw -echo); - for standard input
    source: String,
    /// Of an Ouster its metadata (JSON); of an LD06 a geometry file of kind "nodding", which says how
    /// it is turned
    #[arg(long, value_name = "FILE")]
    geometry: Option<PathBuf>,
    /// Write each segment as a line of CSV
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Stop after so many turns; the first begins anywhere
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    turns: Option<u32>,
    /// Smaller segments are left out
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    min_pixels: u32,
    #[command(flatten)]
    options: Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stop = stop();
    let mut report = Report::new("turn", arguments.out.as_deref(), arguments.turns, arguments.min_pixels)?;
    let geometry = arguments.geometry.as_deref();
    match arguments.source.strip_prefix("udp:") {
        Some(address) => {
            let metadata = geometry.map(read_metadata).transpose()?;
            let (incoming, bound) = Incoming::udp(address)?;
            print(&format!("listening on {bound}\n"))?;
            let mut packets = Packets { incoming, stop };
            spinning::run(&mut packets, metadata.as_ref(), &arguments.options, &mut report)
        }
        None => {
            let mut packets = Packets { incoming: Incoming::bytes(&arguments.source)?, stop };
            panned::run(&mut packets, geometry, &arguments.options, &mut report)
        }
    }
}
