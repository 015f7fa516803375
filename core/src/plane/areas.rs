//! The table of areas, each with its plane. Areas that have ended stay in it as long as there is
//! room, so that a new area can join them.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::{ControlFlow, Range};

use crate::area::Area;
use crate::moments::{Moments, exact_points};
use crate::plane::fitted::{FITTED_LEN, Fitted};
use crate::plane::rules::{LOOKED_AT, Rules};
use crate::plane::tried::Tried;
use crate::plane::work::count;
use crate::row::slots::NONE;
use crate::row::within::{at, put};
use crate::sink::Sink;

/// No slot: a pixel whose area found the table full.
pub(crate) const FULL: u16 = u16::MAX - 1;

/// Marks kept for each area: see [`Marks`].
pub(crate) const MARKS_LEN: usize = 6;

/// State of a free slot.
const FREE: u8 = 0;
/// State of an area that ended.
const ENDED: u8 = 1;
/// State of an area that a column carries on.
const LIVE: u8 = 2;

/// What is known of an area beside its bounds, its moments and its plane.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Marks {
    /// [`FREE`], [`ENDED`] or [`LIVE`].
    state: u8,
    /// Logarithm of its points when its other pieces were last looked for.
    pub bridged: u8,
    /// The last row below which a column still carries it.
    seen: u16,
    /// Pixels beyond its top, bottom, left and right border that are nearer than its plane, and
    /// those that are farther.
    pub beyond: [[u8; 2]; 4],
}

impl Marks {
    fn of(marks: [u16; MARKS_LEN]) -> Marks {
        let [state, seen, beyond @ ..] = marks;
        let [state, bridged] = state.to_le_bytes();
        Marks { state, bridged, seen, beyond: beyond.map(u16::to_le_bytes) }
    }

    fn marks(&self) -> [u16; MARKS_LEN] {
        let [top, bottom, left, right] = self.beyond.map(u16::from_le_bytes);
        [u16::from_le_bytes([self.state, self.bridged]), self.seen, top, bottom, left, right]
    }
}

/// Where [`Areas`] are kept.
pub(crate) struct Tables<'a> {
    pub areas: &'a mut [Area],
    /// Of each slot a [`Fitted`].
    pub fitted: &'a mut [[f32; FITTED_LEN]],
    /// Of each slot its [`Marks`].
    pub marks: &'a mut [[u16; MARKS_LEN]],
}

/// The areas of a scan.
pub(crate) struct Areas<'a> {
    pub rules: &'static Rules,
    tables: Tables<'a>,
    pub tried: Tried<'a>,
    next_label: u32,
    exact_points: u32,
    /// The first free slot; each knows the next one.
    free: u16,
    /// Slots from here on were never used.
    fresh: u16,
    /// Where the search for an area that has ended goes on.
    hand: u16,
    /// Whether an area was joined into another one in this row.
    joined: bool,
    pub row: u16,
    /// Where the search for pieces across gaps goes on: an area, and the other one.
    pub bridge: [u16; 2],
    /// Variance of the turn angle of a row, rad^2.
    pub turn_rad2: f32,
    /// The axis about which rows turn; 0 where they do not.
    pub axis: [f32; 3],
    /// The last turn between two areas that was not reported, radians.
    pub seam_rad: Option<f32>,
}

