//! The subcommands, one per file, and what they share: how they end.

mod bench;
mod demo;
mod evaluate;
mod experiment;
mod listen;
mod lists;
mod messages;
mod office;
mod options;
mod replay;
mod rig;
mod segment;

use std::error::Error;
use std::fs;
use std::io::{self, ErrorKind, Write};
use std::path::Path;
use std::process::ExitCode;

use clap::{Parser, Subcommand};
use scanseg_sim::format::{Geometry, GreyImage, RangeImage, write_all_or_none};

/// What went wrong, in one line.
type Failure = Box<dyn Error>;

/// Segments range images from scanners into planar pieces, row by row (Harati, Gaechter, Siegwart 2006).
#[derive(Parser)]
#[command(name = "scanseg", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    Segment(segment::Arguments),
    Demo(demo::Arguments),
    Bench(bench::Arguments),
    Evaluate(evaluate::Arguments),
    Office(office::Arguments),
    Experiment(experiment::Arguments),
    Rig(rig::Arguments),
    Replay(replay::Arguments),
    Listen(listen::Arguments),
}

/// Runs the command line. Exit code 0, or 2 with one line on stderr.
pub fn main() -> ExitCode {
    let done = match Arguments::try_parse() {
        Ok(arguments) => run(arguments.command),
        Err(e) if e.use_stderr() && std::env::args_os().len() > 1 => Err(first_paragraph(&e).into()),
        Err(e) => e.exit(),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) => {
            eprintln!("scanseg: {}", e.to_string().replace('\n', " "));
            ExitCode::from(2)
        }
    }
}

fn run(command: Command) -> Result<(), Failure> {
    match command {
        Command::Segment(arguments) => segment::run(&arguments),
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Bench(arguments) => bench::run(&arguments),
        Command::Evaluate(arguments) => evaluate::run(&arguments),
        Command::Office(arguments) => office::run(&arguments),
        Command::Experiment(arguments) => experiment::run(&arguments),
        Command::Rig(arguments) => rig::run(&arguments),
        Command::Replay(arguments) => replay::run(&arguments),
        Command::Listen(arguments) => listen::run(&arguments),
    }
}

/// What is wrong with the command line, without the usage that clap adds, as one line.
fn first_paragraph(e: &clap::Error) -> String {
    let text = e.render().to_string();
    let lines: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    lines.join(" ").trim_start_matches("error: ").to_string()
}

/// A range image and its geometry.
struct Scan {
    /// What messages call it.
    name: String,
    geometry: Geometry,
    ranges: RangeImage,
}

impl Scan {
    fn read(scan: &Path, geometry: &Path) -> Result<Scan, Failure> {
        let image = GreyImage::read(scan)?;
        let parsed = Geometry::read(geometry)?;
        let ranges = RangeImage::from_grey(&image, &parsed)
            .map_err(|e| format!("{}: does not fit {}: {e}", geometry.display(), scan.display()))?;
        Ok(Scan { name: scan.display().to_string(), geometry: parsed, ranges })
    }
}

/// Files to be, with their names.
type Files = Vec<(String, Vec<u8>)>;

/// Writes all files into a folder, which is made if it is not there, or none of them.
fn write(folder: &Path, files: &Files) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths: Vec<_> = files.iter().map(|(name, bytes)| (folder.join(name), bytes)).collect();
    let files: Vec<_> = paths.iter().map(|(path, bytes)| (path.as_path(), bytes.as_slice())).collect();
    Ok(write_all_or_none(&files)?)
}

/// Prints to stdout. A reader that has gone is no failure.
fn print(text: &str) -> Result<(), Failure> {
    match io::stdout().write_all(text.as_bytes()) {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(format!("stdout: {e}").into()),
        _ => Ok(()),
    }
}
