//! What the numbers of a geometry file may be. Where the core has a limit it is the same one.

use crate::geometry_error::GeometryError;

/// What a number may be.
pub(crate) struct Limits {
    /// In words, for messages.
    pub text: &'static str,
    holds: fn(f64) -> bool,
}

impl Limits {
    /// Checks the number of a key.
    pub fn check(&self, key: &str, x: f64) -> Result<(), GeometryError> {
        if (self.holds)(x) { Ok(()) } else { Err(GeometryError::value(key, format!("{x:?}"), self.text)) }
    }
}

pub(crate) const UNIT_M: Limits =
    Limits { text: "a number above 0, up to 1000 (metres of one count)", holds: |x| x > 0.0 && x <= 1000.0 };
pub(crate) const MIN_RANGE_M: Limits =
    Limits { text: "a number from 0 to 500 (metres)", holds: |x| (0.0..=500.0).contains(&x) };
pub(crate) const MAX_RANGE_M: Limits = Limits {
    text: "a number above 0 and above `min_range_m` (metres; beyond 500 nothing is used)",
    holds: |x| x > 0.0 && x.is_finite(),
};
pub(crate) const ERROR_M: Limits =
    Limits { text: "a number from 0 to 10 (metres)", holds: |x| (0.0..=10.0).contains(&x) };
pub(crate) const ERROR_PER_M: Limits =
    Limits { text: "a number from 0 to 1 (metres per metre)", holds: |x| (0.0..=1.0).contains(&x) };
pub(crate) const ERROR_PER_M2: Limits =
    Limits { text: "a number from 0 to 1 (metres per square metre)", holds: |x| (0.0..=1.0).contains(&x) };
pub(crate) const CORRELATION_PX: Limits =
    Limits { text: "a number from 1 to 100 (pixels)", holds: |x| (1.0..=100.0).contains(&x) };
pub(crate) const ERROR_DEG: Limits =
    Limits { text: "a number from 0 to 5.7 (degrees)", holds: |x| (0.0..=5.7).contains(&x) };
pub(crate) const ANGLE_DEG: Limits =
    Limits { text: "a number from -36000 to 36000 (degrees)", holds: |x| (-36e3..=36e3).contains(&x) };
pub(crate) const STEP_DEG: Limits =
    Limits { text: "a number from -90 to 90 and not 0 (degrees)", holds: |x| x != 0.0 && (-90.0..=90.0).contains(&x) };
pub(crate) const LEVER_ARM_M: Limits =
    Limits { text: "a number from -10 to 10 (metres)", holds: |x| (-10.0..=10.0).contains(&x) };
pub(crate) const FOCAL_PX: Limits = Limits {
    text: "a number from 0.1 to 1000000, or from -1000000 to -0.1 (pixels)",
    holds: |x| (0.1..=1e6).contains(&x.abs()),
};
pub(crate) const CENTRE_PX: Limits =
    Limits { text: "a number from -1000000 to 1000000 (pixels)", holds: |x| (-1e6..=1e6).contains(&x) };
