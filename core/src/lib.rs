//! Streaming range-image segmentation.
#![no_std]
