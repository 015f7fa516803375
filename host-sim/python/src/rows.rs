//! Scans that come row by row.

use std::ops::ControlFlow;

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use scanseg_core::{AnySegmenter, ConfigError, Join, LabelRow, MAX_ROWS, Pixel, RowBeams, Segment, Segmenter, Sink};
use scanseg_formats::{Geometry, Kind};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams};
use self_cell::{MutBorrow, self_cell};

use crate::arrays::Numbers;
use crate::beams::Beams;
use crate::segments;
use crate::settings::{Noise, Settings, unit_m as metres};
use crate::value_error;

/// What a segmenter refers to.
struct Owner {
    memory: MutBorrow<OwnedMemory>,
    beams: ScanBeams,
}

self_cell!(
    /// A segmenter with its memory.
    struct Running {
        owner: Owner,
        #[not_covariant]
        dependent: AnySegmenter,
    }
);

/// A segmenter that takes rows one at a time.
#[pyclass(module = "scanseg._scanseg")]
pub struct RowSegmenter {
    running: Running,
    geometry: Geometry,
    /// Metres of one count, as the beams have it.
    unit_m: Option<f64>,
    /// The same, as it is said.
    said_unit_m: Option<f64>,
    rows: usize,
    columns: usize,
    /// Rows of the scan that were pushed.
    pushed: usize,
}

#[pymethods]
impl RowSegmenter {
    #[new]
    #[pyo3(signature = (beams, columns, noise, approach, unit_m, min_range_m, max_range_m))]
    fn new(
        beams: &Bound<'_, Beams>,
        columns: Option<usize>,
        noise: Option<Noise>,
        approach: String,
        unit_m: Option<f64>,
        min_range_m: Option<f64>,
        max_range_m: Option<f64>,
    ) -> PyResult<RowSegmenter> {
        let beams = beams.get();
        let columns = columns.or(beams.columns()).ok_or_else(|| {
            value_error(format!("columns: None, but beams of kind {} do not tell how many there are", beams.kind()))
        })?;
        let settings = Settings { noise, approach, unit_m, min_range_m, max_range_m };
        let mut geometry = Geometry::clone(&beams.geometry);
        let rows = beams.rows().unwrap_or(MAX_ROWS);
        settings.apply(&mut geometry)?;
        let config = settings.config(&geometry)?;
        let owner = Owner {
            memory: MutBorrow::new(OwnedMemory::new(config, columns, None)),
            beams: ScanBeams::new(&geometry, rows, columns).map_err(value_error)?,
        };
        let running = Running::try_new(owner, |owner| {
            AnySegmenter::new(config, owner.beams.beams(), columns, owner.memory.borrow_mut().memory())
        })
        .map_err(|e: ConfigError| value_error(e))?;
        // distances come in metres
        geometry.unit_m = 1.0;
        let of_beams_m = beams.has_unit.then_some(beams.geometry.unit_m);
        Ok(RowSegmenter { running, geometry, unit_m: of_beams_m, said_unit_m: unit_m, rows, columns, pushed: 0 })
    }

    fn push<'py>(
        &mut self,
        py: Python<'py>,
        ranges: &Bound<'py, PyAny>,
        turn_deg: Option<f64>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let numbers = Numbers::of("ranges", ranges)?;
        let [_] = numbers.shape::<1>("ranges", "columns")?;
        let row = self.pushed;
        let turned = matches!(self.geometry.kind, Kind::Nodding { .. });
        match turn_deg {
            Some(deg) if !turned => {
                return Err(value_error(format!("turn_deg: {deg}, but only rows of nodding beams have a turn")));
            }
            None if row >= self.rows => {
                let what = if self.rows == 0 { "give its turn_deg" } else { "the beams have no more" };
                return Err(value_error(format!("row {row} of {}: {what}", self.rows)));
            }
            _ => {}
        }
        let unit_m = metres("ranges", numbers.whole.as_deref(), self.said_unit_m, self.unit_m)?;
        let geometry = &self.geometry;
        let range_m = |(column, x): (usize, f64)| geometry.range_m(row, column, x * unit_m);
        let found = py.detach(|| {
            let ranges_m: Vec<f32> = numbers.distances(geometry).enumerate().map(range_m).collect();
            let mut found = Found::default();
            self.running.with_dependent_mut(|owner, segmenter| {
                let mut beams = if row < self.rows {
                    owner.beams.row(row)
                } else {
                    RowBeams::from(0.0).with_lever_arm_m(geometry.beside.lever_arm_m as f32)
                };
                if let Some(deg) = turn_deg {
                    beams.turn_rad = (deg % 360.0).to_radians() as f32;
                }
                segmenter.push_row(&ranges_m, beams, &mut found).map(|_| found)
            })
        });
        let found = found.map_err(value_error)?;
        self.pushed += 1;
        found.into_dict(py, self.columns)
    }

    fn finish<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let mut found = Found::default();
        py.detach(|| self.running.with_dependent_mut(|_, segmenter| segmenter.finish(&mut found)));
        self.pushed = 0;
        found.into_dict(py, self.columns)
    }

    #[getter]
    fn columns(&self) -> usize {
        self.columns
    }
}

/// What came of a row, or of the end of a scan.
#[derive(Default)]
struct Found {
    first_row: Option<usize>,
    labels: Vec<u32>,
    joins: Vec<u32>,
    segments: Vec<Segment>,
}

impl Found {
    /// Returns what `Rows` in `python/scanseg` has.
    fn into_dict(self, py: Python<'_>, columns: usize) -> PyResult<Bound<'_, PyDict>> {
        let (rows, joins) = (self.labels.len() / columns, self.joins.len() / 2);
        let dict = PyDict::new(py);
        dict.set_item("first_row", self.first_row)?;
        dict.set_item("labels", self.labels.into_pyarray(py).reshape([rows, columns])?)?;
        dict.set_item("joins", self.joins.into_pyarray(py).reshape([joins, 2])?)?;
        dict.set_item("columns", segments::columns(py, &self.segments)?)?;
        Ok(dict)
    }
}

impl Sink for Found {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.first_row.get_or_insert(row.row());
        self.labels.extend(row.pixels().map(|pixel| if let Pixel::Segment(label) = pixel { label.0 } else { 0 }));
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.joins.extend([join.from.0, join.into.0]);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.push(*segment);
        ControlFlow::Continue(())
    }
}
