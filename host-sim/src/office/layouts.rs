//! The numbered scenes: what kind of room, how large, what stands in it, and where the scanner is.

use crate::office::body::{Builder, Place, Vector};
use crate::office::furniture as f;
use crate::office::rng::Rng;
use crate::office::room::Room;
use crate::office::set::Set;

/// What a layout leaves: bodies, the scanner's position, its heading in degrees.
pub(super) type Laid = (Builder, Vector, f64);

/// Lays out scene `number` of a set. The two sets share the furniture but neither layouts nor
/// random numbers.
pub(super) fn lay_out(set: Set, number: u32) -> Laid {
    let family = match set {
        Set::Tuning => 0x7475_6e65,
        Set::Validation => 0x7661_6c69,
    };
    let mut rng = Rng::new([family, u64::from(number), 0]);
    let (fill, length, width): (fn(&mut Room), _, _) = match (set, number % 3) {
        (Set::Tuning, 0) => (private_office, rng.between(5.0, 6.0), rng.between(4.0, 5.0)),
        (Set::Tuning, 1) => (shared_office, rng.between(6.5, 9.0), rng.between(5.0, 7.0)),
        (Set::Tuning, _) => (store_room, rng.between(5.0, 8.0), rng.between(4.0, 6.0)),
        (Set::Validation, 0) => (meeting_room, rng.between(5.5, 8.0), rng.between(4.5, 6.0)),
        (Set::Validation, 1) => (open_plan, rng.between(7.0, 9.0), rng.between(6.0, 7.0)),
        (Set::Validation, _) => (library, rng.between(5.5, 8.5), rng.between(4.5, 6.5)),
    };
    let height = rng.between(2.45, 3.2);
    let position = [rng.between(0.8, 0.35 * length), rng.between(0.25, 0.75) * width, rng.between(0.5, 1.2)];
    // Along the room, a little towards its middle.
    let heading_deg = rng.between(-30.0, 30.0) + (0.5 - position[1] / width) * 60.0;
    let mut room = Room::new([length, width, height], position, rng);

    // Doors first: they need floor before furniture takes it.
    let door_wall = 1 + room.rng.below(3);
    room.door(door_wall);
    let window_wall = 1 + (door_wall + room.rng.below(2)) % 3;
    let windows = if room.rng.chance(0.3) { 2 } else { 1 };
    (0..windows).for_each(|_| room.window(window_wall));
    fill(&mut room);
    room.shell();
    (room.builder, position, heading_deg)
}

/// Lays out a hall: 30 m long, with columns, and piles, cupboards and desks along its walls.
pub(super) fn lay_out_hall(set: Set, number: u32) -> Laid {
    let mut rng = Rng::new([0x6861_6c6c, u64::from(number), set as u64]);
    let (length, width, height) = (rng.between(28.0, 32.0), rng.between(16.0, 20.0), rng.between(5.0, 7.0));
    let position = [rng.between(2.0, 8.0), rng.between(0.35, 0.65) * width, rng.between(0.8, 1.6)];
    let heading_deg = rng.between(-30.0, 30.0);
    let mut room = Room::new([length, width, height], position, rng);
    (1..4).for_each(|wall| room.door(wall));
    (1..4).for_each(|wall| room.window(wall));
    some(&mut room, 4..=6, |room| column(room, false));
    some(&mut room, 1..=3, |room| column(room, true));
    some(&mut room, 5..=9, |room| box_pile(room, 4));
    some(&mut room, 4..=8, cupboard);
    some(&mut room, 2..=4, desk_at_wall);
    some(&mut room, 1..=2, beam);
    room.shell();
    (room.builder, position, heading_deg)
}

/// A desk with its back at a wall.
fn desk_at_wall(room: &mut Room) {
    let size = [room.rng.between(0.7, 0.8), room.rng.between(1.4, 1.8), room.rng.between(0.68, 0.78)];
    if let Some(place) = room.at_some_wall([size[0] + 0.75, size[1], 0.8]) {
        desk_and_chair(room, &place, size);
    }
}

/// A desk on floor already taken, mostly with a chair drawn up to it.
fn desk_and_chair(room: &mut Room, place: &Place, size: Vector) {
    f::desk(&mut room.builder, place, size, &mut room.rng);
    if room.rng.chance(0.3) {
        return;
    }
    let (x, y) = (size[0] + room.rng.between(0.2, 0.45), room.rng.between(-0.2, 0.2));
    let yaw_deg = 180.0 + room.rng.between(-50.0, 50.0);
    f::chair(&mut room.builder, &place.then([x, y, 0.0], yaw_deg));
}

