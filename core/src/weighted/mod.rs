//! Planes in single precision, from weighted sums of the beams: how the default finds and keeps them.

pub(crate) mod fitted;
pub(crate) mod plane;
pub(crate) mod rings;
pub(crate) mod sums;

pub use fitted::Fitted;
