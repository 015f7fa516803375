//! The table of areas, each with its plane. Areas that have ended stay in it as long as there is
//! room, so that a new area can join them.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::{ControlFlow, Range};

use crate::area::Area;
use crate::plane::marks::{ENDED, FREE, LIVE, Marks, both_beyond};
use crate::plane::rules::{LOOKED_AT, Rules};
use crate::plane::tried::Tried;
use crate::plane::work::count;
use crate::row::bits::{CHUNK, VECTORS};
use crate::row::slots::NONE;
use crate::segment::SegmentSums;
use crate::sink::Sink;
use crate::weighted::fitted::Fitted;

/// No slot: a pixel whose area found the table full.
pub(crate) const FULL: u16 = u16::MAX - 1;

/// The areas of a scan.
pub(crate) struct Areas<'a> {
    pub rules: &'static Rules,
    table: &'a mut [Area],
    pub tried: Tried<'a>,
    next_label: u32,
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
    /// Variance of the offset of a ring, m^2; 0 where the scanner does not spin.
    pub ring_m2: f32,
    /// Measurements that a pixel is: 1, less where neighbours err alike.
    pub share: f32,
    /// The axis about which rows turn; 0 where they do not.
    pub axis: [f32; 3],
    /// The last turn between two areas that was not reported, radians.
    pub seam_rad: Option<f32>,
    /// Whether areas of the first row stay until the end: the last row neighbours it.
    round: bool,
}

