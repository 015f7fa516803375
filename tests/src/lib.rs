//! Slow, obvious models of what scanseg does, for its tests.
pub mod art;
pub mod checks;
pub mod hoover;
pub mod order;
pub mod reference;
pub mod scenes;
pub mod stream;
pub mod walls;

/// Compiles the example of the project's README.
#[cfg(doctest)]
#[doc = include_str!("../../README.md")]
struct Readme;
