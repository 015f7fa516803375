//! The two sets of numbered scenes.

/// How many numbered scenes a set holds.
pub const SCENES: u32 = 25;

/// Which of the two sets of scenes. They share the furniture, but neither layouts nor random
/// numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Set {
    /// For choosing parameters: private offices, shared offices, store rooms.
    Tuning,
    /// For measuring what was chosen: meeting rooms, open-plan offices, libraries.
    Validation,
}
