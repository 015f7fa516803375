//! Planar surfaces that grow from row to row: the table of areas, with the plane of each.
//!
//! Two areas, or a line and an area, are one surface if their common plane fits both within the noise ([`Fit`]):
//!
//! - the squares that a common plane adds to those of the two planes are no more than chance brings, or
//! - each of the two lies so near to the common plane that noise alone would explain it. That is what scanners need that
//!   have less noise than they are said to have, but bend their ranges.
//!
//! Pieces of a surface need not touch: what is hidden in between does not matter. Areas that have ended stay in the table
//! as long as there is room, so that a new area can join them.

use core::ops::{ControlFlow, Range};

use crate::beam::POINT_UNIT_M;
use crate::event::{Label, Sink};
use crate::fit::{Fit, mean_square_range_m2};
use crate::label::Area;
use crate::plane::{Moments, exact_points};
use crate::within::{at, put};

/// Squares, in units of the noise, that a common plane may add by chance: it has three numbers less than two planes, whose
/// squares exceed 20 once in 6000 times.
const CHANCE: f64 = 20.0;

/// And for each point of the smaller area: surfaces are not quite flat, and noise is not quite what it is said to be.
const UNEVEN: f64 = 0.1;

/// Excess over the noise at which an area still lies near a plane.
const BENT: f64 = 0.1;

/// Variances of the turn angle by which a surface may be bent.
const WOBBLE: f64 = 4.0;

/// Most of that.
const MOST: f64 = 9.0;

/// Large areas that meet at less than 3 deg, and with a step of less than three standard deviations of a range, are a
/// surface that the scanner bends.
const BEND_COS_SQUARE: f32 = 0.99726;
const BEND_STEP: f32 = 9.0;
const BEND_POINTS: u32 = 500;
const BEND_ROWS: u16 = 4;

/// Areas with fewer points join no other one across a gap.
const GAP_POINTS: u32 = 20;

/// No slot: a pixel that belongs to no area.
pub(crate) const NONE: u16 = u16::MAX;
/// No slot: a pixel whose area found the table full.
pub(crate) const FULL: u16 = u16::MAX - 1;

/// Numbers kept for each area: the plane per metre, and its squares.
pub(crate) const PLANE_LEN: usize = 4;
/// Marks kept for each area: its last row, and its state.
pub(crate) const MARKS_LEN: usize = 2;

/// State of a free slot.
const FREE: u16 = 0;
/// State of an area that ended; a live one has 2 and more: 2 + the logarithm of its points when it was last looked for
/// other pieces of it.
const ENDED: u16 = 1;
const LIVE: u16 = 2;

/// What the noise is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Noise {
    /// Variance of a range, m^2.
    pub range_m2: f64,
    /// Variance of the turn angle of a row, rad^2, and the axis of the turn.
    pub turn_rad2: f64,
    pub axis: [f32; 3],
}

impl Noise {
    /// Squared error of the range that the turn angle explains, in units of the noise, for the mean of points on a plane.
    fn wobble(&self, plane: &Fit, points: &Moments) -> f64 {
        if self.turn_rad2 == 0.0 {
            return 0.0;
        }
        let unit = f64::from(POINT_UNIT_M);
        let centre = points.first.map(|sum| sum as f64 / f64::from(points.points));
        let [ax, ay, az] = self.axis.map(f64::from);
        let [x, y, z] = centre;
        let moved = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        let slope: f64 = (0..3).map(|i| moved[i] * plane.m[i]).sum();
        let range_square = (x * x + y * y + z * z) * unit * unit;
        (WOBBLE * slope * slope * range_square * self.turn_rad2 / self.range_m2).min(MOST)
    }
}

/// The areas of a scan.
pub(crate) struct Surfaces<'a> {
    table: &'a mut [Area],
    /// Of each slot the plane per metre, and its squares.
    planes: &'a mut [[f32; PLANE_LEN]],
    /// Of each slot the last row, and the state.
    marks: &'a mut [[u16; MARKS_LEN]],
    next_label: u32,
    exact_points: u32,
    /// Whether an area was joined into another one in this row.
    joined: bool,
    pub row: u16,
}

impl<'a> Surfaces<'a> {
    pub fn new(table: &'a mut [Area], planes: &'a mut [f32], marks: &'a mut [u16], max_range_m: f32) -> Self {
        let (planes, marks) = (planes.as_chunks_mut().0, marks.as_chunks_mut().0);
        Self { table, planes, marks, next_label: 1, exact_points: exact_points(max_range_m), joined: false, row: 0 }
    }

    pub fn reset(&mut self) {
        self.marks.fill([0, FREE]);
        self.next_label = 1;
        self.joined = false;
        self.row = 0;
    }

    pub fn table(&self) -> &[Area] {
        self.table
    }

    /// The plane of a slot, per metre, if it is known well enough to be followed: from the second row on.
    #[inline]
    pub fn plane(&self, slot: u16) -> Option<[f32; 3]> {
        let area = self.table.get(usize::from(slot))?;
        let [x, y, z, _] = at(self.planes, usize::from(slot));
        (self.last_row(slot) > area.first_row).then_some([x, y, z])
    }

