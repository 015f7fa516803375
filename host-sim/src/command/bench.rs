//! `scanseg bench`: the time that the core takes for a scan.

use std::hint::black_box;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use scanseg_core::{Config, LabelRow, Segment, Sink};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, SegmentationError, Segmenter, check_size};
use serde::Serialize;

use super::options::{Options, in_terms_of_options};
use super::{Failure, Scan, print};

/// Smaller segments are not asked for their planes.
const MIN_PIXELS: u32 = 30;

/// Time the core alone: all rows of a scan from memory, labels and planes out
#[derive(Args)]
pub struct Arguments {
    /// Range image: grey PGM (P5) or PNG
    scan: PathBuf,
    /// Its geometry file (TOML)
    #[arg(long, value_name = "FILE")]
    geometry: PathBuf,
    /// Rounds that are timed, after one that is not
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    options: Options,
}

#[derive(Serialize)]
struct Timing {
    median_ns_per_point: f64,
    min_ns_per_point: f64,
    points: usize,
    /// Of 30 pixels or more.
    segments: usize,
}

/// Takes the rows and asks the larger segments for their planes.
#[derive(Default)]
struct Consumer {
    segments: usize,
}

impl Sink for Consumer {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        black_box(row);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if segment.pixels() >= MIN_PIXELS {
            self.segments += 1;
            black_box(segment.plane());
        }
        ControlFlow::Continue(())
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scan = Scan::read(&arguments.scan, &arguments.geometry)?;
    let config = arguments.options.config(&scan.geometry);
    let timing = time(&scan, &config, arguments).map_err(|e| in_terms_of_options(&scan.name, e))?;
    if arguments.json {
        return print(&(serde_json::to_string(&timing)? + "\n"));
    }
    let Timing { median_ns_per_point, min_ns_per_point, points, segments } = timing;
    print(&format!(
        "median_ns_per_point {median_ns_per_point:.2}\nmin_ns_per_point {min_ns_per_point:.2}\n\
         points {points}\nsegments {segments}\n"
    ))
}

fn time(scan: &Scan, config: &Config<'_>, arguments: &Arguments) -> Result<Timing, SegmentationError> {
    let ranges = &scan.ranges;
    check_size(ranges)?;
    let beams = ScanBeams::new(&scan.geometry, ranges.rows, ranges.columns)?;
    let mut memory = OwnedMemory::new(ranges.columns, config, arguments.options.max_labels());
    let approach = arguments.options.approach();
    let mut segmenter = Segmenter::new(approach, *config, beams.beams(), ranges.columns, memory.memory())?;
    let points = ranges.rows * ranges.columns;
    let mut consumer = Consumer::default();
    let mut ns_per_point = Vec::new();
    for _ in 0..=arguments.repeat {
        consumer.segments = 0;
        let started = Instant::now();
        for (row_m, &row_rad) in ranges.range_m.chunks(ranges.columns).zip(beams.rows_rad()) {
            segmenter.push_row(black_box(row_m), row_rad, &mut consumer)?;
        }
        black_box(segmenter.finish(&mut consumer));
        ns_per_point.push(started.elapsed().as_secs_f64() * 1e9 / points as f64);
    }
    // the first round warmed up
    let timed = &mut ns_per_point[1..];
    timed.sort_by(f64::total_cmp);
    let median_ns_per_point = (timed[(timed.len() - 1) / 2] + timed[timed.len() / 2]) / 2.0;
    Ok(Timing { median_ns_per_point, min_ns_per_point: timed[0], points, segments: consumer.segments })
}
