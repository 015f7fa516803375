//! Files as a whole: errors that name the file, and writing that leaves nothing half written.
use std::error::Error;
use std::ffi::OsString;
use std::fmt;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::process;

/// A file that cannot be read, written or understood. Prints as `path: cause`, one line.
#[derive(Debug)]
pub struct FileError {
    /// The file.
    pub path: PathBuf,
    /// What the system or the reader of its contents says.
    pub cause: Box<dyn Error + Send + Sync>,
}

impl FileError {
    pub(crate) fn new(path: &Path, cause: impl Error + Send + Sync + 'static) -> Self {
        FileError { path: path.into(), cause: Box::new(cause) }
    }
}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.path.display(), self.cause)
    }
}

impl Error for FileError {
    fn source(&self) -> Option<&(dyn Error + 'static)> {
        Some(&*self.cause)
    }
}

/// Writes a file so that it either has all of `bytes` or is what it was before; a file already
/// there is replaced.
///
/// # Errors
/// What the system says, with the path.
pub fn write_atomic(path: impl AsRef<Path>, bytes: &[u8]) -> Result<(), FileError> {
    write_all_or_none(&[(path.as_ref(), bytes)])
}

/// Writes files that belong together: all of them go to temporary names beside their targets first,
/// and take their own names only when every one is complete and on the disk.
///
/// # Errors
/// What the system says, with the path. No temporary file remains. Targets are untouched unless it
/// is one of the final renames that fails, after others have been done: then each target is either
/// new or old, never half written.
pub fn write_all_or_none(files: &[(&Path, &[u8])]) -> Result<(), FileError> {
    let mut written = Vec::with_capacity(files.len());
    for (path, bytes) in files {
        written.push(Temporary::write(path, bytes).map_err(|e| FileError::new(path, e))?);
    }
    for (temporary, (path, _)) in written.iter().zip(files) {
        fs::rename(&temporary.path, path).map_err(|e| FileError::new(path, e))?;
    }
    Ok(())
}

/// A temporary file; removed when dropped, unless it has been renamed.
struct Temporary {
    path: PathBuf,
}

impl Temporary {
    fn write(target: &Path, bytes: &[u8]) -> io::Result<Temporary> {
        let (temporary, mut file) = Temporary::create(target)?;
        file.write_all(bytes)?;
        file.sync_all()?;
        Ok(temporary)
    }

    fn create(target: &Path) -> io::Result<(Temporary, File)> {
        let name = target.file_name().ok_or(io::ErrorKind::InvalidFilename)?;
        // Another writer of the same target, or one that was killed, may hold the first names.
        for attempt in 0..100 {
            let mut hidden = OsString::from(".");
            hidden.push(name);
            hidden.push(format!(".{}-{attempt}.tmp", process::id()));
            let path = target.with_file_name(hidden);
            match OpenOptions::new().write(true).create_new(true).open(&path) {
                Ok(file) => return Ok((Temporary { path }, file)),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
        Err(io::ErrorKind::AlreadyExists.into())
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing under this name, and on an error the first one is the
        // one to report.
        let _ = fs::remove_file(&self.path);
    }
}
