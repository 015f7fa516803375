//! Why a scan cannot be segmented.

use std::error::Error;
use std::fmt;

use scanseg_core::{ConfigError, MAX_COLUMNS, MAX_ROWS, PushError};
use scanseg_formats::{GeometryError, RangeImage};

/// Why a scan cannot be segmented.
#[derive(Clone, Debug, PartialEq)]
pub enum SegmentationError {
    /// The geometry does not fit the image.
    Geometry(GeometryError),
    /// The image is empty or larger than the core takes.
    Size {
        /// Rows of the image.
        rows: usize,
        /// Columns of the image.
        columns: usize,
    },
    /// The core refuses the configuration or the beams.
    Config(ConfigError),
    /// The core refuses a row.
    Push(PushError),
}

impl fmt::Display for SegmentationError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SegmentationError::Geometry(e) => e.fmt(f),
            SegmentationError::Size { rows, columns } => {
                write!(f, "{rows} rows x {columns} columns is not within 1 x 1 to {MAX_ROWS} x {MAX_COLUMNS}")
            }
            SegmentationError::Config(e) => e.fmt(f),
            SegmentationError::Push(e) => e.fmt(f),
        }
    }
}

impl Error for SegmentationError {}

impl From<GeometryError> for SegmentationError {
    fn from(e: GeometryError) -> Self {
        SegmentationError::Geometry(e)
    }
}

impl From<ConfigError> for SegmentationError {
    fn from(e: ConfigError) -> Self {
        SegmentationError::Config(e)
    }
}

impl From<PushError> for SegmentationError {
    fn from(e: PushError) -> Self {
        SegmentationError::Push(e)
    }
}

/// Checks that the core takes images of this size: up to [`MAX_ROWS`] x [`MAX_COLUMNS`] pixels, and
/// not empty.
///
/// # Errors
/// [`SegmentationError::Size`] if not.
pub fn check_size(scan: &RangeImage) -> Result<(), SegmentationError> {
    let fits = (1..=MAX_ROWS).contains(&scan.rows) && (1..=MAX_COLUMNS).contains(&scan.columns);
    if fits { Ok(()) } else { Err(SegmentationError::Size { rows: scan.rows, columns: scan.columns }) }
}
