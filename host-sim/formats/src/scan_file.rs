//! Files with scans, whatever their format: told by their content, not by their name.

use std::path::{Path, PathBuf};

use crate::cloud::e57::{self, E57File};
use crate::cloud::{pcd, ply};
use crate::depth;
use crate::file::{Cause, FileError};
use crate::grey_image::{GreyImage, MAX_PIXELS};
use crate::lidar::{Datagrams, ld06, pcap};
use crate::npy;
#[cfg(feature = "ros")]
use crate::ros;
use crate::scan::{Frames, ReadOptions, Scan, Source};
use crate::scan_error::ScanError;

/// The formats that are told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// A grey image, PGM or PNG.
    Grey,
    /// An array of NumPy.
    Npy,
    /// A cloud of the Point Cloud Library.
    Pcd,
    /// A polygon file.
    Ply,
    /// Scans of a terrestrial scanner.
    E57,
    /// A packet capture of a lidar: pcap or pcapng.
    Packets,
    /// Bytes of an LD06.
    Ld06,
    /// A recording of ROS 2 as MCAP.
    Mcap,
    /// A recording of ROS 2 as SQLite.
    Db3,
}

impl Format {
    /// Returns the format of a file by its first bytes, of which 4096 are enough.
    pub fn of(head: &[u8]) -> Option<Format> {
        let netpbm = head.len() >= 2 && head[0] == b'P' && (b'1'..=b'7').contains(&head[1]);
        if netpbm || head.starts_with(b"\x89PNG\r\n\x1a\n") {
            return Some(Format::Grey);
        }
        if head.starts_with(npy::SIGNATURE) {
            return Some(Format::Npy);
        }
        if head.starts_with(b"ply\n") || head.starts_with(b"ply\r") {
            return Some(Format::Ply);
        }
        if head.starts_with(e57::SIGNATURE) {
            return Some(Format::E57);
        }
        if Datagrams::is_capture(head) {
            return Some(Format::Packets);
        }
        if head.starts_with(b"\x89MCAP") {
            return Some(Format::Mcap);
        }
        if head.starts_with(b"SQLite format 3\0") {
            return Some(Format::Db3);
        }
        if ld06::model(head).is_some() {
            return Some(Format::Ld06);
        }
        pcd::is_pcd(head).then_some(Format::Pcd)
    }
}

/// A file that has been looked at: how many scans it has is known.
pub struct ScanFile {
    path: PathBuf,
    frames: Box<dyn Frames>,
}

impl ScanFile {
    /// Opens a file.
    ///
    /// # Errors
    /// What the system says; a format that is not known; a file that has no scan, or whose header
    /// cannot be true.
    pub fn open(path: impl AsRef<Path>, options: &ReadOptions) -> Result<ScanFile, FileError> {
        let path = path.as_ref();
        let frames = frames_of(path, options).map_err(|cause| FileError::of(path, cause))?;
        Ok(ScanFile { path: path.into(), frames })
    }

    /// Looks at the bytes of a file that is not on a disk. `name` is for messages.
    ///
    /// # Errors
    /// As [`ScanFile::open`]. Captures and recordings are refused: they are read from a disk alone.
    pub fn of_bytes(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<ScanFile, FileError> {
        let path = Path::new(name);
        let read = || -> Result<Box<dyn Frames>, Cause> {
            let source = Source::of(path, bytes)?;
            let format = Format::of(&source.head).ok_or(ScanError::Unknown)?;
            let lacks = || ScanError::lacks("a capture or a recording", "its file on a disk").into();
            of_source(source, format, options)?.ok_or_else(lacks)
        };
        Ok(ScanFile { path: path.into(), frames: read().map_err(|cause| FileError::of(path, cause))? })
    }

    /// Returns how many scans it has, one or more.
    pub fn frames(&self) -> usize {
        self.frames.count()
    }

    /// Reads a scan, 0 to less than [`ScanFile::frames`].
    ///
    /// # Errors
    /// A scan that is damaged, too large, or without rows and columns.
    pub fn frame(&mut self, n: usize) -> Result<Scan, FileError> {
        self.frames.read(n).map_err(|cause| FileError::of(&self.path, cause))
    }
}

/// No cloud is read whose file is longer: 64 bytes for each of the most pixels.
const MAX_CLOUD_BYTES: u64 = 64 * MAX_PIXELS as u64;

fn frames_of(path: &Path, options: &ReadOptions) -> Result<Box<dyn Frames>, Cause> {
    #[cfg(feature = "ros")]
    if path.is_dir()
        && let Some(recording) = ros::is_folder_of_one(path)?
    {
        return frames_of(&recording, options);
    }
    let source = Source::open(path)?;
    let format = Format::of(&source.head).ok_or(ScanError::Unknown)?;
    Ok(match format {
        Format::Packets => Box::new(pcap::frames(path, options)?),
        Format::Ld06 => Box::new(ld06::scan(source.name(), &source.bytes(ld06::MAX_BYTES)?, options)?),
        #[cfg(feature = "ros")]
        Format::Mcap => Box::new(ros::frames_of_mcap(path, options)?),
        #[cfg(feature = "ros")]
        Format::Db3 => Box::new(ros::frames_of_db3(path, options)?),
        _ => of_source(source, format, options)?.ok_or_else(|| {
            let what = "the feature ros of this build: cargo build --release --features ros (or db3)";
            ScanError::lacks("a recording of ROS 2", what)
        })?,
    })
}

/// Returns the scans of an image or a cloud; none of captures and recordings.
fn of_source(source: Source<'_>, format: Format, options: &ReadOptions) -> Result<Option<Box<dyn Frames>>, Cause> {
    let name = source.name();
    Ok(Some(match format {
        Format::Grey => Box::new(depth::grey(name, &GreyImage::read_from(source.read())?, options)?),
        Format::Npy => Box::new(depth::npy(name, &source.bytes(MAX_CLOUD_BYTES)?, options)?),
        Format::Pcd => Box::new(pcd::read(&source.bytes(MAX_CLOUD_BYTES)?)?.into_scan(name, options)?),
        Format::Ply => Box::new(ply::read(&source.bytes(MAX_CLOUD_BYTES)?)?.into_scan(name, options)?),
        Format::E57 => Box::new(E57File::open(name, source.bytes(MAX_CLOUD_BYTES)?, options)?),
        Format::Packets | Format::Ld06 | Format::Mcap | Format::Db3 => return Ok(None),
    }))
}
