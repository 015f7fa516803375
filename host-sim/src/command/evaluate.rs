//! `scanseg evaluate`: a label image against the ground truth, by the classes of Hoover et al.

use std::path::PathBuf;

use clap::Args;
use scanseg_formats::GreyImage;
use scanseg_sim::hoover::{Hoover, Overlaps};
use serde::Serialize;

use crate::command::output::{Failure, print, write};

/// Hoover's customary tolerance.
const TOLERANCE: f64 = 0.8;

/// Compare a label image with the ground truth (Hoover et al. 1996)
#[derive(Args)]
pub struct Arguments {
    /// Label image of the truth: grey PGM (P5) or PNG; 0 is no region
    #[arg(long, value_name = "FILE")]
    truth: PathBuf,
    /// Label image to evaluate, of the same size; 0 is no region
    #[arg(long, value_name = "FILE")]
    labels: PathBuf,
    /// Part of its pixels that a region must share, above 0.5, up to 1 [default: 0.8, and
    /// hoover.csv has all from 0.51 to 1 in steps of 0.01]
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    tolerance: Option<f64>,
    /// Regions of fewer pixels count as no region, in both images
    #[arg(long, value_name = "N", default_value_t = 1)]
    min_pixels: u32,
    /// Folder for hoover.json and hoover.csv; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

/// The counts at one tolerance.
#[derive(Serialize)]
struct Record {
    tolerance: f64,
    truth_regions: usize,
    segments: usize,
    correct: usize,
    over_segmented: usize,
    under_segmented: usize,
    missed: usize,
    noise: usize,
}

impl From<Hoover> for Record {
    fn from(h: Hoover) -> Record {
        Record {
            tolerance: h.tolerance,
            truth_regions: h.truth_regions,
            segments: h.segments,
            correct: h.correct,
            over_segmented: h.over_segmented,
            under_segmented: h.under_segmented,
            missed: h.missed,
            noise: h.noise,
        }
    }
}

impl Record {
    const NAMES: [&str; 8] =
        ["tolerance", "truth_regions", "segments", "correct", "over_segmented", "under_segmented", "missed", "noise"];

    fn fields(&self) -> [String; 8] {
        let counts = [
            self.truth_regions,
            self.segments,
            self.correct,
            self.over_segmented,
            self.under_segmented,
            self.missed,
            self.noise,
        ];
        let mut fields = [const { String::new() }; 8];
        fields[0] = self.tolerance.to_string();
        fields[1..].iter_mut().zip(counts).for_each(|(field, count)| *field = count.to_string());
        fields
    }
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (truth, labels) = (GreyImage::read(&arguments.truth)?, GreyImage::read(&arguments.labels)?);
    if (truth.rows, truth.columns) != (labels.rows, labels.columns) {
        let size = |image: &GreyImage| format!("{} rows x {} columns", image.rows, image.columns);
        let (truth_name, labels_name) = (arguments.truth.display(), arguments.labels.display());
        return Err(format!("{labels_name}: {}, but {truth_name} has {}", size(&labels), size(&truth)).into());
    }
    let overlaps = Overlaps::new(&truth.values, &labels.values, arguments.min_pixels as usize)?;
    let line = |tolerance| Ok::<_, Failure>(Record::from(overlaps.at(tolerance)?));
    let chosen = line(arguments.tolerance.unwrap_or(TOLERANCE))?;
    let curve = match arguments.tolerance {
        Some(tolerance) => vec![line(tolerance)?],
        None => (51..=100).map(|percent| line(f64::from(percent) / 100.0)).collect::<Result<_, _>>()?,
    };
    if let Some(folder) = &arguments.out {
        let mut json = serde_json::to_vec_pretty(&chosen)?;
        json.push(b'\n');
        let mut csv = Record::NAMES.join(",") + "\n";
        curve.iter().for_each(|line| csv += &(line.fields().join(",") + "\n"));
        let files = [("hoover.json", json), ("hoover.csv", csv.into_bytes())];
        write(folder, &files.map(|(name, bytes)| (name.to_string(), bytes)).into())?;
    }
    let table: Vec<_> =
        Record::NAMES.iter().zip(chosen.fields()).map(|(name, field)| format!("{name:16}{field:>8}\n")).collect();
    print(&table.concat())
}
