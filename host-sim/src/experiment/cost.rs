//! What a method costs per point as scans of one scene grow.

use std::ops::RangeInclusive;

use crate::experiment::method::METHODS;
use crate::experiment::parallel::in_parallel;
use crate::experiment::scans::scan;
use crate::office::Set;
use crate::timing::Timing;

/// Rows and columns: 10^4 to 2 * 10^6 points, each about twice those before.
const SIZES: [(usize, usize); 8] =
    [(75, 135), (110, 198), (160, 289), (233, 421), (340, 614), (496, 896), (723, 1305), (1053, 1900)];

/// Rounds of which the median is taken: the more, the smaller the scan.
pub const ROUNDS: RangeInclusive<usize> = 5..=101;

/// How often [`costs`] calls its `step_done`.
pub(super) const STEPS: usize = SIZES.len();

/// The time that a method takes for a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Which of [`METHODS`].
    pub method: usize,
    /// Rows of the scan.
    pub rows: usize,
    /// Columns of the scan.
    pub columns: usize,
    /// Nanoseconds per point, on one core, median of so many rounds as [`ROUNDS`] says.
    pub ns_per_point: f64,
}

impl Cost {
    /// Points of the scan.
    pub fn points(&self) -> usize {
        self.rows * self.columns
    }
}

/// Returns the costs of all methods, by method, then size. The noise falls with the distance of the
/// points, of which it is 3 % at 4 m, so that scans of every size show about the same number of
/// segments.
pub(super) fn costs(set: Set, step_done: impl Fn()) -> Vec<Cost> {
    let scans = in_parallel(SIZES.len(), |i| {
        let range_noise_m = range_noise_m(SIZES[i]);
        let (scan, _, geometry) = scan(set, 0, SIZES[i], range_noise_m);
        (scan, geometry, range_noise_m as f32)
    });
    let mut costs = vec![];
    for (scan, geometry, range_noise_m) in &scans {
        for (i, method) in METHODS.iter().enumerate() {
            let config = (method.config)(*range_noise_m);
            let rounds = (4_000_000 / scan.range_m.len()).clamp(*ROUNDS.start(), *ROUNDS.end());
            let timing = Timing::of(scan, geometry, config, None, rounds);
            let ns_per_point = timing.expect("a simulated scan fits").median_ns();
            costs.push(Cost { method: i, rows: scan.rows, columns: scan.columns, ns_per_point });
        }
        step_done();
    }
    costs.sort_by_key(|cost| (cost.method, cost.points()));
    costs
}

fn range_noise_m((rows, columns): (usize, usize)) -> f64 {
    let step_deg = (100.0 / rows as f64).min(180.0 / columns as f64);
    0.03 * 4.0 * step_deg.to_radians()
}
