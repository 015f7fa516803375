//! `scanseg rig`: scanner, encoder, segmenter and link on simulated wires, live.

mod faults;
mod live;
mod surroundings;

use std::cell::RefCell;
use std::path::PathBuf;
use std::rc::Rc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use scanseg_core::{AnySegmenter, Segmenter};
use scanseg_formats::capture::{Capture, CaptureEvent, geometry_on_tilt};
use scanseg_formats::{Geometry, Kind, write_atomic};
use scanseg_hal::link::Message;
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Phase, Settings, Unit, Variant};
use scanseg_hal::rig::{Rig, RigSink, TiltLimits};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, SegmentationError, enough_labels};
use scanseg_virtual_rig::{Arrival, Chain, Motion, scanner_on_tilt};

use crate::command::input::Input;
use crate::command::messages::{Host, LinkOptions, counters_line};
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, print, warn};
use crate::command::rig::faults::{Fault, Faults, parse_fault};
use crate::command::rig::live::Live;
use crate::command::rig::surroundings::{Ranges, office, recorded};
use crate::command::warnings;

/// Run a virtual scanner on a virtual tilt, its wires, drivers, segmenter and link
///
/// An LMS 2xx that nods between 50 degrees up and down in an office, or in a recorded scan; one
/// turn of its mirror a row. In a terminal it runs in real time, and the last line shows the row
/// that came last: each segment its letter, . for a return in none, blank for no return.
#[derive(Args)]
pub struct Arguments {
    /// Which of the simulated offices
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "scan")]
    scene: u32,
    /// Instead of an office, a range image of a nodding scanner
    #[arg(long, value_name = "FILE", requires = "geometry")]
    scan: Option<PathBuf>,
    /// Its geometry file, see docs/scan-format.md
    #[arg(long, value_name = "FILE", requires = "scan")]
    geometry: Option<PathBuf>,
    /// Stop after so many scans, but not before all of --faults has struck; the first begins
    /// anywhere in the sweep
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    scans: u32,
    /// What goes wrong: loss=RATE, flip=RATE, insert=RATE of the bytes on the scanner's wires;
    /// reset=SECONDS, when the scanner's power fails; stuck=SECONDS, when its encoder sticks, for a
    /// second (or, while no row comes, as soon as rows come again); up to 600 s
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_fault)]
    faults: Vec<Fault>,
    /// Write what came from scanner and encoder, for scanseg replay
    #[arg(long, value_name = "CAPTURE")]
    save: Option<PathBuf>,
    #[command(flatten)]
    link: LinkOptions,
    #[command(flatten)]
    options: Options,
}

const SETTINGS: Settings = Settings {
    baud: Baud::B500000,
    variant: Variant::Deg180Step1,
    unit: Unit::Millimetre,
    mode: MeasuringMode::Range32Field,
    interlaced: false,
};
const COLUMNS: usize = SETTINGS.variant.columns() as usize;
/// 200 rows in 100 degrees.
const RATE_DEG_PER_S: f64 = 37.5;
const TOP_DEG: f64 = 50.0;
const LIMITS: TiltLimits = TiltLimits {
    min_rate_rad_per_s: 0.5 * RATE_DEG_PER_S.to_radians() as f32,
    max_rate_rad_per_s: 1.5 * RATE_DEG_PER_S.to_radians() as f32,
    sweep_rad: f32::INFINITY,
    pause_us: 1_000_000,
};
/// Time of the simulation after which no scan will come any more, for each scan asked for.
const PATIENCE_US: u64 = 60_000_000;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (geometry, range_m) = surroundings(arguments)?;
    let refused = |e: SegmentationError| in_terms_of_options("rig", e);
    let beams = ScanBeams::new(&geometry, 1, COLUMNS).map_err(|e| refused(e.into()))?;
    let config = arguments.options.config(&geometry)?;
    let mut memory = OwnedMemory::new(config, COLUMNS, arguments.options.max_labels());
    let segmenter =
        AnySegmenter::new(config, beams.beams(), COLUMNS, memory.memory()).map_err(|e| refused(e.into()))?;
    let mut rows_m = [0.0; 2 * COLUMNS];
    let rig = Rig::new(SETTINGS, LIMITS, segmenter, &mut rows_m)?;
    let stated = arguments.options.states_noise(&geometry);
    warnings::no_noise("rig", &config, stated).iter().for_each(|warning| warn(warning));
    let faults = Faults::new(&arguments.faults);
    let motion: Motion = Rc::new(nod);
    let mut lms = scanner_on_tilt(SETTINGS, &motion, range_m).running(SETTINGS.baud, SETTINGS.variant);
    lms.wires.faults = faults.wires;
    let mut chain = Chain::new(SETTINGS, lms, motion, rig);

    let host = Rc::default();
    let mut live = Live::new(arguments.link.reporter(&host));
    let mut saved = Capture::new(SETTINGS, LIMITS);
    let mut screen = Screen::new(&host)?;
    let scans = arguments.scans as usize;
    let save = arguments.save.is_some().then_some(&mut saved);
    let run = run_scans(scans, &mut chain, faults, &mut live, &mut screen, save);
    let told = run.and_then(|complete| {
        if !complete {
            live.sink.send(&Message::Status(chain.rig.counters()));
            print(&format!("{}\n", host.borrow().lines.join("\n")))?;
        }
        Ok(())
    });
    let (enough, unlabelled) = (enough_labels(config.approach(), COLUMNS), host.borrow().unlabelled);
    let full = warnings::unlabelled_pixels("rig", unlabelled, enough, arguments.options.max_labels());
    full.iter().for_each(|warning| warn(warning));
    // what has come until a reader went is kept
    if let Some(path) = &arguments.save {
        write_atomic(path, saved.to_text().as_bytes())?;
    }
    if let Some(path) = &arguments.link.link {
        write_atomic(path, &host.borrow().bytes)?;
    }
    told
}

