//! Which lines and areas are one surface.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane::areas::{Areas, FULL};
use crate::plane::row::{Cached, RowView};
use crate::row::bits::{CHUNK, load, mask, pack};
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part, put};
use crate::sink::Sink;
use crate::sums::{Fitted, dot, less};
use core::ops::{ControlFlow, Range};

/// Areas above a line that are tried.
const TRIED: usize = 8;
/// Pairs of neighbours that were tried last.
const PAIRS: usize = 8;

impl Areas<'_> {
    /// How badly a line fits an area, and the common plane; `None` if it does not fit.
    pub fn takes(&self, slot: u16, line: &Fitted, points: u32) -> Option<(f32, Fitted)> {
        let area = self.get(slot);
        let (common, a, b) = area.fitted.with(line);
        let n = points as f32;
        let added = a + b;
        let wobble = self.wobble(line.sums.c, common.m, line.sums.w / n) * n;
        let few = (area.points as f32).min(4.0 * n);
        let limit = n.max(line.squares + self.rules.chance) + self.rules.uneven * few + wobble;
        (added + line.squares < limit).then_some((added, common))
    }

    /// Whether two areas are one surface; then its plane.
    pub fn common(&self, one: u16, other: u16) -> Option<Fitted> {
        let (one, other) = (self.get(one), self.get(other));
        let rules = self.rules;
        let (n1, n2) = (one.points as f32, other.points as f32);
        let (common, a, b) = one.fitted.with(&other.fitted);
        let wobble1 = self.wobble(one.fitted.sums.c, common.m, one.fitted.sums.w / n1);
        let wobble2 = self.wobble(other.fitted.sums.c, common.m, other.fitted.sums.w / n2);
        let (small, wobble) = if n1 < n2 { (n1, wobble1) } else { (n2, wobble2) };
        let by_chance = a + b < rules.chance + (rules.uneven + wobble) * small;
        let near = |squares: f32, n: f32, wobble: f32| squares < (1.0 + rules.bent + wobble) * n;
        let all = near(one.fitted.squares + a, n1, wobble1) && near(other.fitted.squares + b, n2, wobble2);
        (by_chance || all).then_some(common)
    }

    /// Whether two large areas meet at a small angle, and without a step at the beam u.
    pub fn bends(&self, one: u16, other: u16, u: [f32; 3], row: &RowView) -> Option<Fitted> {
        let large = |slot: u16| self.size(slot).0 >= 4 && self.get(slot).points >= self.rules.bend_points;
        if !large(one) || !large(other) {
            return None;
        }
        let (a, b) = (self.plane(one)?, self.plane(other)?);
        let (aligned, squares) = (dot(a, b), dot(a, a) * dot(b, b));
        let (near, far) = (dot(a, u), dot(b, u));
        let step = (near - far) * (near - far);
        let range_m = if near > 1e-4 { 1.0 / near } else { return None };
        let least = self.rules.bend_step * row.variance.at(range_m) * near * near * far * far;
        let bends = aligned > 0.0 && aligned * aligned > self.rules.bend_cos_square * squares && step < least;
        bends.then(|| self.get(one).fitted.with(&self.get(other).fitted).0)
    }

    /// Whether two large areas are one but for a turn between them that was not reported; the plane in the place of the
    /// later one.
    pub fn seam(&self, one: u16, later: u16) -> Option<(f32, Fitted)> {
        let rules = self.rules;
        let large = |slot: u16| {
            let area = self.get(slot);
            let wide = area.last_column - area.first_column >= rules.seam_columns;
            wide && self.size(slot).0 >= 3 && area.points >= rules.seam_points
        };
        if self.axis == [0.0; 3] || !large(one) || !large(later) {
            return None;
        }
        let (one, later) = (self.get(one), self.get(later));
        let ([ax, ay, az], [x, y, z]) = (self.axis, later.fitted.m);
        let by = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        let (turn_rad, common, added) = one.fitted.with_off(&later.fitted, by);
        let small = one.points.min(later.points) as f32;
        #[cfg(feature = "trace")]
        std::eprintln!(
            "seam row {} {} px + {} px turn {:.2} deg added {added:.0} without {:.0}",
            self.row,
            one.points,
            later.points,
            turn_rad.to_degrees(),
            one.fitted.with(&later.fitted).1 + one.fitted.with(&later.fitted).2
        );
        (turn_rad.abs() < rules.seam_rad && added < rules.chance + rules.seam_uneven * small)
            .then_some((turn_rad, common))
    }

    /// The area that a line belongs to: of those above it the one that it fits best for each pixel that touches, or a new
    /// one.
    pub fn area_for(&mut self, above: &[u16], run: &Range<usize>, line: &Fitted, points: u32) -> u16 {
        let near = run.start.saturating_sub(1)..above.len().min(run.end + 1);
        let mut tried = [(NONE, 0u32); TRIED];
        let mut count = 0;
        for same in equal_runs(part(above, near.clone())) {
            let slot = at(above, near.start + same.start);
            if slot >= FULL {
                continue;
            }
            match tried.iter_mut().take(count).find(|tried| tried.0 == slot) {
                Some(known) => known.1 += same.len() as u32,
                None if count < TRIED => {
                    tried[count] = (slot, same.len() as u32);
                    count += 1;
                }
                None => {}
            }
        }
        let mut best: (f32, u16, Option<Fitted>) = (f32::MAX, NONE, None);
        for &(slot, touching) in tried.iter().take(count) {
            if touching < 2 && run.len() > 3 {
                continue;
            }
            let (rows, size) = self.size(slot);
            if points == 1 && size > 2 * u32::from(rows) {
                continue;
            }
            if let Some((badly, common)) = self.takes(slot, line, points) {
                let badly = badly / touching as f32;
                if badly < best.0 {
                    best = (badly, slot, Some(common));
                }
            }
        }
        match best {
            (_, slot, Some(common)) => {
                self.take(slot, run, &common, points);
                slot
            }
            _ => self.begin(run, line, points),
        }
    }

    /// Joins two areas if they are one surface.
    pub fn try_join<S: Sink + ?Sized>(&mut self, one: u16, other: u16, sink: &mut S) -> ControlFlow<(), bool> {
        let Some(common) = self.common(one, other) else { return ControlFlow::Continue(false) };
        self.join(one, other, &common, sink)?;
        ControlFlow::Continue(true)
    }

    /// Joins areas of this row to others on the same plane, across what hides the rest.
    pub fn bridge<S: Sink + ?Sized>(&mut self, mut budget: u32, sink: &mut S) -> ControlFlow<()> {
        let used = self.used();
        let rules = self.rules;
        let mut steps = u32::from(used);
        while budget > 0 && steps > 0 {
            let [hand, from] = self.bridge;
            let area = self.get(hand);
            let size = area.points.checked_ilog2().unwrap_or(0) as u8;
            let due = hand < used
                && area.state != 0
                && area.link == hand
                && area.points >= rules.gap_points
                && area.last_row > area.first_row
                && size > area.bridged;
            if !due {
                self.bridge = [if hand + 1 < used { hand + 1 } else { 0 }, 0];
                steps -= 1;
                continue;
            }
            let fitted = area.fitted;
            let room = rules.chance + (1.0 + rules.bent) * area.points as f32;
            let factor = fitted.sums.factor(1e-3);
            let mut other = from;
            let mut joined = false;
            while other < used && budget > 0 {
                let candidate = self.get(other);
                let near = candidate.state != 0
                    && other != hand
                    && candidate.link == other
                    && candidate.points >= rules.gap_points;
                other += 1;
                budget -= 1;
                if !near {
                    continue;
                }
                let n = candidate.points.min(area.points) as f32;
                let u = candidate.fitted.sums.c;
                let e = dot(u, fitted.m) - dot(u, candidate.fitted.m);
                let limit = rules.chance + (rules.uneven + 9.0 * f32::from(u8::from(self.turn_rad2 > 0.0))) * n;
                let limit = if limit > room { limit } else { room };
                if e * e > limit * 1.1 * (1.0 / candidate.fitted.sums.w + factor.variance(less(u, fitted.sums.c))) {
                    continue;
                }
                budget = budget.saturating_sub(5);
                if !self.hidden(hand, other - 1) {
                    continue;
                }
                if let Some(common) = self.common(hand, other - 1) {
                    let kept = self.join(hand, other - 1, &common, sink)?;
                    self.bridge = [kept, 0];
                    joined = true;
                    break;
                }
            }
            if joined {
                continue;
            }
            if other >= used {
                self.edit(hand, |area| area.bridged = size);
                self.bridge = [if hand + 1 < used { hand + 1 } else { 0 }, 0];
                steps -= 1;
            } else {
                self.bridge = [hand, other];
            }
        }
        ControlFlow::Continue(())
    }
}

