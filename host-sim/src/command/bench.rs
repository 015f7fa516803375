//! `scanseg bench`: the time that the core takes for a scan.

use clap::Args;
use scanseg_sim::timing::Timing;
use serde::Serialize;

use crate::command::input::ScanArguments;
use crate::command::options::{Options, in_terms_of_options};
use crate::command::output::{Failure, print, warn};
use crate::command::warnings;

/// Time the core alone: all rows of a scan from memory, labels and planes out
#[derive(Args)]
pub struct Arguments {
    #[command(flatten)]
    scan: ScanArguments,
    /// Rounds that are timed, after one that is not
    #[arg(long, value_name = "N", default_value_t = 20, value_parser = clap::value_parser!(u32).range(1..))]
    repeat: u32,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
    #[command(flatten)]
    options: Options,
}

/// What is printed.
#[derive(Serialize)]
struct Figures {
    median_ns_per_point: f64,
    min_ns_per_point: f64,
    points: usize,
    /// Of 30 pixels or more.
    segments: usize,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let input = arguments.scan.read()?;
    let config = arguments.options.config(&input.geometry)?;
    let (max_labels, rounds) = (arguments.options.max_labels(), arguments.repeat as usize);
    let timing = Timing::of(&input.ranges, &input.geometry, config, max_labels, rounds)
        .map_err(|e| in_terms_of_options(&input.name, e))?;
    let stated = arguments.options.states_noise(&input.geometry);
    warnings::of_scan(&input, &config, stated).iter().for_each(|warning| warn(warning));
    let figures = Figures {
        median_ns_per_point: timing.median_ns(),
        min_ns_per_point: timing.ns_per_point[0],
        points: input.ranges.range_m.len(),
        segments: timing.segments,
    };
    if arguments.json {
        return print(&(serde_json::to_string(&figures)? + "\n"));
    }
    let Figures { median_ns_per_point, min_ns_per_point, points, segments } = figures;
    print(&format!(
        "median_ns_per_point {median_ns_per_point:.2}\nmin_ns_per_point {min_ns_per_point:.2}\n\
         points {points}\nsegments {segments}\n"
    ))
}