    /// Rows and points of an area.
    pub fn size(&self, slot: u16) -> (u16, u32) {
        let area = self.get(slot);
        (self.last_row(slot) - area.first_row + 1, area.points)
    }

    fn get(&self, slot: u16) -> &Area {
        self.table.get(usize::from(slot)).unwrap_or(&Area::EMPTY)
    }

    fn last_row(&self, slot: u16) -> u16 {
        at(self.marks, usize::from(slot))[0]
    }

    fn state(&self, slot: u16) -> u16 {
        at(self.marks, usize::from(slot))[1]
    }

    fn mark(&mut self, slot: u16, last_row: u16, state: u16) {
        put(self.marks, usize::from(slot), [last_row, state]);
    }

    fn set_state(&mut self, slot: u16, state: u16) {
        self.mark(slot, self.last_row(slot), state);
    }

    fn squares(&self, slot: u16) -> f64 {
        f64::from(at(self.planes, usize::from(slot))[3])
    }

    fn set_plane(&mut self, slot: u16, fit: &Fit) {
        let [x, y, z] = fit.per_metre();
        put(self.planes, usize::from(slot), [x, y, z, fit.squares as f32]);
    }

    /// The slot that an area was joined into in this row; its own if none.
    pub fn root(&self, mut slot: u16) -> u16 {
        while let Some(area) = self.table.get(usize::from(slot)).filter(|area| area.link != slot) {
            slot = area.link;
        }
        slot
    }

    /// Adds a run of this row to an area.
    pub fn extend(&mut self, slot: u16, run: &Range<usize>, moments: &Moments) {
        let (row, exact) = (self.row, self.exact_points);
        if let Some(area) = self.table.get_mut(usize::from(slot)) {
            area.take(run, moments, exact);
        }
        self.mark(slot, row, self.state(slot));
    }

    /// A new area from a line, whose squares are given in units of the noise; [`FULL`] if there is no room. The smallest
    /// area that has ended makes room.
    pub fn begin(&mut self, line: &Range<usize>, moments: &Moments, squares: f64, noise: &Noise) -> u16 {
        let slots = 0..self.table.len().min(usize::from(FULL)) as u16;
        let mut best = None;
        for slot in slots {
            let size = match self.state(slot) {
                FREE => 0,
                ENDED => self.get(slot).points,
                _ => continue,
            };
            if best.is_none_or(|(least, _)| size < least) {
                best = Some((size, slot));
            }
            if size == 0 {
                break;
            }
        }
        let Some((_, slot)) = best else { return FULL };
        put(self.table, usize::from(slot), Area::begin(self.next_label, self.row, line.start as u16, slot));
        self.next_label += 1;
        self.set_state(slot, LIVE);
        // no plane, which nothing follows: some points never make one
        let squares = squares * noise.range_m2 / mean_square_range_m2(moments);
        put(self.planes, usize::from(slot), [0.0, 0.0, 0.0, squares as f32]);
        self.extend(slot, line, moments);
        slot
    }

    /// How badly a line fits an area; `None` if it does not. The line's own squares are given in units of the noise.
    pub fn takes(&self, slot: u16, line: &Moments, squares: f64, noise: &Noise) -> Option<f64> {
        let area = self.get(slot).moments();
        let mut both = area;
        both.merge(line);
        let fit = Fit::of(&both)?;
        let points = f64::from(line.points);
        let added = (fit.squares - self.squares(slot)) * mean_square_range_m2(line) / noise.range_m2;
        let slack = UNEVEN * f64::from(area.points).min(4.0 * points) + noise.wobble(&fit, line) * points;
        (added < points.max(squares + CHANCE) + slack).then_some(added - squares)
    }

    /// Whether two areas are one surface; then its plane.
    fn common(&self, one: u16, other: u16, noise: &Noise) -> Option<Fit> {
        let parts = [one, other].map(|slot| (self.get(slot).moments(), self.squares(slot)));
        let mut both = parts[0].0;
        both.merge(&parts[1].0);
        let fit = Fit::of(&both)?;
        let small = if parts[0].0.points < parts[1].0.points { &parts[0].0 } else { &parts[1].0 };
        let per_noise = |part: &Moments| mean_square_range_m2(part) / noise.range_m2;
        let added = (fit.squares - parts[0].1 - parts[1].1) * per_noise(small);
        let by_chance = added < CHANCE + (UNEVEN + noise.wobble(&fit, small)) * f64::from(small.points);
        let near = |part: &Moments| {
            fit.squares_of(part) * per_noise(part) < (1.0 + BENT + noise.wobble(&fit, part)) * f64::from(part.points)
        };
        (by_chance || parts.iter().all(|(part, _)| near(part))).then_some(fit)
    }

