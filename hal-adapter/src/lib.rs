//! Scanner and tilt-encoder drivers for the range-image segmentation of `scanseg-core`.
#![no_std]
