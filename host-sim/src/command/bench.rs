//! `scanseg bench`: the time that the core takes for a scan.

use std::path::PathBuf;

use clap::Args;
use scanseg_sim::timing::Timing;
use serde::Serialize;

use super::options::{Options, in_terms_of_options};
use super::{Failure, Scan, print};

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
struct Line {
    median_ns_per_point: f64,
    min_ns_per_point: f64,
    points: usize,
    /// Of 30 pixels or more.
    segments: usize,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let scan = Scan::read(&arguments.scan, &arguments.geometry)?;
    arguments.options.check()?;
    let config = arguments.options.config(&scan.geometry);
    let (approach, max_labels) = (arguments.options.approach(), arguments.options.max_labels());
    let rounds = arguments.repeat as usize;
    let timing = Timing::of(&scan.ranges, &scan.geometry, approach, &config, max_labels, rounds)
        .map_err(|e| in_terms_of_options(&scan.name, e))?;
    let line = Line {
        median_ns_per_point: timing.median_ns(),
        min_ns_per_point: timing.ns_per_point[0],
        points: scan.ranges.range_m.len(),
        segments: timing.segments,
    };
    if arguments.json {
        return print(&(serde_json::to_string(&line)? + "\n"));
    }
    let Line { median_ns_per_point, min_ns_per_point, points, segments } = line;
    print(&format!(
        "median_ns_per_point {median_ns_per_point:.2}\nmin_ns_per_point {min_ns_per_point:.2}\n\
         points {points}\nsegments {segments}\n"
    ))
}
