//! Which lines and areas are one surface.
//!
//! A common plane adds squares to those that each has of its own plane. Lines and areas join where
//! it adds no more than chance, unevenness and the turn of the rows explain.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::{ControlFlow, Range};

use crate::arithmetic::{below, cross, dot, lone_sqrt, plus};
use crate::plane::areas::{Areas, FULL};
use crate::plane::noise::Variance;
use crate::plane::rules::{ALONE_LEAN, MEETS, MOST_RATIO, TRIED_AREAS, WIDE};
use crate::plane::tried::Grown;
use crate::plane::work::count;
use crate::row::slots::{NONE, equal_runs};
use crate::row::within::{at, part};
use crate::sink::Sink;
use crate::weighted::fitted::Fitted;
use crate::weighted::sums::Sums;

impl Areas<'_> {
    /// Squares for each point that the turn angle explains, on a plane m.
    fn wobble(&self, sums: &Sums, m: [f32; 3], points: f32) -> f32 {
        if self.turn_rad2 == 0.0 {
            return 0.0;
        }
        let slope = dot(cross(self.axis, sums.c), m);
        let square = self.rules.wobble * slope * slope * self.turn_rad2 * sums.w / points;
        if square < self.rules.most_wobble { square } else { self.rules.most_wobble }
    }

    /// A line without the turn of its row, which all of its pixels share, on a plane m. Where there is none it
    /// leans across the row by [`ALONE_LEAN`].
    fn without_turn(&self, line: &Fitted, m: Option<[f32; 3]>) -> Fitted {
        if self.turn_rad2 == 0.0 {
            return *line;
        }
        let leaning = || {
            let c = line.sums.c;
            let out = plus(c, -dot(c, self.axis), self.axis);
            let square = dot(out, out);
            let square = if square > 1e-9 { square } else { 1e-9 };
            let slope = ALONE_LEAN * lone_sqrt(dot(line.m, line.m) / square);
            out.map(|x| slope * x)
        };
        let slope = m.map_or_else(leaning, |m| cross(m, self.axis));
        Fitted { sums: line.sums.without(slope, self.turn_rad2), ..*line }
    }

    /// How badly a line fits an area, and the common plane; `None` if it does not fit.
    fn takes(&self, slot: u16, line: &Fitted, points: u32) -> Option<(f32, Fitted)> {
        // most of what is no surface is told by its range, which is quick. The mean beam of a wide
        // line, less what its pixels share, may pass its plane by or meet it behind the scanner:
        // there ranges tell nothing
        let u = line.sums.c;
        let (one, other) = (dot(u, line.m), dot(u, self.m(slot)));
        let far = one > MOST_RATIO * other || other > MOST_RATIO * one;
        let meets = || one > 0.0 && one * one > MEETS * dot(line.m, line.m);
        if far && (points < WIDE || meets()) {
            return None;
        }
        let line = &self.without_turn(line, self.has_plane(slot).then(|| self.m(slot)));
        let common = self.fitted(slot).with(line);
        let n = self.share * points as f32;
        let badly = common.one + common.other;
        let wobble = self.wobble(&line.sums, common.fitted.m, n) * n;
        let (all, most) = (self.measurements(slot), 4.0 * n);
        let few = if all < most { all } else { most };
        let chance = line.squares + self.rules.chance;
        let limit = if chance > n { chance } else { n } + self.rules.uneven * few + wobble;
        (badly + line.squares < limit).then_some((badly, common.fitted))
    }

    /// The plane of two areas if they are one surface.
    pub fn common(&self, one: u16, other: u16) -> Option<Fitted> {
        let rules = self.rules;
        // not called, as `Areas::fitted` is: at the end of a scan this is most of the work
        count(20);
        let [n1, n2] = [one, other].map(|slot| self.share * self.get(slot).points as f32);
        let (one, other) = (self.get(one).fitted(), self.get(other).fitted());
        let common = one.with(&other);
        let wobble1 = self.wobble(&one.sums, common.fitted.m, n1);
        let wobble2 = self.wobble(&other.sums, common.fitted.m, n2);
        let (small, wobble) = if n1 < n2 { (n1, wobble1) } else { (n2, wobble2) };
        // squares beyond the noise say that it is more here than it is said to be
        let own = (one.squares + other.squares) / (n1 + n2);
        let own = if below(own, 1.0) { 1.0 } else { own };
        let own = if below(own, rules.rougher) { own } else { rules.rougher };
        let by_chance = common.one + common.other < own * (rules.chance + (rules.uneven + wobble) * small);
        let near = |squares: f32, n: f32, wobble: f32| squares < (1.0 + rules.bent + wobble) * n;
        let all = near(one.squares + common.one, n1, wobble1) && near(other.squares + common.other, n2, wobble2);
        (by_chance || all).then_some(common.fitted)
    }

    /// The plane of two large areas that meet at a small angle, and without a step at the beam u: the
    /// scanner bends them.
    fn bends(&self, one: u16, other: u16, u: [f32; 3], variance: &Variance) -> Option<Fitted> {
        let rules = self.rules;
        let large = |slot: u16| self.get(slot).points >= rules.bend_points;
        if !large(one) || !large(other) {
            return None;
        }
        let (a, b) = (self.plane(one)?, self.plane(other)?);
        let (aligned, squares) = (dot(a, b), dot(a, a) * dot(b, b));
        let (near, far) = (dot(a, u), dot(b, u));
        // 10 km
        if near <= 1e-4 {
            return None;
        }
        let step = (near - far) * (near - far);
        let least = rules.bend_step * variance.lone_at(1.0 / near) * near * near * far * far;
        let bends = aligned > 0.0 && aligned * aligned > rules.bend_cos_square * squares && step < least;
        bends.then(|| self.fitted(one).with(&self.fitted(other)).fitted)
    }

    /// The turn between two large areas that are one but for it, radians, and their plane in the
    /// place of the later one: the servo went on by more or less than was reported.
    fn seam(&self, one: u16, later: u16) -> Option<(f32, Fitted)> {
        let rules = self.rules;
        let large = |slot: u16| {
            let area = self.get(slot);
            let wide = area.last_column.saturating_sub(area.first_column) >= rules.seam_columns;
            wide && self.size(slot).0 >= rules.seam_rows
        };
        if self.axis == [0.0; 3] || !large(one) || !large(later) {
            return None;
        }
        let small = self.measurements(one).min(self.measurements(later));
        let (one, later) = (self.fitted(one), self.fitted(later));
        let (turn_rad, common, added) = one.with_off(&later, cross(self.axis, later.m));
        let explained = turn_rad.abs() < rules.seam_rad && added < rules.chance + rules.seam_uneven * small;
        explained.then_some((turn_rad, common))
    }

    /// Joins two neighbours that have a plane each, if they are one surface; u is the beam where
    /// they meet, `other` the earlier one.
    pub fn join_neighbour<S: Sink + ?Sized>(
        &mut self,
        one: u16,
        other: u16,
        u: [f32; 3],
        variance: &Variance,
        sink: &mut S,
    ) -> ControlFlow<()> {
        let common = self.common(one, other).or_else(|| self.bends(one, other, u, variance));
        let common = common.or_else(|| {
            let (turn_rad, common) = self.seam(other, one)?;
            self.seam_rad = Some(turn_rad);
            Some(common)
        });
        if let Some(common) = common {
            self.join(one, other, &common, sink)?;
        }
        ControlFlow::Continue(())
    }

    /// Whether a pair has grown since it was tried last; it is tried now.
    pub fn is_due(&mut self, one: u16, other: u16) -> bool {
        let [one, other] = [one, other].map(|slot| {
            let area = self.get(slot);
            Grown { slot, label: area.label, points: area.points }
        });
        self.tried.is_due(one, other)
    }

    /// The area that a line belongs to: of those above it the one that it fits best for each pixel
    /// that touches, or a new one; [`FULL`] if there is no room.
    pub fn area_for(&mut self, above: &[u16], run: &Range<usize>, line: &Fitted, points: u32) -> u16 {
        let (touched, count) = touched(above, run);
        let mut best: (f32, u16, Option<Fitted>) = (f32::MAX, NONE, None);
        for &(slot, touching) in touched.iter().take(count) {
            if touching < 2 && run.len() > 3 {
                continue;
            }
            let (rows, size) = self.size(slot);
            if points == 1 && size > 2 * u32::from(rows) {
                continue;
            }
            if let Some((badly, common)) = self.takes(slot, line, points) {
                let badly = badly / touching as f32;
                best = if badly < best.0 { (badly, slot, Some(common)) } else { best };
            }
        }
        match best {
            (_, slot, Some(common)) => {
                self.extend(slot, run, &common, points);
                slot
            }
            _ => self.begin(run, &self.without_turn(line, None), points),
        }
    }
}

