//! The room itself, and finding free spots in it.

use crate::office::body::{Builder, Place, Surface, Vector, rectangle};
use crate::office::rng::Rng;

pub(super) const X: Vector = [1.0, 0.0, 0.0];
pub(super) const Y: Vector = [0.0, 1.0, 0.0];
pub(super) const Z: Vector = [0.0, 0.0, 1.0];

/// Walls are this thick: the depth of window and door reveals.
const WALL_M: f64 = 0.11;

/// An opening in a wall, in the wall's terms: middle, width, bottom and top.
#[derive(Clone, Copy, Debug)]
struct Opening {
    middle: f64,
    width: f64,
    bottom: f64,
    top: f64,
}

/// A room under construction: x in 0..length, y in 0..width, the floor at z = 0. The scanner's own
/// spot is taken.
///
/// Walls count 0 to 3: at x = 0, at y = 0, at x = length, at y = width. In a wall's terms x points
/// into the room and y runs along it from its middle.
#[derive(Clone, Debug)]
pub(super) struct Room {
    pub length: f64,
    pub width: f64,
    pub height: f64,
    pub builder: Builder,
    pub rng: Rng,
    scanner: Vector,
    /// Floor taken: lowest x, lowest y, highest x, highest y.
    taken: Vec<[f64; 4]>,
    openings: [Vec<Opening>; 4],
}

impl Room {
    pub fn new([length, width, height]: Vector, scanner: Vector, rng: Rng) -> Self {
        let taken = vec![[scanner[0] - 0.6, scanner[1] - 0.6, scanner[0] + 0.6, scanner[1] + 0.6]];
        Self { length, width, height, builder: Builder::default(), rng, scanner, taken, openings: Default::default() }
    }

    /// Returns the place of a wall and how long it is.
    fn wall(&self, wall: usize) -> (Place, f64) {
        let (l, w) = (self.length, self.width);
        match wall {
            0 => (Place::new(0.0, w / 2.0, 0.0), w),
            1 => (Place::new(l / 2.0, 0.0, 90.0), l),
            2 => (Place::new(l, w / 2.0, 180.0), w),
            _ => (Place::new(l / 2.0, w, 270.0), l),
        }
    }

