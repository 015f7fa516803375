//! Whole scans.

use std::path::{Path, PathBuf};

use numpy::{IntoPyArray, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyList};
use scanseg_core::{AnyConfig, Ranging, Segment};
use scanseg_formats::{Geometry, RangeImage, ReadOptions, Scan, write_atomic};
use scanseg_sim::export::outlines::Outlines;
use scanseg_sim::export::points;
use scanseg_sim::export::{Outline, Planarity, Segmented, outlines_of, planarities_of};
use scanseg_sim::segmentation::{FoundNoise, Segmentation, SegmentationError, states_noise, within_limits};

use crate::arrays::{Numbers, vectors};
use crate::beams::Beams;
use crate::segments;
use crate::settings::{Noise, Settings, unit_m as metres};
use crate::{file_error, value_error};

#[pyfunction]
#[pyo3(signature = (ranges, beams, noise, approach, unit_m, min_range_m, max_range_m, min_pixels))]
#[allow(clippy::too_many_arguments)] // they have names in Python
pub fn segment<'py>(
    py: Python<'py>,
    ranges: &Bound<'py, PyAny>,
    beams: &Bound<'py, Beams>,
    noise: Option<Noise>,
    approach: String,
    unit_m: Option<f64>,
    min_range_m: Option<f64>,
    max_range_m: Option<f64>,
    min_pixels: u32,
) -> PyResult<Bound<'py, PyDict>> {
    let beams = beams.get();
    let numbers = Numbers::of("ranges", ranges)?;
    let [rows, columns] = numbers.shape("ranges", "rows x columns")?;
    let mut geometry = Geometry::clone(&beams.geometry);
    let (whole, of_beams) = (numbers.whole.as_deref(), beams.has_unit.then_some(geometry.unit_m));
    let unit_m = Some(metres("ranges", whole, unit_m, of_beams)?);
    let settings = Settings { noise, approach, unit_m, min_range_m, max_range_m };
    settings.apply(&mut geometry)?;
    let config = settings.config(&geometry)?;
    let found = py.detach(|| {
        let image = RangeImage::from_distances(rows, columns, numbers.distances(&geometry), &geometry)?;
        Found::of(image, geometry, config, min_pixels)
    });
    found.map_err(value_error)?.into_dict(py)
}

#[pyfunction]
#[pyo3(signature = (xyz, noise, approach, unit_m, min_range_m, max_range_m, min_pixels))]
#[allow(clippy::too_many_arguments)] // they have names in Python
pub fn segment_cloud<'py>(
    py: Python<'py>,
    xyz: &Bound<'py, PyAny>,
    noise: Option<Noise>,
    approach: String,
    unit_m: Option<f64>,
    min_range_m: Option<f64>,
    max_range_m: Option<f64>,
    min_pixels: u32,
) -> PyResult<Bound<'py, PyDict>> {
    let (rows, columns, points) = vectors("xyz", xyz)?;
    let options = ReadOptions { unit_m, ..ReadOptions::default() };
    let scan = py.detach(|| Scan::of_points("xyz".into(), rows, columns, points, &options));
    let Scan { image, mut geometry, .. } = scan.map_err(value_error)?;
    let settings = Settings { noise, approach, unit_m, min_range_m, max_range_m };
    settings.apply(&mut geometry)?;
    let config = settings.config(&geometry)?;
    let found = py.detach(|| Found::of(image, geometry, config, min_pixels));
    found.map_err(value_error)?.into_dict(py)
}

/// All that is found in a scan.
struct Found {
    scan: SegmentedScan,
    planarities: Vec<Planarity>,
    outlines: Vec<Option<Outline>>,
    edges: Vec<bool>,
    noise: Option<FoundNoise>,
    beam_stretch: f32,
    unlabelled: u32,
}

/// A segmented scan, for files of it.
#[pyclass(frozen, module = "scanseg._scanseg")]
pub struct SegmentedScan {
    image: RangeImage,
    geometry: Geometry,
    ranging: Ranging,
    range_noise_m: Vec<f32>,
    labels: Vec<u32>,
    segments: Vec<Segment>,
}

impl SegmentedScan {
    fn segmented(&self) -> Segmented<'_> {
        Segmented {
            image: &self.image,
            geometry: &self.geometry,
            ranging: &self.ranging,
            range_noise_m: &self.range_noise_m,
            labels: &self.labels,
            segments: &self.segments,
        }
    }
}

