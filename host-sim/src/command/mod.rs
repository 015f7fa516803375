//! The `scanseg` command: the subcommands, one per file.

mod bench;
mod demo;
mod evaluate;
mod experiment;
mod exports;
mod input;
mod listen;
mod lists;
mod live;
mod messages;
mod noise;
mod office;
mod opened;
mod options;
mod output;
mod planes;
mod replay;
mod rig;
#[cfg(feature = "ros2")]
mod ros2;
mod say;
mod scene_set;
mod segment;
mod shown;
#[cfg(unix)]
mod signals;
mod warnings;

use std::io::{self, Write};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::command::output::Failure;

/// Segments range images from scanners into planar pieces, row by row (Harati, Gaechter, Siegwart
/// 2006).
#[derive(Parser)]
#[command(name = "scanseg", version, arg_required_else_help = true)]
#[command(after_help = "Range images and their geometry files, with examples to copy: docs/scan-format.md")]
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
    Live(live::Arguments),
    #[cfg(feature = "ros2")]
    Ros2(ros2::Arguments),
}

/// Runs the command line. Exit code 0, or 2 with one line on stderr. A reader of stdout that has gone
/// ends the program, and is no failure.
pub fn main() -> ExitCode {
    #[cfg(unix)]
    signals::remove_temporaries_at_end();
    let done = match Arguments::try_parse() {
        Ok(arguments) => run(arguments.command),
        Err(e) if e.use_stderr() && std::env::args_os().len() > 1 => Err(first_paragraph(&e).into()),
        Err(e) if e.use_stderr() => {
            _ = e.print();
            return ExitCode::from(2);
        }
        Err(help) => help.print().and_then(|()| io::stdout().flush()).map_err(say::stdout_failure),
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(e) if e.is::<say::ReaderGone>() => ExitCode::SUCCESS,
        Err(e) => {
            say::error(&e);
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
        Command::Live(arguments) => live::run(&arguments),
        #[cfg(feature = "ros2")]
        Command::Ros2(arguments) => ros2::run(&arguments),
    }
}

/// Returns what is wrong with the command line, without the usage that clap adds, as one line.
fn first_paragraph(e: &clap::Error) -> String {
    let text = e.render().to_string();
    let lines: Vec<&str> = text.lines().map(str::trim).take_while(|line| !line.is_empty()).collect();
    lines.join(" ").trim_start_matches("error: ").to_string()
}