/// A cupboard at a wall: tall, or low with a box on it.
fn cupboard(room: &mut Room) {
    let low = room.rng.chance(0.5);
    let height = if low { room.rng.between(0.7, 1.2) } else { room.rng.between(1.7, 2.1) };
    let size = [room.rng.between(0.38, 0.6), room.rng.between(0.8, 1.3), height];
    if let Some(place) = room.at_some_wall(size) {
        f::cupboard(&mut room.builder, &place, size);
        if low && room.rng.chance(0.5) {
            let on_top = place.then([size[0] / 2.0, room.rng.between(-0.2, 0.2), height], 90.0);
            f::boxes(&mut room.builder, &on_top, 1, &mut room.rng);
        }
    }
}

/// An open shelf at a wall.
fn shelf(room: &mut Room) {
    let size = [0.32, room.rng.between(0.8, 1.2), room.rng.between(1.3, 1.9)];
    if let Some(place) = room.at_some_wall(size) {
        f::shelf(&mut room.builder, &place, size, &mut room.rng);
    }
}

/// Boxes, one on another, standing at an angle.
fn box_pile(room: &mut Room, most: usize) {
    if let Some(place) = room.in_the_open([0.6, 0.6], 45.0) {
        let count = 1 + room.rng.below(most);
        f::boxes(&mut room.builder, &place, count, &mut room.rng);
    }
}

fn bin(room: &mut Room) {
    if let Some(place) = room.at_some_wall([0.45, 0.4, 0.6]) {
        f::bin(&mut room.builder, &place.then([0.22, 0.0, 0.0], 0.0), &mut room.rng);
    }
}

/// A column from floor to ceiling, round or square.
fn column(room: &mut Room, round: bool) {
    let size = room.rng.between(0.3, 0.5);
    if let Some(place) = room.in_the_open([size, size], 0.0) {
        let height = room.height;
        if round {
            room.builder.cylinder(&place, [0.0; 3], size / 2.0, height);
        } else {
            room.builder.block(&place, [0.0, 0.0, height / 2.0], [size, size, height]);
        }
    }
}

/// A chair standing about.
fn loose_chair(room: &mut Room) {
    if let Some(place) = room.in_the_open([0.7, 0.7], 45.0) {
        f::chair(&mut room.builder, &place);
    }
}

fn board(room: &mut Room) {
    let width = room.rng.between(1.2, 2.0);
    // Hung where nothing tall stands, and nothing will: the floor below it is taken.
    if let Some(place) = room.at_some_wall([0.1, width, 2.1]) {
        f::board(&mut room.builder, &place, width);
    }
}

fn radiator(room: &mut Room) {
    if let Some(place) = room.at_some_wall([0.2, 1.1, 0.75]) {
        f::radiator(&mut room.builder, &place, 1.1);
    }
}

/// A lamp under the ceiling, anywhere in the farther half of the room.
fn lamp(room: &mut Room) {
    let (x, y) = (room.rng.between(0.4, 0.8) * room.length, room.rng.between(0.3, 0.7) * room.width);
    let place = Place::new(x, y, 90.0 * room.rng.below(2) as f64);
    f::lamp(&mut room.builder, &place, room.height, &mut room.rng);
}

/// A beam under the ceiling across the room.
fn beam(room: &mut Room) {
    let (x, drop) = (room.rng.between(0.5, 0.8) * room.length, room.rng.between(0.2, 0.35));
    let centre = [x, room.width / 2.0, room.height - drop / 2.0];
    room.builder.block(&Place::new(0.0, 0.0, 0.0), centre, [0.3, room.width, drop]);
}

/// Calls `piece` as often as `counts` says, lowest to highest.
fn some(room: &mut Room, counts: std::ops::RangeInclusive<usize>, piece: fn(&mut Room)) {
    let count = counts.start() + room.rng.below(counts.end() - counts.start() + 1);
    (0..count).for_each(|_| piece(room));
}

fn private_office(room: &mut Room) {
    some(room, 1..=1, desk_at_wall);
    some(room, 1..=1, cupboard);
    some(room, 0..=1, shelf);
    some(room, 0..=1, bin);
    some(room, 0..=1, |room| box_pile(room, 2));
}

