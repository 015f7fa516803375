//! Recorded scans, which lie beside the repository and may be absent.

use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Returns the folder of a set, if it is there. If not, says "skipped", also where the output of
/// tests is captured.
pub fn recorded(set: &str) -> Option<PathBuf> {
    let folder = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data")).join(set);
    let there = folder.is_dir();
    if !there {
        _ = writeln!(io::stderr(), "skipped: {} is absent", folder.display());
    }
    there.then_some(folder)
}
