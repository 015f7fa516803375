//! Segments as arrays, one a property.

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scanseg_core::{Plane, Segment};

/// What a segment without a plane has in its place.
const NO_PLANE: Plane =
    Plane { normal: [f32::NAN; 3], distance_m: f32::NAN, rms_m: f32::NAN, covariance: [[f32::NAN; 4]; 4] };

/// Returns the properties of segments, an array each: those of `SEGMENT` in `python/scanseg`.
pub fn columns<'py>(py: Python<'py>, segments: &[Segment]) -> PyResult<Bound<'py, PyDict>> {
    let count = segments.len();
    let planes: Vec<Plane> = segments.iter().map(|segment| segment.plane().unwrap_or(NO_PLANE)).collect();
    let whole = |of: fn(&Segment) -> u32| segments.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
    let real = |of: fn(&Plane) -> f32| planes.iter().map(of).collect::<Vec<_>>().into_pyarray(py);
    let normals: Vec<f32> = planes.iter().flat_map(|plane| plane.normal).collect();
    let covariances: Vec<f32> = planes.iter().flat_map(|plane| plane.covariance).flatten().collect();
    let columns = PyDict::new(py);
    columns.set_item("label", whole(|segment| segment.label.0))?;
    columns.set_item("pixels", whole(Segment::pixels))?;
    columns.set_item("first_row", whole(|segment| segment.first_row.into()))?;
    columns.set_item("last_row", whole(|segment| segment.last_row.into()))?;
    columns.set_item("first_column", whole(|segment| segment.first_column.into()))?;
    columns.set_item("last_column", whole(|segment| segment.last_column.into()))?;
    columns.set_item("normal", normals.into_pyarray(py).reshape([count, 3])?)?;
    columns.set_item("distance_m", real(|plane| plane.distance_m))?;
    columns.set_item("rms_m", real(|plane| plane.rms_m))?;
    columns.set_item("covariance", covariances.into_pyarray(py).reshape([count, 4, 4])?)?;
    Ok(columns)
}
