//! A box room, segmented by planes that go on from row to row: the default.
//!
//! Run with `cargo run -p scanseg-core --example plane`.

mod common;

use common::{BEAMS, COLUMNS, scan};
use scanseg_core::{PlaneConfig, PlaneSegmenter, Ranging, buffers};

/// Ranges with a standard deviation of 5 mm.
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.005));

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // on a microcontroller: a `static`
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut segmenter = PlaneSegmenter::new(CONFIG, BEAMS, COLUMNS, buffers.memory())?;
    Ok(scan(&mut segmenter)?)
}
