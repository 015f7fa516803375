//! Files as a whole: errors that name the file, and reading that has a bound.
use std::error::Error;
use std::fmt;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// What went wrong with a file.
pub(crate) type Cause = Box<dyn Error + Send + Sync>;

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

    /// The error of a file that was read. One of another file, which it needs, stays as it is.
    pub(crate) fn of(path: &Path, cause: Cause) -> Self {
        match cause.downcast::<FileError>() {
            Ok(of_other_file) => *of_other_file,
            Err(cause) => FileError { path: path.into(), cause },
        }
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

/// Reads a file of at most `most` bytes. Nothing beyond them is read, whatever the file is: a device
/// need not have an end.
///
/// # Errors
/// What the system says; [`io::ErrorKind::FileTooLarge`] if there is more.
pub fn read_at_most(path: impl AsRef<Path>, most: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    File::open(path)?.take(most + 1).read_to_end(&mut bytes)?;
    if bytes.len() as u64 > most {
        let what = format!("more than {} MiB, the most that is read", most >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, what));
    }
    Ok(bytes)
}
