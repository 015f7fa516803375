//! Attics: roofs that slope to both sides, and a stage at the far end with stairs up to it.

use crate::office::body::{Builder, Place, Surface, Vector, rectangle};
use crate::office::furniture as f;
use crate::office::layouts::Laid;
use crate::office::rng::Rng;
use crate::office::room::{Room, X, Y, Z};
use crate::office::set::Set;

/// Lays out attic `number` of a set.
pub(super) fn lay_out_attic(set: Set, number: u32) -> Laid {
    let mut rng = Rng::new([0x6174_7469, u64::from(number), set as u64]);
    let (length, width) = (rng.between(5.5, 7.5), rng.between(4.8, 6.0));
    let (knee_m, slope_deg) = (rng.between(0.7, 1.1), rng.between(36.0, 48.0));
    let ridge_m = knee_m + libm::tan(f64::to_radians(slope_deg)) * width / 2.0;
    let position = [rng.between(0.8, 0.35 * length), rng.between(0.4, 0.6) * width, rng.between(1.2, 1.6)];
    let heading_deg = rng.between(-25.0, 25.0);
    let mut room = Room::new([length, width, ridge_m], position, rng);
    stage(&mut room);
    for _ in 0..1 + room.rng.below(3) {
        if let Some(place) = room.in_the_open([0.6, 0.6], 45.0) {
            f::boxes(&mut room.builder, &place, 2, &mut room.rng);
        }
    }
    if room.rng.chance(0.6)
        && let Some(place) = room.in_the_open([0.45, 1.2], 10.0)
    {
        f::cupboard(&mut room.builder, &place.then([-0.2, 0.0, 0.0], 0.0), [0.4, 1.1, 0.9]);
    }
    let chimney = Place::new(room.rng.between(0.35, 0.6) * length, room.rng.between(0.35, 0.65) * width, 0.0);
    if room.claim(&chimney, [0.5, 0.5]) {
        room.builder.block(&chimney, [0.0, 0.0, ridge_m / 2.0], [0.5, 0.5, ridge_m]);
    }
    roofs(&mut room, knee_m, slope_deg);
    (room.builder, position, heading_deg)
}

/// A stage over the whole width of the far end, and a flight of stairs up to it.
fn stage(room: &mut Room) {
    let (length, width) = (room.length, room.width);
    let steps = 4 + room.rng.below(3);
    let [tread_m, rise_m] = [room.rng.between(0.24, 0.3), room.rng.between(0.17, 0.2)];
    let (wide_m, depth_m) = (room.rng.between(0.9, 1.3), room.rng.between(1.4, 2.0));
    let top_m = steps as f64 * rise_m;
    let middle = Place::new(length - depth_m / 2.0, width / 2.0, 0.0);
    room.claim(&middle, [depth_m, width]);
    room.builder.block(&middle, [0.0, 0.0, top_m / 2.0], [depth_m, width, top_m]);
    let run_m = (steps - 1) as f64 * tread_m;
    let across = room.rng.between(0.25, 0.75) * width;
    let foot = Place::new(length - depth_m - run_m, across, 0.0);
    room.claim(&foot.then([run_m / 2.0, 0.0, 0.0], 0.0), [run_m, wide_m]);
    stairs(&mut room.builder, &foot, steps - 1, [tread_m, wide_m, rise_m]);
}

/// Stairs up along local x, from the middle of their foot. Each tread and each riser is a surface,
/// and so is each side.
fn stairs(b: &mut Builder, foot: &Place, steps: usize, [tread_m, wide_m, rise_m]: Vector) {
    let half = wide_m / 2.0;
    let (run_m, top_m) = (steps as f64 * tread_m, steps as f64 * rise_m);
    let mut surfaces = vec![];
    for step in 0..steps {
        let (x, z) = (step as f64 * tread_m, step as f64 * rise_m);
        surfaces.push(rectangle(foot, [x, -half, z], Z, Y, [rise_m, wide_m]));
        surfaces.push(rectangle(foot, [x, -half, z + rise_m], X, Y, [tread_m, wide_m]));
    }
    // what is above the steps is cut out of the sides: (z, x) and (x, z)
    let mut right = rectangle(foot, [0.0, -half, 0.0], X, Z, [run_m, top_m]);
    let mut left = rectangle(foot, [0.0, half, 0.0], Z, X, [top_m, run_m]);
    for step in 0..steps {
        let (from, to, above) = (step as f64 * tread_m, (step + 1) as f64 * tread_m, (step + 1) as f64 * rise_m);
        cut_out(&mut right, [from, above, to, top_m]);
        cut_out(&mut left, [above, from, top_m, to]);
    }
    surfaces.extend([right, left]);
    b.body(surfaces);
}

/// Opens a rectangle, which beams go through.
fn cut_out(surface: &mut Surface, hole: [f64; 4]) {
    if let Surface::Rectangle { holes, .. } = surface {
        holes.push(hole);
    }
}

/// Floor, gables, low walls to both sides and the roof on them, with a beam along it and perhaps a
/// window.
fn roofs(room: &mut Room, knee_m: f64, slope_deg: f64) {
    let (l, w, h) = (room.length, room.width, room.height);
    let (sin, cos) = (libm::sin(slope_deg.to_radians()), libm::cos(slope_deg.to_radians()));
    let slope_m = w / 2.0 / cos;
    let here = Place::new(0.0, 0.0, 0.0);
    let b = &mut room.builder;
    b.body(vec![rectangle(&here, [0.0; 3], X, Y, [l, w])]);
    // gables are seen below the roof only
    b.body(vec![rectangle(&here, [0.0; 3], Y, Z, [w, h])]);
    b.body(vec![rectangle(&here, [l, 0.0, 0.0], Z, Y, [h, w])]);
    for (side, place) in [here, Place::new(l, w, 180.0)].into_iter().enumerate() {
        b.body(vec![rectangle(&place, [0.0; 3], Z, X, [knee_m, l])]);
        let up = [0.0, cos, sin];
        let mut roof = rectangle(&place, [0.0, 0.0, knee_m], up, X, [slope_m, l]);
        if side == 0 || room.rng.chance(0.5) {
            let [low, wide] = [room.rng.between(0.3, 0.45) * slope_m, room.rng.between(0.7, 1.2)];
            let from = room.rng.between(0.35, 0.7) * (l - wide);
            let window = [low, from, low + 1.1, from + wide];
            cut_out(&mut roof, window);
            let corner = [from, low * cos - 0.05 * sin, knee_m + low * sin + 0.05 * cos];
            b.glass(rectangle(&place, corner, up, X, [1.1, wide]));
        }
        b.body(vec![roof]);
        let at = room.rng.between(0.55, 0.7) * slope_m;
        let centre = [l / 2.0, at * cos + 0.1, knee_m + at * sin - 0.12];
        b.block(&place, centre, [l, 0.12, 0.2]);
    }
}
