//! Host side of scanseg: whole scans through the core, the simulated office, evaluation, the
//! paper's experiment, and the pictures that the `scanseg` command writes.
//!
//! Modules use each other in one direction: the `scanseg` command, [`experiment`], [`overview`],
//! [`view`], [`export`] and [`picture`], [`segmentation`], [`parallel`]. Files are read and written by [`scanseg_formats`]; the simulated
//! scanner is `scanseg_virtual_rig`.

pub mod experiment;
pub mod export;
pub mod hoover;
pub mod office;
pub mod overview;
pub mod parallel;
pub mod picture;
pub mod segmentation;
pub mod timing;
pub mod view;