impl<'a> Areas<'a> {
    pub fn new(
        tables: Tables<'a>,
        tried: Tried<'a>,
        max_range_m: f32,
        axis: [f32; 3],
        rules: &'static Rules,
    ) -> Areas<'a> {
        Self {
            rules,
            tables,
            tried,
            next_label: 1,
            exact_points: exact_points(max_range_m),
            free: NONE,
            fresh: 0,
            hand: 0,
            joined: false,
            row: 0,
            bridge: [0, 0],
            turn_rad2: 0.0,
            axis,
            seam_rad: None,
        }
    }

    pub fn reset(&mut self) {
        self.tables.marks.fill(Marks::default().marks());
        self.tried.reset();
        (self.next_label, self.free, self.fresh, self.hand, self.row) = (1, NONE, 0, 0, 0);
        (self.joined, self.bridge, self.seam_rad) = (false, [0, 0], None);
    }

    pub fn table(&self) -> &[Area] {
        self.tables.areas
    }

    /// Slots in use are below.
    pub fn used(&self) -> u16 {
        self.fresh
    }

    /// The area of a slot.
    pub fn get(&self, slot: u16) -> &Area {
        self.tables.areas.get(usize::from(slot)).unwrap_or(&Area::EMPTY)
    }

    /// The plane of a slot with its sums.
    pub fn fitted(&self, slot: u16) -> Fitted {
        // what follows costs ten times as much as a pixel
        count(10);
        Fitted::from_numbers(at(self.tables.fitted, usize::from(slot)))
    }

    fn set_fitted(&mut self, slot: u16, fitted: &Fitted) {
        put(self.tables.fitted, usize::from(slot), fitted.numbers());
    }

    /// The plane of a slot.
    pub fn m(&self, slot: u16) -> [f32; 3] {
        let [.., x, y, z, _] = at(self.tables.fitted, usize::from(slot));
        [x, y, z]
    }

    pub fn marks(&self, slot: u16) -> Marks {
        Marks::of(at(self.tables.marks, usize::from(slot)))
    }

    pub fn set_marks(&mut self, slot: u16, marks: &Marks) {
        put(self.tables.marks, usize::from(slot), marks.marks());
    }

    /// Whether an area has a plane: one row has none.
    pub fn has_plane(&self, slot: u16) -> bool {
        let area = self.get(slot);
        area.frontier > area.first_row
    }

    /// The plane of a slot if it is known well enough to be followed.
    #[inline]
    pub fn plane(&self, slot: u16) -> Option<[f32; 3]> {
        let area = self.tables.areas.get(usize::from(slot))?;
        let [.., x, y, z, squares] = at(self.tables.fitted, usize::from(slot));
        let smooth = squares <= self.rules.rough * area.points as f32 + self.rules.rough_by_chance;
        (area.frontier > area.first_row && smooth).then_some([x, y, z])
    }

    /// Rows and points of an area.
    pub fn size(&self, slot: u16) -> (u16, u32) {
        let area = self.get(slot);
        (area.frontier - area.first_row + 1, area.points)
    }

    /// The slot that an area was joined into in this row; its own if none.
    pub fn root(&self, mut slot: u16) -> u16 {
        while let Some(area) = self.tables.areas.get(usize::from(slot)).filter(|area| area.link != slot) {
            slot = area.link;
        }
        slot
    }

    /// Whether a slot holds an area that was not joined into another one.
    pub fn is_root(&self, slot: u16) -> bool {
        self.marks(slot).state != FREE && self.get(slot).link == slot
    }

    /// Adds a run of this row to an area, which makes its plane this one.
    pub fn extend(&mut self, slot: u16, run: &Range<usize>, fitted: &Fitted, moments: &Moments) {
        let (row, exact) = (self.row, self.exact_points);
        let Some(area) = self.tables.areas.get_mut(usize::from(slot)) else { return };
        area.take(run, moments, exact);
        area.frontier = row;
        self.set_fitted(slot, fitted);
        self.carry(slot);
    }

    /// A new area from a line; [`FULL`] if there is no room.
    pub fn begin(&mut self, line: &Range<usize>, fitted: &Fitted, moments: &Moments) -> u16 {
        let slot = self.vacant();
        let Some(area) = self.tables.areas.get_mut(usize::from(slot)) else { return FULL };
        *area = Area::begin(self.next_label, self.row, line.start as u16, slot);
        self.next_label += 1;
        self.set_marks(slot, &Marks { state: LIVE, ..Marks::default() });
        self.extend(slot, line, fitted, moments);
        slot
    }

    /// A slot for a new area: a free one, or that of a small area that has ended.
    fn vacant(&mut self) -> u16 {
        if self.free != NONE {
            let slot = self.free;
            self.free = self.get(slot).link;
            return slot;
        }
        if usize::from(self.fresh) < self.tables.areas.len().min(usize::from(FULL)) {
            self.fresh += 1;
            return self.fresh - 1;
        }
        // the smallest of the next ones that have ended
        let (mut best, mut ended) = ((u32::MAX, FULL), 0);
        for _ in 0..self.fresh.min(LOOKED_AT) {
            count(1);
            self.hand = if self.hand + 1 < self.fresh { self.hand + 1 } else { 0 };
            if self.marks(self.hand).state == ENDED {
                let points = self.get(self.hand).points;
                best = if points < best.0 { (points, self.hand) } else { best };
                ended += 1;
                if ended == LOOKED_AT / 8 {
                    break;
                }
            }
        }
        best.1
    }

    /// Joins two areas into one of that plane; gives its slot.
    pub fn join<S: Sink + ?Sized>(
        &mut self,
        one: u16,
        other: u16,
        common: &Fitted,
        sink: &mut S,
    ) -> ControlFlow<(), u16> {
        let older = self.get(one).label < self.get(other).label;
        let (kept, gone) = if older { (one, other) } else { (other, one) };
        let exact = self.exact_points;
        let Some(area) = self.tables.areas.get_mut(usize::from(gone)) else { return ControlFlow::Continue(one) };
        area.link = kept;
        let other = *area;
        let Some(area) = self.tables.areas.get_mut(usize::from(kept)) else { return ControlFlow::Continue(one) };
        let join = area.absorb(&other, exact);
        area.frontier = area.frontier.max(other.frontier);
        let (of_kept, of_gone) = (self.marks(kept), self.marks(gone));
        let beyond = core::array::from_fn(|side| both_beyond(of_kept.beyond[side], of_gone.beyond[side]));
        let (seen, bridged) = (of_kept.seen.max(of_gone.seen), of_kept.bridged.max(of_gone.bridged));
        // one that has ended is reported again
        self.set_marks(kept, &Marks { state: LIVE, bridged, seen, beyond });
        self.set_fitted(kept, common);
        self.joined = true;
        sink.join(join)?;
        ControlFlow::Continue(kept)
    }

    /// After the joins of a row: every pixel refers to the area itself.
    pub fn settle(&mut self, rows: [&mut [u16]; 2]) {
        if core::mem::take(&mut self.joined) {
            for slot in rows.into_iter().flatten().filter(|slot| **slot < FULL) {
                *slot = self.root(*slot);
            }
        }
    }

    /// An area that a column carries on to the next row.
    pub fn carry(&mut self, slot: u16) {
        let marks = Marks { seen: self.row, ..self.marks(slot) };
        self.set_marks(slot, &marks);
    }

    /// After a row: areas that no column carries are complete. `all`: every area is.
    pub fn close<S: Sink + ?Sized>(&mut self, all: bool, sink: &mut S) -> ControlFlow<()> {
        count(usize::from(self.fresh));
        for slot in 0..self.fresh {
            let marks = self.marks(slot);
            if marks.state == FREE {
                continue;
            }
            let area = self.get(slot);
            let mut gone = area.link != slot;
            if !gone && marks.state == LIVE && (all || marks.seen != self.row) {
                sink.segment(&area.segment(area.frontier))?;
                // smaller ones are never joined again
                gone = area.points < self.rules.gap_points;
                self.set_marks(slot, &Marks { state: ENDED, ..marks });
            }
            if gone {
                self.set_marks(slot, &Marks { state: FREE, ..marks });
                if let Some(area) = self.tables.areas.get_mut(usize::from(slot)) {
                    area.link = self.free;
                    self.free = slot;
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// Counters of one border of both areas.
fn both_beyond(one: [u8; 2], other: [u8; 2]) -> [u8; 2] {
    let sums = [0, 1].map(|i| u16::from(one[i]) + u16::from(other[i]));
    let most = u16::from(u8::MAX);
    let halve = sums[0] > most || sums[1] > most;
    sums.map(|n| if halve { n / 2 } else { n } as u8)
}
