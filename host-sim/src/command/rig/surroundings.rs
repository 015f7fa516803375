//! What the virtual scanner looks at: a simulated office, or a recorded range image.

use scanseg_formats::{Angles, Kind, RangeImage};
use scanseg_sim::office::{Scene, Set};

use crate::command::input::Input;
use crate::command::output::Failure;

/// Range by bearing from the right edge, degrees, and turn angle, radians; 0 without a return.
pub type Ranges = Box<dyn FnMut(f64, f64) -> f64>;

/// Returns the ranges of a simulated office.
pub fn office(number: u32) -> Ranges {
    let scene = Scene::numbered(Set::Tuning, number);
    Box::new(move |bearing_deg, turn_rad| {
        let (bearing, turn) = ((bearing_deg - 90.0).to_radians(), turn_rad);
        let direction = [bearing.cos() * turn.cos(), bearing.sin(), bearing.cos() * turn.sin()];
        scene.cast(direction).map_or(0.0, |(range_m, _)| range_m)
    })
}

/// Returns the ranges of the nearest pixels of a range image.
pub fn recorded(input: Input) -> Result<Ranges, Failure> {
    let RangeImage { rows, columns, range_m } = input.ranges;
    let Kind::Nodding { beam_deg, turn_deg, .. } = input.geometry.kind else {
        return Err(format!("{}: not of a nodding scanner", input.name).into());
    };
    let list = |angles: &Angles, count| (0..count).map(|i| angles.at(i)).collect::<Vec<_>>();
    let (beams_deg, turns_deg) = (list(&beam_deg, columns), list(&turn_deg, rows));
    let nearest = |list: &[f64], deg: f64| {
        let off = |i: &usize| (list[*i] - deg).abs();
        (0..list.len()).min_by(|a, b| off(a).total_cmp(&off(b))).filter(|i| off(i) < 1.0)
    };
    Ok(Box::new(move |bearing_deg, turn_rad| {
        let pixel = nearest(&turns_deg, turn_rad.to_degrees()).zip(nearest(&beams_deg, bearing_deg - 90.0));
        pixel.map_or(0.0, |(row, column)| f64::from(range_m[row * columns + column]))
    }))
}
