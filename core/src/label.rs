//! Labels (paper section 4: "each closed area gets a label"): 4-connected areas, by runs, in one
//! pass. Of the edge-based approach runs are what edges leave of a row, and those that touch are
//! one area; of the region-based one they are lines, and [`Growth`] says which areas take them.
//!
//! Only the frontier is remembered: the runs of the row before that may still be touched, then the
//! runs of this row so far, a queue of at most floor(columns / 2) + 2 entries. Each run refers to a
//! slot of the table of live areas. Where areas join within a row, one slot becomes a link to the
//! other; at the end of the row all runs refer to roots again.
//!
//! A slot is free the moment no run refers to it, so floor(columns / 2) + 1 slots are enough for
//! every image:
//! - The slot that a run has joined others into keeps the run's own reference to the end of the
//!   row, and only such slots are linked to. Hence every slot in use is referred to by a run of its
//!   own.
//! - Runs that can no longer be touched are dropped before a new area takes a slot, and then the
//!   frontier without the new run has at most floor(columns / 2) runs. With gaps between runs,
//!   because every run has its pixel and a gap. With runs that touch, of two pixels or more, let
//!   the new one be `s..e`: floor(s / 2) runs at most are to its left, and those of the row above
//!   that end after e are at most 1 + floor((columns - e - 1) / 2), with e >= s + 2; together no
//!   more than floor((columns - 1) / 2).

use core::ops::{ControlFlow, Range};

use crate::area::Area;
use crate::moments::{Moments, exact_points};
use crate::row::slots::{NONE, RunSlots, ring_place, set_ring_slot};
use crate::segment::SegmentSums;
use crate::sink::Sink;

/// Words of the frontier: one more run than live labels, two runs a word.
pub(crate) const fn frontier_words(columns: usize) -> usize {
    (columns / 2 + 2).div_ceil(2)
}

/// How an approach lets areas grow, run by run. One that `TAKES_ALL` needs `moments` only.
pub(crate) trait Growth {
    /// Whether areas take every run that touches them, so that those that touch one run are one.
    const TAKES_ALL: bool = false;

    /// The next run of the row.
    fn begin(&mut self, run: &Range<usize>) {
        let _ = run;
    }

    /// Whether an area of the row above, which the run touches, takes the run, and how well: of
    /// several the one that takes it best, and of equal ones the leftmost, gets it.
    fn takes(&mut self, area: &Area) -> Option<u32> {
        let _ = area;
        Some(0)
    }

    /// Whether the area that got the run and another one that it touches are one.
    fn joins(&mut self, one: &Area, other: &Area) -> bool {
        let _ = (one, other);
        true
    }

    /// Whether the areas of the last and of the first run, which are neighbours across the seam,
    /// are one.
    fn meets(&mut self, one: &Area, other: &Area) -> bool {
        let _ = (one, other);
        true
    }

    /// The moments of the run.
    fn moments(&mut self, run: Range<usize>) -> Moments;
}

/// The live areas and the frontier.
pub(crate) struct Labels<'a> {
    table: &'a mut [Area],
    /// Ring of slots, two a word.
    frontier: &'a mut [u32],
    head: usize,
    len: usize,
    /// First free slot, `NONE` if all are taken.
    free: u16,
    next_label: u32,
    /// Row in progress.
    row: u16,
    /// Points up to which no sum of an area can overflow.
    exact_points: u32,
}

impl<'a> Labels<'a> {
    pub fn new(table: &'a mut [Area], frontier: &'a mut [u32], max_range_m: f32) -> Self {
        let exact_points = exact_points(max_range_m);
        let mut labels = Self { table, frontier, head: 0, len: 0, free: NONE, next_label: 1, row: 0, exact_points };
        labels.reset();
        labels
    }

    /// Forgets all areas and starts again at label 1.
    pub fn reset(&mut self) {
        let slots = self.table.len().min(usize::from(NONE));
        for (i, area) in self.table.iter_mut().enumerate() {
            let next = if i + 1 < slots { i as u32 + 1 } else { u32::from(NONE) };
            *area = Area { label: next, ..Area::EMPTY };
        }
        self.free = if slots > 0 { 0 } else { NONE };
        (self.head, self.len) = (0, 0);
        (self.next_label, self.row) = (1, 0);
    }

