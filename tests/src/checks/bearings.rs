//! Bearing angles of the core against the reference.

use crate::reference::beams::angle_between;
use crate::reference::bearing::bearing_counts;
use crate::stream::{Scan, reference_trace};
use scanseg_core::{MAX_ERROR_RAD, Ranging, Trace};
use std::f64::consts::PI;

/// The core has its coarse arc tangent.
pub const MICROMATH: bool = cfg!(feature = "micromath");

/// Beams nearer than this, 0.05 deg, may be off by more than one count.
pub const NEAR_RAD: f64 = 8.7e-4;

/// Asserts that every bearing angle along a trace is off by no more than rounding explains, for
/// ranges from 0.05 m to 100 m. `each` is told how far apart the two beams are, radians, the count,
/// and by how much it is off.
///
/// Two beams may be an error of f32 nearer or farther apart than they should. Near the axis of a
/// nodding scanner two rows `turn` apart have Phi = turn cos p; cos p comes from the addition
/// theorem in f32 and errs by 1e-7, a rounding or two of numbers up to 1, which relative to Phi is
/// 1e-7 turn / Phi. The bearing angle moves by half of that at most: d BA = sin BA cos BA d(sin
/// Phi) / sin Phi. At 0.05 deg and more that is less than half a count.
pub fn assert_same(scan: &Scan, ranging: &Ranging, trace: Trace, mut each: impl FnMut(f64, u16, f64)) {
    let (beams, size) = (scan.reference_beams(), scan.size());
    let found = scan.counts(ranging, trace);
    let expected = bearing_counts(&scan.image(ranging), &beams, reference_trace(trace));
    for (pixel, (found, expected)) in size.pixels().zip(found.into_iter().zip(expected)) {
        let previous = reference_trace(trace).previous(size, pixel);
        let phi = previous.map(|at| angle_between(beams.direction(pixel), beams.direction(at)));
        let Some(phi) = phi else {
            assert_eq!((found, expected), (0, 0), "{:?}, {trace:?}, {pixel:?}", scan.rig);
            continue;
        };
        if (phi / 1e-5 - 1.0).abs() < 0.1 {
            continue;
        }
        let off = f64::from(found) - f64::from(expected);
        let turn = scan.turn_rad[pixel.0] - scan.turn_rad[pixel.0 - usize::from(trace.rows)];
        let is_near = off.abs() <= allowed(phi, turn.abs().into());
        assert!(
            (found == 0) == (expected == 0) && is_near,
            "{:?}, {trace:?}, {pixel:?}, {phi} rad apart: {found} {expected}",
            scan.rig
        );
        each(phi, found, off);
    }
}

/// Largest error in counts for beams `phi` rad apart, of rows `turn` rad apart.
fn allowed(phi: f64, turn: f64) -> f64 {
    if MICROMATH {
        // both are rounded to counts
        return (f64::from(MAX_ERROR_RAD) * 65535.0 / PI).ceil() + 1.0;
    }
    let near = if phi < NEAR_RAD && turn > 0.0 { 0.5 * 1e-7 * turn / phi } else { 0.0 };
    1.0 + (near * 65535.0 / PI).ceil()
}
