//! What every subcommand does: fail with one line, write files, print, show how far it is.

use std::error::Error;
use std::fs;
use std::path::Path;

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

/// Returns a progress bar on stderr. Nothing is drawn where that is no terminal.
pub fn bar(length: usize) -> ProgressBar {
    let style = ProgressStyle::with_template("segmenting {wide_bar} {percent} %, {eta} left");
    ProgressBar::new(length as u64).with_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()))
}
