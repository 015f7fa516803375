//! A sample of the tilt.

/// A turn angle of the scanner and the time when it was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Latch {
    /// Turn angle, radians. Keep it within -pi to pi: a large `f32` has a coarse step, and
    /// segmenters refuse angles beyond 6300.
    pub turn_rad: f32,
    /// Time, microseconds from an arbitrary origin.
    pub time_us: u64,
}
