//! Which areas are one surface: lines join areas, neighbours join, pieces join across gaps, bent
//! surfaces join.
//!
//! Two areas, or a line and an area, are one surface if their common plane fits both within the
//! noise ([`Fit`]):
//!
//! - the squares that a common plane adds to those of the two planes are no more than chance
//!   brings, or
//! - each of the two lies so near to the common plane that noise alone would explain it. That is
//!   what scanners need that have less noise than they are said to have, but bend their ranges.
//!
//! Pieces of a surface need not touch: what is hidden in between does not matter.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::{ControlFlow, Range};

use crate::arithmetic::dot;
use crate::moments::Moments;
use crate::plane::fit::{Fit, mean_square_range_m2};
use crate::plane::noise::Noise;
use crate::plane::rules::{REMEMBERED_PAIRS, TRIED_AREAS};
use crate::plane::scanline::Scanline;
use crate::plane::surface::{FREE, FULL, LIVE, Surfaces};
use crate::row::bits::{CHUNK, load, mask, pack};
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part, put};
use crate::sink::Sink;

impl Surfaces<'_> {
    /// How badly a line fits an area; `None` if it does not. `chi_square` is the line's own.
    pub fn takes(&self, slot: u16, line: &Moments, chi_square: f64, noise: &Noise) -> Option<f64> {
        let area = self.get(slot).moments();
        let mut both = area;
        both.merge(line);
        let fit = Fit::of(&both)?;
        let points = f64::from(line.points);
        let added = (fit.relative_squares - self.relative_squares(slot)) * mean_square_range_m2(line) / noise.range_m2;
        let slack = self.rules.uneven * f64::from(area.points).min(4.0 * points)
            + noise.wobble(&fit, line, self.rules) * points;
        (added < points.max(chi_square + self.rules.chance) + slack).then_some(added - chi_square)
    }

    /// Whether two areas are one surface; then its plane.
    fn common(&self, one: u16, other: u16, noise: &Noise) -> Option<Fit> {
        let parts = [one, other].map(|slot| (self.get(slot).moments(), self.relative_squares(slot)));
        let mut both = parts[0].0;
        both.merge(&parts[1].0);
        let fit = Fit::of(&both)?;
        let small = if parts[0].0.points < parts[1].0.points { &parts[0].0 } else { &parts[1].0 };
        let per_noise = |part: &Moments| mean_square_range_m2(part) / noise.range_m2;
        let added = (fit.relative_squares - parts[0].1 - parts[1].1) * per_noise(small);
        let by_chance = added
            < self.rules.chance + (self.rules.uneven + noise.wobble(&fit, small, self.rules)) * f64::from(small.points);
        let near = |part: &Moments| {
            fit.relative_squares_of(part) * per_noise(part)
                < (1.0 + self.rules.bent + noise.wobble(&fit, part, self.rules)) * f64::from(part.points)
        };
        (by_chance || parts.iter().all(|(part, _)| near(part))).then_some(fit)
    }

    /// Whether two large areas meet at a small angle, and without a step. `inverse_m` gives the
    /// inverse of the range at which a plane is seen where they meet.
    pub fn bends(&self, one: u16, other: u16, noise: &Noise, inverse_m: impl Fn([f32; 3]) -> f32) -> Option<Fit> {
        let large =
            |slot: u16| self.size(slot).0 >= self.rules.bend_rows && self.get(slot).points >= self.rules.bend_points;
        let (a, b) = (self.plane(one)?, self.plane(other)?);
        let (aligned, squares) = (dot(a, b), dot(a, a) * dot(b, b));
        let (near, far) = (inverse_m(a), inverse_m(b));
        // 1 / far - 1 / near, without a division
        let step = (near - far) * (near - far);
        let least = self.rules.bend_step * noise.range_m2 as f32 * near * near * far * far;
        let bends = large(one)
            && large(other)
            && aligned > 0.0
            && aligned * aligned > self.rules.bend_cos_square * squares
            && step < least;
        let mut both = self.get(one).moments();
        both.merge(&self.get(other).moments());
        bends.then(|| Fit::of(&both)).flatten()
    }

    /// Joins two areas if they are one surface.
    pub fn try_join<S: Sink + ?Sized>(
        &mut self,
        one: u16,
        other: u16,
        noise: &Noise,
        sink: &mut S,
    ) -> ControlFlow<(), bool> {
        let Some(fit) = self.common(one, other, noise) else { return ControlFlow::Continue(false) };
        self.join(one, other, &fit, sink)?;
        ControlFlow::Continue(true)
    }

    /// Joins areas of this row to all others on the same plane, each time that they have twice the
    /// points.
    pub fn bridge<S: Sink + ?Sized>(&mut self, noise: &Noise, sink: &mut S) -> ControlFlow<()> {
        let slots = self.table().len() as u16;
        for slot in 0..slots {
            let (state, points) = (self.state(slot), self.get(slot).points);
            let due = state >= LIVE
                && self.is_root(slot)
                && self.last_row(slot) == self.row
                && self.get(slot).first_row < self.row
                && points >= self.rules.gap_points
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
                    && self.get(other).points >= self.rules.gap_points;
                if candidate && self.try_join(slot, other, noise, sink)? {
                    slot = self.root(slot);
                }
            }
        }
        ControlFlow::Continue(())
    }
}

