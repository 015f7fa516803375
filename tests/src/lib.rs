//! Slow, obvious models of what scanseg does, for its tests.
pub mod hoover;