#[pymethods]
impl SegmentedScan {
    fn write_points(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let bytes: fn(&Segmented<'_>) -> Vec<u8> = match ending(&path) {
            "ply" => points::ply,
            "pcd" => points::pcd,
            _ => return Err(value_error(format!("{}: the name must end in .ply or .pcd", path.display()))),
        };
        py.detach(|| write_atomic(&path, &bytes(&self.segmented()))).map_err(file_error)
    }

    fn write_outlines(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        let outlines = py.detach(|| Outlines::of(&self.segmented()));
        let bytes = match ending(&path) {
            "ply" => outlines.ply(),
            "csv" => outlines.csv(),
            "json" => outlines.json().map_err(value_error)?,
            "geojson" => outlines.geojson().map_err(value_error)?,
            _ => {
                let what = "the name must end in .ply, .csv, .json or .geojson";
                return Err(value_error(format!("{}: {what}", path.display())));
            }
        };
        py.detach(|| write_atomic(&path, &bytes)).map_err(file_error)
    }
}

/// Returns what a name ends in.
fn ending(path: &Path) -> &str {
    path.extension().and_then(|ending| ending.to_str()).unwrap_or_default()
}

impl Found {
    fn of(
        image: RangeImage,
        geometry: Geometry,
        config: AnyConfig<'_>,
        min_pixels: u32,
    ) -> Result<Found, SegmentationError> {
        let segmentation = Segmentation::of(&image, &geometry, config, None, || ())?;
        let (labels, segments) = (segmentation.numbers(min_pixels), segmentation.of_pixels(min_pixels).to_vec());
        let ranging = config.ranging();
        let image = within_limits(&image, &ranging);
        let range_noise_m = if states_noise(&geometry) { vec![] } else { segmentation.range_noise_m };
        let scan = SegmentedScan { image, geometry, ranging, range_noise_m, labels, segments };
        let (planarities, outlines) = (planarities_of(&scan.segmented()), outlines_of(&scan.segmented()));
        let Segmentation { closed_edges: edges, noise, beam_stretch, unlabelled, .. } = segmentation;
        Ok(Found { scan, planarities, outlines, edges, noise, beam_stretch, unlabelled })
    }

    /// Returns what `Result` in `python/scanseg` has.
    fn into_dict(self, py: Python<'_>) -> PyResult<Bound<'_, PyDict>> {
        let Found { scan, planarities, outlines, edges, noise, beam_stretch, unlabelled } = self;
        let (listed, shape) = (scan.segments.len(), [scan.image.rows, scan.image.columns]);
        let columns = segments::columns(py, &scan.segments)?;
        columns.set_item("label", (1..=listed as u32).collect::<Vec<_>>().into_pyarray(py))?;
        let residuals = planarities.iter().map(|planarity| planarity.residual_per_noise.unwrap_or(f32::NAN));
        columns.set_item("residual_per_noise", residuals.collect::<Vec<_>>().into_pyarray(py))?;
        columns
            .set_item("planarity", PyList::new(py, planarities.iter().map(|planarity| planarity.verdict.name()))?)?;
        let areas = outlines.iter().map(|outline| outline.as_ref().map_or(f64::NAN, |outline| outline.area_m2));
        columns.set_item("area_m2", areas.collect::<Vec<_>>().into_pyarray(py))?;
        let polygons = PyList::empty(py);
        for outline in outlines {
            let corners_m = outline.map(|outline| outline.corners_m).unwrap_or_default();
            let flat: Vec<f64> = corners_m.iter().flatten().copied().collect();
            polygons.append(flat.into_pyarray(py).reshape([corners_m.len(), 3])?)?;
        }
        let dict = PyDict::new(py);
        dict.set_item("columns", columns)?;
        dict.set_item("polygons", polygons)?;
        dict.set_item("labels", scan.labels.clone().into_pyarray(py).reshape(shape)?)?;
        dict.set_item("edges", edges.into_pyarray(py).reshape(shape)?)?;
        dict.set_item("ranges", scan.image.range_m.clone().into_pyarray(py).reshape(shape)?)?;
        dict.set_item("noise_m", noise.map(|noise| noise.counted_m))?;
        dict.set_item("noise_range_m", noise.map(|noise| noise.range_m))?;
        dict.set_item("beam_stretch", beam_stretch)?;
        dict.set_item("unlabelled", unlabelled)?;
        dict.set_item("beams", Bound::new(py, Beams::of_ranges(scan.geometry.clone()))?)?;
        dict.set_item("files", Bound::new(py, scan)?)?;
        Ok(dict)
    }
}
