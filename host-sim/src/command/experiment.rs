//! `scanseg experiment`: the experiment of the paper, with its figures.

use std::path::PathBuf;

use clap::Args;
use scanseg_sim::experiment::{Results, report};
use scanseg_sim::office::SCENES;

use crate::command::output::{Failure, bar, print, write};
use crate::command::scene_set::SetName;

/// Run the experiment of the paper (section 5, Figs. 6 to 9) and draw its figures
///
/// Writes a page, index.html, the figures as SVG and PNG, and the tables as Markdown and CSV.
#[derive(Args)]
pub struct Arguments {
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Which of the two sets of scenes
    #[arg(long, value_enum, default_value = "tuning")]
    set: SetName,
    /// Only the first N scenes
    #[arg(long, value_name = "N", default_value_t = SCENES, value_parser = clap::value_parser!(u32).range(1..=i64::from(SCENES)))]
    scenes: u32,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let bar = bar(Results::steps(arguments.scenes));
    let results = Results::of(arguments.set.set(), arguments.scenes, || bar.inc(1));
    bar.finish_and_clear();
    write(&arguments.out, &report::files(&results))?;
    let page = arguments.out.join("index.html");
    print(&format!("{}\nlook at {}\n", report::markdown(&results), page.display()))
}
