//! Scans with their geometry, as the command line names them.

use std::path::{Path, PathBuf};

use clap::Args;
use scanseg_core::Ranging;
use scanseg_formats::{
    CameraOptions, FileError, Geometry, GeometryError, RangeImage, ReadOptions, Scan, ScanError, ScanFile,
};
use scanseg_sim::segmentation::within_limits;

use crate::command::output::Failure;

/// What describes the geometry file.
const PAGE: &str = "see docs/scan-format.md";

/// Reads a geometry file. What is wrong with it comes with the page that describes it.
pub fn read_geometry(path: &Path) -> Result<Geometry, Failure> {
    Geometry::read(path).map_err(|e| if e.cause.is::<GeometryError>() { with_page(&e) } else { e.into() })
}

/// Returns what is wrong with a geometry, with the page that describes it.
pub fn with_page(e: &impl ToString) -> Failure {
    format!("{} ({PAGE})", e.to_string()).into()
}

/// A scan on the command line.
#[derive(Args)]
pub struct ScanArguments {
    /// A scan: range or depth image (PGM, PNG, npy), organised cloud (PCD, PLY, E57, npy), capture or
    /// recording; its content says which. See docs/formats.md
    scan: PathBuf,
    /// Its geometry file, see docs/scan-format.md; or the intrinsics of a depth camera, as TUM, ROS,
    /// RealSense or Open3D write them. Scans that bring their beams along need none
    #[arg(long, value_name = "FILE")]
    geometry: Option<PathBuf>,
    /// Metres of one count, or of one unit of the coordinates [default: as the files say; else 0.001
    /// of counts, 1 of coordinates]
    #[arg(long, value_name = "M", allow_negative_numbers = true)]
    unit_m: Option<f64>,
    /// Depth image: focal length along a row, pixels
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    fx: Option<f64>,
    /// Depth image: focal length along a column, pixels [default: as along a row]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    fy: Option<f64>,
    /// Depth image: column of the optical axis [default: the middle]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    cx: Option<f64>,
    /// Depth image: row of the optical axis [default: the middle]
    #[arg(long, value_name = "PX", allow_negative_numbers = true)]
    cy: Option<f64>,
    /// Recording: the topic to read [default: the only one that has scans]
    #[arg(long, value_name = "NAME")]
    topic: Option<String>,
    /// Of a file with several scans this one, from 0 on
    #[arg(long, value_name = "N")]
    frame: Option<usize>,
}

/// What a file of several scans has.
pub struct Inputs {
    file: ScanFile,
    next: usize,
}

impl Iterator for Inputs {
    /// The number of a scan, and the scan.
    type Item = Result<(usize, Input), Failure>;

    fn next(&mut self) -> Option<Self::Item> {
        let n = self.next;
        self.next += 1;
        let file = &mut self.file;
        (n < file.frames()).then(|| Ok((n, file.frame(n).map_err(failure)?.into())))
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let left = self.file.frames().saturating_sub(self.next);
        (left, Some(left))
    }
}

impl ExactSizeIterator for Inputs {}

impl ScanArguments {
    /// Opens the file.
    pub fn open(&self) -> Result<ScanFile, Failure> {
        let camera = CameraOptions { fx_px: self.fx, fy_px: self.fy, cx_px: self.cx, cy_px: self.cy };
        let (geometry, topic) = (self.geometry.clone(), self.topic.clone());
        let options = ReadOptions { geometry, unit_m: self.unit_m, camera, topic, ..ReadOptions::default() };
        ScanFile::open(&self.scan, &options).map_err(failure)
    }

    /// Reads all scans one after the other, each when it is asked for.
    pub fn all(&self) -> Result<Inputs, Failure> {
        Ok(Inputs { file: self.open()?, next: 0 })
    }

    /// Reads the scan that is asked for, or the first.
    pub fn read(&self) -> Result<Input, Failure> {
        let mut file = self.open()?;
        let (count, n) = (file.frames(), self.frame.unwrap_or(0));
        if n >= count {
            return Err(format!("{}: no frame {n}, it has {count}", self.scan.display()).into());
        }
        let mut input = Input::from(file.frame(n).map_err(failure)?);
        if count > 1 && self.frame.is_none() {
            input.remarks.push(format!("frame 0 of {count}: --frame N is another one, --all-frames all"));
        }
        Ok(input)
    }
}

/// Returns what is wrong with a file. What is wrong with its geometry comes with the page that
/// describes that.
fn failure(e: FileError) -> Failure {
    let of_geometry = e.cause.is::<GeometryError>()
        || matches!(e.cause.downcast_ref(), Some(ScanError::Misfit { .. } | ScanError::NoGeometry));
    if of_geometry { with_page(&e) } else { e.into() }
}

/// A scan and its geometry.
pub struct Input {
    /// What messages call it.
    pub name: String,
    pub geometry: Geometry,
    pub ranges: RangeImage,
    /// Pixels for which the file has a distance.
    pub counts: usize,
    /// What its reader took it for.
    pub remarks: Vec<String>,
}

impl From<Scan> for Input {
    fn from(scan: Scan) -> Input {
        let Scan { name, image, geometry, measured, remarks } = scan;
        Input { name, geometry, ranges: image, counts: measured, remarks }
    }
}

impl Input {
    /// Reads a scan with its geometry file.
    pub fn read(scan: &Path, geometry: &Path) -> Result<Input, Failure> {
        let options = ReadOptions { geometry: Some(geometry.into()), ..ReadOptions::default() };
        let mut file = ScanFile::open(scan, &options).map_err(failure)?;
        Ok(file.frame(0).map_err(failure)?.into())
    }

    /// Returns the ranges without what lies outside of the limits.
    pub fn returns(&self, ranging: &Ranging) -> RangeImage {
        within_limits(&self.ranges, ranging)
    }

    /// Returns a line for each remark.
    pub fn remarks(&self) -> String {
        self.remarks.iter().map(|remark| format!("{}: {remark}\n", self.name)).collect()
    }
}