impl<'a> Areas<'a> {
    pub fn new(
        table: &'a mut [Area],
        tried: Tried<'a>,
        axis: [f32; 3],
        rules: &'static Rules,
        round: bool,
    ) -> Areas<'a> {
        Self {
            rules,
            table,
            tried,
            next_label: 1,
            free: NONE,
            fresh: 0,
            hand: 0,
            joined: false,
            row: 0,
            bridge: [0, 0],
            turn_rad2: 0.0,
            ring_m2: 0.0,
            share: 1.0,
            axis,
            seam_rad: None,
            round,
        }
    }

    pub fn reset(&mut self) {
        self.table.fill(Area::EMPTY);
        self.tried.reset();
        (self.next_label, self.free, self.fresh, self.hand, self.row) = (1, NONE, 0, 0, 0);
        (self.joined, self.bridge, self.seam_rad) = (false, [0, 0], None);
    }

    pub fn table(&self) -> &[Area] {
        self.table
    }

    /// Slots in use are below.
    pub fn used(&self) -> u16 {
        self.fresh
    }

    /// The area of a slot.
    pub fn get(&self, slot: u16) -> &Area {
        self.table.get(usize::from(slot)).unwrap_or(&Area::EMPTY)
    }

    fn change(&mut self, slot: u16, change: impl FnOnce(&mut Area)) {
        if let Some(area) = self.table.get_mut(usize::from(slot)) {
            change(area);
        }
    }

    /// The plane of a slot with its sums. Called on a microcontroller: each copy is 60 bytes.
    #[cfg_attr(not(target_os = "none"), inline)]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn fitted(&self, slot: u16) -> Fitted {
        // what follows costs ten times as much as a pixel
        count(10);
        self.get(slot).fitted()
    }

    /// The plane of a slot.
    pub fn m(&self, slot: u16) -> [f32; 3] {
        self.get(slot).m()
    }

    /// Changes the planes of all areas: of the middle of its columns, and the plane with its sums.
    pub fn change_planes(&mut self, change: impl Fn(usize, &Fitted) -> Fitted) {
        for area in self.table.iter_mut().take(usize::from(self.fresh)).filter(|area| area.points > 0) {
            let middle = (usize::from(area.first_column) + usize::from(area.last_column)) / 2;
            area.set_fitted(&change(middle, &area.fitted()));
        }
    }

    /// Takes a pixel for so many measurements, those of the areas so far as well.
    pub fn weigh(&mut self, share: f32) {
        let change = share / core::mem::replace(&mut self.share, share);
        if change.to_bits() != 1.0f32.to_bits() {
            self.change_planes(|_, fitted| fitted.weighed(change));
        }
    }

    pub fn marks(&self, slot: u16) -> Marks {
        Marks::of(self.get(slot))
    }

    pub fn set_marks(&mut self, slot: u16, marks: &Marks) {
        self.change(slot, |area| marks.keep_in(area));
    }

    /// Whether an area has a plane: one row has none.
    pub fn has_plane(&self, slot: u16) -> bool {
        let area = self.get(slot);
        area.frontier > area.first_row
    }

    /// The plane of a slot if it is known well enough to be followed.
    #[inline]
    pub fn plane(&self, slot: u16) -> Option<[f32; 3]> {
        let area = self.table.get(usize::from(slot))?;
        let smooth =
            area.squares() <= self.rules.rough * (self.share * area.points as f32) + self.rules.rough_by_chance;
        (area.frontier > area.first_row && smooth).then(|| area.m())
    }

    /// Measurements of an area: its points, those that err alike counted once. Called on a microcontroller, 0.2 KB less.
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn measurements(&self, slot: u16) -> f32 {
        self.share * self.get(slot).points as f32
    }

    /// Rows and points of an area.
    pub fn size(&self, slot: u16) -> (u16, u32) {
        let area = self.get(slot);
        (area.frontier - area.first_row + 1, area.points)
    }

    /// The slot that an area was joined into in this row; its own if none.
    pub fn root(&self, mut slot: u16) -> u16 {
        while let Some(area) = self.table.get(usize::from(slot)).filter(|area| area.link != slot) {
            slot = area.link;
        }
        slot
    }

    /// Whether a slot holds an area that was not joined into another one.
    pub fn is_root(&self, slot: u16) -> bool {
        self.marks(slot).state != FREE && self.get(slot).link == slot
    }

    /// Adds a run of this row to an area, which makes its plane this one.
    pub fn extend(&mut self, slot: u16, run: &Range<usize>, fitted: &Fitted, points: u32) {
        let row = self.row;
        self.change(slot, |area| {
            area.reach(run);
            area.points = area.points.saturating_add(points);
            area.frontier = row;
            area.set_fitted(fitted);
        });
        self.carry(slot);
    }

    /// A new area from a line; [`FULL`] if there is no room.
    pub fn begin(&mut self, line: &Range<usize>, fitted: &Fitted, points: u32) -> u16 {
        let slot = self.vacant();
        let Some(area) = self.table.get_mut(usize::from(slot)) else { return FULL };
        *area = Area::begin(self.next_label, self.row, line.start as u16, slot);
        Marks { state: LIVE, ..Marks::default() }.keep_in(area);
        self.next_label += 1;
        self.extend(slot, line, fitted, points);
        slot
    }

    /// A slot for a new area: a free one, or that of a small area that has ended.
    fn vacant(&mut self) -> u16 {
        if self.free != NONE {
            let slot = self.free;
            self.free = self.get(slot).link;
            return slot;
        }
        if usize::from(self.fresh) < self.table.len().min(usize::from(FULL)) {
            self.fresh += 1;
            return self.fresh - 1;
        }
        // the smallest of the next ones that have ended
        let (mut best, mut ended) = ((u32::MAX, FULL), 0);
        for _ in 0..self.fresh.min(LOOKED_AT) {
            count(1);
            self.hand = if self.hand + 1 < self.fresh { self.hand + 1 } else { 0 };
            if self.marks(self.hand).state == ENDED && !self.stays(self.hand) {
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

    /// Whether an area is kept for the last row.
    fn stays(&self, slot: u16) -> bool {
        self.round && self.get(slot).first_row == 0
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
        self.change(gone, |area| area.link = kept);
        let other = *self.get(gone);
        let Some(area) = self.table.get_mut(usize::from(kept)) else { return ControlFlow::Continue(one) };
        let join = area.unite(&other);
        area.points = area.points.saturating_add(other.points);
        area.frontier = area.frontier.max(other.frontier);
        area.set_fitted(common);
        let (of_kept, of_gone) = (Marks::of(area), Marks::of(&other));
        let beyond = core::array::from_fn(|side| both_beyond(of_kept.beyond[side], of_gone.beyond[side]));
        let (seen, bridged) = (of_kept.seen.max(of_gone.seen), of_kept.bridged.max(of_gone.bridged));
        // one that has ended is reported again
        Marks { state: LIVE, bridged, seen, beyond }.keep_in(area);
        self.joined = true;
        sink.join(join)?;
        ControlFlow::Continue(kept)
    }

    /// After the joins of a row: every pixel refers to the area itself.
    pub fn settle(&mut self, rows: [&mut [u16]; 3]) {
        if core::mem::take(&mut self.joined) {
            let mut last = (NONE, NONE);
            for chunk in rows.into_iter().flat_map(|row| row.chunks_mut(CHUNK)) {
                let is_last = |same: bool, slot: &u16| same & (*slot == last.0);
                if VECTORS && last.0 == last.1 && chunk.iter().fold(true, is_last) {
                    continue;
                }
                for slot in chunk {
                    if *slot != last.0 {
                        last = (*slot, self.root(*slot));
                    }
                    *slot = last.1;
                }
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
                let rings = f32::from(self.size(slot).0);
                let fitted = area.fitted().known_by_rings(self.ring_m2, rings);
                let sums = SegmentSums::Fitted { pixels: area.points, fitted };
                sink.segment(&area.segment(area.frontier, sums))?;
                // smaller ones are never joined again
                gone = area.points < self.rules.gap_points && !self.stays(slot);
                self.set_marks(slot, &Marks { state: ENDED, ..marks });
            }
            if gone {
                self.set_marks(slot, &Marks { state: FREE, ..marks });
                let free = self.free;
                self.change(slot, |area| area.link = free);
                self.free = slot;
            }
        }
        ControlFlow::Continue(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sink::LabelRow;

    struct Nothing;
    impl Sink for Nothing {
        fn row(&mut self, _: &LabelRow<'_>) -> ControlFlow<()> {
            ControlFlow::Continue(())
        }
    }

    /// The slot of a new area in a full table of 100: those from `ended` on have ended, later ones
    /// are smaller.
    fn vacant_where(ended: u16) -> u16 {
        let (mut table, mut pairs) = ([Area::EMPTY; 100], [0; 16]);
        let mut areas = Areas::new(&mut table, Tried::new(&mut pairs), [0.0; 3], &Rules::TUNED, false);
        areas.reset();
        for slot in 0..100 {
            assert_eq!(areas.begin(&(0..4), &Fitted::default(), 200 - slot), slot as u16);
        }
        areas.row = 1;
        (0..ended).for_each(|slot| areas.carry(slot));
        assert!(areas.close(false, &mut Nothing).is_continue());
        areas.begin(&(0..4), &Fitted::default(), 30)
    }

    /// The smallest of the next eight that have ended is given up, of the next 64 in all; what has
    /// not ended stays.
    #[test]
    fn the_smallest_of_the_next_ones() {
        assert_eq!(vacant_where(0), 8);
        assert_eq!(vacant_where(65), FULL);
        if !cfg!(miri) {
            assert_eq!(vacant_where(20), 27);
            assert_eq!(vacant_where(63), 64);
        }
    }
}
