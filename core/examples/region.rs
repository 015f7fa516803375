//! A box room, segmented by regions that grow from the lines of each row.
//!
//! Run with `cargo run -p scanseg-core --example region`.

mod common;

use common::{BEAMS, COLUMNS, scan};
use scanseg_core::{RegionConfig, RegionSegmenter, buffers};

/// The paper's settings.
const CONFIG: RegionConfig = RegionConfig::paper();

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // on a microcontroller: a `static`
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut segmenter = RegionSegmenter::new(CONFIG, BEAMS, COLUMNS, buffers.memory())?;
    Ok(scan(&mut segmenter)?)
}
