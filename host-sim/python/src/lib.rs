//! What Python's package `scanseg` calls: `python/scanseg` documents it, and makes dataclasses of
//! the dictionaries that come from here.
//!
//! Nothing is computed here. Arrays become what the other crates take, and what they return
//! becomes arrays. Python's lock is released meanwhile.

mod arrays;
mod beams;
mod rows;
mod segments;
mod settings;
mod whole;

use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;

/// The functions and classes.
#[pymodule]
mod _scanseg {
    #[pymodule_export]
    use crate::beams::Beams;
    #[pymodule_export]
    use crate::rows::RowSegmenter;
    #[pymodule_export]
    use crate::whole::{segment, segment_cloud};
}

/// What is wrong with a value, as Python has it.
fn value_error(e: impl ToString) -> PyErr {
    PyValueError::new_err(e.to_string())
}
