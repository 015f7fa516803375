//! What Python's package `scanseg` calls: `python/scanseg` documents it, and makes dataclasses of
//! the dictionaries that come from here.
//!
//! Nothing is computed here. Arrays become what the other crates take, and what they return
//! becomes arrays. Python's lock is released meanwhile.

mod arrays;
mod beams;
mod files;
mod rows;
mod scenes;
mod segments;
mod settings;
mod whole;

use pyo3::exceptions::{PyOSError, PyValueError};
use pyo3::prelude::*;
use scanseg_formats::FileError;

/// The functions and classes.
#[pymodule]
mod _scanseg {
    #[pymodule_export]
    use crate::beams::Beams;
    #[pymodule_export]
    use crate::files::{ScanFile, read_labels, write_labels, write_ranges};
    #[pymodule_export]
    use crate::rows::RowSegmenter;
    #[pymodule_export]
    use crate::scenes::{evaluate, office};
    #[pymodule_export]
    use crate::whole::{SegmentedScan, segment, segment_cloud};
}

/// What is wrong with a value, as Python has it.
fn value_error(e: impl ToString) -> PyErr {
    PyValueError::new_err(e.to_string())
}

/// What is wrong with a file: what the system says is an `OSError`, the rest a `ValueError`.
fn file_error(e: FileError) -> PyErr {
    match e.cause.downcast_ref::<std::io::Error>().and_then(std::io::Error::raw_os_error) {
        Some(number) => PyOSError::new_err((number, e.cause.to_string(), e.path)),
        None => value_error(e),
    }
}