    /// The table of areas, and the slots in it of the runs of the row just labelled.
    pub fn labelled(&self) -> (&[Area], RunSlots<'_>) {
        (self.table, self.slots())
    }

    /// Labels one row. `previous` and `current` are the runs of the row before and of this row;
    /// `seam`: the last run neighbours the first across the seam of an image that wraps. Returns
    /// the number of pixels that got no label.
    pub fn label_row<S: Sink + ?Sized, G: Growth>(
        &mut self,
        row: usize,
        previous: impl Iterator<Item = Range<usize>> + Clone,
        current: impl Iterator<Item = Range<usize>>,
        seam: bool,
        growth: &mut G,
        sink: &mut S,
    ) -> ControlFlow<(), u32> {
        self.row = row as u16;
        let mut above = previous;
        let mut next = above.next();
        let mut unlabelled = 0;
        let mut found = 0;
        for run in current {
            growth.begin(&run);
            while next.as_ref().is_some_and(|a| a.end <= run.start) {
                next = above.next();
                self.drop_run(sink)?;
            }
            let mut slot =
                if G::TAKES_ALL { NONE } else { self.choose(next.iter().cloned().chain(above.clone()), &run, growth) };
            self.refer(slot);
            while let Some(a) = next.as_ref().filter(|a| a.start < run.end) {
                let more = a.end > run.end;
                let root = self.root(self.entry(0));
                if slot == NONE && G::TAKES_ALL && root != NONE {
                    slot = root;
                    self.refer(slot);
                } else if slot != NONE && root != slot && root != NONE && growth.joins(self.get(slot), self.get(root)) {
                    self.join(slot, root, sink)?;
                }
                if more {
                    break;
                }
                next = above.next();
                self.drop_run(sink)?;
            }
            if slot == NONE {
                slot = self.begin(&run);
            }
            if slot == NONE {
                unlabelled += run.len() as u32;
            } else {
                let (moments, exact) = (growth.moments(run.clone()), self.exact_points);
                if let Some(area) = self.area(slot) {
                    area.reach(&run);
                    area.add(&moments, exact);
                }
            }
            self.push_run(slot);
            found += 1;
        }
        while next.is_some() {
            next = above.next();
            self.drop_run(sink)?;
        }
        if seam && found > 1 {
            self.join_across_seam(found, growth, sink)?;
        }
        self.settle();
        ControlFlow::Continue(unlabelled)
    }

    /// Joins the areas of the first and of the last of `found` runs, if they are one.
    fn join_across_seam<S: Sink + ?Sized, G: Growth>(
        &mut self,
        found: usize,
        growth: &mut G,
        sink: &mut S,
    ) -> ControlFlow<()> {
        let (first, last) = (self.root(self.entry(0)), self.root(self.entry(found - 1)));
        if first != last && first != NONE && last != NONE && growth.meets(self.get(first), self.get(last)) {
            self.join(first, last, sink)?;
        }
        ControlFlow::Continue(())
    }

    /// Ends the scan: every area left is complete.
    pub fn finish<S: Sink + ?Sized>(&mut self, sink: &mut S) -> ControlFlow<()> {
        self.row = self.row.wrapping_add(1);
        while self.len > 0 {
            self.drop_run(sink)?;
        }
        ControlFlow::Continue(())
    }

    /// The slot of the area that gets a run, of those that touch it; `NONE` if none takes it.
    fn choose(
        &mut self,
        above: impl Iterator<Item = Range<usize>>,
        run: &Range<usize>,
        growth: &mut impl Growth,
    ) -> u16 {
        let (mut best, mut how_well) = (NONE, 0);
        for (i, _) in above.take_while(|a| a.start < run.end).enumerate() {
            let root = self.root(self.entry(i));
            if root == NONE || root == best {
                continue;
            }
            if let Some(well) = growth.takes(self.get(root)).filter(|&well| best == NONE || well > how_well) {
                (best, how_well) = (root, well);
            }
        }
        best
    }

