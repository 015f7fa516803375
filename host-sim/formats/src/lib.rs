//! The files of scanseg: range images, their geometry, label images, captures of a scanner.

mod angles;
mod beside;
mod camera;
pub mod capture;
mod cloud;
mod depth;
pub mod file;
pub mod geometry;
mod geometry_error;
mod geometry_toml;
pub mod grey_image;
pub mod lidar;
mod limits;
mod noise;
mod npy;
pub mod range_image;
#[cfg(feature = "ros")]
pub mod ros;
pub mod scan;
mod scan_error;
mod scan_file;
mod sensors;
mod streamed;
mod write;

pub use angles::Angles;
pub use beside::Beside;
pub use capture::{Capture, CaptureError};
pub use cloud::axes::Axes;
pub use file::{FileError, read_at_most};
pub use geometry::{Depth, Geometry, Kind, TurnAxis};
pub use geometry_error::GeometryError;
pub use grey_image::{GreyImage, ImageError, MAX_PIXELS};
pub use noise::Noise;
pub use range_image::{RangeError, RangeImage};
pub use scan::{CameraOptions, ReadOptions, Scan};
pub use scan_error::ScanError;
pub use scan_file::{Format, ScanFile};
pub use sensors::{SENSORS, Sensor};
pub use write::{remove_temporaries, write_all_or_none, write_atomic};

/// Compiles the example of the README.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
