//! Streets: house fronts to both sides, some set back, pavements above the road, parked cars, trees.

use crate::office::body::{Builder, Place, Surface, Vector, rectangle};
use crate::office::layouts::Laid;
use crate::office::rng::Rng;
use crate::office::room::{X, Y, Z};
use crate::office::set::Set;

/// From the middle of the road to the kerb.
const ROAD_M: f64 = 3.2;
/// From there to the fronts that are not set back.
const PAVEMENT_M: f64 = 2.4;
const KERB_M: f64 = 0.12;
/// The street is seen so far either way.
const REACH_M: f64 = 32.0;
/// Windows and doors are so far behind the front.
const REVEAL_M: f64 = 0.15;

/// Lays out street `number` of a set: it runs along x, and the scanner stands on it.
pub(super) fn lay_out_street(set: Set, number: u32) -> Laid {
    let mut rng = Rng::new([0x7374_7265, u64::from(number), set as u64]);
    let position = [0.0, rng.between(-1.5, 1.5), rng.between(1.2, 1.8)];
    let heading_deg = rng.between(-60.0, 60.0);
    let mut b = Builder::default();
    let along = 2.0 * REACH_M;
    b.body(vec![rectangle(&Place::new(0.0, 0.0, 0.0), [-REACH_M, -ROAD_M, 0.0], X, Y, [along, 2.0 * ROAD_M])]);
    for yaw_deg in [0.0, 180.0] {
        // in terms of a side: x across the street towards it, y along its kerb
        let side = Place::new(0.0, 0.0, 90.0 + yaw_deg);
        b.body(vec![
            rectangle(&side, [ROAD_M, -REACH_M, 0.0], Z, Y, [KERB_M, along]),
            rectangle(&side, [ROAD_M, -REACH_M, KERB_M], X, Y, [2.0 * PAVEMENT_M, along]),
        ]);
        houses(&mut b, &side, &mut rng);
        for ahead in [-1.0, 1.0] {
            if rng.chance(0.6) {
                let along = ahead * rng.between(4.0, 12.0);
                tree(&mut b, &side.then([ROAD_M + 0.6, along, KERB_M], 0.0), &mut rng);
            }
            if rng.chance(0.6) {
                let (along, yaw_deg) = (ahead * rng.between(5.0, 14.0), 90.0 + rng.between(-4.0, 4.0));
                car(&mut b, &side.then([ROAD_M - 1.0, along, 0.0], yaw_deg), &mut rng);
            }
        }
    }
    (b, position, heading_deg)
}

/// A row of houses, with an alley now and then.
fn houses(b: &mut Builder, side: &Place, rng: &mut Rng) {
    let mut y = -REACH_M;
    while y < REACH_M - 5.0 {
        let (width, back) = (rng.between(6.0, 11.0), [0.0, 0.0, 0.4, 1.2][rng.below(4)]);
        let floors = 1 + rng.below(3);
        let front = side.then([ROAD_M + PAVEMENT_M + back, y + width / 2.0, KERB_M], 180.0);
        house(b, &front, [8.0, width, 0.4 + 2.7 * floors as f64], floors, rng);
        y += width + if rng.chance(0.2) { 1.5 } else { 0.0 };
    }
}

