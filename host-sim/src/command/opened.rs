//! Files that are opened with the program of the system for them.

use std::path::Path;
use std::process::{Command, Stdio};

use crate::command::output::{Failure, print};

/// Opens a file with the program of the system for it; says where the file is if there is none.
pub fn open(file: &Path) -> Result<(), Failure> {
    let file = std::path::absolute(file)?;
    let program: &[&str] = match std::env::consts::OS {
        "macos" => &["open"],
        // `start` is of the shell; its first argument is a title
        "windows" => &["cmd", "/c", "start", ""],
        _ => &["xdg-open"],
    };
    let mut command = Command::new(program[0]);
    command.args(&program[1..]).arg(&file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    let opened = command.status().is_ok_and(|status| status.success());
    if opened { Ok(()) } else { print(&format!("look at {}\n", file.display())) }
}
