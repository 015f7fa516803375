//! Bearing angles of a whole scan, for pictures and figures.

use scanseg_core::{Ranging, Row, Trace, bearing_row};
use scanseg_formats::{Geometry, RangeImage};

use crate::segmentation::beams::ScanBeams;
use crate::segmentation::error::{SegmentationError, check_size};

/// Returns the bearing angles of a scan along a trace, as [`bearing_row`] gives them; 0 where there
/// is none.
///
/// # Errors
/// As [`crate::segmentation::Segmentation::of`].
pub fn bearing_image(
    scan: &RangeImage,
    geometry: &Geometry,
    ranging: &Ranging,
    trace: Trace,
) -> Result<Vec<u16>, SegmentationError> {
    check_size(scan)?;
    let beams = ScanBeams::new(geometry, scan.rows, scan.columns)?;
    let row = |row: usize| Row {
        ranges_m: &scan.range_m[row * scan.columns..(row + 1) * scan.columns],
        beams: beams.row(row),
        row,
    };
    let mut counts = vec![0; scan.rows * scan.columns];
    for (now, out) in counts.chunks_mut(scan.columns).enumerate() {
        if let Some(before) = now.checked_sub(usize::from(trace.rows)) {
            bearing_row(ranging, beams.beams(), trace, row(now), row(before), out)?;
        }
    }
    Ok(counts)
}
