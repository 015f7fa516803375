//! Files: range images, their geometry, label images.
pub mod geometry;
