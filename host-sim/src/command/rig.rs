//! `scanseg rig`: scanner, encoder, segmenter and link on simulated wires, live.

use std::ops::ControlFlow;
use std::path::PathBuf;
use std::rc::Rc;
use std::thread::sleep;
use std::time::{Duration, Instant};

use clap::Args;
use indicatif::{ProgressBar, ProgressStyle};
use scanseg_core::{Join, Label, LabelRow, Pixel, Segment, Sink};
use scanseg_hal::link::{Message, Reporter};
use scanseg_hal::lms2xx::{Baud, MeasuringMode, Phase, Settings, Trouble, Unit, Variant};
use scanseg_hal::rig::{Rig, RigSink, ScanFinished, ScanStarted, TiltLimits};
use scanseg_sim::format::capture::{self, Capture};
use scanseg_sim::format::{Kind, RangeImage, write_atomic};
use scanseg_sim::office::{Scene, Set};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, SegmentationError, Segmenter};
use scanseg_sim::virtual_rig::{Chain, EncoderFault, Faults, Motion, scanner_on_tilt};

use super::messages::{Output, counters_line};
use super::options::{Options, in_terms_of_options};
use super::replay::geometry_of;
use super::{Failure, Scan, print};

/// Run a virtual scanner on a virtual tilt, its wires, drivers, segmenter and link
///
/// An LMS 2xx that nods between 50 degrees up and down in an office, or in a recorded scan; one turn of its mirror a row.
/// In a terminal it runs in real time, and the last line shows the row that came last: each segment its letter, . for a
/// return in none, blank for no return.
#[derive(Args)]
pub struct Arguments {
    /// Which of the simulated offices
    #[arg(long, value_name = "N", default_value_t = 0, conflicts_with = "scan")]
    scene: u32,
    /// Instead of an office, a range image of a nodding scanner
    #[arg(long, value_name = "FILE", requires = "geometry")]
    scan: Option<PathBuf>,
    /// Its geometry file (TOML)
    #[arg(long, value_name = "FILE", requires = "scan")]
    geometry: Option<PathBuf>,
    /// Stop after so many scans; the first begins anywhere in the sweep
    #[arg(long, value_name = "N", default_value_t = 2, value_parser = clap::value_parser!(u32).range(1..))]
    scans: u32,
    /// What goes wrong: loss=RATE, flip=RATE, insert=RATE of the bytes on the scanner's wires; reset=SECONDS, when the
    /// scanner's power fails; stuck=SECONDS, when its encoder sticks, for a second
    #[arg(long, value_name = "LIST", value_delimiter = ',', value_parser = parse_fault)]
    faults: Vec<Fault>,
    /// Write what came from scanner and encoder, for scanseg replay
    #[arg(long, value_name = "CAPTURE")]
    save: Option<PathBuf>,
    #[command(flatten)]
    output: Output,
    #[command(flatten)]
    options: Options,
}

