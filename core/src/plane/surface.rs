//! Planar surfaces that grow from row to row: the table of areas, with the plane of each.
//!
//! Areas that have ended stay in the table as long as there is room, so that a new area can join
//! them.

use core::ops::{ControlFlow, Range};

use crate::area::Area;
use crate::moments::{Moments, exact_points};
use crate::plane::fit::{Fit, mean_square_range_m2};
use crate::plane::noise::Noise;
use crate::plane::rules::Rules;
use crate::row::within::{at, put};
use crate::sink::Sink;

/// No slot: a pixel whose area found the table full.
pub(crate) const FULL: u16 = u16::MAX - 1;

/// Numbers kept for each area: the plane per metre, and its squares.
pub(crate) const PLANE_LEN: usize = 4;
/// Marks kept for each area: its last row, and its state.
pub(crate) const MARKS_LEN: usize = 2;

/// State of a free slot.
pub(crate) const FREE: u16 = 0;
/// State of an area that ended; a live one has 2 and more: 2 + the logarithm of its points when it
/// was last looked for other pieces of it.
pub(crate) const ENDED: u16 = 1;
pub(crate) const LIVE: u16 = 2;

/// The areas of a scan.
pub(crate) struct Surfaces<'a> {
    pub rules: &'static Rules,
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
    pub fn new(
        table: &'a mut [Area],
        planes: &'a mut [f32],
        marks: &'a mut [u16],
        max_range_m: f32,
        rules: &'static Rules,
    ) -> Self {
        let (planes, marks) = (planes.as_chunks_mut().0, marks.as_chunks_mut().0);
        let exact_points = exact_points(max_range_m);
        Self { rules, table, planes, marks, next_label: 1, exact_points, joined: false, row: 0 }
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

    /// The plane of a slot, per metre, if it is known well enough to be followed: from the second
    /// row on.
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

    /// The area of a slot.
    pub fn get(&self, slot: u16) -> &Area {
        self.table.get(usize::from(slot)).unwrap_or(&Area::EMPTY)
    }

    /// The last row with a pixel of an area.
    pub fn last_row(&self, slot: u16) -> u16 {
        at(self.marks, usize::from(slot))[0]
    }

    /// State of a slot.
    pub fn state(&self, slot: u16) -> u16 {
        at(self.marks, usize::from(slot))[1]
    }

    fn mark(&mut self, slot: u16, last_row: u16, state: u16) {
        put(self.marks, usize::from(slot), [last_row, state]);
    }

    /// Sets the state of a slot.
    pub fn set_state(&mut self, slot: u16, state: u16) {
        self.mark(slot, self.last_row(slot), state);
    }

    /// Squares that its points leave to its plane, relative to the ranges.
    pub fn relative_squares(&self, slot: u16) -> f64 {
        f64::from(at(self.planes, usize::from(slot))[3])
    }

    /// Sets the plane of an area.
    pub fn set_plane(&mut self, slot: u16, fit: &Fit) {
        let [x, y, z] = fit.per_metre();
        put(self.planes, usize::from(slot), [x, y, z, fit.relative_squares as f32]);
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

    /// A new area from a line; [`FULL`] if there is no room. The smallest
    /// area that has ended makes room.
    pub fn begin(&mut self, line: &Range<usize>, moments: &Moments, chi_square: f64, noise: &Noise) -> u16 {
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
        let squares = chi_square * noise.range_m2 / mean_square_range_m2(moments);
        put(self.planes, usize::from(slot), [0.0, 0.0, 0.0, squares as f32]);
        self.extend(slot, line, moments);
        slot
    }

    /// Joins two areas into one of that plane.
    pub fn join<S: Sink + ?Sized>(&mut self, one: u16, other: u16, fit: &Fit, sink: &mut S) -> ControlFlow<()> {
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

    /// Whether an area was not joined into another one.
    pub fn is_root(&self, slot: u16) -> bool {
        self.get(slot).link == slot
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
    pub fn close<S: Sink + ?Sized>(&mut self, all: bool, sink: &mut S) -> ControlFlow<()> {
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
}
