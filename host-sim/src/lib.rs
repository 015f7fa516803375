//! Host side of scanseg: range-image files and their geometry, whole scans through the core, the simulated office,
//! evaluation, the paper's experiment, and the pictures that the `scanseg` command writes.
mod approach;
pub mod experiment;
pub mod format;
pub mod hoover;
pub mod office;
pub mod overview;
pub mod picture;
pub mod segmentation;
pub mod timing;
pub mod virtual_rig;
