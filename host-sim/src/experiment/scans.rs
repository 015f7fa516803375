//! Scans of the scenes.

use scanseg_formats::{Geometry, RangeImage};

use crate::office::{Scene, Sensor, Set};

/// Returns a scan of a scene by the paper's scanner in some resolution, with its truth. The errors
/// are those of seed 0, as in `scanseg office`.
pub(super) fn scan(set: Set, scene: u32, size: (usize, usize), range_noise_m: f64) -> (RangeImage, Vec<u16>, Geometry) {
    let sensor = Sensor { range_noise_m, ..Sensor::nodding(size.0, size.1) };
    let scan = Scene::numbered(set, scene).scan(&sensor, 0).expect("a good sensor");
    (RangeImage { rows: scan.rows, columns: scan.columns, range_m: scan.range_m }, scan.truth, scan.geometry)
}
