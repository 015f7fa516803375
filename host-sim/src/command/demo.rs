//! `scanseg demo`: the simulated office, scanned and segmented. Needs no file.

use std::path::PathBuf;

use clap::Args;
use scanseg_formats::{GreyImage, RangeImage};
use scanseg_sim::office::{Scene, Sensor, Set};

use crate::command::input::Input;
use crate::command::options::Options;
use crate::command::output::{Failure, print, write};
use crate::command::segment::{ListOptions, segment};

/// Standard deviation of a range if nothing else is asked for.
const RANGE_NOISE_M: f64 = 0.01;

const RANGE_NOISE_HELP: &str = "Standard deviation of one range, of the simulated sensor as well as for the segmentation \
    [default: 0.01, that of a SICK LMS 200; with --preset paper take 0.001: bearing angles between neighbouring pixels, \
    which the paper takes, drown in several millimetres of noise]";

/// Scan a simulated office and segment it; needs no other file
#[derive(Args)]
#[command(mut_arg("range_noise_m", |arg| arg.help(RANGE_NOISE_HELP)))]
pub struct Arguments {
    /// Folder for the results; made if it is not there
    #[arg(long, value_name = "DIR", default_value = "out")]
    out: PathBuf,
    /// Which office, and which random errors
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u32,
    #[command(flatten)]
    lists: ListOptions,
    #[command(flatten)]
    options: Options,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let range_noise_m = arguments.options.range_noise_m.unwrap_or(RANGE_NOISE_M);
    let sensor = Sensor { range_noise_m, ..Sensor::nodding(200, 361) };
    let simulated = Scene::numbered(Set::Tuning, arguments.seed).scan(&sensor, u64::from(arguments.seed))?;
    let (rows, columns, geometry) = (simulated.rows, simulated.columns, simulated.geometry);
    let image = RangeImage { rows, columns, range_m: simulated.range_m }.to_grey(&geometry)?;
    let truth = GreyImage { rows, columns, max_value: 65535, values: simulated.truth };
    // As from the file, so that `scanseg segment` on it gives the same.
    let ranges = RangeImage::from_grey(&image, &geometry)?;

    let counts = ranges.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    let input = Input { name: "simulated office".to_string(), geometry, ranges, counts, remarks: vec![] };
    let config = arguments.options.config(&input.geometry)?;
    let (mut files, summary) = segment(&input, config, &arguments.options, &arguments.lists)?;
    files.push(("scan.png".to_string(), image.to_png()));
    files.push(("scan.pgm".to_string(), image.to_pgm()));
    files.push(("geometry.toml".to_string(), input.geometry.to_toml().into_bytes()));
    files.push(("truth.png".to_string(), truth.to_png()));
    write(&arguments.out, &files)?;
    print(&format!("{summary}look at {}\n", arguments.out.join("overview.png").display()))?;
    arguments.lists.open(&arguments.out)
}
