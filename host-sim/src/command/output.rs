//! What every subcommand does: fail with one line, write files, print, show how far it is.

use std::error::Error;
use std::fs;
use std::path::Path;
use std::process::{Command, Stdio};

use indicatif::{ProgressBar, ProgressStyle};
use scanseg_formats::write_all_or_none;

pub use crate::command::say::{print, warn};

/// What went wrong, in one line.
pub type Failure = Box<dyn Error>;

/// Files to be, with their names.
pub type Files = Vec<(String, Vec<u8>)>;

/// Writes all files into a folder, which is made if it is not there, or none of them.
pub fn write(folder: &Path, files: &Files) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let paths: Vec<_> = files.iter().map(|(name, bytes)| (folder.join(name), bytes)).collect();
    let files: Vec<_> = paths.iter().map(|(path, bytes)| (path.as_path(), bytes.as_slice())).collect();
    Ok(write_all_or_none(&files)?)
}

/// Opens a file with the program of the system for it, or with that of the environment variable
/// BROWSER; says where the file is if there is none.
pub fn show(file: &Path) -> Result<(), Failure> {
    let file = std::path::absolute(file)?;
    let usual: &[&str] = match std::env::consts::OS {
        "macos" => &["open"],
        // `start` is of the shell; its first argument is a title
        "windows" => &["cmd", "/c", "start", ""],
        _ => &["xdg-open"],
    };
    let named = std::env::var_os("BROWSER");
    let mut command = match &named {
        Some(browser) => Command::new(browser),
        None => Command::new(usual[0]),
    };
    if named.is_none() {
        command.args(&usual[1..]);
    }
    command.arg(&file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let opened = command.status().is_ok_and(|status| status.success());
    if opened { Ok(()) } else { print(&format!("look at {}\n", file.display())) }
}

/// Returns a progress bar on stderr. Nothing is drawn where that is no terminal.
pub fn bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("segmenting {wide_bar} {percent} %, {eta} left");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
