//! The turn angle of a row and its continuation.

use super::limits::TiltLimits;
use crate::pairing::shorter_way;

/// Turn angle and direction of the tilt at a time.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub turn_rad: f32,
    pub rising: bool,
    pub start_us: u64,
}

impl Place {
    /// Returns the angle turned since `before`, radians; `None` if both cannot belong to one sweep.
    pub fn since(&self, before: &Place, limits: &TiltLimits) -> Option<f32> {
        let moved_rad = shorter_way(self.turn_rad - before.turn_rad);
        let moved_rad = if self.rising { moved_rad } else { -moved_rad };
        let time_us = u32::try_from(self.start_us.checked_sub(before.start_us)?).ok()?;
        let time_s = 1e-6 * time_us as f32;
        let [least_rad, most_rad] = [limits.min_rate_rad_per_s, limits.max_rate_rad_per_s].map(|rate| rate * time_s);
        let goes_on = self.rising == before.rising && time_us <= limits.pause_us;
        (goes_on && (least_rad..=most_rad).contains(&moved_rad)).then_some(moved_rad)
    }
}