/// The area that a line belongs to: of those above it the one that it fits best for each pixel that
/// touches, or a new one.
pub(crate) fn area_for(
    surfaces: &mut Surfaces,
    above: &[u16],
    line: &Range<usize>,
    moments: &Moments,
    chi_square: f64,
    noise: &Noise,
) -> u16 {
    let near = line.start.saturating_sub(1)..above.len().min(line.end + 1);
    let mut tried = [(NONE, 0u32); TRIED_AREAS];
    let mut count = 0;
    for run in equal_runs(part(above, near.clone())) {
        let slot = at(above, near.start + run.start);
        if slot >= FULL {
            continue;
        }
        match tried.iter_mut().take(count).find(|tried| tried.0 == slot) {
            Some(known) => known.1 += run.len() as u32,
            None if count < TRIED_AREAS => {
                tried[count] = (slot, run.len() as u32);
                count += 1;
            }
            None => {}
        }
    }
    let mut best = (f64::MAX, NONE);
    for &(slot, touching) in tried.iter().take(count) {
        if touching < 2 && line.len() > 3 {
            continue;
        }
        if let Some(badly) = surfaces.takes(slot, moments, chi_square, noise) {
            let badly = badly / f64::from(touching);
            if badly < best.0 {
                best = (badly, slot);
            }
        }
    }
    match best.1 {
        NONE => surfaces.begin(line, moments, chi_square, noise),
        slot => {
            surfaces.extend(slot, line, moments);
            slot
        }
    }
}

/// Joins areas that are neighbours in this row, or from this row to the one above, and have a
/// common plane.
pub(crate) fn join_neighbours<S: Sink + ?Sized>(
    surfaces: &mut Surfaces,
    line: &Scanline,
    above: &[u16],
    slots: &[u16],
    noise: &Noise,
    sink: &mut S,
) -> ControlFlow<()> {
    let mut done = [(NONE, NONE); REMEMBERED_PAIRS];
    let mut next = 0;
    let columns = slots.len();
    for from in (0..columns).step_by(CHUNK) {
        // columns whose neighbour to the right or above is of another area
        let [here, up, right] =
            [(slots, from), (above, from), (slots, from + 1)].map(|(row, from)| *load(row, from, &mut [NONE; CHUNK]));
        let mut differ: [bool; CHUNK] = core::array::from_fn(|i| (here[i] != up[i]) | (here[i] != right[i]));
        // the neighbour may be in the next chunk, or across the seam
        put(&mut differ, CHUNK.min(columns - from) - 1, true);
        let mut bits = pack(&differ) & mask(from / CHUNK, columns);
        while bits != 0 {
            let column = from + bits.trailing_zeros() as usize;
            bits &= bits - 1;
            let slot = at(slots, column);
            if slot >= FULL {
                continue;
            }
            let beside = |ahead: usize| match column + ahead {
                c if c < columns => at(slots, c),
                c if line.wraps => at(slots, c - columns),
                _ => NONE,
            };
            let right = if beside(1) < FULL { beside(1) } else { beside(2) };
            for other in [right, at(above, column)] {
                if other >= FULL || other == slot {
                    continue;
                }
                let pair = (slot.min(other), slot.max(other));
                if done.contains(&pair) {
                    continue;
                }
                done[next % REMEMBERED_PAIRS] = pair;
                next += 1;
                let (one, other) = (surfaces.root(slot), surfaces.root(other));
                join_pair(surfaces, one, other, line, column, noise, sink)?;
            }
        }
    }
    ControlFlow::Continue(())
}

/// Joins two neighbours that meet in a column, if they are one surface.
fn join_pair<S: Sink + ?Sized>(
    surfaces: &mut Surfaces,
    one: u16,
    other: u16,
    line: &Scanline,
    column: usize,
    noise: &Noise,
    sink: &mut S,
) -> ControlFlow<()> {
    let rows = surfaces.rules.neighbour_rows;
    if one == other || surfaces.size(one).0 < rows || surfaces.size(other).0 < rows {
        return ControlFlow::Continue(());
    }
    if surfaces.try_join(one, other, noise, sink)? {
        return ControlFlow::Continue(());
    }
    match surfaces.bends(one, other, noise, |plane| line.inverse_m(column, plane)) {
        Some(fit) => surfaces.join(one, other, &fit, sink),
        None => ControlFlow::Continue(()),
    }
}

/// The logarithm of a number of points, rounded down.
fn log2(points: u32) -> u16 {
    points.checked_ilog2().unwrap_or(0) as u16
}
