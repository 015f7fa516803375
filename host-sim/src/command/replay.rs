//! `scanseg replay`: what a scanner and its tilt said, through the same code as on a board.

use std::fs;
use std::path::PathBuf;
use std::rc::Rc;

use clap::Args;
use scanseg_hal::link::Message;
use scanseg_hal::lms2xx::{Action, Session, Variant};
use scanseg_hal::rig::Rig;
use scanseg_sim::format::capture::{Came, Capture, HEAD};
use scanseg_sim::format::{Angles, FileError, Geometry, Kind, TurnAxis, write_atomic};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, SegmentationError, Segmenter};

use super::messages::Output;
use super::options::{Options, in_terms_of_options};
use super::{Failure, print};

/// Replay what was recorded of a scanner: telegrams to segments, as on a board
///
/// The capture is one of scanseg rig --save, or the raw bytes that a SICK LMS 2xx sent, with the turn angle of each of its
/// telegrams in a geometry file.
#[derive(Args)]
pub struct Arguments {
    /// Capture, or raw bytes of the scanner
    capture: PathBuf,
    /// Raw bytes: geometry file (TOML) of a nodding scanner; telegram n is its row n
    #[arg(long, value_name = "FILE", requires = "range_bits")]
    geometry: Option<PathBuf>,
    /// Raw bytes: how many bits of a value are the range, 13 to 16; the scanner's measuring mode says so
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(13..=16), requires = "geometry")]
    range_bits: Option<u32>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    options: Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let name = arguments.capture.display().to_string();
    let file_error = |cause| FileError { path: arguments.capture.clone(), cause };
    let raw = fs::read(&arguments.capture).map_err(|e| file_error(e.into()))?;
    let (capture, geometry) = match (raw.starts_with(HEAD.as_bytes()), &arguments.geometry, arguments.range_bits) {
        (true, None, _) => {
            let text = String::from_utf8_lossy(&raw);
            let capture = Capture::parse(&text).map_err(|e| file_error(e.into()))?;
            let geometry = geometry_of(capture.settings.variant);
            (capture, geometry)
        }
        (true, Some(_), _) => return Err(format!("{name}: this capture needs no --geometry").into()),
        (false, Some(path), Some(range_bits)) => {
            let geometry = Geometry::read(path)?;
            let capture = Capture::of_telegrams(&raw, &geometry, range_bits).map_err(|e| file_error(e.into()))?;
            (capture, geometry)
        }
        (false, ..) => return Err(format!("{name}: raw bytes need --geometry and --range-bits").into()),
    };
    let columns = usize::from(capture.settings.variant.columns());
    let rows = match &geometry.kind {
        Kind::Nodding { turn_deg: Angles::Listed(list), .. } => list.len(),
        _ => 1,
    };
    let refused = |e: SegmentationError| in_terms_of_options(&name, e);
    let beams = ScanBeams::new(&geometry, rows, columns).map_err(|e| refused(e.into()))?;
    arguments.options.check()?;
    let config = arguments.options.config(&geometry);
    let mut memory = OwnedMemory::new(columns, &config, arguments.options.max_labels());
    let segmenter = Segmenter::new(arguments.options.approach(), config, beams.beams(), columns, memory.memory())
        .map_err(|e| refused(e.into()))?;
    let mut rows_m = vec![0.0; 2 * columns];
    let mut rig =
        Rig::new(capture.settings, capture.limits, segmenter, &mut rows_m).map_err(|e| format!("{name}: {e}"))?;

    let host = Rc::default();
    let mut reporter = arguments.output.reporter(&host);
    let mut session = Session::listening(capture.settings);
    for came in &capture.events {
        match came {
            Came::Tilt(sample) => rig.tilt(*sample),
            Came::Bytes { time_us, bytes } => {
                rig.receive(&mut session, bytes, *time_us, &mut reporter);
                if let Action::Tell(trouble) = session.poll((time_us / 1000) as u32) {
                    rig.trouble(trouble, &mut reporter);
                }
                rig.idle(*time_us, &mut reporter);
            }
        }
    }
    rig.finish(&mut reporter);
    if rig.counters().scans == 0 {
        reporter.send(&Message::Status(rig.counters()));
    }
    let host = host.borrow();
    if let Some(path) = &arguments.output.link {
        write_atomic(path, &host.bytes)?;
    }
    print(&host.lines.iter().map(|line| line.clone() + "\n").collect::<String>())
}

/// The geometry of an LMS 2xx that tilts, see [`scanseg_hal::rig::beams`]. Turn angles come with the rows.
pub fn geometry_of(variant: Variant) -> Geometry {
    let beam_deg =
        Angles::Even { start: -f64::from(variant.view_deg()) / 2.0, step: f64::from(variant.step_cdeg()) / 100.0 };
    let turn_deg = Angles::Even { start: 0.0, step: 1.0 };
    Geometry {
        unit_m: 0.001,
        no_return: vec![],
        min_range_m: None,
        max_range_m: None,
        range_noise_m: None,
        kind: Kind::Nodding { beam_deg, turn_deg, turn_axis: TurnAxis::Y },
    }
}
