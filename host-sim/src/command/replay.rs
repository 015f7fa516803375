//! `scanseg replay`: what a scanner and its tilt said, through the same code as on a board.

use std::fs;
use std::path::PathBuf;
use std::rc::Rc;

use clap::Args;
use scanseg_core::{AnySegmenter, Segmenter};
use scanseg_formats::capture::{Capture, CaptureEvent, HEAD, geometry_on_tilt};
use scanseg_formats::{Angles, FileError, Geometry, Kind, write_atomic};
use scanseg_hal::link::Message;
use scanseg_hal::lms2xx::{Action, Session};
use scanseg_hal::rig::{Rig, RigSink};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, SegmentationError};

use crate::command::messages::LinkOptions;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, print};

/// Replay what was recorded of a scanner: telegrams to segments, as on a board
///
/// The capture is one of scanseg rig --save, or the raw bytes that a SICK LMS 2xx sent, with the
/// turn angle of each of its telegrams in a geometry file.
#[derive(Args)]
pub struct Arguments {
    /// Capture, or raw bytes of the scanner
    capture: PathBuf,
    /// Raw bytes: geometry file (TOML) of a nodding scanner; telegram n is its row n
    #[arg(long, value_name = "FILE", requires = "range_bits")]
    geometry: Option<PathBuf>,
    /// Raw bytes: how many bits of a value are the range, 13 to 16; the scanner's measuring mode
    /// says so
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(13..=16), requires = "geometry")]
    range_bits: Option<u32>,
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    options: Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.capture.display().to_string();
    let (capture, geometry) = read(arguments)?;
    let columns = usize::from(capture.settings.variant.columns());
    let rows = match &geometry.kind {
        Kind::Nodding { turn_deg: Angles::Listed(list), .. } => list.len(),
        _ => 1,
    };
    let refused = |e: SegmentationError| in_terms_of_options(&name, e);
    let beams = ScanBeams::new(&geometry, rows, columns).map_err(|e| refused(e.into()))?;
    let config = arguments.options.config(&geometry)?;
    let mut memory = OwnedMemory::new(config, columns, arguments.options.max_labels());
    let segmenter =
        AnySegmenter::new(config, beams.beams(), columns, memory.memory()).map_err(|e| refused(e.into()))?;
    let mut rows_m = vec![0.0; 2 * columns];
    let mut rig =
        Rig::new(capture.settings, capture.limits, segmenter, &mut rows_m).map_err(|e| format!("{name}: {e}"))?;

    let host = Rc::default();
    let mut reporter = arguments.link.reporter(&host);
    play(&capture, &mut rig, &mut reporter);
    if rig.counters().scans == 0 {
        reporter.send(&Message::Status(rig.counters()));
    }
    let host = host.borrow();
    if let Some(path) = &arguments.link.link {
        write_atomic(path, &host.bytes)?;
    }
    print(&host.lines.iter().map(|line| line.clone() + "\n").collect::<String>())
}

/// Reads the capture, or makes one of raw bytes, and the geometry of its scans.
fn read(arguments: &Arguments) -> Result<(Capture, Geometry), Failure> {
    let name = arguments.capture.display();
    let file_error = |cause| FileError { path: arguments.capture.clone(), cause };
    let raw = fs::read(&arguments.capture).map_err(|e| file_error(e.into()))?;
    match (raw.starts_with(HEAD.as_bytes()), &arguments.geometry, arguments.range_bits) {
        (true, None, _) => {
            let text = String::from_utf8_lossy(&raw);
            let capture = Capture::parse(&text).map_err(|e| file_error(e.into()))?;
            let geometry = geometry_on_tilt(capture.settings.variant);
            Ok((capture, geometry))
        }
        (true, Some(_), _) => Err(format!("{name}: this capture needs no --geometry").into()),
        (false, Some(path), Some(range_bits)) => {
            let geometry = Geometry::read(path)?;
            Ok(Capture::of_telegrams(&raw, &geometry, range_bits).map_err(|e| file_error(e.into()))?)
        }
        (false, ..) => Err(format!("{name}: raw bytes need --geometry and --range-bits").into()),
    }
}

/// Gives the rig all that the capture holds, as a board would.
fn play(capture: &Capture, rig: &mut Rig<'_, impl Segmenter>, sink: &mut impl RigSink) {
    let mut session = Session::listening(capture.settings);
    for event in &capture.events {
        match event {
            CaptureEvent::Tilt(sample) => rig.tilt(*sample),
            CaptureEvent::Bytes { time_us, bytes } => {
                rig.receive(&mut session, bytes, *time_us, sink);
                if let Action::Tell(trouble) = session.poll((time_us / 1000) as u32) {
                    rig.trouble(trouble, sink);
                }
                rig.idle(*time_us, sink);
            }
        }
    }
    rig.finish(sink);
}