/// Joins areas that are neighbours in this row, or from this row to the one above, and have a common plane. Counts what is
/// beyond the borders.
pub(crate) fn join_neighbours<S: Sink + ?Sized>(
    areas: &mut Areas,
    row: &RowView,
    above: &[u16],
    slots: &[u16],
    cached: &mut Cached,
    sink: &mut S,
) -> ControlFlow<()> {
    let mut done = [(NONE, NONE); PAIRS];
    let mut next = 0;
    let columns = slots.len();
    for from in (0..columns).step_by(CHUNK) {
        let [here, up, right] =
            [(slots, from), (above, from), (slots, from + 1)].map(|(row, from)| *load(row, from, &mut [NONE; CHUNK]));
        let mut differ: [bool; CHUNK] = core::array::from_fn(|i| (here[i] != up[i]) | (here[i] != right[i]));
        put(&mut differ, CHUNK.min(columns - from) - 1, true);
        let mut bits = pack(&differ) & mask(from / CHUNK, columns);
        while bits != 0 {
            let column = from + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let slot = at(slots, column);
            let over = at(above, column);
            let wrapped = |ahead: usize| match column + ahead {
                c if c < columns => Some(c),
                c if row.wraps => Some(c - columns),
                _ => None,
            };
            let (lanes, i) = cached.at(row, column);
            let (range_m, u) = (lanes.range_m[i], row.beam(lanes.cos[i], lanes.sin[i]));
            // what is here, beyond the borders of the area above and of that to the right
            if over < FULL && over != slot && range_m > 0.0 {
                let nearer = border(areas, over, 1, u, range_m, row);
                // this one has no plane yet
                if slot < FULL
                    && areas.get(slot).first_row == areas.row
                    && let Some(nearer) = nearer
                {
                    areas.border(slot, 0, !nearer);
                }
            }
            if slot < FULL && over != slot && areas.get(slot).first_row < areas.row {
                areas_above(areas, slot, over, u, row);
            }
            let beside = wrapped(1).map_or(NONE, |c| at(slots, c));
            if beside != slot {
                if beside < FULL && range_m > 0.0 {
                    border(areas, beside, 2, u, range_m, row);
                }
                if slot < FULL
                    && let Some(c) = wrapped(1)
                {
                    let (lanes, i) = cached.at(row, c);
                    let (range_m, u) = (lanes.range_m[i], row.beam(lanes.cos[i], lanes.sin[i]));
                    if range_m > 0.0 {
                        border(areas, slot, 3, u, range_m, row);
                    }
                }
            }
            if slot >= FULL {
                continue;
            }
            let mut right = beside;
            for ahead in 2..=usize::from(row.gap_columns) + 1 {
                if right < FULL {
                    break;
                }
                right = wrapped(ahead).map_or(NONE, |c| at(slots, c));
            }
            for other in [right, over] {
                if other >= FULL || other == slot {
                    continue;
                }
                let pair = (slot.min(other), slot.max(other));
                if done.contains(&pair) {
                    continue;
                }
                done[next % PAIRS] = pair;
                next += 1;
                let (one, other) = (areas.root(slot), areas.root(other));
                if one != other && areas.size(one).0 > 1 && areas.size(other).0 > 1 && areas.is_due(one, other) {
                    if areas.try_join(one, other, sink)? {
                        continue;
                    }
                    if let Some(common) = areas.bends(one, other, u, row) {
                        areas.join(one, other, &common, sink)?;
                    } else if let Some((turn_rad, common)) = areas.seam(other, one) {
                        areas.seam_rad = Some(turn_rad);
                        areas.join(one, other, &common, sink)?;
                    }
                }
            }
        }
    }
    ControlFlow::Continue(())
}

