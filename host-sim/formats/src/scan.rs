//! A scan, and what a reader of files with scans is.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use crate::file::{Cause, FileError, read_at_most};
use crate::geometry::Geometry;
use crate::geometry_toml;
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
    /// The text of that file where it is not to be read from a disk; `geometry` is its name in messages.
    pub geometry_text: Option<String>,
    /// Metres of one count or of one unit of the coordinates, in place of what the file says.
    pub unit_m: Option<f64>,
    /// The camera of a depth image.
    pub camera: CameraOptions,
    /// The topic of a recording, where several would do.
    pub topic: Option<String>,
}

impl ReadOptions {
    /// Returns the geometry file, if one is given.
    pub(crate) fn geometry(&self) -> Result<Option<Geometry>, FileError> {
        match (&self.geometry, &self.geometry_text) {
            (Some(path), Some(text)) => Geometry::parse(text).map(Some).map_err(|e| FileError::new(path, e)),
            (Some(path), None) => Geometry::read(path).map(Some),
            (None, _) => Ok(None),
        }
    }

    /// Returns name and text of the geometry file, if one is given.
    pub(crate) fn geometry_text(&self) -> Result<Option<(&Path, String)>, FileError> {
        let Some(path) = self.geometry.as_deref() else { return Ok(None) };
        if let Some(text) = &self.geometry_text {
            return Ok(Some((path, text.clone())));
        }
        let bytes = read_at_most(path, geometry_toml::MAX_FILE_BYTES).map_err(|e| FileError::new(path, e))?;
        String::from_utf8(bytes).map(|text| Some((path, text))).map_err(|e| FileError::new(path, e.utf8_error()))
    }
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

/// The scans of a file. Each format makes its own.
pub(crate) trait Frames: Send {
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

/// The bytes of a file, from its start on.
pub(crate) struct Source<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its first bytes, up to 4096.
    pub head: Vec<u8>,
    rest: Box<dyn Read + 'a>,
}

impl<'a> Source<'a> {
    /// Opens a file and reads its head.
    pub fn open(path: &'a Path) -> io::Result<Source<'a>> {
        Source::of(path, File::open(path)?)
    }

    /// Reads the head of what is to be called `path`.
    pub fn of(path: &'a Path, mut rest: impl Read + 'a) -> io::Result<Source<'a>> {
        let mut head = Vec::new();
        (&mut rest).take(4096).read_to_end(&mut head)?;
        Ok(Source { path, head, rest: Box::new(rest) })
    }

    /// What messages call a scan of it.
    pub fn name(&self) -> String {
        self.path.display().to_string()
    }

    /// Returns what reads it.
    pub fn read(self) -> impl Read + 'a {
        io::Cursor::new(self.head).chain(self.rest)
    }

    /// Returns its bytes. There may be `most`.
    pub fn bytes(self, most: u64) -> Result<Vec<u8>, Cause> {
        let mut bytes = Vec::new();
        self.read().take(most + 1).read_to_end(&mut bytes)?;
        if bytes.len() as u64 > most { Err(ScanError::FileBytes { most }.into()) } else { Ok(bytes) }
    }
}
