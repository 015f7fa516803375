//! Angles of rows and columns.

use crate::geometry_error::GeometryError;
use crate::limits::{ANGLE_DEG, STEP_DEG};

/// Angles of the rows or of the columns of a range image, in degrees.
#[derive(Clone, Debug, PartialEq)]
pub enum Angles {
    /// Index `i` is at `start_deg + i * step_deg`.
    Even {
        /// Angle of index 0.
        start_deg: f64,
        /// Angle from one index to the next; not zero.
        step_deg: f64,
    },
    /// One angle per index.
    Listed(Vec<f64>),
}

impl Angles {
    /// Returns the angle of index `i` in degrees. `i` must lie within a list.
    pub fn at(&self, i: usize) -> f64 {
        match self {
            Angles::Even { start_deg, step_deg } => start_deg + i as f64 * step_deg,
            Angles::Listed(list) => list[i],
        }
    }

    /// Returns what breaks a rule: of a list its first entry that does.
    pub(crate) fn check(&self, key: &str) -> Vec<GeometryError> {
        match self {
            Angles::Even { start_deg, step_deg } => {
                let start = ANGLE_DEG.check(&format!("{key}.start"), *start_deg);
                let step = STEP_DEG.check(&format!("{key}.step"), *step_deg);
                [start, step].into_iter().filter_map(Result::err).collect()
            }
            Angles::Listed(list) if list.is_empty() => vec![GeometryError::value(key, "[]", "one angle or more")],
            Angles::Listed(list) => {
                let mut entries = (0..).zip(list).map(|(i, deg)| ANGLE_DEG.check(&format!("{key}[{i}]"), *deg));
                entries.find_map(Result::err).into_iter().collect()
            }
        }
    }
}