    /// A new area that begins with `run`; `NONE` if the table is full.
    fn begin(&mut self, run: &Range<usize>) -> u16 {
        let slot = self.free;
        let Some(area) = self.table.get_mut(usize::from(slot)) else { return NONE };
        self.free = area.label as u16;
        *area = Area { frontier: 1, ..Area::begin(self.next_label, self.row, run.start as u16, slot) };
        self.next_label += 1;
        slot
    }

    /// Joins the area of slot `gone` into that of slot `kept`, whose run of this row is to the
    /// left. The smaller label stays.
    fn join<S: Sink + ?Sized>(&mut self, kept: u16, gone: u16, sink: &mut S) -> ControlFlow<()> {
        let exact = self.exact_points;
        let Some(area) = self.area(gone) else { return ControlFlow::Continue(()) };
        area.link = kept;
        let other = *area;
        let Some(area) = self.area(kept) else { return ControlFlow::Continue(()) };
        let join = area.unite(&other);
        area.add(&other.moments(), exact);
        sink.join(join)
    }

    /// Drops the frontier's first run: nothing can touch it any more.
    fn drop_run<S: Sink + ?Sized>(&mut self, sink: &mut S) -> ControlFlow<()> {
        let slot = self.entry(0);
        self.head = ring_place(self.frontier.len(), self.head, 1);
        self.len -= 1;
        let row = self.row;
        let Some(area) = self.area(slot) else { return ControlFlow::Continue(()) };
        area.frontier = area.frontier.wrapping_sub(1);
        if area.frontier > 0 {
            return ControlFlow::Continue(());
        }
        let area = *area;
        self.release(slot);
        if area.link != slot {
            return ControlFlow::Continue(());
        }
        let sums = SegmentSums::Moments(area.moments());
        sink.segment(&area.segment(row.wrapping_sub(1), sums))
    }

    /// After a row: every run refers to the root of its area, and slots that were links are free.
    fn settle(&mut self) {
        for i in 0..self.len {
            let slot = self.entry(i);
            let root = self.root(slot);
            if root != slot {
                self.set_entry(i, root);
                self.refer(root);
                let Some(area) = self.area(slot) else { continue };
                area.frontier = area.frontier.wrapping_sub(1);
                // its link stays readable until the slot is taken again, which no settling does
                if area.frontier == 0 {
                    self.release(slot);
                }
            }
        }
    }

    fn release(&mut self, slot: u16) {
        let free = self.free;
        if let Some(area) = self.area(slot) {
            area.label = u32::from(free);
            self.free = slot;
        }
    }

    /// The slot that holds the area of `slot`. Halves the path as it goes.
    fn root(&mut self, mut slot: u16) -> u16 {
        while slot != NONE {
            let link = self.get(slot).link;
            if link == slot {
                break;
            }
            let beyond = self.get(link).link;
            if let Some(area) = self.area(slot) {
                area.link = beyond;
            }
            slot = beyond;
        }
        slot
    }

    fn get(&self, slot: u16) -> &Area {
        self.table.get(usize::from(slot)).unwrap_or(&Area::EMPTY)
    }

    /// The area of a slot; none for [`NONE`].
    fn area(&mut self, slot: u16) -> Option<&mut Area> {
        self.table.get_mut(usize::from(slot))
    }

    /// One more run of the frontier refers to a slot, unless it is [`NONE`].
    fn refer(&mut self, slot: u16) {
        if let Some(area) = self.area(slot) {
            area.frontier += 1;
        }
    }

    /// The slots of the runs of the frontier.
    fn slots(&self) -> RunSlots<'_> {
        RunSlots { words: self.frontier, head: self.head }
    }

    /// Slot of the `index`-th run of the frontier.
    fn entry(&self, index: usize) -> u16 {
        self.slots().of_run(index)
    }

    fn set_entry(&mut self, index: usize, slot: u16) {
        let place = ring_place(self.frontier.len(), self.head, index);
        set_ring_slot(self.frontier, place, slot);
    }

    fn push_run(&mut self, slot: u16) {
        self.set_entry(self.len, slot);
        self.len += 1;
    }
}