#[derive(Clone, Copy)]
enum Fault {
    /// One in so many bytes.
    Loss(u32),
    Flip(u32),
    Insert(u32),
    /// Times, microseconds.
    Reset(u64),
    Stuck(u64),
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
/// How long an encoder sticks.
const STUCK_US: u64 = 1_000_000;
/// Time of the simulation after which no scan will come any more, for each scan asked for.
const PATIENCE_US: u64 = 60_000_000;

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let mut geometry = geometry_of(SETTINGS.variant);
    let range_m = match (&arguments.scan, &arguments.geometry) {
        (Some(scan), Some(path)) => {
            let scan = Scan::read(scan, path)?;
            geometry.range_noise_m = scan.geometry.range_noise_m;
            if let (Kind::Nodding { turn_axis: to, .. }, Kind::Nodding { turn_axis, .. }) =
                (&mut geometry.kind, &scan.geometry.kind)
            {
                *to = *turn_axis;
            }
            recorded(scan)?
        }
        _ => office(arguments.scene),
    };
    let refused = |e: SegmentationError| in_terms_of_options("rig", e);
    let beams = ScanBeams::new(&geometry, 1, COLUMNS).map_err(|e| refused(e.into()))?;
    arguments.options.check()?;
    let config = arguments.options.config(&geometry);
    let mut memory = OwnedMemory::new(COLUMNS, &config, arguments.options.max_labels());
    let segmenter = Segmenter::new(arguments.options.approach(), config, beams.beams(), COLUMNS, memory.memory())
        .map_err(|e| refused(e.into()))?;
    let mut rows_m = [0.0; 2 * COLUMNS];
    let rig = Rig::new(SETTINGS, LIMITS, segmenter, &mut rows_m)?;
    let motion: Motion = Rc::new(nod);
    let mut lms = scanner_on_tilt(SETTINGS, &motion, range_m).running(SETTINGS.baud, SETTINGS.variant);
    let (mut resets_us, mut stuck_us) = (vec![], vec![]);
    let Faults { drop_one_in, flip_one_in, insert_one_in, .. } = &mut lms.wires.faults;
    for fault in &arguments.faults {
        match *fault {
            Fault::Loss(one_in) => *drop_one_in = one_in,
            Fault::Flip(one_in) => *flip_one_in = one_in,
            Fault::Insert(one_in) => *insert_one_in = one_in,
            Fault::Reset(at_us) => resets_us.push(at_us),
            Fault::Stuck(at_us) => stuck_us.push(at_us..at_us + STUCK_US),
        }
    }
    let mut chain = Chain::new(SETTINGS, lms, motion, rig);

    let host = Rc::default();
    let mut sink = Live { reporter: arguments.output.reporter(&host), row: String::new() };
    let mut saved = Capture::new(SETTINGS, LIMITS);
    let bar = ProgressBar::new_spinner().with_style(ProgressStyle::with_template("{spinner} {prefix}\n{wide_msg}")?);
    let started = Instant::now();
    let (mut shown, mut over) = (0, 0);
    while over < arguments.scans {
        let now_us = chain.now_us();
        while let Some(at) = resets_us.iter().position(|&at_us| at_us <= now_us) {
            resets_us.swap_remove(at);
            chain.lms.power_cycle(now_us);
        }
        let stuck = stuck_us.iter().any(|times| times.contains(&now_us));
        chain.encoder_fault = if stuck { EncoderFault::Stuck } else { EncoderFault::None };
        let came = chain.step(&mut sink);
        if arguments.save.is_some() && !came.bytes.is_empty() {
            saved.events.push(capture::Came::Tilt(came.latch));
            // Whoever replays it only listens: to him, scans from before the set-up would be part of the scan.
            if chain.phase() == Phase::Running {
                saved.events.push(capture::Came::Bytes { time_us: came.time_us, bytes: came.bytes });
            }
        }
        let lines = &host.borrow().lines;
        while over < arguments.scans
            && let Some(line) = lines.get(shown)
        {
            bar.suspend(|| print(&format!("{line}\n")))?;
            over += u32::from(line.starts_with("scan ") && line.contains(" over "));
            shown += 1;
        }
        if !bar.is_hidden() {
            let ahead = Duration::from_micros(chain.now_us()).saturating_sub(started.elapsed());
            bar.set_prefix(sink.row.clone());
            bar.set_message(counters_line(&chain.rig.counters()));
            bar.tick();
            sleep(ahead);
        }
        if chain.now_us() > PATIENCE_US * u64::from(arguments.scans) {
            break;
        }
    }
    bar.finish_and_clear();
    if over < arguments.scans {
        sink.reporter.send(&Message::Status(chain.rig.counters()));
        print(&format!("{}\n", host.borrow().lines[shown..].join("\n")))?;
    }
    if let Some(path) = &arguments.save {
        write_atomic(path, saved.to_text().as_bytes())?;
    }
    if let Some(path) = &arguments.output.link {
        write_atomic(path, &host.borrow().bytes)?;
    }
    Ok(())
}

/// The link, and the last row as a line of text.
struct Live<F> {
    reporter: Reporter<F>,
    row: String,
}

