//! Why a capture of a lidar cannot be read.

use std::error::Error;
use std::fmt;

/// Why a capture of a lidar cannot be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum LidarError {
    /// The file of the capture is damaged; how.
    Capture(String),
    /// The description of an Ouster is not as it should be; how.
    Metadata(String),
    /// Nothing in the capture is of a lidar that is known, and why.
    NoLidar(String),
    /// The frame asked for is not in the capture.
    NoFrame {
        /// Its number, from 0.
        number: usize,
        /// So many are there.
        frames: usize,
    },
    /// How the scanner was turned is not known.
    NoTurn,
}

impl fmt::Display for LidarError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            LidarError::Capture(how) => write!(f, "not a readable capture: {how}"),
            LidarError::Metadata(how) => write!(f, "not the metadata of an Ouster: {how}"),
            LidarError::NoLidar(why) => f.write_str(why),
            LidarError::NoFrame { number, frames } => {
                write!(f, "no frame {number}: there are {frames}, counted from 0")
            }
            LidarError::NoTurn => {
                write!(f, "an LD06 does not say how it is turned: give the turn of its rows (--turn-deg START,STEP)")
            }
        }
    }
}

impl Error for LidarError {}
