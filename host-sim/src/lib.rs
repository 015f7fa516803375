//! Host side of scanseg: range-image files and their geometry, the simulated office, evaluation, and the pictures that
//! the `scanseg` command writes.
pub mod format;
pub mod virtual_rig;
