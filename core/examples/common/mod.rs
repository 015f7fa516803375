//! A box room and a scanner that tilts in it, which the examples share.

use std::ops::ControlFlow;

use scanseg_core::{Beams, Columns, LabelRow, PushError, Segment, Segmenter, Sink, TurnAxis};

/// Columns of a row: -75 to 75 deg.
pub const COLUMNS: usize = 151;
const STEP_RAD: f32 = std::f32::consts::PI / 180.0;
const START_RAD: f32 = -75.0 * STEP_RAD;

/// The beams of a scanner that tilts.
pub const BEAMS: Beams<'static> =
    Beams::Nodding { columns: Columns::Even { start_rad: START_RAD, step_rad: STEP_RAD }, axis: TurnAxis::Y };

/// Prints each segment the moment it is complete.
struct Print;

impl Sink for Print {
    fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        if let Some(plane) = segment.plane() {
            let [x, y, z] = plane.normal;
            let (pixels, distance_m) = (segment.pixels(), plane.distance_m);
            println!("{}: {pixels} pixels, normal ({x:.2}, {y:.2}, {z:.2}), {distance_m:.2} m away", segment.label);
        }
        ControlFlow::Continue(())
    }
}

/// Range to the walls, floor and ceiling of a box around the scanner, along the beam at angle `b`
/// of a row at turn angle `t`.
fn room_m(b: f32, t: f32) -> f32 {
    let direction = [b.cos() * t.cos(), b.sin(), b.cos() * t.sin()];
    let (near_m, far_m) = ([3.0, 2.5, 1.0], [4.0, 2.0, 1.5]);
    let walls = direction.iter().zip(near_m.iter().zip(far_m));
    walls.fold(f32::INFINITY, |range_m, (&d, (&near_m, far_m))| {
        let wall_m = if d < 0.0 { -near_m / d } else { far_m / d };
        range_m.min(wall_m)
    })
}

/// Pushes a scan of the room, row by row, as a scanner would deliver it.
pub fn scan(segmenter: &mut impl Segmenter) -> Result<(), PushError> {
    for row in -60..60 {
        let turn_rad = STEP_RAD * row as f32;
        let ranges_m: [f32; COLUMNS] =
            std::array::from_fn(|column| room_m(START_RAD + STEP_RAD * column as f32, turn_rad));
        segmenter.push_row(&ranges_m, turn_rad, &mut Print)?;
    }
    println!("{:?}", segmenter.finish(&mut Print));
    Ok(())
}
