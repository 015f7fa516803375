//! Simulated offices, and evaluation against the truth.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scanseg_sim::hoover::Overlaps;
use scanseg_sim::office::{Scene, Sensor, Set, SimulatedScan};

use crate::arrays::ids;
use crate::beams::Beams;
use crate::value_error;

#[pyfunction]
pub fn evaluate<'py>(
    py: Python<'py>,
    labels: &Bound<'py, PyAny>,
    truth: &Bound<'py, PyAny>,
    tolerance: f64,
    min_pixels: usize,
) -> PyResult<Bound<'py, PyDict>> {
    let (rows, columns, labels) = ids("labels", labels)?;
    let (truth_rows, truth_columns, truth) = ids("truth", truth)?;
    if (rows, columns) != (truth_rows, truth_columns) {
        let what = format!("labels: {rows} x {columns} pixels, but truth has {truth_rows} x {truth_columns}");
        return Err(value_error(what));
    }
    let hoover = py.detach(|| Overlaps::new(&truth, &labels, min_pixels)?.at(tolerance)).map_err(value_error)?;
    let dict = PyDict::new(py);
    dict.set_item("tolerance", hoover.tolerance)?;
    dict.set_item("truth_regions", hoover.truth_regions)?;
    dict.set_item("segments", hoover.segments)?;
    dict.set_item("correct", hoover.correct)?;
    dict.set_item("over_segmented", hoover.over_segmented)?;
    dict.set_item("under_segmented", hoover.under_segmented)?;
    dict.set_item("missed", hoover.missed)?;
    dict.set_item("noise", hoover.noise)?;
    Ok(dict)
}

#[pyfunction]
pub fn office<'py>(
    py: Python<'py>,
    scene: u32,
    set: &str,
    sensor: &str,
    shape: Option<(usize, usize)>,
    noise_m: f64,
    seed: u64,
) -> PyResult<Bound<'py, PyDict>> {
    let set = match set {
        "tuning" => Set::Tuning,
        "validation" => Set::Validation,
        other => return Err(value_error(format!("set: '{other}', must be tuning or validation"))),
    };
    let (of, usual): (fn(usize, usize) -> Sensor, _) = match sensor {
        "nodding" => (Sensor::nodding, (200, 361)),
        "spinning" => (Sensor::spinning, (128, 1024)),
        "pinhole" => (Sensor::pinhole, (240, 320)),
        other => return Err(value_error(format!("sensor: '{other}', must be nodding, spinning or pinhole"))),
    };
    let (rows, columns) = shape.unwrap_or(usual);
    let sensor = Sensor { range_noise_m: noise_m, ..of(rows, columns) };
    let scan = py.detach(|| Scene::numbered(set, scene).scan(&sensor, seed));
    let SimulatedScan { rows, columns, range_m, truth, geometry } = scan.map_err(value_error)?;
    let dict = PyDict::new(py);
    dict.set_item("ranges", range_m.into_pyarray(py).reshape([rows, columns])?)?;
    dict.set_item("truth", truth.into_pyarray(py).reshape([rows, columns])?)?;
    dict.set_item("beams", Bound::new(py, Beams::of(geometry, false))?)?;
    Ok(dict)
}
