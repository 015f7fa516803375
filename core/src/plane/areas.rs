//! The table of areas.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::area::Area;
use crate::moments::Moments;
use crate::plane::rules::Rules;
use crate::row::slots::NONE;
use crate::row::within::{at, put};
use crate::segment::{Join, Label, Segment};
use crate::sink::Sink;
use crate::sums::{Errors, Fitted, Sums};
use core::ops::{ControlFlow, Range};

/// Pairs of neighbours that are remembered, of an image of `columns` columns.
pub(crate) const fn tried_pairs(columns: usize) -> usize {
    columns / 4 + 16
}

pub(crate) const FULL: u16 = u16::MAX - 1;

const FREE: u8 = 0;
const ENDED: u8 = 1;
const LIVE: u8 = 2;

/// An area: what the default keeps in an element of the table.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Patch {
    pub(crate) fitted: Fitted,
    pub(crate) points: u32,
    pub(crate) label: u32,
    pub(crate) first_row: u16,
    pub(crate) last_row: u16,
    pub(crate) first_column: u16,
    pub(crate) last_column: u16,
    /// Itself, or the slot that it was joined into; of a free one the next free one.
    pub(crate) link: u16,
    /// The last row above which a column still carries it.
    seen: u16,
    /// Border pixels beyond which something is nearer, or farther.
    /// Beyond the top, bottom, left and right border.
    pub(crate) beyond: [[u8; 2]; 4],
    pub(crate) state: u8,
    /// Logarithm of the points when its bridges were last looked for.
    pub(crate) bridged: u8,
}

/// The areas of a scan.
pub(crate) struct Areas<'a> {
    table: &'a mut [Area],
    next_label: u32,
    free: u16,
    /// Slots from here on were never used.
    fresh: u16,
    /// Where the search for an ended area goes on.
    hand: u16,
    joined: bool,
    /// A running number of the changes.
    pub row: u16,
    pub rules: &'a Rules,
    /// What the queue of bridges is at: the area, and the next other one.
    pub bridge: [u16; 2],
    pub turn_rad2: f32,
    /// The last seam that was found, rad.
    pub seam_rad: Option<f32>,
    pub axis: [f32; 3],
    /// Pairs that were tried, at their sizes then: what has not grown is not tried again.
    tried: &'a mut [u32],
}

impl<'a> Areas<'a> {
    pub fn new(table: &'a mut [Area], tried: &'a mut [u32], rules: &'a Rules) -> Self {
        let mut areas = Self {
            table,
            next_label: 1,
            free: NONE,
            fresh: 0,
            hand: 0,
            joined: false,
            row: 0,
            rules,
            bridge: [0, 0],
            turn_rad2: 0.0,
            seam_rad: None,
            axis: [0.0; 3],
            tried,
        };
        areas.reset();
        areas
    }

    pub fn reset(&mut self) {
        self.table.fill(Area::EMPTY);
        (self.next_label, self.free, self.fresh, self.hand, self.row) = (1, NONE, 0, 0, 0);
        (self.joined, self.bridge) = (false, [0, 0]);
        self.tried.fill(0);
    }

    pub fn table(&self) -> &[Area] {
        self.table
    }

    /// Slots in use are below.
    pub fn used(&self) -> u16 {
        self.fresh
    }

    #[inline]
    pub fn get(&self, slot: u16) -> Patch {
        Patch::load(self.table.get(usize::from(slot)).unwrap_or(&Area::EMPTY))
    }

    /// Changes an area.
    #[inline]
    pub fn edit(&mut self, slot: u16, change: impl FnOnce(&mut Patch)) {
        if let Some(area) = self.table.get_mut(usize::from(slot)) {
            let mut patch = Patch::load(area);
            change(&mut patch);
            patch.store(area);
        }
    }

    /// The plane of a slot if it is known well enough to be followed.
    #[inline]
    pub fn plane(&self, slot: u16) -> Option<[f32; 3]> {
        let area = Patch::load(self.table.get(usize::from(slot))?);
        let smooth = area.fitted.squares <= self.rules.rough * area.points as f32 + 60.0;
        (area.last_row > area.first_row && smooth).then_some(area.fitted.m)
    }

    pub fn size(&self, slot: u16) -> (u16, u32) {
        let area = self.get(slot);
        (area.last_row - area.first_row + 1, area.points)
    }

    pub fn root(&self, mut slot: u16) -> u16 {
        while let Some(area) = self.table.get(usize::from(slot)).filter(|area| area.link != slot) {
            slot = area.link;
        }
        slot
    }

    /// Adds a run of this row to an area, with errors against the area's plane.
    pub fn extend(&mut self, slot: u16, run: &Range<usize>, sums: &Sums, errors: &Errors, points: u32) {
        let row = self.row;
        self.edit(slot, |area| {
            if points > 0 {
                area.fitted.extend(sums, errors);
                area.points = area.points.saturating_add(points);
            }
            area.take(run, row);
        });
    }

