//! `scanseg ros2`: what a topic of ROS 2 brings, segmented and published while it comes.

mod cdr;
mod published;
mod session;
mod topics;

use std::path::PathBuf;
use std::sync::atomic::Ordering;
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Args;
use ros2_client::{Context, ContextOptions, NodeName, NodeOptions};
use scanseg_formats::ReadOptions;
use scanseg_formats::ros::{Came, LiveScans};

use crate::command::live::packets::{Packets, stop};
use crate::command::live::report::Report;
use crate::command::options::Options;
use crate::command::output::{Failure, print};
use crate::command::ros2::published::Published;
use crate::command::ros2::session::Session;
use crate::command::ros2::topics::Topics;

/// Segment what a topic of ROS 2 brings, while it comes
///
/// PointCloud2 (organised), Image of depths with the camera_info beside it, or LaserScan with what
/// turns it (/tf, or the only joint of /joint_states that moves). No ROS need be installed. Publishes
/// /scanseg/points, the scan as a PointCloud2 with rgb and label, and /scanseg/planes, its segments as
/// markers; of a LaserScan also /scanseg/rows, each row as soon as its turn is known. Each scan prints a line: its planes, the rate, how long it waits from its arrival until it
/// is published, and what was lost. Ctrl-C ends it. The domain is that of ROS_DOMAIN_ID.
#[derive(Args)]
pub struct Arguments {
    /// The topic, as /camera/depth/points
    topic: String,
    /// A geometry file: its limits and its errors hold
    #[arg(long, value_name = "FILE")]
    geometry: Option<PathBuf>,
    /// Metres of one count, or of one unit of the coordinates [default: 0.001 of counts, 1 of
    /// coordinates]
    #[arg(long, value_name = "M")]
    unit_m: Option<f64>,
    /// Write each segment as a line of CSV
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Stop after so many scans
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    scans: Option<u32>,
    /// Smaller segments are left out
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u32).range(1..))]
    min_pixels: u32,
    #[command(flatten)]
    options: Options,
}

/// So often it is looked for a topic that is not there.
const LOOK: Duration = Duration::from_millis(50);

/// So long the last messages have to get to those that listen; nothing tells whether they have.
const LAST: Duration = Duration::from_millis(200);

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let stop = stop();
    let report = Report::new("scan", arguments.out.as_deref(), arguments.scans, arguments.min_pixels)?;
    let context = Context::with_options(ContextOptions::new().domain_id(domain()?))?;
    let options = NodeOptions::new().enable_rosout(false).start_parameter_services(false);
    let mut node = context.new_node(NodeName::new("/", "scanseg")?, options)?;
    // those that listen find it while it waits
    let published = Published::new(&mut node)?;
    print(&format!("waiting for {}\n", arguments.topic))?;
    let dds_name = format!("rt{}", arguments.topic);
    let kind = loop {
        if stop.load(Ordering::Relaxed) {
            return Ok(());
        }
        let writers = context.domain_participant().discovered_writers();
        let mut topics = writers.iter().map(|writer| &writer.publication_topic_data);
        match topics.find(|topic| topic.topic_name == dds_name) {
            Some(topic) => break topic.type_name.replace("::dds_::", "::").replace("::", "/"),
            None => sleep(LOOK),
        }
    };
    let kind = kind.strip_suffix('_').unwrap_or(&kind);
    let read = ReadOptions { geometry: arguments.geometry.clone(), unit_m: arguments.unit_m, ..ReadOptions::default() };
    let scans = LiveScans::new(&arguments.topic, kind, read)
        .ok_or_else(|| format!("{}: no scans are read of {kind}", arguments.topic))?;
    let topics = Topics::subscribe(&context, &node, &scans.needed())?;
    let lost = topics.lost();
    let packets = Packets { incoming: topics.incoming()?, stop };
    print(&format!("listening to {} ({kind})\n", arguments.topic))?;

    let mut session = Session {
        topic: &arguments.topic,
        options: &arguments.options,
        min_pixels: arguments.min_pixels,
        scans,
        packets,
        published,
        report,
        lost,
        came: Instant::now(),
        strange: 0,
        unsent: 0,
    };
    let mut next = session.next();
    while let Some(came) = next {
        next = match came {
            Came::Scan(scan) => {
                if session.scan(scan)? {
                    session.next()
                } else {
                    None
                }
            }
            Came::Row { row, .. } => session.rows(row)?,
        };
    }
    sleep(LAST);
    Ok(())
}

/// Returns the domain of ROS 2.
fn domain() -> Result<u16, Failure> {
    match std::env::var("ROS_DOMAIN_ID") {
        Ok(text) if !text.is_empty() => {
            text.parse().map_err(|_| format!("ROS_DOMAIN_ID is {text}, not a number").into())
        }
        _ => Ok(0),
    }
}
