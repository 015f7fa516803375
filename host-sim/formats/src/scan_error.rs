//! Why a file has no scan that can be read.

use std::error::Error;
use std::fmt;
use std::path::PathBuf;

use crate::grey_image::MAX_PIXELS;

/// Why a file has no scan that can be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ScanError {
    /// None of the formats.
    Unknown,
    /// A grey image alone does not say where its beams point.
    NoGeometry,
    /// The geometry does not fit the image.
    Misfit {
        /// The geometry file.
        geometry: PathBuf,
        /// What does not fit.
        message: String,
    },
    /// More bytes than are read.
    FileBytes {
        /// How many are.
        most: u64,
    },
    /// More than [`MAX_PIXELS`] pixels, or none.
    Pixels {
        /// Rows by the header.
        rows: usize,
        /// Columns by the header.
        columns: usize,
    },
    /// A cloud without rows and columns.
    Unorganised {
        /// How many points it has.
        points: usize,
        /// How one gets an organised one.
        advice: &'static str,
    },
    /// No pixel has a distance.
    NothingMeasured {
        /// Pixels that there are.
        pixels: usize,
    },
    /// The file is not as its format says.
    Damaged {
        /// Its format.
        format: &'static str,
        /// What is wrong.
        message: String,
    },
    /// A file of this format, but without what a scan needs.
    Lacks {
        /// Its format.
        format: &'static str,
        /// What it lacks.
        what: String,
    },
}

impl ScanError {
    /// [`ScanError::Damaged`], of what a reader of the format says.
    pub(crate) fn damaged(format: &'static str, e: impl fmt::Display) -> ScanError {
        ScanError::Damaged { format, message: one_line(&e.to_string()) }
    }

    /// [`ScanError::Lacks`].
    pub(crate) fn lacks(format: &'static str, what: impl Into<String>) -> ScanError {
        ScanError::Lacks { format, what: what.into() }
    }

    /// Checks that a scan of this size may be read. Returns its pixels.
    pub(crate) fn check_pixels(rows: usize, columns: usize) -> Result<usize, ScanError> {
        let pixels = rows.checked_mul(columns).filter(|pixels| (1..=MAX_PIXELS).contains(pixels));
        pixels.ok_or(ScanError::Pixels { rows, columns })
    }
}

/// Text of others in one line of bounded length, without control characters.
fn one_line(text: &str) -> String {
    let most = 200;
    let plain = |c: char| if c.is_control() { ' ' } else { c };
    let cut: String = text.trim().chars().map(plain).take(most).collect();
    if text.chars().count() > most { cut + "..." } else { cut }
}

impl fmt::Display for ScanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            ScanError::Unknown => write!(f, "none of the formats that are read: PGM (P5), PNG, npy, PCD, PLY, E57"),
            ScanError::NoGeometry => {
                write!(
                    f,
                    "an image alone does not say where its pixels look: give --geometry FILE, or --fx PIXELS of a depth camera"
                )
            }
            ScanError::Misfit { geometry, message } => {
                write!(f, "{} does not fit: {message}", geometry.display())
            }
            ScanError::FileBytes { most } => write!(f, "more than {} MiB, the most that is read", most >> 20),
            ScanError::Pixels { rows, columns } => {
                let pixels = *rows as u128 * *columns as u128;
                write!(f, "{rows} rows x {columns} columns are {pixels} pixels, not 1 to {MAX_PIXELS}")
            }
            ScanError::Unorganised { points, advice } => {
                write!(f, "{points} points without rows and columns: {advice}")
            }
            ScanError::NothingMeasured { pixels } => write!(f, "none of {pixels} pixels has a distance"),
            ScanError::Damaged { format, message } => write!(f, "damaged {format}: {message}"),
            ScanError::Lacks { format, what } => write!(f, "{format} without {what}"),
        }
    }
}

impl Error for ScanError {}