    /// Adds a line to an area above it: `common` is the plane of both.
    pub fn take(&mut self, slot: u16, run: &Range<usize>, common: &Fitted, points: u32) {
        let row = self.row;
        self.edit(slot, |area| {
            area.fitted = *common;
            area.points = area.points.saturating_add(points);
            area.take(run, row);
        });
    }

    /// A new area from a line; [`FULL`] if there is no room.
    pub fn begin(&mut self, run: &Range<usize>, line: &Fitted, points: u32) -> u16 {
        let slot = self.vacant();
        let Some(area) = self.table.get_mut(usize::from(slot)) else { return FULL };
        let patch = Patch {
            fitted: *line,
            points,
            label: self.next_label,
            first_row: self.row,
            last_row: self.row,
            first_column: run.start as u16,
            last_column: run.end as u16 - 1,
            link: slot,
            seen: self.row,
            state: LIVE,
            ..Patch::default()
        };
        patch.store(area);
        self.next_label = self.next_label.wrapping_add(1);
        slot
    }

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
        // the smallest of the next ended ones
        let mut best = (u32::MAX, FULL);
        let mut looked = 0;
        for _ in 0..self.fresh.min(64) {
            self.hand = if self.hand + 1 < self.fresh { self.hand + 1 } else { 0 };
            let area = self.get(self.hand);
            if area.state == ENDED {
                if area.points < best.0 {
                    best = (area.points, self.hand);
                }
                looked += 1;
                if looked == 8 {
                    break;
                }
            }
        }
        best.1
    }

    /// Whether a pair has grown since it was tried last; it is now.
    pub fn is_due(&mut self, one: u16, other: u16) -> bool {
        let (one, other) = if one < other { (one, other) } else { (other, one) };
        let class = |slot: u16| {
            let area = self.get(slot);
            // steps of the size by a half or a third, and the label
            (area.points as f32).to_bits() >> 22 ^ area.label << 9
        };
        let key = class(one).wrapping_mul(0x9e37_79b1) ^ class(other).wrapping_mul(0x85eb_ca77).rotate_left(13);
        let key = key | 1;
        let place = (u32::from(one).wrapping_mul(0x9e37_79b1) ^ u32::from(other).wrapping_mul(0xc2b2_ae3d)) >> 8;
        let place = place as usize % self.tried.len().max(1);
        let due = at(self.tried, place) != key;
        put(self.tried, place, key);
        due
    }

    /// Joins two areas into one with that plane; gives the slot.
    pub fn join<S: Sink + ?Sized>(
        &mut self,
        one: u16,
        other: u16,
        common: &Fitted,
        sink: &mut S,
    ) -> ControlFlow<(), u16> {
        let older = self.get(one).label < self.get(other).label;
        let (kept, gone) = if older { (one, other) } else { (other, one) };
        self.edit(gone, |area| area.link = kept);
        let other = self.get(gone);
        self.edit(kept, |area| {
            area.fitted = *common;
            area.points = area.points.saturating_add(other.points);
            area.first_row = area.first_row.min(other.first_row);
            area.last_row = area.last_row.max(other.last_row);
            area.first_column = area.first_column.min(other.first_column);
            area.last_column = area.last_column.max(other.last_column);
            for (side, other) in area.beyond.iter_mut().zip(other.beyond) {
                let sum = [0, 1].map(|i| u16::from(side[i]) + u16::from(other[i]));
                let half = sum[0] > 255 || sum[1] > 255;
                *side = sum.map(|n| if half { n / 2 } else { n } as u8);
            }
            area.seen = area.seen.max(other.seen);
            // also of two that have ended: it is reported again
            area.state = LIVE;
            area.bridged = area.bridged.max(other.bridged);
        });
        let into = self.get(kept).label;
        self.joined = true;
        sink.join(Join { from: Label(other.label), into: Label(into) })?;
        ControlFlow::Continue(kept)
    }

    /// After the joins of a row: every pixel refers to the area itself.
    pub fn settle(&mut self, rows: [&mut [u16]; 2]) {
        if core::mem::take(&mut self.joined) {
            for row in rows {
                for slot in row {
                    if *slot < FULL {
                        *slot = self.root(*slot);
                    }
                }
            }
        }
    }

    /// An area that a column carries on to the next row.
    pub fn carry(&mut self, slot: u16) {
        let row = self.row;
        self.edit(slot, |area| area.seen = row);
    }

    /// After a row: areas that no column carries are complete.
    pub fn close<S: Sink + ?Sized>(&mut self, all: bool, sink: &mut S) -> ControlFlow<()> {
        for slot in 0..self.fresh {
            let area = self.get(slot);
            if area.state == FREE {
                continue;
            }
            let mut gone = area.link != slot;
            if !gone && area.state >= LIVE && (all || area.seen != self.row) {
                self.edit(slot, |area| area.state = ENDED);
                // too small ever to be joined again
                gone = area.points < self.rules.gap_points;
                sink.segment(&area.segment())?;
            }
            if gone {
                let free = self.free;
                self.edit(slot, |area| (area.state, area.link) = (FREE, free));
                self.free = slot;
            }
        }
        ControlFlow::Continue(())
    }

    /// Squared errors that the turn angle explains, for each point at a beam u on a plane m.
    pub fn wobble(&self, u: [f32; 3], m: [f32; 3], weight_per_point: f32) -> f32 {
        if self.turn_rad2 == 0.0 {
            return 0.0;
        }
        let ([ax, ay, az], [x, y, z]) = (self.axis, u);
        let moved = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        let slope = crate::sums::dot(moved, m);
        let square = 4.0 * slope * slope * self.turn_rad2 * weight_per_point;
        if square < 9.0 { square } else { 9.0 }
    }

    /// Counts a pixel beyond a border: side 0 top, 1 bottom, 2 left, 3 right.
    pub fn border(&mut self, slot: u16, side: usize, nearer: bool) {
        self.edit(slot, |area| {
            let counters = &mut area.beyond[side % 4];
            let i = usize::from(!nearer);
            if counters[i] == 255 {
                *counters = counters.map(|n| n / 2);
            }
            counters[i] += 1;
        });
    }

    /// Whether what lies between two areas may hide the rest of one surface.
    pub fn hidden(&self, one: u16, other: u16) -> bool {
        let (a, b) = (&self.get(one), &self.get(other));
        let (mut sum, mut any) = ([0u32; 2], false);
        let both = |sum: [u32; 2], first: &Patch, side1: usize, second: &Patch, side2: usize| {
            [0, 1].map(|i| sum[i] + u32::from(first.beyond[side1][i]) + u32::from(second.beyond[side2][i]))
        };
        let (up, down) = if a.first_row <= b.first_row { (a, b) } else { (b, a) };
        if up.last_row < down.first_row {
            (sum, any) = (both(sum, up, 1, down, 0), true);
        }
        let (left, right) = if a.first_column <= b.first_column { (a, b) } else { (b, a) };
        if left.last_column < right.first_column {
            (sum, any) = (both(sum, left, 3, right, 2), true);
        }
        if !any {
            for side in 0..4 {
                sum = both(sum, a, side, b, side);
            }
        }
        16 * sum[0] >= self.rules.hidden * (sum[0] + sum[1])
    }
}

