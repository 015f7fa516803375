//! Where the beams of the pixels point.

use std::path::PathBuf;
use std::sync::Arc;

use numpy::{IntoPyArray, PyArray3, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyTuple;
use scanseg_core::MAX_RANGE_M;
use scanseg_formats::{Angles, Beside, Depth, Geometry, GeometryError, Kind, TurnAxis};
use scanseg_sim::export::point_m;

use crate::arrays::{Numbers, list, vectors};
use crate::{file_error, value_error};

/// Where the beams of the pixels point, and what is known of the scanner: a geometry.
#[pyclass(frozen, eq, module = "scanseg")]
#[derive(Clone, PartialEq)]
pub struct Beams {
    /// The geometry.
    pub geometry: Arc<Geometry>,
    /// Whether its unit is that of the scanner's counts, and not the usual one.
    pub has_unit: bool,
}

impl Beams {
    /// The beams of a scan that brought them along.
    pub fn of(geometry: Geometry, has_unit: bool) -> Beams {
        Beams { geometry: Arc::new(geometry), has_unit }
    }

    fn checked(kind: Kind, beside: Beside) -> PyResult<Beams> {
        let geometry = Geometry { beside, ..Geometry::of(kind) };
        check(&geometry).map_err(value_error)?;
        Ok(Beams::of(geometry, false))
    }

    /// The beams of a scan whose ranges are along the beams, whatever its pixels measured, and lack what
    /// is outside of the limits.
    pub fn of_ranges(mut geometry: Geometry) -> Beams {
        if let Kind::Pinhole { depth: depth @ Depth::Z, .. } = &mut geometry.kind {
            *depth = Depth::Range;
            // that of the depths is none of the ranges
            geometry.max_range_m = geometry.max_range_m.map(|_| MAX_RANGE_M.into());
        }
        Beams::of(geometry, false)
    }

    /// Returns how many rows an image has, if the beams tell.
    pub fn rows(&self) -> Option<usize> {
        let of_rows = match &self.geometry.kind {
            Kind::Nodding { turn_deg: Angles::Listed(list), .. }
            | Kind::Spinning { elevation_deg: Angles::Listed(list), .. } => Some(list.len()),
            Kind::Free { directions, columns, .. } => Some(directions.len() / columns.max(&1)),
            _ => None,
        };
        match &self.geometry.beside.row_offset_deg {
            Some(Angles::Listed(list)) => Some(list.len()),
            _ => of_rows,
        }
    }

    /// Returns how many columns an image has, if the beams tell.
    pub fn columns(&self) -> Option<usize> {
        match &self.geometry.kind {
            Kind::Nodding { beam_deg: Angles::Listed(list), .. }
            | Kind::Spinning { azimuth_deg: Angles::Listed(list), .. } => Some(list.len()),
            Kind::Free { columns, .. } => Some(*columns),
            _ => None,
        }
    }
}

/// Checks a geometry. The turns of the rows may be left out: they come with the rows.
pub fn check(geometry: &Geometry) -> Result<(), GeometryError> {
    match with_turns(geometry) {
        Some(turned) => turned.check(),
        None => geometry.check(),
    }
}

/// Returns a geometry whose turns are left out with some in their place.
fn with_turns(geometry: &Geometry) -> Option<Geometry> {
    let Kind::Nodding { beam_deg, turn_deg: Angles::Listed(list), turn_axis } = &geometry.kind else { return None };
    let turn_deg = Angles::Even { start_deg: 0.0, step_deg: 1.0 };
    let kind = Kind::Nodding { beam_deg: beam_deg.clone(), turn_deg, turn_axis: *turn_axis };
    list.is_empty().then(|| Geometry { kind, ..geometry.clone() })
}

/// Returns the text of a geometry file, if there are such beams in one.
pub fn toml_of(geometry: &Geometry) -> PyResult<String> {
    match &geometry.kind {
        Kind::Free { .. } => Err(value_error("a geometry file has no beams of kind free")),
        _ => Ok(geometry.to_toml()),
    }
}

fn listed(what: &str, any: Option<&Bound<'_, PyAny>>) -> PyResult<Option<Angles>> {
    any.map(|any| Ok(Angles::Listed(list(what, any)?))).transpose()
}

#[pymethods]
impl Beams {
    /// Return the beams of a 2D scanner that tilts or pans about an axis in its scan plane.
    ///
    /// Parameters
    /// ----------
    /// beam_deg : (W,) array
    ///     Angle of each column in the scan plane from its middle, degrees; the axis is at +-90.
    /// turn_deg : (H,) array, optional
    ///     Turn of the scan plane of each row, degrees. Without it each row brings its turn: `Segmenter.push`.
    /// axis : {"y", "z"}
    ///     The axis: "y" points left, the scanner tilts; "z" points up, it pans.
    /// column_offset_deg : (W,) array, optional
    ///     How much more than its row each column is turned, degrees.
    /// lever_arm_m : float
    ///     Distance of the scanner's origin from the axis, along the beam at angle 0, metres, -10 to 10.
    ///
    /// Returns
    /// -------
    /// Beams
    #[staticmethod]
    #[pyo3(signature = (beam_deg, turn_deg=None, axis="y", *, column_offset_deg=None, lever_arm_m=0.0))]
    fn nodding(
        beam_deg: &Bound<'_, PyAny>,
        turn_deg: Option<&Bound<'_, PyAny>>,
        axis: &str,
        column_offset_deg: Option<&Bound<'_, PyAny>>,
        lever_arm_m: f64,
    ) -> PyResult<Beams> {
        let turn_axis = match axis {
            "y" => TurnAxis::Y,
            "z" => TurnAxis::Z,
            other => return Err(value_error(format!("axis: '{other}', must be y or z"))),
        };
        let beam_deg = Angles::Listed(list("beam_deg", beam_deg)?);
        let turn_deg = listed("turn_deg", turn_deg)?.unwrap_or(Angles::Listed(vec![]));
        let column_offset_deg = listed("column_offset_deg", column_offset_deg)?;
        let beside = Beside { column_offset_deg, lever_arm_m, ..Beside::NONE };
        Beams::checked(Kind::Nodding { beam_deg, turn_deg, turn_axis }, beside)
    }

    /// Return the beams of a spinning scanner: (cos e cos a, cos e sin a, sin e).
    ///
    /// Parameters
    /// ----------
    /// azimuth_deg : (W,) array
    ///     Azimuth a of each column, degrees.
    /// elevation_deg : (H,) array
    ///     Elevation e of each row, degrees.
    /// wraps : bool
    ///     Whether the last column neighbours the first.
    /// row_offset_deg : (H,) array, optional
    ///     What is added to the azimuths of each row, degrees: lasers that look beside the others.
    ///
    /// Returns
    /// -------
    /// Beams
    #[staticmethod]
    #[pyo3(signature = (azimuth_deg, elevation_deg, *, wraps=true, row_offset_deg=None))]
    fn spinning(
        azimuth_deg: &Bound<'_, PyAny>,
        elevation_deg: &Bound<'_, PyAny>,
        wraps: bool,
        row_offset_deg: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Beams> {
        let azimuth_deg = Angles::Listed(list("azimuth_deg", azimuth_deg)?);
        let elevation_deg = Angles::Listed(list("elevation_deg", elevation_deg)?);
        let beside = Beside { row_offset_deg: listed("row_offset_deg", row_offset_deg)?, ..Beside::NONE };
        Beams::checked(Kind::Spinning { azimuth_deg, elevation_deg, wraps }, beside)
    }

    /// Return the beams of a camera: normalised (1, -(u - cx) / fx, -(v - cy) / fy) for column u, row v.
    ///
    /// Parameters
    /// ----------
    /// fx, fy : float
    ///     Focal lengths along a row and along a column, pixels.
    /// cx, cy : float
    ///     Column and row of the optical axis, counted from 0, pixels.
    /// depth : {"z", "range"}
    ///     What the pixels measure: along the camera's axis, or along the beam.
    ///
    /// Returns
    /// -------
    /// Beams
    #[staticmethod]
    #[pyo3(signature = (fx, fy, cx, cy, *, depth="z"))]
    fn pinhole(fx: f64, fy: f64, cx: f64, cy: f64, depth: &str) -> PyResult<Beams> {
        let depth = match depth {
            "z" => Depth::Z,
            "range" => Depth::Range,
            other => return Err(value_error(format!("depth: '{other}', must be z or range"))),
        };
        Beams::checked(Kind::Pinhole { fx_px: fx, fy_px: fy, cx_px: cx, cy_px: cy, depth }, Beside::NONE)
    }

    /// Return beams of any arrangement. Those of the other kinds are segmented twice as fast.
    ///
    /// Parameters
    /// ----------
    /// directions : (H, W, 3) array
    ///     A unit vector for each pixel; anything where nothing was measured.
    /// wraps : bool
    ///     Whether the last column neighbours the first.
    ///
    /// Returns
    /// -------
    /// Beams
    #[staticmethod]
    #[pyo3(signature = (directions, *, wraps=false))]
    fn free(directions: &Bound<'_, PyAny>, wraps: bool) -> PyResult<Beams> {
        let (_, columns, directions) = vectors("directions", directions)?;
        Beams::checked(Kind::Free { directions, columns, wraps }, Beside::NONE)
    }

    /// Read a geometry file (docs/scan-format.md), with the unit, the limits and the noise that it states.
    ///
    /// Parameters
    /// ----------
    /// path : path
    ///     A TOML file.
    ///
    /// Returns
    /// -------
    /// Beams
    #[staticmethod]
    fn read(path: PathBuf) -> PyResult<Beams> {
        Ok(Beams::of(Geometry::read(&path).map_err(file_error)?, true))
    }

    /// Return the beams of the text of a geometry file, see `read`.
    #[staticmethod]
    fn from_toml(text: &str) -> PyResult<Beams> {
        Ok(Beams::of(Geometry::parse(text).map_err(value_error)?, true))
    }

    /// Return the text of a geometry file. Free beams have none.
    fn to_toml(&self) -> PyResult<String> {
        toml_of(&self.geometry)
    }

    /// "nodding", "spinning", "pinhole" or "free".
    #[getter]
    pub fn kind(&self) -> &'static str {
        match &self.geometry.kind {
            Kind::Nodding { .. } => "nodding",
            Kind::Spinning { .. } => "spinning",
            Kind::Pinhole { .. } => "pinhole",
            Kind::Free { .. } => "free",
        }
    }

    /// Return the points of pixels.
    ///
    /// Parameters
    /// ----------
    /// ranges : (H, W) array
    ///     Ranges along the beams, metres.
    ///
    /// Returns
    /// -------
    /// (H, W, 3) float64
    ///     Metres, x forward, y left, z up; NaN without a range.
    fn points<'py>(&self, py: Python<'py>, ranges: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray3<f64>>> {
        let numbers = Numbers::of("ranges", ranges)?;
        let [rows, columns] = numbers.shape("ranges", "rows x columns")?;
        self.geometry.fits(rows, columns).map_err(value_error)?;
        let point = |(i, range_m): (usize, &f64)| {
            let is_return = *range_m > 0.0 && range_m.is_finite();
            if is_return { point_m(&self.geometry, i / columns, i % columns, *range_m as f32) } else { [f64::NAN; 3] }
        };
        let points: Vec<f64> = py.detach(|| numbers.values.iter().enumerate().flat_map(point).collect());
        points.into_pyarray(py).reshape([rows, columns, 3])
    }

    /// Returns what was pickled. `toml` lacks what a geometry file cannot have: the turns, if they are
    /// left out, and free directions.
    #[staticmethod]
    fn _unpickled(
        toml: &str,
        has_unit: bool,
        no_turns: bool,
        directions: Option<&Bound<'_, PyAny>>,
        wraps: bool,
    ) -> PyResult<Beams> {
        let mut geometry = Geometry::parse(toml).map_err(value_error)?;
        if let Kind::Nodding { turn_deg, .. } = &mut geometry.kind
            && no_turns
        {
            *turn_deg = Angles::Listed(vec![]);
        }
        if let Some(directions) = directions {
            let (_, columns, directions) = vectors("directions", directions)?;
            geometry.kind = Kind::Free { directions, columns, wraps };
        }
        Ok(Beams::of(geometry, has_unit))
    }

    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let (py, unpickled) = (slf.py(), slf.get_type().getattr("_unpickled")?);
        let Beams { geometry, has_unit } = slf.get();
        let turned = with_turns(geometry);
        let arguments = if let Kind::Free { directions, columns, wraps } = &geometry.kind {
            let flat: Vec<f32> = directions.iter().flatten().copied().collect();
            let array = flat.into_pyarray(py).reshape([directions.len() / columns, *columns, 3])?;
            let kind = Kind::Pinhole { fx_px: 1.0, fy_px: 1.0, cx_px: 0.0, cy_px: 0.0, depth: Depth::Range };
            let rest = Geometry { kind, ..Geometry::clone(geometry) };
            (rest.to_toml(), *has_unit, false, Some(array), *wraps).into_pyobject(py)?
        } else {
            let toml = turned.as_ref().unwrap_or(geometry).to_toml();
            (toml, *has_unit, turned.is_some(), None::<Bound<'_, PyArray3<f32>>>, false).into_pyobject(py)?
        };
        Ok((unpickled, arguments))
    }

    fn __repr__(&self) -> String {
        let size = |n: Option<usize>| n.map_or("any".to_string(), |n| n.to_string());
        format!("<scanseg.Beams: {}, {} rows x {} columns>", self.kind(), size(self.rows()), size(self.columns()))
    }
}
