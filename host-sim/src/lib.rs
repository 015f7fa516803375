//! Host side of scanseg: range-image files and their geometry, whole scans through the core, the simulated office,
//! evaluation, and the pictures that the `scanseg` command writes.
mod approach;
pub mod format;
pub mod hoover;
pub mod office;
pub mod overview;
pub mod picture;
pub mod segmentation;
pub mod virtual_rig;