    /// Whether two large areas meet at a small angle, and without a step. `inverse_m` gives the inverse of the range at
    /// which a plane is seen where they meet.
    pub fn bends(&self, one: u16, other: u16, noise: &Noise, inverse_m: impl Fn([f32; 3]) -> f32) -> Option<Fit> {
        let large = |slot: u16| self.size(slot).0 >= BEND_ROWS && self.get(slot).points >= BEND_POINTS;
        let (a, b) = (self.plane(one)?, self.plane(other)?);
        let dot = |u: [f32; 3], v: [f32; 3]| u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
        let (aligned, squares) = (dot(a, b), dot(a, a) * dot(b, b));
        let (near, far) = (inverse_m(a), inverse_m(b));
        // 1 / far - 1 / near, without a division
        let step = (near - far) * (near - far);
        let least = BEND_STEP * noise.range_m2 as f32 * near * near * far * far;
        let bends = large(one)
            && large(other)
            && aligned > 0.0
            && aligned * aligned > BEND_COS_SQUARE * squares
            && step < least;
        let mut both = self.get(one).moments();
        both.merge(&self.get(other).moments());
        bends.then(|| Fit::of(&both)).flatten()
    }

    /// Joins two areas if they are one surface.
    pub fn try_join<S: Sink>(&mut self, one: u16, other: u16, noise: &Noise, sink: &mut S) -> ControlFlow<(), bool> {
        let Some(fit) = self.common(one, other, noise) else { return ControlFlow::Continue(false) };
        self.join(one, other, &fit, sink)?;
        ControlFlow::Continue(true)
    }

    /// Joins two areas into one of that plane.
    pub fn join<S: Sink>(&mut self, one: u16, other: u16, fit: &Fit, sink: &mut S) -> ControlFlow<()> {
        let older = self.get(one).label < self.get(other).label;
        let (kept, gone) = if older { (one, other) } else { (other, one) };
        let exact = self.exact_points;
        let Some(area) = self.table.get_mut(usize::from(gone)) else { return ControlFlow::Continue(()) };
        area.link = kept;
        let other = *area;
        let Some(area) = self.table.get_mut(usize::from(kept)) else { return ControlFlow::Continue(()) };
        let join = area.absorb(&other, exact);
        self.joined = true;
        let latest = self.last_row(kept).max(self.last_row(gone));
        self.mark(kept, latest, self.state(kept).max(self.state(gone)));
        self.set_plane(kept, fit);
        sink.join(join)
    }

    /// Planes of the areas that this row has added to.
    pub fn refit(&mut self) {
        for slot in 0..self.table.len() as u16 {
            let grown = self.state(slot) >= LIVE && self.last_row(slot) == self.row;
            let old = grown && self.get(slot).first_row < self.row;
            if let Some(fit) = old.then(|| Fit::of(&self.get(slot).moments())).flatten() {
                self.set_plane(slot, &fit);
            }
        }
    }

    fn is_root(&self, slot: u16) -> bool {
        self.get(slot).link == slot
    }

    /// Joins areas of this row to all others on the same plane, each time that they have twice the points.
    pub fn bridge<S: Sink>(&mut self, noise: &Noise, sink: &mut S) -> ControlFlow<()> {
        let slots = self.table.len() as u16;
        for slot in 0..slots {
            let (state, points) = (self.state(slot), self.get(slot).points);
            let due = state >= LIVE
                && self.is_root(slot)
                && self.last_row(slot) == self.row
                && self.get(slot).first_row < self.row
                && points >= GAP_POINTS
                && LIVE + log2(points) > state;
            if !due {
                continue;
            }
            self.set_state(slot, LIVE + log2(points));
            let mut slot = slot;
            for other in 0..slots {
                let candidate = self.state(other) != FREE
                    && other != slot
                    && self.is_root(other)
                    && self.get(other).points >= GAP_POINTS;
                if candidate && self.try_join(slot, other, noise, sink)? {
                    slot = self.root(slot);
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// After the joins of a row: every pixel refers to the area itself.
    pub fn settle(&mut self, slots: &mut [u16]) {
        if core::mem::take(&mut self.joined) {
            for slot in slots {
                *slot = self.root(*slot);
            }
        }
    }

    /// After a row: areas that have not grown are complete. `all`: every area is.
    pub fn close<S: Sink>(&mut self, all: bool, sink: &mut S) -> ControlFlow<()> {
        for slot in 0..self.table.len() as u16 {
            let state = self.state(slot);
            if state == FREE {
                continue;
            }
            if !self.is_root(slot) {
                self.set_state(slot, FREE);
            } else if state >= LIVE && (all || self.last_row(slot) < self.row) {
                self.set_state(slot, ENDED);
                sink.segment(&self.get(slot).segment(self.last_row(slot)))?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Label of a slot.
    pub fn label(table: &[Area], slot: u16) -> Option<Label> {
        table.get(usize::from(slot)).map(|area| Label(area.label))
    }
}

/// The logarithm of a number of points, rounded down.
fn log2(points: u32) -> u16 {
    points.checked_ilog2().unwrap_or(0) as u16
}