impl Patch {
    #[inline(always)]
    pub fn load(area: &Area) -> Patch {
        let (store, [last_row, seen, state]) = (area.store, area.halves);
        let number = |i: usize| f32::from_bits(store[i % 16]);
        let (near, far) = (store[14].to_le_bytes(), store[15].to_le_bytes());
        Patch {
            fitted: Fitted {
                sums: Sums {
                    w: number(0),
                    c: [number(1), number(2), number(3)],
                    s: [number(4), number(5), number(6), number(7), number(8), number(9)],
                },
                m: [number(10), number(11), number(12)],
                squares: number(13),
            },
            points: area.points,
            label: area.label,
            first_row: area.first_row,
            last_row,
            first_column: area.first_column,
            last_column: area.last_column,
            link: area.link,
            seen,
            beyond: [[near[0], near[1]], [near[2], near[3]], [far[0], far[1]], [far[2], far[3]]],
            state: state as u8,
            bridged: (state >> 8) as u8,
        }
    }

    #[inline(always)]
    pub fn store(&self, area: &mut Area) {
        let [b0, b1, b2, b3] = self.beyond;
        let bytes = |[a, b]: [u8; 2], [c, d]: [u8; 2]| u32::from_le_bytes([a, b, c, d]);
        let bits = self.fitted.numbers().map(f32::to_bits);
        area.store = core::array::from_fn(|i| match i {
            14 => bytes(b0, b1),
            15 => bytes(b2, b3),
            i => bits[i % 14],
        });
        area.points = self.points;
        area.label = self.label;
        area.halves = [self.last_row, self.seen, u16::from(self.state) | u16::from(self.bridged) << 8];
        area.first_row = self.first_row;
        area.first_column = self.first_column;
        area.last_column = self.last_column;
        area.link = self.link;
    }

    fn take(&mut self, run: &Range<usize>, row: u16) {
        self.first_column = self.first_column.min(run.start as u16);
        self.last_column = self.last_column.max(run.end as u16 - 1);
        self.last_row = row;
        self.seen = row;
    }

    fn segment(&self) -> Segment {
        Segment {
            label: Label(self.label),
            first_row: self.first_row,
            last_row: self.last_row,
            first_column: self.first_column,
            last_column: self.last_column,
            moments: Moments { points: self.points, ..Moments::default() },
            fitted: Some(self.fitted),
        }
    }
}