impl<F: FnMut(&[u8])> Sink for Live<F> {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        let pixels: Vec<Pixel> = row.pixels().collect();
        // Every third column: 60 letters.
        let letters = pixels.iter().skip(1).step_by(3).map(|pixel| match pixel {
            Pixel::Segment(Label(label)) => char::from(b'A' + (label % 26) as u8),
            Pixel::NoReturn => ' ',
            Pixel::Edge | Pixel::Unlabelled => '.',
        });
        self.row = format!("row {:3} |{}|", row.row(), letters.rev().collect::<String>());
        self.reporter.row(row)
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.reporter.join(join)
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.reporter.segment(segment)
    }
}

impl<F: FnMut(&[u8])> RigSink for Live<F> {
    fn scan_started(&mut self, scan: &ScanStarted) {
        self.reporter.scan_started(scan);
    }

    fn scan_finished(&mut self, scan: &ScanFinished) {
        self.reporter.scan_finished(scan);
    }

    fn trouble(&mut self, trouble: Trouble) {
        self.reporter.trouble(trouble);
    }
}

/// Down and up again at an even rate.
fn nod(time_us: f64) -> f64 {
    let phase = (time_us * 1e-6 * RATE_DEG_PER_S / (2.0 * TOP_DEG)).rem_euclid(2.0);
    let down = if phase < 1.0 { phase } else { 2.0 - phase };
    (TOP_DEG * (1.0 - 2.0 * down)).to_radians()
}

/// Range by bearing from the right edge, degrees, and turn angle, radians; 0 without a return.
type Ranges = Box<dyn FnMut(f64, f64) -> f64>;

fn office(number: u32) -> Ranges {
    let scene = Scene::numbered(Set::Tuning, number);
    Box::new(move |bearing_deg, turn_rad| {
        let (bearing, turn) = ((bearing_deg - 90.0).to_radians(), turn_rad);
        let direction = [bearing.cos() * turn.cos(), bearing.sin(), bearing.cos() * turn.sin()];
        scene.cast(direction).map_or(0.0, |(range_m, _)| range_m)
    })
}

/// The nearest pixel of a recorded scan.
fn recorded(scan: Scan) -> Result<Ranges, Failure> {
    let RangeImage { rows, columns, range_m } = scan.ranges;
    let Kind::Nodding { beam_deg, turn_deg, .. } = scan.geometry.kind else {
        return Err(format!("{}: not of a nodding scanner", scan.name).into());
    };
    let list = |angles: &scanseg_sim::format::Angles, count| (0..count).map(|i| angles.at(i)).collect::<Vec<_>>();
    let (beams_deg, turns_deg) = (list(&beam_deg, columns), list(&turn_deg, rows));
    let nearest = |list: &[f64], deg: f64| {
        let off = |i: &usize| (list[*i] - deg).abs();
        (0..list.len()).min_by(|a, b| off(a).total_cmp(&off(b))).filter(|i| off(i) < 1.0)
    };
    Ok(Box::new(move |bearing_deg, turn_rad| {
        let pixel = nearest(&turns_deg, turn_rad.to_degrees()).zip(nearest(&beams_deg, bearing_deg - 90.0));
        pixel.map_or(0.0, |(row, column)| f64::from(range_m[row * columns + column]))
    }))
}

/// `loss=0.001`.
fn parse_fault(text: &str) -> Result<Fault, String> {
    let names = "loss=RATE, flip=RATE, insert=RATE, reset=SECONDS or stuck=SECONDS";
    let (name, number) = text.split_once('=').ok_or(format!("not {names}"))?;
    let value: f64 = number.parse().map_err(|_| format!("`{number}` is not a number"))?;
    let one_in = match 1e-9..=0.5 {
        rates if rates.contains(&value) => Ok((1.0 / value).round() as u32),
        _ => Err(format!("a rate of {value} is not within 1e-9 and 0.5")),
    };
    let at_us = match 0.0..=1e6 {
        times if times.contains(&value) => Ok((1e6 * value) as u64),
        _ => Err(format!("a time of {value} s is not within 0 and 1e6")),
    };
    Ok(match name {
        "loss" => Fault::Loss(one_in?),
        "flip" => Fault::Flip(one_in?),
        "insert" => Fault::Insert(one_in?),
        "reset" => Fault::Reset(at_us?),
        "stuck" => Fault::Stuck(at_us?),
        _ => return Err(format!("`{name}` is not {names}")),
    })
}