/// A house of the given depth, width and height of the eaves, with a window or a door in each 2 m of
/// each floor, and a roof; origin at the foot of the middle of the front, which faces local x.
fn house(b: &mut Builder, place: &Place, [depth, width, eaves_m]: Vector, floors: usize, rng: &mut Rng) {
    let half = width / 2.0;
    let mut front = rectangle(place, [0.0, -half, 0.0], Y, Z, [width, eaves_m]);
    let (bays, wide) = ((width / 2.2) as usize, rng.between(0.9, 1.3));
    let door = rng.below(bays);
    for (floor, bay) in (0..floors).flat_map(|floor| (0..bays).map(move |bay| (floor, bay))) {
        let is_door = (floor, bay) == (0, door);
        let (bottom, height) = if is_door { (0.0, 2.1) } else { (0.9 + 2.7 * floor as f64, 1.4) };
        let middle = (bay as f64 + 0.5) * width / bays as f64 - half;
        if let Surface::Rectangle { holes, .. } = &mut front {
            holes.push([half + middle - wide / 2.0, bottom, half + middle + wide / 2.0, bottom + height]);
        }
        let inner = place.then([-REVEAL_M, middle - wide / 2.0, bottom], 0.0);
        let pane = rectangle(&inner, [0.0; 3], Y, Z, [wide, height]);
        let mut reveal = vec![
            rectangle(&inner, [0.0; 3], Z, X, [height, REVEAL_M]),
            rectangle(&inner, [0.0, wide, 0.0], X, Z, [REVEAL_M, height]),
            rectangle(&inner, [0.0, 0.0, height], Y, X, [wide, REVEAL_M]),
        ];
        if is_door {
            reveal.push(pane);
        } else {
            b.glass(pane);
            reveal.push(rectangle(&inner, [0.0; 3], X, Y, [REVEAL_M, wide]));
        }
        b.body(reveal);
    }
    let pitch_rad = rng.between(30.0, 45.0f64).to_radians();
    let up = [-libm::cos(pitch_rad), 0.0, libm::sin(pitch_rad)];
    b.body(vec![
        front,
        rectangle(place, [-depth, -half, 0.0], X, Z, [depth, eaves_m]),
        rectangle(place, [-depth, half, 0.0], Z, X, [eaves_m, depth]),
        rectangle(place, [0.0, -half, eaves_m], Y, up, [width, 0.5 * depth / -up[0]]),
    ]);
}

/// A tree: a trunk, and a crown of leaves and twigs, each seen in a few pixels; origin at its foot.
fn tree(b: &mut Builder, foot: &Place, rng: &mut Rng) {
    let (bare_m, radius_m) = (rng.between(1.9, 2.6), rng.between(1.0, 1.6));
    b.cylinder(foot, [0.0; 3], rng.between(0.1, 0.2), bare_m + 0.5 * radius_m);
    let mut leaves = vec![];
    while leaves.len() < 400 {
        let mut at = [0.0; 3].map(|_: f64| rng.between(-radius_m, radius_m));
        if at.iter().map(|x| x * x).sum::<f64>() > radius_m * radius_m {
            continue;
        }
        at[2] += bare_m + 0.8 * radius_m;
        let size_m = rng.between(0.06, 0.2);
        let lean_rad = rng.between(-1.5, 1.5);
        let leaf = foot.then(at, rng.between(0.0, 360.0));
        let up = [libm::sin(lean_rad), 0.0, libm::cos(lean_rad)];
        // both sides of it
        leaves.push(rectangle(&leaf, [0.0; 3], Y, up, [size_m, size_m]));
        leaves.push(rectangle(&leaf, [0.0; 3], up, Y, [size_m, size_m]));
    }
    b.body(leaves);
}

/// A parked car: a body and a cabin with leaning windscreens; origin on the road below its middle.
fn car(b: &mut Builder, place: &Place, rng: &mut Rng) {
    let (length, height) = (rng.between(3.8, 4.6), rng.between(0.55, 0.65));
    b.block(place, [0.0, 0.0, 0.25 + height / 2.0], [length, 1.75, height]);
    let (from, lean_deg) = (0.25 + height, rng.between(25.0, 35.0));
    let half = length / 4.0;
    b.block(place, [-0.2, 0.0, from + 0.3], [2.0 * half, 1.5, 0.6]);
    b.leaning_block(place, [half - 0.2, 0.0, from + 0.2], [0.3, 1.5, 0.7], lean_deg);
    b.leaning_block(place, [-half - 0.2, 0.0, from + 0.2], [0.3, 1.5, 0.7], -lean_deg);
}
