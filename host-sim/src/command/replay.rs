//! `scanseg replay`: what a scanner and its tilt said, through the same code as on a board.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use clap::Args;
use scanseg_core::{AnySegmenter, Segmenter};
use scanseg_formats::capture::{Capture, CaptureError, CaptureEvent, MAGIC, geometry_on_tilt};
use scanseg_formats::{Angles, FileError, Geometry, Kind, read_at_most, write_atomic};
use scanseg_hal::link::Message;
use scanseg_hal::lms2xx::{Action, Session};
use scanseg_hal::rig::{Rig, RigSink};
use scanseg_sim::segmentation::{OwnedMemory, RecordedScan, Recorder, ScanBeams, SegmentationError, enough_labels};

use crate::command::input::{Input, read_geometry, with_page};
use crate::command::messages::LinkOptions;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, print, warn, write};
use crate::command::segment::{ListOptions, segment};
use crate::command::warnings;

/// Replay what was recorded of a scanner: telegrams to segments, as on a board
///
/// The capture is one of scanseg rig --save, or the raw bytes that a SICK LMS 2xx sent, with the
/// turn angle of each of its telegrams in a geometry file.
#[derive(Args)]
pub struct Arguments {
    /// Capture, or raw bytes of the scanner
    capture: PathBuf,
    /// Raw bytes: geometry file of a nodding scanner, see docs/scan-format.md; telegram n is its
    /// row n
    #[arg(long, value_name = "FILE", requires = "range_bits")]
    geometry: Option<PathBuf>,
    /// Raw bytes: how many bits of a value are the range, 13 to 16; the scanner's measuring mode
    /// says so
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(13..=16), requires = "geometry")]
    range_bits: Option<u32>,
    /// Folder for the files that scanseg segment writes, in a folder scan-N for scan N; made if it
    /// is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    options: Options,
}

/// No capture is longer: three hours of a scanner at its fastest.
const MOST_BYTES: u64 = 1 << 30;

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
    let scans = Rc::default();
    let segmenter = Recorder::new(segmenter, &scans);
    let mut rows_m = vec![0.0; 2 * columns];
    let mut rig =
        Rig::new(capture.settings, capture.limits, segmenter, &mut rows_m).map_err(|e| format!("{name}: {e}"))?;
    if arguments.geometry.is_some() {
        // of even turn angles as many as telegrams, and one before the first
        let tilts = capture.events.iter().filter(|event| matches!(event, CaptureEvent::Tilt(_))).count();
        let rows = if rows > 1 { rows } else { tilts.saturating_sub(1) };
        warnings::of_geometry(&name, &geometry, rows, columns).iter().for_each(|warning| warn(warning));
    }
    let stated = arguments.options.states_noise(&geometry);
    warnings::no_noise(&name, &config, stated).iter().for_each(|warning| warn(warning));

    let host = Rc::default();
    let mut reporter = arguments.link.reporter(&host);
    let lines = || host.borrow_mut().take_lines(usize::MAX).iter().map(|line| line.clone() + "\n").collect::<String>();
    let played = play(&capture, &mut rig, &mut reporter, || print(&lines())).and_then(|()| {
        if rig.counters().scans == 0 {
            reporter.send(&Message::Status(rig.counters()));
        }
        print(&lines())
    });
    let host = host.borrow();
    let (enough, max_labels) = (enough_labels(config.approach(), columns), arguments.options.max_labels());
    warnings::unlabelled_pixels(&name, host.unlabelled, enough, max_labels).iter().for_each(|warning| warn(warning));
    if let Some(path) = &arguments.link.link {
        write_atomic(path, &host.bytes)?;
    }
    played?;
    let Some(out) = &arguments.out else { return Ok(()) };
    for (number, scan) in (1..).zip(scans.take()) {
        write_scan(out, number, scan, &geometry, arguments)?;
    }
    Ok(())
}

/// Writes what `scanseg segment` writes of a scan.
fn write_scan(
    out: &Path,
    number: u32,
    scan: RecordedScan,
    geometry: &Geometry,
    arguments: &Arguments,
) -> Result<(), Failure> {
    let mut geometry = geometry.clone();
    if let Kind::Nodding { turn_deg, .. } = &mut geometry.kind {
        *turn_deg = Angles::Listed(scan.turns_rad.iter().map(|rad| f64::from(*rad).to_degrees()).collect());
    }
    let ranges = scan.image();
    let counts = ranges.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    let name = format!("{}, scan {number}", arguments.capture.display());
    let config = arguments.options.config(&geometry)?;
    let input = Input { name, geometry, ranges, counts, remarks: vec![] };
    let lists = ListOptions::usual(arguments.link.min_pixels);
    let (files, _) = segment(&input, config, &arguments.options, &lists)?;
    let folder = out.join(format!("scan-{number}"));
    write(&folder, &files)?;
    print(&format!("look at {}\n", folder.join("overview.png").display()))
}

/// Reads the capture, or makes one of raw bytes, and the geometry of its scans.
fn read(arguments: &Arguments) -> Result<(Capture, Geometry), Failure> {
    let name = arguments.capture.display();
    let file_error = |cause| FileError { path: arguments.capture.clone(), cause };
    let raw = read_at_most(&arguments.capture, MOST_BYTES).map_err(|e| file_error(e.into()))?;
    match (raw.starts_with(MAGIC.as_bytes()), &arguments.geometry, arguments.range_bits) {
        (true, None, _) => {
            let text = String::from_utf8_lossy(&raw);
            let capture = Capture::parse(&text).map_err(|e| file_error(e.into()))?;
            let geometry = geometry_on_tilt(capture.settings.variant);
            Ok((capture, geometry))
        }
        (true, Some(_), _) => Err(format!("{name}: this capture needs no --geometry").into()),
        (false, Some(path), Some(range_bits)) => {
            let geometry = read_geometry(path)?;
            let capture_and_geometry = Capture::of_telegrams(&raw, &geometry, range_bits).map_err(|e| match e {
                CaptureError::Geometry { .. } => with_page(&format!("{}: does not fit {name}: {e}", path.display())),
                e => file_error(e.into()).into(),
            })?;
            Ok(capture_and_geometry)
        }
        (false, ..) => Err(format!("{name}: raw bytes need --geometry and --range-bits").into()),
    }
}

/// Gives the rig all that the capture holds, as a board would, and prints what comes of it.
fn play(
    capture: &Capture,
    rig: &mut Rig<'_, impl Segmenter>,
    sink: &mut impl RigSink,
    print: impl Fn() -> Result<(), Failure>,
) -> Result<(), Failure> {
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
                print()?;
            }
        }
    }
    rig.finish(sink);
    Ok(())
}
