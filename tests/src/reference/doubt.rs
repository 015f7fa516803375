//! How sure the decisions of the reference are, where single precision may decide otherwise.

/// Decisions by a threshold, and how many of them fell so close to it that rounding could turn
/// them.
#[derive(Clone, Copy, Debug, Default)]
pub struct Doubt {
    /// Decisions.
    pub decisions: usize,
    /// Those in doubt.
    pub doubtful: usize,
}

impl Doubt {
    /// Whether `value` is above `threshold`; in doubt where they are nearer than `margin`, or not
    /// numbers.
    pub fn above(&mut self, value: f64, threshold: f64, margin: f64) -> bool {
        self.decisions += 1;
        let sure = (value - threshold).abs() > margin;
        self.doubtful += usize::from(!sure);
        value > threshold
    }
}
