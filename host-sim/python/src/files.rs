//! Files with scans and with labels.

use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scanseg_formats::{
    CameraOptions, Geometry, GreyImage, RangeImage, ReadOptions, Scan, ScanFile as File, write_all_or_none,
};

use crate::arrays::{Numbers, ids};
use crate::beams::{Beams, toml_of};
use crate::{file_error, value_error};

/// A file with one scan or more, whatever its format: its content says which.
///
/// Formats: range and depth images (PGM, PNG, npy), organised clouds (PCD, PLY, E57, npy), captures of
/// Ouster, Velodyne and LD06, recordings of ROS 2 (MCAP). See docs/formats.md.
///
/// Parameters
/// ----------
/// path : path
///     The file.
/// geometry : path, optional
///     Its geometry file (docs/scan-format.md), or the intrinsics of a depth camera as TUM, ROS, RealSense
///     or Open3D write them. Scans that bring their beams along need none.
/// unit_m : float, optional
///     Metres of one count, or of one unit of the coordinates, in place of what the file says.
/// fx, fy, cx, cy : float, optional
///     The camera of a depth image, pixels. `fx` alone makes square pixels and an axis in the middle.
/// topic : str, optional
///     The topic of a recording, where several have scans.
///
/// Raises
/// ------
/// OSError
///     A file that cannot be read.
/// ValueError
///     A file that has no scan, or that is not as its format says.
///
/// Notes
/// -----
/// ``len(file)`` is the number of its scans, ``file[n]`` reads one, and ``for scan in file`` all. Those of a
/// capture or recording come one after the other: an earlier one is looked for from the start again.
#[pyclass(frozen, module = "scanseg")]
pub struct ScanFile {
    file: Mutex<File>,
    frames: usize,
}

#[pymethods]
impl ScanFile {
    #[new]
    #[pyo3(signature = (path, *, geometry=None, unit_m=None, fx=None, fy=None, cx=None, cy=None, topic=None))]
    #[allow(clippy::too_many_arguments)] // they have names in Python
    fn new(
        py: Python<'_>,
        path: PathBuf,
        geometry: Option<PathBuf>,
        unit_m: Option<f64>,
        fx: Option<f64>,
        fy: Option<f64>,
        cx: Option<f64>,
        cy: Option<f64>,
        topic: Option<String>,
    ) -> PyResult<ScanFile> {
        let camera = CameraOptions { fx_px: fx, fy_px: fy, cx_px: cx, cy_px: cy };
        let options = ReadOptions { geometry, unit_m, camera, topic, ..ReadOptions::default() };
        let file = py.detach(|| File::open(&path, &options)).map_err(file_error)?;
        Ok(ScanFile { frames: file.frames(), file: Mutex::new(file) })
    }

    fn __len__(&self) -> usize {
        self.frames
    }

    fn __getitem__<'py>(&self, py: Python<'py>, n: isize) -> PyResult<Bound<'py, PyAny>> {
        let count = self.frames as isize;
        let at = if n < 0 { n + count } else { n };
        if !(0..count).contains(&at) {
            return Err(PyIndexError::new_err(format!("scan {n} of {count}")));
        }
        let read = || self.file.lock().unwrap_or_else(PoisonError::into_inner).frame(at as usize);
        let Scan { name, image, geometry, remarks, .. } = py.detach(read).map_err(file_error)?;
        let ranges = image.range_m.into_pyarray(py).reshape([image.rows, image.columns])?;
        let dict = PyDict::new(py);
        dict.set_item("name", name)?;
        dict.set_item("ranges", ranges)?;
        dict.set_item("beams", Bound::new(py, Beams::of_ranges(geometry))?)?;
        dict.set_item("remarks", remarks)?;
        py.import("scanseg._files")?.getattr("Scan")?.call((), Some(&dict))
    }
}

/// Returns the bytes of an image, PNG or PGM by the name of its file.
fn encoded(path: &Path, image: &GreyImage) -> PyResult<Vec<u8>> {
    match path.extension().and_then(|ending| ending.to_str()) {
        Some("png") => Ok(image.to_png()),
        Some("pgm") => Ok(image.to_pgm()),
        _ => Err(value_error(format!("{}: the name must end in .png or .pgm", path.display()))),
    }
}

/// Read a label image.
///
/// Parameters
/// ----------
/// path : path
///     Grey PGM (P5) or PNG, 8 or 16 bits.
///
/// Returns
/// -------
/// (H, W) uint16
#[pyfunction]
pub fn read_labels<'py>(py: Python<'py>, path: PathBuf) -> PyResult<Bound<'py, PyArray2<u16>>> {
    let image = py.detach(|| GreyImage::read(&path)).map_err(file_error)?;
    image.values.into_pyarray(py).reshape([image.rows, image.columns])
}

/// Write a label image.
///
/// Parameters
/// ----------
/// path : path
///     NAME.png or NAME.pgm.
/// labels : (H, W) array of whole numbers
///     0 to 65535.
#[pyfunction]
pub fn write_labels(py: Python<'_>, path: PathBuf, labels: &Bound<'_, PyAny>) -> PyResult<()> {
    let (rows, columns, values) = ids("labels", labels)?;
    let bytes = encoded(&path, &GreyImage { rows, columns, max_value: 65535, values })?;
    py.detach(|| write_all_or_none(&[(&path, &bytes)])).map_err(file_error)
}

/// Write a range image of 16 bits, and its geometry file beside it.
///
/// Parameters
/// ----------
/// path : path
///     NAME.png or NAME.pgm; the geometry goes to NAME.toml.
/// ranges : (H, W) array
///     Ranges along the beams, metres.
/// beams : Beams
///     Where the pixels look; not free ones, which a geometry file cannot have.
/// unit_m : float
///     Metres of one count.
#[pyfunction]
#[pyo3(signature = (path, ranges, beams, *, unit_m=0.001))]
pub fn write_ranges(
    py: Python<'_>,
    path: PathBuf,
    ranges: &Bound<'_, PyAny>,
    beams: &Bound<'_, Beams>,
    unit_m: f64,
) -> PyResult<()> {
    let numbers = Numbers::of("ranges", ranges)?;
    let [rows, columns] = numbers.shape("ranges", "rows x columns")?;
    let geometry = Geometry { unit_m, ..Geometry::clone(&beams.get().geometry) };
    geometry.check().map_err(value_error)?;
    let toml = toml_of(&geometry)?;
    let image = RangeImage { rows, columns, range_m: numbers.values.iter().map(|&x| x as f32).collect() };
    let bytes = encoded(&path, &image.to_grey(&geometry).map_err(value_error)?)?;
    let beside = path.with_extension("toml");
    py.detach(|| write_all_or_none(&[(&path, &bytes), (&beside, toml.as_bytes())])).map_err(file_error)
}
