//! A box room, segmented by the edges in its bearing-angle images.
//!
//! Run with `cargo run -p scanseg-core --example edge`.

mod common;

use common::{BEAMS, COLUMNS, scan};
use scanseg_core::{EdgeConfig, EdgeSegmenter, buffers};

/// The paper's settings.
const CONFIG: EdgeConfig = EdgeConfig::paper();

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // on a microcontroller: a `static`
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let mut segmenter = EdgeSegmenter::new(CONFIG, BEAMS, COLUMNS, buffers.memory())?;
    Ok(scan(&mut segmenter)?)
}