/// The first few areas that a run touches from below, each with the pixels that do.
fn touched(above: &[u16], run: &Range<usize>) -> ([(u16, u32); TRIED_AREAS], usize) {
    let near = run.start.saturating_sub(1)..above.len().min(run.end + 1);
    let (mut touched, mut count) = ([(NONE, 0u32); TRIED_AREAS], 0);
    for same in equal_runs(part(above, near.clone())) {
        let slot = at(above, near.start + same.start);
        if slot >= FULL {
            continue;
        }
        let pixels = same.len() as u32;
        match touched.iter_mut().take(count).find(|known| known.0 == slot) {
            Some(known) => known.1 += pixels,
            None => {
                if let Some(next) = touched.get_mut(count) {
                    *next = (slot, pixels);
                    count += 1;
                }
            }
        }
    }
    (touched, count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area::Area;
    use crate::config::Ranging;
    use crate::plane::rules::Rules;
    use crate::plane::tried::Tried;

    /// Points of hardly any weight, at the mean beam c, on the plane m.
    fn light(c: [f32; 3], m: [f32; 3]) -> Fitted {
        let mut numbers = [0.0; 15];
        (numbers[0], numbers[1]) = (1e-6, 1e-6);
        numbers[2..5].copy_from_slice(&c);
        numbers[11..14].copy_from_slice(&m);
        Fitted::from_numbers(numbers)
    }

    /// Whether a line that fits anywhere is not refused for its range: the plane 1 m ahead, and an
    /// area on one `ratio` times as far. `cos`: of the incidence of its mean beam.
    fn takes(cos: f32, ratio: f32, points: u32) -> bool {
        let (mut table, mut pairs) = ([Area::EMPTY; 2], [0; 16]);
        let mut areas = Areas::new(&mut table, Tried::new(&mut pairs), [0.0; 3], &Rules::TUNED, false);
        areas.reset();
        let c = [cos, (1.0 - cos * cos).sqrt(), 0.0];
        let slot = areas.begin(&(0..20), &light(c, [1.0 / ratio, 0.0, 0.0]), 20);
        areas.takes(slot, &light(c, [1.0, 0.0, 0.0]), points).is_some()
    }

    /// A line at more than 1.5 times the range of an area, or an area at more than 1.5 times that of
    /// a line, is another surface. Of 8 pixels on that counts only where the range is told: up to 84
    /// deg of incidence.
    #[test]
    fn lines_of_another_range() {
        assert_eq!([1.45, 1.55, 1.0 / 1.45, 1.0 / 1.55].map(|ratio| takes(1.0, ratio, 1)), [true, false, true, false]);
        assert_eq!([7, 8].map(|points| takes(0.05, 2.0, points)), [false, true]);
        assert_eq!([0.09, 0.11, -0.5].map(|cos| takes(cos, 2.0, 8)), [true, false, true]);
    }

    /// Two walls of 1000 points one behind the other, 4 m and 4.3 m away, are one that the scanner
    /// bends where 30 cm are less than 2.4 standard deviations of the noise at 4 m.
    #[test]
    fn a_step_at_the_noise_of_its_range() {
        let bends = |per_m2: f32, points: u32| {
            let (mut table, mut pairs) = ([Area::EMPTY; 2], [0; 16]);
            let mut areas = Areas::new(&mut table, Tried::new(&mut pairs), [0.0; 3], &Rules::TUNED, false);
            areas.reset();
            let walls = [4.0, 4.3].map(|range_m| {
                let wall = light([1.0, 0.0, 0.0], [1.0 / range_m, 0.0, 0.0]);
                let slot = areas.begin(&(0..50), &wall, points / 2);
                areas.row += 1;
                areas.extend(slot, &(0..50), &wall, points - points / 2);
                slot
            });
            let variance = Variance::stated(&Ranging::new(0.0).with_growing_noise(0.0, per_m2), 0.0015);
            areas.bends(walls[0], walls[1], [1.0, 0.0, 0.0], &variance).is_some()
        };
        assert_eq!([bends(0.01, 1000), bends(0.006, 1000), bends(0.01, 999)], [true, false, false]);
    }

    /// Walls of 400 pixels side by side, 4 m away and `step_m` farther, each with `rough` of the noise of 10 mm as its
    /// squares, join where the step is within the noise that they tell themselves: at most four times the variance.
    #[test]
    fn a_step_within_what_walls_are_rough_by() {
        let joins = |rough: f32, step_m: f32| {
            let (mut table, mut pairs) = ([Area::EMPTY; 2], [0; 16]);
            let mut areas = Areas::new(&mut table, Tried::new(&mut pairs), [0.0; 3], &Rules::TUNED, false);
            areas.reset();
            let [one, other] = [(-0.2, 4.0), (0.2, 4.0 + step_m)].map(|(y, range_m): (f32, f32)| {
                let w = 400.0 * 256.0 / 1e-4;
                let scatter = 0.01 * w;
                let sums = [w, w, (1.0 - y * y).sqrt(), y, 0.0, 0.0, scatter, scatter, 0.0, 0.0, 0.0];
                let mut numbers = [0.0; 15];
                numbers[..11].copy_from_slice(&sums);
                (numbers[11], numbers[14]) = (1.0 / range_m, 400.0 * rough);
                areas.begin(&(0..400), &Fitted::from_numbers(numbers), 400)
            });
            areas.common(one, other).is_some()
        };
        let most_mm = |rough: f32| (1..50).take_while(|&mm| joins(rough, 1e-3 * mm as f32)).last();
        assert_eq!([1.0, 2.0, 4.0, 20.0].map(most_mm), [14, 17, 25, 25].map(Some));
    }
}