fn shared_office(room: &mut Room) {
    // Two desks face to face in the farther half, a little askew.
    let turn_deg = if room.rng.chance(0.5) { 0.0 } else { 90.0 };
    let (x, y) = (room.rng.between(0.55, 0.7) * room.length, room.rng.between(0.4, 0.6) * room.width);
    let middle = Place::new(x, y, turn_deg);
    if room.claim(&middle, [3.0, 1.7]) {
        for (yaw_deg, height) in [(0.0, 0.71), (180.0, 0.75)] {
            desk_and_chair(room, &middle.then([0.0; 3], yaw_deg).then([0.02, 0.05, 0.0], 0.0), [0.78, 1.6, height]);
        }
    } else {
        desk_at_wall(room);
    }
    some(room, 0..=1, cupboard);
    some(room, 0..=1, board);
    some(room, 0..=1, |room| column(room, true));
    some(room, 0..=1, lamp);
    some(room, 0..=1, bin);
}

fn store_room(room: &mut Room) {
    some(room, 1..=2, cupboard);
    some(room, 0..=1, shelf);
    some(room, 1..=2, |room| box_pile(room, 3));
    some(room, 0..=1, |room| column(room, false));
    some(room, 0..=1, loose_chair);
    some(room, 0..=1, bin);
    some(room, 0..=1, radiator);
}

fn meeting_room(room: &mut Room) {
    let size = [room.rng.between(0.9, 1.2), room.rng.between(1.6, 2.4)];
    if let Some(place) = room.in_the_open([size[0] + 1.0, size[1] + 0.2], 15.0) {
        f::table(&mut room.builder, &place, size);
        for side in [-1.0, 1.0] {
            for y in [-0.3, 0.3] {
                if room.rng.chance(0.45) {
                    let at = [side * (size[0] / 2.0 + room.rng.between(0.15, 0.4)), y * size[1], 0.0];
                    let yaw_deg = 90.0 + side * 90.0 + room.rng.between(-40.0, 40.0);
                    f::chair(&mut room.builder, &place.then(at, yaw_deg));
                }
            }
        }
    }
    some(room, 0..=1, board);
    some(room, 0..=2, cupboard);
    some(room, 0..=1, lamp);
    some(room, 0..=1, bin);
}

fn open_plan(room: &mut Room) {
    // Desks at odd angles, each behind its own screen.
    for _ in 0..1 + room.rng.below(2) {
        if let Some(place) = room.in_the_open([1.9, 1.7], 35.0) {
            let back = place.then([-0.75, 0.0, 0.0], 0.0);
            desk_and_chair(room, &back, [0.78, 1.5, 0.73]);
            if room.rng.chance(0.6) {
                let height = room.rng.between(1.2, 1.6);
                f::partition(&mut room.builder, &back.then([-0.1, 0.0, 0.0], 0.0), 1.6, height);
            }
        }
    }
    some(room, 1..=1, beam);
    some(room, 0..=1, |room| column(room, false));
    some(room, 1..=2, cupboard);
    some(room, 0..=1, |room| column(room, true));
    some(room, 0..=1, |room| box_pile(room, 2));
}

fn library(room: &mut Room) {
    // A shelf standing free, a round table, and a block in a corner that makes the room L-shaped.
    let (depth, width) = (room.rng.between(1.0, 1.8), room.rng.between(1.0, 1.8));
    let left = if room.rng.chance(0.5) { 0.0 } else { room.width - width };
    let corner = Place::new(room.length - depth / 2.0, left + width / 2.0, 0.0);
    if room.claim(&corner, [depth, width]) {
        let height = room.height;
        room.builder.block(&corner, [0.0, 0.0, height / 2.0], [depth, width, height]);
    }
    if let Some(place) = room.in_the_open([0.4, 1.3], 20.0) {
        let size = [0.34, 1.2, room.rng.between(1.3, 1.9)];
        f::shelf(&mut room.builder, &place.then([-0.17, 0.0, 0.0], 0.0), size, &mut room.rng);
    }
    if let Some(place) = room.in_the_open([1.3, 1.3], 0.0) {
        f::round_table(&mut room.builder, &place, 0.55);
    }
    some(room, 0..=1, loose_chair);
    some(room, 0..=1, |room| box_pile(room, 1));
    some(room, 0..=1, lamp);
    some(room, 0..=1, cupboard);
}