/// Returns what the scanner looks at, and where its beams point.
fn surroundings(arguments: &Arguments) -> Result<(Geometry, Ranges), Failure> {
    let mut geometry = geometry_on_tilt(SETTINGS.variant);
    let (Some(image), Some(path)) = (&arguments.scan, &arguments.geometry) else {
        return Ok((geometry, office(arguments.scene)));
    };
    let input = Input::read(image, path)?;
    geometry.range_noise_m = input.geometry.range_noise_m;
    if let (Kind::Nodding { turn_axis: to, .. }, Kind::Nodding { turn_axis, .. }) =
        (&mut geometry.kind, &input.geometry.kind)
    {
        *to = *turn_axis;
    }
    Ok((geometry, recorded(input)?))
}

/// Runs the chain until so many scans are over, and a scan after the last fault, or until none will
/// come any more. Returns whether they are over.
fn run_scans<S: Segmenter, R: RigSink>(
    mut scans: usize,
    chain: &mut Chain<'_, S>,
    mut faults: Faults,
    live: &mut Live<R>,
    screen: &mut Screen<'_>,
    mut save: Option<&mut Capture>,
) -> Result<bool, Failure> {
    loop {
        faults.strike(chain);
        let came = chain.step(live);
        if let Some(capture) = &mut save {
            keep(capture, came, chain.phase());
        }
        if !faults.are_over() {
            scans = scans.max(screen.scans_over() + 1);
        }
        screen.print_lines(scans)?;
        screen.draw(&live.row, chain);
        let complete = screen.scans_over() >= scans;
        if complete || chain.now_us() > PATIENCE_US * scans as u64 {
            screen.bar.finish_and_clear();
            return Ok(complete);
        }
    }
}

/// The terminal: lines that stay, and below them the last row and the counters where there is
/// someone to look.
struct Screen<'a> {
    host: &'a RefCell<Host>,
    bar: ProgressBar,
    started: Instant,
}

impl<'a> Screen<'a> {
    fn new(host: &'a RefCell<Host>) -> Result<Screen<'a>, Failure> {
        let style = ProgressStyle::with_template("{spinner} {prefix}\n{wide_msg}")?;
        Ok(Screen { host, bar: ProgressBar::new_spinner().with_style(style), started: Instant::now() })
    }

    /// Returns how many scans are over.
    fn scans_over(&self) -> usize {
        self.host.borrow().scan_ends.len()
    }

    /// Prints what is new, up to the end of the last of so many scans.
    fn print_lines(&mut self, scans: usize) -> Result<(), Failure> {
        let mut host = self.host.borrow_mut();
        let end = host.scan_ends.get(scans - 1).copied().unwrap_or(usize::MAX);
        for line in host.take_lines(end) {
            self.bar.suspend(|| print(&format!("{line}\n")))?;
        }
        Ok(())
    }

    /// Draws the last row, in real time. Does nothing where nobody looks.
    fn draw<S: Segmenter>(&self, row: &str, chain: &Chain<'_, S>) {
        if self.bar.is_hidden() {
            return;
        }
        let ahead = Duration::from_micros(chain.now_us()).saturating_sub(self.started.elapsed());
        self.bar.set_prefix(row.to_string());
        self.bar.set_message(counters_line(&chain.rig.counters()));
        self.bar.tick();
        sleep(ahead);
    }
}

/// Adds what came to a capture. Whoever replays it only listens: to him, scans from before the
/// set-up would be part of the scan, and so the bytes are kept only while the scanner runs.
fn keep(capture: &mut Capture, came: Arrival, phase: Phase) {
    if came.bytes.is_empty() {
        return;
    }
    capture.events.push(CaptureEvent::Tilt(came.latch));
    if phase == Phase::Running {
        capture.events.push(CaptureEvent::Bytes { time_us: came.time_us, bytes: came.bytes });
    }
}

/// Down and up again at an even rate.
fn nod(time_us: f64) -> f64 {
    let phase = (time_us * 1e-6 * RATE_DEG_PER_S / (2.0 * TOP_DEG)).rem_euclid(2.0);
    let down = if phase < 1.0 { phase } else { 2.0 - phase };
    (TOP_DEG * (1.0 - 2.0 * down)).to_radians()
}