/// Counts what is seen at range r along u beyond a border of an area; gives whether it is nearer, if either.
fn border(areas: &mut Areas, slot: u16, side: usize, u: [f32; 3], range_m: f32, row: &RowView) -> Option<bool> {
    let slot = areas.root(slot);
    let area = areas.get(slot);
    if area.last_row == area.first_row {
        return None;
    }
    let q = dot(u, area.fitted.m);
    let s = range_m * q - 1.0;
    let square = range_m * range_m * s * s;
    if square > 9.0 * row.variance.at(range_m) {
        areas.border(slot, side, s < 0.0);
        return Some(s < 0.0);
    }
    None
}

/// Counts the area above beyond the top border of an area that has a plane.
fn areas_above(areas: &mut Areas, slot: u16, over: u16, u: [f32; 3], row: &RowView) {
    if over >= FULL || areas.get(over).last_row == areas.get(over).first_row {
        return;
    }
    let (over, slot) = (areas.root(over), areas.root(slot));
    if over == slot {
        return;
    }
    let (q, above) = (dot(u, areas.get(slot).fitted.m), dot(u, areas.get(over).fitted.m));
    // as if the area above went on to here
    if above > 1e-4 && q > 1e-4 {
        let range_m = 1.0 / above;
        let s = range_m * q - 1.0;
        if range_m * range_m * s * s > 9.0 * row.variance.at(range_m) {
            areas.border(slot, 0, s < 0.0);
        }
    }
}
