//! Files with scans, whatever their format: told by their content, not by their name.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::cloud::e57::{self, E57File};
use crate::cloud::{pcd, ply};
use crate::depth;
use crate::file::{Cause, FileError};
use crate::geometry::Geometry;
use crate::grey_image::{GreyImage, MAX_PIXELS};
use crate::npy;
use crate::range_image::RangeImage;
use crate::scan_error::ScanError;

/// A scan: ranges with the geometry of their beams.
#[derive(Clone, Debug, PartialEq)]
pub struct Scan {
    /// What messages call it: its file, and where that has several scans which one.
    pub name: String,
    /// Its ranges. Those outside of the limits of the geometry are left out.
    pub image: RangeImage,
    /// Where its beams point, and what is known of its errors. `unit_m` is what one count, or one
    /// unit of the coordinates, was taken for.
    pub geometry: Geometry,
    /// Pixels for which the file has a distance, be it within the limits or not.
    pub measured: usize,
    /// What its reader took it for, where the file does not say it: sentences for the user.
    pub remarks: Vec<String>,
}

/// What the user says of a file.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// A geometry file, or the intrinsics of a camera. Grey images need one, or the focal length;
    /// of scans that bring their beams along it tells the limits and the errors.
    pub geometry: Option<PathBuf>,
    /// Metres of one count or of one unit of the coordinates, in place of what the file says.
    pub unit_m: Option<f64>,
    /// The camera of a depth image.
    pub camera: CameraOptions,
    /// The topic of a recording, where several would do.
    pub topic: Option<String>,
}

/// A camera by its numbers, pixels. `fx_px` alone makes square pixels and an axis in the middle of
/// the image.
#[derive(Clone, Copy, Debug, Default)]
pub struct CameraOptions {
    /// Focal length along a row.
    pub fx_px: Option<f64>,
    /// Focal length along a column.
    pub fy_px: Option<f64>,
    /// Column of the optical axis.
    pub cx_px: Option<f64>,
    /// Row of the optical axis.
    pub cy_px: Option<f64>,
}

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

/// The scans of a file. Each format makes its own.
pub(crate) trait Frames {
    /// Returns how many there are, one or more.
    fn count(&self) -> usize;

    /// Reads one of them.
    fn read(&mut self, n: usize) -> Result<Scan, Cause>;
}

/// A file that has one scan.
impl Frames for Scan {
    fn count(&self) -> usize {
        1
    }

    fn read(&mut self, _: usize) -> Result<Scan, Cause> {
        Ok(self.clone())
    }
}

/// A file that is open, from its start on.
pub(crate) struct Source<'a> {
    /// Its path.
    pub path: &'a Path,
    head: Vec<u8>,
    rest: File,
}

impl<'a> Source<'a> {
    fn open(path: &'a Path) -> io::Result<Source<'a>> {
        let mut rest = File::open(path)?;
        let mut head = Vec::new();
        (&mut rest).take(4096).read_to_end(&mut head)?;
        Ok(Source { path, head, rest })
    }

    /// What messages call a scan of it.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Returns what reads it.
    pub fn read(self) -> impl Read {
        io::Cursor::new(self.head).chain(self.rest)
    }

    /// Returns its bytes. There may be `most`.
    pub fn bytes(self, most: u64) -> Result<Vec<u8>, Cause> {
        let mut bytes = Vec::new();
        self.read().take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most { Err(ScanError::FileBytes { most }.into()) } else { Ok(bytes) }
    }
}

/// No cloud is read whose file is longer: 64 bytes for each of the most pixels.
const MAX_CLOUD_BYTES: u64 = 64 * MAX_PIXELS as u64;

fn frames_of(path: &Path, options: &ReadOptions) -> Result<Box<dyn Frames>, Cause> {
    let source = Source::open(path)?;
    let name = source.name();
    let format = Format::of(&source.head).ok_or(ScanError::Unknown)?;
    Ok(match format {
        Format::Grey => Box::new(depth::grey(name, &GreyImage::read_from(source.read())?, options)?),
        Format::Npy => Box::new(depth::npy(name, &source.bytes(MAX_CLOUD_BYTES)?, options)?),
        Format::Pcd => Box::new(pcd::read(&source.bytes(MAX_CLOUD_BYTES)?)?.into_scan(name, options)?),
        Format::Ply => Box::new(ply::read(&source.bytes(MAX_CLOUD_BYTES)?)?.into_scan(name, options)?),
        Format::E57 => Box::new(E57File::open(name, source.bytes(MAX_CLOUD_BYTES)?, options)?),
    })
}
