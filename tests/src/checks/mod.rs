//! What is asserted of a scan of any kind, by properties and by fuzzing, one file for each
//! approach.

pub mod bearings;
pub mod edges;
pub mod planes;
pub mod regions;
