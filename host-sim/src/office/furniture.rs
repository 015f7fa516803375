//! What stands in an office. Each piece has its origin on the floor at the middle of its back,
//! local x to its front, unless said otherwise; lengths are metres.

use crate::office::body::{Builder, Place, Vector};
use crate::office::rng::Rng;

/// Height of table tops.
const TABLE_M: f64 = 0.73;

/// A desk of the given depth, width and height with side and back panels, perhaps a drawer unit, a
/// monitor and papers.
pub(super) fn desk(b: &mut Builder, place: &Place, [depth, width, h]: Vector, rng: &mut Rng) {
    b.block(place, [depth / 2.0, 0.0, h - 0.0125], [depth, width, 0.025]);
    for side in [-1.0, 1.0] {
        let y = side * (width / 2.0 - 0.06);
        b.block(place, [depth / 2.0, y, (h - 0.025) / 2.0], [depth - 0.12, 0.02, h - 0.025]);
    }
    b.block(place, [0.10, 0.0, h - 0.25], [0.02, width - 0.16, 0.4]);
    let side = if rng.chance(0.5) { 1.0 } else { -1.0 };
    if rng.chance(0.4) {
        b.block(place, [depth / 2.0, side * (width / 2.0 - 0.32), 0.33], [depth - 0.22, 0.40, 0.54]);
    }
    if rng.chance(0.85) {
        let y = rng.between(-0.2, 0.2) * width;
        monitor(b, &place.then([rng.between(0.2, 0.3), y, h], rng.between(-20.0, 20.0)), rng);
    }
    if rng.chance(0.2) {
        // A pile of papers or a closed laptop.
        let at = place.then([0.35, -side * (width / 2.0 - 0.25), h], rng.between(-30.0, 30.0));
        b.block(&at, [0.0, 0.0, 0.04], [0.30, 0.22, 0.08]);
    }
}

/// A monitor on its foot; origin at the middle of the foot.
fn monitor(b: &mut Builder, place: &Place, rng: &mut Rng) {
    let width = rng.between(0.48, 0.62);
    b.block(place, [-0.02, 0.0, 0.005], [0.16, 0.20, 0.01]);
    b.block(place, [-0.05, 0.0, 0.11], [0.02, 0.05, 0.20]);
    b.leaning_block(place, [0.0, 0.0, 0.30], [0.03, width, 0.34], rng.between(0.0, 8.0));
}

/// An office chair; origin under the middle of the seat, local x where the sitter looks.
pub(super) fn chair(b: &mut Builder, place: &Place) {
    b.block(place, [0.0, 0.0, 0.45], [0.46, 0.46, 0.05]);
    b.leaning_block(place, [-0.25, 0.0, 0.78], [0.035, 0.42, 0.48], 10.0);
    b.cylinder(place, [0.0, 0.0, 0.03], 0.025, 0.395);
    b.cylinder(place, [0.0; 3], 0.27, 0.03);
}

/// A cupboard.
pub(super) fn cupboard(b: &mut Builder, place: &Place, [depth, width, height]: Vector) {
    b.block(place, [depth / 2.0, 0.0, height / 2.0], [depth, width, height]);
}

/// An open shelf: back, sides, boards, and rows of books on some boards.
pub(super) fn shelf(b: &mut Builder, place: &Place, [depth, width, height]: Vector, rng: &mut Rng) {
    b.block(place, [0.016, 0.0, height / 2.0], [0.012, width - 0.04, height - 0.02]);
    for side in [-1.0, 1.0] {
        b.block(place, [depth / 2.0, side * (width / 2.0 - 0.01), height / 2.0], [depth, 0.02, height]);
    }
    let boards = (height / 0.6) as usize;
    let pitch = (height - 0.10) / boards as f64;
    for i in 0..=boards {
        let z = 0.06 + i as f64 * pitch;
        b.block(place, [depth / 2.0 + 0.005, 0.0, z], [depth - 0.03, width - 0.04, 0.02]);
        if i < boards && rng.chance(0.45) {
            let books = rng.between(0.3, 0.8) * (width - 0.1);
            let free = width - 0.1 - books;
            let size = [rng.between(0.15, 0.22), books, rng.between(0.20, 0.28)];
            let y = rng.between(-0.5, 0.5) * free;
            b.block(place, [0.03 + size[0] / 2.0, y, z + 0.01 + size[2] / 2.0], size);
        }
    }
}

/// Cardboard boxes on one another, each turned a little; origin under the middle.
pub(super) fn boxes(b: &mut Builder, place: &Place, count: usize, rng: &mut Rng) {
    let (mut z, mut shrink) = (0.0, 1.0);
    for _ in 0..count {
        let size = [rng.between(0.30, 0.45), rng.between(0.40, 0.60), rng.between(0.22, 0.40)].map(|s| s * shrink);
        b.block(&place.then([0.0, 0.0, z], rng.between(-25.0, 25.0)), [0.0, 0.0, size[2] / 2.0], size);
        z += size[2];
        shrink *= 0.85;
    }
}

/// A waste bin with a lid; origin under the middle.
pub(super) fn bin(b: &mut Builder, place: &Place, rng: &mut Rng) {
    b.cylinder(place, [0.0; 3], rng.between(0.13, 0.18), rng.between(0.32, 0.60));
}

/// A table with four legs; origin under the middle.
pub(super) fn table(b: &mut Builder, place: &Place, [depth, width]: [f64; 2]) {
    b.block(place, [0.0, 0.0, TABLE_M - 0.02], [depth, width, 0.04]);
    for (x, y) in [(-0.5, -0.5), (-0.5, 0.5), (0.5, -0.5), (0.5, 0.5)] {
        let leg = [x * (depth - 0.2), y * (width - 0.2), (TABLE_M - 0.04) / 2.0];
        b.block(place, leg, [0.06, 0.06, TABLE_M - 0.04]);
    }
}

/// A round table on one leg; origin under the middle.
pub(super) fn round_table(b: &mut Builder, place: &Place, radius: f64) {
    b.cylinder(place, [0.0; 3], 0.28, 0.03);
    b.cylinder(place, [0.0, 0.0, 0.03], 0.05, TABLE_M - 0.07);
    b.cylinder(place, [0.0, 0.0, TABLE_M - 0.04], radius, 0.04);
}

/// A free-standing screen between desks; origin under the middle, local x across it.
pub(super) fn partition(b: &mut Builder, place: &Place, width: f64, height: f64) {
    b.block(place, [0.0, 0.0, (height + 0.04) / 2.0], [0.06, width, height - 0.04]);
    for side in [-1.0, 1.0] {
        b.block(place, [0.0, side * (width / 2.0 - 0.1), 0.02], [0.45, 0.06, 0.04]);
    }
}

/// A board on the wall; origin at the foot of the wall below its middle.
pub(super) fn board(b: &mut Builder, place: &Place, width: f64) {
    b.block(place, [0.015, 0.0, 1.5], [0.03, width, 1.1]);
}

/// A radiator on the wall; origin at the foot of the wall below its middle.
pub(super) fn radiator(b: &mut Builder, place: &Place, width: f64) {
    b.block(place, [0.10, 0.0, 0.42], [0.10, width, 0.55]);
}

/// A lamp under the ceiling, or hung below it; origin on the floor below its middle.
pub(super) fn lamp(b: &mut Builder, place: &Place, ceiling_m: f64, rng: &mut Rng) {
    let drop = if rng.chance(0.5) { 0.0 } else { rng.between(0.3, 0.5) };
    b.block(place, [0.0, 0.0, ceiling_m - drop - 0.025], [0.25, 1.3, 0.05]);
}
