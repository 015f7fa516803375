//! Pieces of one surface on both sides of what hides the rest of it. They are looked for with a
//! budget of work for each row: the search goes on where the row before has left it.

use core::ops::ControlFlow;

use crate::arithmetic::dot;
use crate::arithmetic::less;
use crate::plane::areas::Areas;
use crate::plane::rules::{BRIDGE_TRY, SURE};
use crate::plane::work::count;
use crate::sink::Sink;
use crate::weighted::fitted::Fitted;
use crate::weighted::sums::Factor;

/// An area whose other pieces are looked for.
struct Piece {
    points: u32,
    /// Squares that it may have at most in all, near a plane.
    near: f32,
    fitted: Fitted,
    factor: Factor,
}

impl Areas<'_> {
    /// Joins areas to others on the same plane, across what hides the rest, as far as the budget
    /// goes: one unit for each pair that is looked at, and some more for each that is tried.
    pub fn bridge<S: Sink + ?Sized>(&mut self, mut budget: u32, sink: &mut S) -> ControlFlow<()> {
        let used = self.used();
        // no area is looked at twice
        let mut left = u32::from(used);
        while budget > 0 && left > 0 {
            let [slot, from] = self.bridge;
            if !self.is_due_for_bridges(slot) {
                self.bridge = [if slot + 1 < used { slot + 1 } else { 0 }, 0];
                left -= 1;
                count(1);
                continue;
            }
            if let Some(kept) = self.bridge_from(slot, from, &mut budget, sink)? {
                // it has grown, and begins again
                self.bridge = [kept, 0];
            } else if self.bridge[1] >= used {
                let mut marks = self.marks(slot);
                marks.bridged = self.magnitude(slot);
                self.set_marks(slot, &marks);
                self.bridge = [if slot + 1 < used { slot + 1 } else { 0 }, 0];
                left -= 1;
            }
        }
        ControlFlow::Continue(())
    }

    /// Logarithm of the points of an area.
    fn magnitude(&self, slot: u16) -> u8 {
        self.get(slot).points.checked_ilog2().unwrap_or(0) as u8
    }

    /// Whether an area is large enough to have other pieces.
    fn may_bridge(&self, slot: u16) -> bool {
        self.is_root(slot) && self.get(slot).points >= self.rules.gap_points
    }

    /// Whether an area has doubled since its other pieces were last looked for.
    fn is_due_for_bridges(&self, slot: u16) -> bool {
        slot < self.used()
            && self.may_bridge(slot)
            && self.has_plane(slot)
            && self.magnitude(slot) > self.marks(slot).bridged
    }

    /// Looks for another piece of an area among the slots from one on, as far as the budget goes.
    /// Gives the slot of both if they have joined.
    fn bridge_from<S: Sink + ?Sized>(
        &mut self,
        slot: u16,
        from: u16,
        budget: &mut u32,
        sink: &mut S,
    ) -> ControlFlow<(), Option<u16>> {
        let fitted = self.fitted(slot);
        let factor = fitted.sums.factor(1e-3);
        let near = self.rules.chance + (1.0 + self.rules.bent) * self.measurements(slot);
        let piece = Piece { points: self.get(slot).points, near, fitted, factor };
        for other in from..self.used() {
            if *budget == 0 {
                self.bridge = [slot, other];
                return ControlFlow::Continue(None);
            }
            *budget -= 1;
            count(1);
            if other == slot || !self.may_bridge(other) || !self.may_meet(&piece, other) {
                continue;
            }
            *budget = budget.saturating_sub(BRIDGE_TRY);
            if self.hidden(slot, other)
                && let Some(common) = self.common(slot, other)
            {
                return ControlFlow::Continue(Some(self.join(slot, other, &common, sink)?));
            }
        }
        self.bridge = [slot, self.used()];
        ControlFlow::Continue(None)
    }

    /// Whether the middle of another area is near enough to the plane of a piece for a common plane
    /// to be possible: quick, and never wrongly no.
    fn may_meet(&self, piece: &Piece, other: u16) -> bool {
        let rules = self.rules;
        // not called, as `Areas::fitted` is: of this only some numbers are read
        count(10);
        let candidate = self.get(other).fitted();
        let small = self.share * self.get(other).points.min(piece.points) as f32;
        let wobble = if self.turn_rad2 > 0.0 { rules.most_wobble } else { 0.0 };
        let (by_chance, near) = (rules.chance + (rules.uneven + wobble) * small, piece.near);
        let limit = if by_chance > near { by_chance } else { near };
        let u = candidate.sums.c;
        let e = dot(u, piece.fitted.m) - dot(u, candidate.m);
        let variance = 1.0 / candidate.sums.w + piece.factor.variance(less(u, piece.fitted.sums.c));
        e * e <= limit * SURE * variance
    }
}
