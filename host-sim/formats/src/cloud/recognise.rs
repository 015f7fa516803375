//! The arrangement of beams, recognised in the points of a cloud.
//!
//! Beams that are arranged as those of a scanner or a camera cost less than free ones, and are known
//! where nothing was measured. A cloud whose points do not lie on such beams keeps beams of its own.

use crate::beside::Beside;
use crate::cloud::angular::{Grid, nodding, spinning};
use crate::cloud::fit::{Arrangement, length, median};
use crate::cloud::pinhole;
use crate::geometry::{Kind, TurnAxis};

/// Returns the arrangement of the beams through points, row by row from the origin; where nothing was
/// measured a point is 0.
pub(crate) fn arrangement(points: &[[f32; 3]], columns: usize) -> Arrangement {
    let camera = pinhole::fit(points, columns);
    let certain = camera.as_ref().filter(|(deviation, _)| deviation.fits() && deviation.root_mean_square() < 0.02);
    if let Some((_, kind)) = certain {
        return Arrangement { kind: kind.clone(), beside: Beside::NONE };
    }
    let mut found = vec![];
    found.extend(camera.map(|(deviation, kind)| (deviation, Arrangement { kind, beside: Beside::NONE })));
    for axis in [TurnAxis::Z, TurnAxis::Y] {
        let Some(grid) = Grid::of(points, columns, axis) else { continue };
        if axis == TurnAxis::Z {
            found.extend(spinning(&grid));
        }
        found.extend(nodding(&grid, axis));
    }
    let best = found.into_iter().filter(|(deviation, _)| deviation.fits());
    let best = best.min_by(|a, b| a.0.root_mean_square().total_cmp(&b.0.root_mean_square()));
    best.map_or_else(|| free(points, columns), |(_, arrangement)| arrangement)
}

/// Where a beam without a return points: a unit vector would say that it is known.
pub(crate) const NOWHERE: [f32; 3] = [0.0; 3];

/// Returns beams through the points.
fn free(points: &[[f32; 3]], columns: usize) -> Arrangement {
    let direction = |point: &[f32; 3]| {
        let range = length(point);
        if range > 0.0 { point.map(|x| (f64::from(x) / range) as f32) } else { NOWHERE }
    };
    let directions: Vec<_> = points.iter().map(direction).collect();
    let kind = Kind::Free { wraps: wraps(points, columns), directions, columns };
    Arrangement { kind, beside: Beside::NONE }
}

/// Whether the last column neighbours the first: most steps across the seam are no longer than three
/// steps within the rows.
fn wraps(points: &[[f32; 3]], columns: usize) -> bool {
    let angle = |a: &[f32; 3], b: &[f32; 3]| {
        let (ra, rb) = (length(a), length(b));
        let dot: f64 = (0..3).map(|i| f64::from(a[i]) * f64::from(b[i])).sum();
        (ra * rb > 0.0).then(|| (dot / (ra * rb)).clamp(-1.0, 1.0).acos())
    };
    let rows = || points.chunks_exact(columns);
    let mut within: Vec<f64> =
        rows().flat_map(|row| row.windows(2).step_by(7).filter_map(|pair| angle(&pair[0], &pair[1]))).collect();
    let mut across: Vec<f64> = rows().filter_map(|row| angle(&row[0], &row[columns - 1])).collect();
    match (median(&mut within), median(&mut across)) {
        (Some(within), Some(across)) => columns > 8 && across <= 3.0 * within,
        _ => false,
    }
}
