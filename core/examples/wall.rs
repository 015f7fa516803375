//! A wall, row by row: the example of the README.
//!
//! Run with `cargo run -p scanseg-core --example wall`.

use core::ops::ControlFlow;
use scanseg_core::{
    Beams, Columns, LabelRow, PlaneConfig, PlaneSegmenter, Ranging, Segment, Segmenter, Sink, TurnAxis, buffers,
};

struct Planes;

impl Sink for Planes {
    fn row(&mut self, _labels: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(()) // the labels of a row, if you want them
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if let Some(plane) = segment.plane() {
            println!("{} pixels, {:.3} m away, normal {:.3?}", segment.pixels(), plane.distance_m, plane.normal);
        }
        ControlFlow::Continue(())
    }
}

const COLUMNS: usize = 181;
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01)); // standard deviation of a range: 1 cm

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // a line scanner that nods: half a degree from beam to beam, one degree from row to row
    let (start_rad, step_rad) = (-45_f32.to_radians(), 0.5_f32.to_radians());
    let beams = Beams::Nodding { columns: Columns::Even { start_rad, step_rad }, axis: TurnAxis::Y };
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY; // all the memory; a static on a microcontroller
    let mut segmenter = PlaneSegmenter::new(CONFIG, beams, COLUMNS, buffers.memory())?;
    for row in 0..60 {
        let turn_rad = (row as f32 - 30.0).to_radians();
        // metres, from a scanner; here a wall 2 m ahead
        let ranges_m: [f32; COLUMNS] =
            core::array::from_fn(|column| 2.0 / ((start_rad + step_rad * column as f32).cos() * turn_rad.cos()));
        segmenter.push_row(&ranges_m, turn_rad, &mut Planes)?;
    }
    segmenter.finish(&mut Planes); // 10860 pixels, 2.000 m away, normal [-1.000, ...]
    Ok(())
}
