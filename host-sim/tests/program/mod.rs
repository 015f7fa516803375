//! The `scanseg` command as a process.
#![allow(dead_code)] // each test uses some of it

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// Returns an empty folder of the test's own.
pub fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Runs `scanseg` in a folder. Arguments are separated by blanks.
pub fn scanseg(folder: &Path, arguments: &str) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_scanseg"));
    command.current_dir(folder).args(arguments.split_whitespace()).stdin(Stdio::null()).output().unwrap()
}

/// Returns its stdout. It must have succeeded without a word on stderr.
pub fn succeeds(folder: &Path, arguments: &str) -> String {
    let output = scanseg(folder, arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.success() && stderr.is_empty(), "{arguments}: {stderr}");
    String::from_utf8(output.stdout).unwrap()
}

/// Exit code 2, nothing on stdout, one line on stderr that holds all of `says`, nothing new in the
/// folder.
pub fn fails(folder: &Path, arguments: &str, says: &[&str]) {
    let entries = || {
        let mut names: Vec<_> = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().file_name()).collect();
        names.sort();
        names
    };
    let before = entries();
    let output = scanseg(folder, arguments);
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(2), "{arguments}: {stderr}");
    assert!(output.stdout.is_empty(), "{arguments}");
    assert_eq!((stderr.lines().count(), stderr.ends_with('\n')), (1, true), "{arguments}: {stderr}");
    for what in says {
        assert!(stderr.contains(what), "{arguments}: {what} is not in: {stderr}");
    }
    assert_eq!(entries(), before, "{arguments}");
}
