//! Writing that leaves nothing half written.
use std::ffi::OsString;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::{Mutex, MutexGuard, PoisonError};

use crate::file::FileError;

/// Writes one file as [`write_all_or_none`] does.
///
/// # Errors
/// As [`write_all_or_none`].
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), FileError> {
    write_all_or_none(&[(path.as_ref(), bytes)])
}

/// Writes files that belong together. First all targets are looked at: a folder is refused. Then all
/// files go to temporary names beside their targets, and take their own names only when every one is
/// complete and on the disk. A symbolic link stays, and what it names is replaced. A target that is
/// no file, such as a pipe or a device, is written to before any file takes its name.
///
/// # Errors
/// What the system says, with the path. No temporary file remains. Targets are untouched unless it
/// is one of the final renames that fails, after others have been done: then each target is either
/// new or old, never half written.
pub fn write_all_or_none(files: &[(&Path, &[u8])]) -> Result<(), FileError> {
    let named = |path: &Path, result: io::Result<()>| result.map_err(|e| FileError::new(path, e));
    let mut targets = Vec::with_capacity(files.len());
    for (path, _) in files {
        targets.push(Target::of(path).map_err(|e| FileError::new(path, e))?);
    }
    let mut written = Vec::with_capacity(files.len());
    for (target, (path, bytes)) in targets.iter().zip(files) {
        if let Target::File(file) = target {
            written.push((Temporary::write(file, bytes).map_err(|e| FileError::new(path, e))?, file, path));
        }
    }
    // only now, so that the disk takes them together
    for (temporary, _, path) in &written {
        named(path, temporary.file.sync_all())?;
    }
    for (target, (path, bytes)) in targets.iter().zip(files) {
        if let Target::Stream = target {
            named(path, OpenOptions::new().append(true).create(true).open(path).and_then(|mut f| f.write_all(bytes)))?;
        }
    }
    // Whoever ends the program waits, so that no set of files is new in part.
    let names = names();
    for (temporary, file, path) in &written {
        named(path, fs::rename(&temporary.path, file))?;
    }
    drop(names);
    Ok(())
}

/// Removes all temporary files, and lets none be made any more: for a program that is about to end
/// because of a signal.
pub fn remove_temporaries() {
    if let Some(paths) = names().take() {
        paths.iter().for_each(|path| _ = fs::remove_file(path));
    }
}

/// What is written to.
enum Target {
    /// A file that is replaced or made.
    File(PathBuf),
    /// Something that takes bytes, and stays what it is.
    Stream,
}

impl Target {
    fn of(path: &Path) -> io::Result<Target> {
        let is_link = fs::symlink_metadata(path).is_ok_and(|there| there.is_symlink());
        // links of the system to what a program has open
        let is_open = is_link && (path.starts_with("/dev") || path.starts_with("/proc"));
        match fs::metadata(path) {
            Ok(there) if there.is_dir() => Err(ErrorKind::IsADirectory.into()),
            Ok(there) if !there.is_file() || is_open => Ok(Target::Stream),
            Ok(_) if is_link => Ok(Target::File(fs::canonicalize(path)?)),
            Ok(_) => Ok(Target::File(path.into())),
            // a link to nothing yet
            Err(e) if e.kind() == ErrorKind::NotFound && is_link => Ok(Target::Stream),
            Err(e) if e.kind() == ErrorKind::NotFound => Ok(Target::File(path.into())),
            Err(e) => Err(e),
        }
    }
}

/// The temporary files that there are; none once no more are to be made.
static NAMES: Mutex<Option<Vec<PathBuf>>> = Mutex::new(Some(Vec::new()));

fn names() -> MutexGuard<'static, Option<Vec<PathBuf>>> {
    NAMES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A temporary file; removed when dropped, unless it has been renamed.
struct Temporary {
    path: PathBuf,
    file: File,
}

impl Temporary {
    fn write(target: &Path, bytes: &[u8]) -> io::Result<Temporary> {
        let mut temporary = Temporary::create(target)?;
        temporary.file.write_all(bytes)?;
        Ok(temporary)
    }

    fn create(target: &Path) -> io::Result<Temporary> {
        let name = target.file_name().ok_or(ErrorKind::InvalidFilename)?;
        let mut names = names();
        let names = names.as_mut().ok_or(ErrorKind::Interrupted)?;
        // Another writer of the same target, or one that was killed, may hold the first names.
        for attempt in 0..100 {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.tmp", process::id()));
            let path = target.with_file_name(hidden);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => {
                    names.push(path.clone());
                    return Ok(Temporary { path, file });
                }
                Err(e) if e.kind() == ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
        Err(ErrorKind::AlreadyExists.into())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing under this name, and on an error the first one is the
        // one to report.
        let _ = fs::remove_file(&self.path);
        if let Some(paths) = names().as_mut() {
            paths.retain(|path| *path != self.path);
        }
    }
}