    /// Takes the floor under a rectangle in the terms of `place` (back, right, front, left); false
    /// where that is not free or outside the room. Beside walls the rectangle's axes are the
    /// room's; otherwise a box around it counts.
    fn take(&mut self, place: &Place, [x0, y0, x1, y1]: [f64; 4]) -> bool {
        let corners = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]].map(|[x, y]| place.point([x, y, 0.0]));
        let of = |i: usize, pick: fn(f64, f64) -> f64| corners.iter().map(|c| c[i]).reduce(pick).unwrap_or(0.0);
        let area = [of(0, f64::min), of(1, f64::min), of(0, f64::max), of(1, f64::max)];
        let inside = area[0] > -0.01 && area[1] > -0.01 && area[2] < self.length + 0.01 && area[3] < self.width + 0.01;
        let gap = 0.04;
        let clear =
            |t: &[f64; 4]| area[0] > t[2] + gap || area[2] < t[0] - gap || area[1] > t[3] + gap || area[3] < t[1] - gap;
        let free = inside && self.taken.iter().all(clear);
        if free {
            self.taken.push(area);
        }
        free
    }

    /// Returns a free spot with its back at a wall, for something of this depth and width; what is
    /// taller than a window's sill does not stand before the window.
    pub fn at_wall(&mut self, wall: usize, [depth, width, height]: Vector) -> Option<Place> {
        let (place, length) = self.wall(wall);
        for _ in 0..16 {
            let y = self.rng.between(-0.5, 0.5) * (length - width);
            let beside = |o: &Opening| (o.middle - y).abs() > (o.width + width) / 2.0 + 0.1 || o.bottom > height;
            let spot = place.then([0.0, y, 0.0], 0.0);
            if self.openings[wall].iter().all(beside) && self.take(&spot, [0.0, -width / 2.0, depth, width / 2.0]) {
                return Some(spot);
            }
        }
        None
    }

    /// Returns a free spot at one of the walls in view, or else at the wall behind the scanner.
    pub fn at_some_wall(&mut self, size: Vector) -> Option<Place> {
        let first = self.rng.below(3);
        (0..3).find_map(|i| self.at_wall(1 + (first + i) % 3, size)).or_else(|| self.at_wall(0, size))
    }

    /// Returns a free spot away from the walls and from the scanner, turned up to `turn_deg` either
    /// way from one of the room's four directions.
    pub fn in_the_open(&mut self, [depth, width]: [f64; 2], turn_deg: f64) -> Option<Place> {
        for _ in 0..24 {
            let (x, y) = (self.rng.between(0.5, self.length - 0.5), self.rng.between(0.5, self.width - 0.5));
            let yaw = 90.0 * self.rng.below(4) as f64 + self.rng.between(-turn_deg, turn_deg);
            let spot = Place::new(x, y, yaw);
            let (dx, dy) = (x - self.scanner[0], y - self.scanner[1]);
            if dx * dx + dy * dy > 1.5 * 1.5 && self.take(&spot, [-depth / 2.0, -width / 2.0, depth / 2.0, width / 2.0])
            {
                return Some(spot);
            }
        }
        None
    }

    /// Takes the floor around the middle of something of this depth and width; false where it is
    /// not free.
    pub fn claim(&mut self, place: &Place, [depth, width]: [f64; 2]) -> bool {
        self.take(place, [-depth / 2.0, -width / 2.0, depth / 2.0, width / 2.0])
    }

    /// A door with its frame in a wall, shut or ajar; one that stands ajar shows a corridor.
    pub fn door(&mut self, wall: usize) {
        let (place, length) = self.wall(wall);
        let width = 0.92;
        let middle = self.rng.between(-0.5, 0.5) * (length - width - 0.8);
        let door = place.then([0.0, middle, 0.0], 0.0);
        if !self.take(&door, [0.0, -width / 2.0 - 0.08, width, width / 2.0 + 0.08]) {
            return;
        }
        let (half, top) = (width / 2.0, 2.04);
        self.openings[wall].push(Opening { middle, width, bottom: 0.0, top });
        let b = &mut self.builder;
        frame(b, &door, half, top);
        if self.rng.chance(0.5) {
            b.block(&door, [-0.05, 0.0, top / 2.0], [0.04, width, top]);
            b.block(&door, [0.01, half - 0.1, 1.05], [0.05, 0.14, 0.02]);
            return;
        }
        let ajar = door.then([0.0, half, 0.0], self.rng.between(20.0, 95.0));
        b.block(&ajar, [0.0, -half + 0.01, top / 2.0 + 0.01], [0.04, width - 0.04, top - 0.02]);
        let (depth, ceiling) = (1.9, 2.4);
        let far = -WALL_M - depth;
        let left = length / 2.0 - middle;
        let ends = (left - length, left);
        b.body(vec![
            rectangle(&door, [far, ends.0, 0.0], Y, Z, [length, ceiling]),
            rectangle(&door, [far, ends.0, ceiling], Y, X, [length, depth]),
            rectangle(&door, [far, ends.0, 0.0], Z, X, [ceiling, depth]),
            rectangle(&door, [far, ends.1, 0.0], X, Z, [depth, ceiling]),
        ]);
    }

    /// A window in a wall; beams are lost in the glass.
    pub fn window(&mut self, wall: usize) {
        let (place, length) = self.wall(wall);
        let width = self.rng.between(1.1, 2.2);
        let middle = self.rng.between(-0.5, 0.5) * (length - width - 0.6);
        let (bottom, top) = (self.rng.between(0.85, 1.05), self.height - self.rng.between(0.25, 0.5));
        if self.openings[wall].iter().any(|o| (o.middle - middle).abs() < (o.width + width) / 2.0 + 0.3) {
            return;
        }
        self.openings[wall].push(Opening { middle, width, bottom, top });
        let window = place.then([0.0, middle, bottom], 0.0);
        let (half, height, pane) = (width / 2.0, top - bottom, -0.03);
        let b = &mut self.builder;
        b.glass(rectangle(&window, [pane, -half, 0.0], Y, Z, [width, height]));
        if width > 1.6 {
            b.block(&window, [pane, 0.0, height / 2.0], [0.04, 0.07, height]);
        }
    }

    /// Floor, ceiling and the walls with their openings. Comes last, when all openings are known.
    pub fn shell(&mut self) {
        let (l, w, h) = (self.length, self.width, self.height);
        let room = Place::new(0.0, 0.0, 0.0);
        let b = &mut self.builder;
        // The floor runs on into corridors as one surface; outside windows nobody sees it.
        b.body(vec![rectangle(&room, [-3.0, -3.0, 0.0], X, Y, [l + 6.0, w + 6.0])]);
        b.body(vec![rectangle(&room, [0.0, 0.0, h], Y, X, [w, l])]);
        for wall in 0..4 {
            let (place, length) = self.wall(wall);
            let b = &mut self.builder;
            let mut surface = rectangle(&place, [0.0, -length / 2.0, 0.0], Y, Z, [length, h]);
            if let Surface::Rectangle { holes, .. } = &mut surface {
                holes.extend(self.openings[wall].iter().map(|o| {
                    let from = length / 2.0 + o.middle - o.width / 2.0;
                    [from, o.bottom, from + o.width, o.top]
                }));
            }
            b.body(vec![surface]);
            for o in &self.openings[wall] {
                let at = place.then([-WALL_M, o.middle, o.bottom], 0.0);
                let (half, height) = (o.width / 2.0, o.top - o.bottom);
                let mut reveal = vec![
                    rectangle(&at, [0.0, -half, 0.0], Z, X, [height, WALL_M]),
                    rectangle(&at, [0.0, half, 0.0], X, Z, [WALL_M, height]),
                    rectangle(&at, [0.0, -half, height], Y, X, [o.width, WALL_M]),
                ];
                if o.bottom > 0.0 {
                    reveal.push(rectangle(&at, [0.0, -half, 0.0], X, Y, [WALL_M, o.width]));
                }
                b.body(reveal);
            }
        }
    }
}

/// A door frame around an opening of this half width and height: it stands 2 cm out of the wall and
/// narrows the opening by 2 cm. Its front is one face.
fn frame(b: &mut Builder, door: &Place, half: f64, top: f64) {
    let (thick, out, outer_top, inner, inner_top) = (0.02, half + 0.06, top + 0.06, half - 0.02, top - 0.02);
    let mut front = rectangle(door, [thick, -out, 0.0], Y, Z, [2.0 * out, outer_top]);
    if let Surface::Rectangle { holes, .. } = &mut front {
        holes.push([out - inner, -1.0, out + inner, inner_top]);
    }
    b.body(vec![
        front,
        rectangle(door, [0.0, -out, 0.0], X, Z, [thick, outer_top]),
        rectangle(door, [0.0, out, 0.0], Z, X, [outer_top, thick]),
        rectangle(door, [0.0, -out, outer_top], X, Y, [thick, 2.0 * out]),
        rectangle(door, [-thick, -inner, 0.0], Z, X, [inner_top, 2.0 * thick]),
        rectangle(door, [-thick, inner, 0.0], X, Z, [2.0 * thick, inner_top]),
        rectangle(door, [-thick, -inner, inner_top], Y, X, [2.0 * inner, 2.0 * thick]),
    ]);
}
