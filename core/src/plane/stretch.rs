//! By what share the beam angles of a turning scanner are too small, from the runs of planes.
//!
//! Where beams lie 1 % farther apart than is said, a wall is seen bent. On a line of a row u . m =
//! 1 / r. A beam angle b that is too small by a share s of it is off by s b, and moves u . m by s b
//! (du/db . m). What another line through the run does not explain of that tells s, and s is the
//! same on every wall. It counts when walls of two directions agree on it: a bent surface tells of
//! itself alone.
//!
//! From then on the beams are where they are found to be, and the planes so far are changed to what
//! they are along those.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::{cos_sin, cross, dot, lone_inverse_sqrt, plus};
use crate::plane::areas::{Areas, FULL};
use crate::plane::rules::{
    STRETCH, STRETCH_CHANGE, STRETCH_KNOWN, STRETCH_LEAST, STRETCH_RAD, STRETCH_ROWS, STRETCH_SAMPLES,
};
use crate::plane::scanline::{Along, Cached, Scanline};
use crate::plane::work::count;
use crate::row::fan::Fan;
use crate::row::within::{at, part};
use crate::weighted::fitted::Fitted;

/// The share by which beam angles are too small.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Stretch {
    /// What walls ahead, to the left and to the right have told.
    told: [Told; 3],
    /// The share that counts.
    pub share: f32,
}

/// Shares of runs, each times its weight, which is one over its variance, and the weights.
#[derive(Clone, Copy, Debug, Default)]
struct Told {
    products: f32,
    weights: f32,
}

/// A pixel, as it is seen from the middle of its run.
#[derive(Clone, Copy)]
struct Sample {
    /// Parts of its beam along that in the middle, and across it.
    along: f32,
    across: f32,
    inverse_m: f32,
    weight: f32,
    angle_rad: f32,
}

impl Sample {
    /// Of weight 0.
    const NONE: Sample = Sample { along: 0.0, across: 0.0, inverse_m: 0.0, weight: 0.0, angle_rad: 0.0 };
}

/// The line of a run, by least squares: one over the range is `ahead` along + `aside` across.
#[derive(Clone, Copy)]
struct Line {
    ahead: f32,
    aside: f32,
    /// Weighted squares and products of along and across, and the determinant of these.
    squares: [f32; 3],
    det: f32,
}

impl Line {
    fn of(samples: &[Sample]) -> Option<Line> {
        let [mut aa, mut ab, mut bb, mut ae, mut be, mut about] = [0.0; 6];
        // differences from a line square to the first beam: nothing cancels
        for &Sample { along, across, inverse_m, weight, .. } in samples {
            about = if aa == 0.0 { inverse_m } else { about };
            let error = inverse_m - about * along;
            let (a, b) = (weight * along, weight * across);
            (aa, ab, bb) = (aa + a * along, ab + a * across, bb + b * across);
            (ae, be) = (ae + a * error, be + b * error);
        }
        let det = aa * bb - ab * ab;
        let is_line = det > 1e-6 * aa * bb;
        let (ahead, aside) = (about + (ae * bb - be * ab) / det, (be * aa - ae * ab) / det);
        is_line.then_some(Line { ahead, aside, squares: [aa, ab, bb], det })
    }

    /// The share that the rest of the run's errors tells, and its weight.
    fn share(&self, samples: &[Sample]) -> (f32, f32) {
        let Line { ahead, aside, squares: [aa, ab, bb], det } = *self;
        let [mut pp, mut pa, mut pb, mut pe, mut ee, mut count] = [0.0; 6];
        for &Sample { along, across, inverse_m, weight, angle_rad } in samples {
            let error = inverse_m - ahead * along - aside * across;
            // less what turns the line alone
            let by = aside * (angle_rad * along - across) - ahead * angle_rad * across;
            let p = weight * by;
            (pp, pa, pb) = (pp + p * by, pa + p * along, pb + p * across);
            (pe, ee) = (pe + p * error, ee + weight * error * error);
            count += if weight > 0.0 { 1.0 } else { 0.0 };
        }
        let weight = pp - (pa * pa * bb - 2.0 * pa * pb * ab + pb * pb * aa) / det;
        let share = pe / weight;
        // rougher than noise is less sure
        let rough = (ee - pe * share) / (count - 3.0);
        (share, if rough > 1.0 { weight / rough } else { weight })
    }
}

impl Told {
    /// Takes what a run tells, along beams to which the share so far is given.
    #[inline(never)] // its samples leave the stack
    fn add(&mut self, line: &Scanline, run: Range<usize>, so_far: f32, cached: &mut Cached) {
        let middle = (run.start + run.end) / 2;
        let (middle_rad, here) = (line.fan.column_rad(middle), cached.lone(line, middle));
        let mut samples = [Sample::NONE; STRETCH_SAMPLES];
        let columns = run.clone().step_by(run.len().div_ceil(STRETCH_SAMPLES).max(1));
        count(columns.len());
        for (sample, column) in samples.iter_mut().zip(columns) {
            let pixel = cached.lone(line, column);
            if pixel.range_m == 0.0 {
                continue;
            }
            let square_m2 = pixel.range_m * pixel.range_m;
            *sample = Sample {
                along: pixel.cos * here.cos + pixel.sin * here.sin,
                across: pixel.sin * here.cos - pixel.cos * here.sin,
                inverse_m: 1.0 / pixel.range_m,
                weight: square_m2 * square_m2 / (line.alike_px * line.variance.lone_at(pixel.range_m)),
                angle_rad: line.fan.column_rad(column) - middle_rad,
            };
        }
        let Some(found) = Line::of(&samples) else { return };
        let (share, weight) = found.share(&samples);
        let share = share + so_far;
        if weight * (STRETCH * STRETCH) >= 1.0 && share.abs() <= 3.0 * STRETCH {
            self.products += weight * share;
            self.weights += weight;
        }
    }
}

impl Stretch {
    /// Looks at the runs of a row. Returns how much more the share that counts is now, if it is
    /// another one.
    pub fn look_at(&mut self, line: &Scanline, areas: &Areas, slots: &[u16], cached: &mut Cached) -> Option<f32> {
        let row = usize::from(areas.row);
        let is_looked_at = row < STRETCH_ROWS || row.is_multiple_of(4);
        if !is_looked_at || !line.fan.turns() || !line.frame.plain {
            return None;
        }
        let mut start = 0;
        while start < slots.len() {
            let slot = at(slots, start);
            let end = start + part(slots, start..slots.len()).iter().take_while(|&&s| s == slot).count();
            let wide_rad = line.fan.column_rad(end - 1) - line.fan.column_rad(start);
            if slot < FULL && wide_rad.abs() >= STRETCH_RAD {
                let Along { a, b, .. } = line.along(areas.m(slot));
                let told = &mut self.told[if b.abs() <= a.abs() { 0 } else { 1 + usize::from(b < 0.0) }];
                if told.weights * (STRETCH_KNOWN * STRETCH_KNOWN) < 1.0 {
                    told.add(line, start..end, self.share, cached);
                }
            }
            start = end;
        }
        let more = self.found() - self.share;
        self.share += if more.abs() > STRETCH_CHANGE { more } else { 0.0 };
        (more.abs() > STRETCH_CHANGE).then_some(more)
    }

    /// What walls of two directions tell and none denies, to three standard deviations; else 0.
    fn found(&self) -> f32 {
        let told = || self.told.iter().filter(|told| told.weights > 0.0);
        let (products, weights) = told().fold((0.0, 0.0), |sums, told| (sums.0 + told.products, sums.1 + told.weights));
        if weights == 0.0 {
            return 0.0;
        }
        let share = products / weights;
        let sd = |weights| 3.0 * lone_inverse_sqrt(weights);
        let tell = told().filter(|told| sd(told.weights) < share.abs()).count();
        let agree = told().all(|told| (told.products / told.weights - share).abs() < sd(told.weights));
        let counts = agree && tell > 1 && share.abs() > STRETCH_LEAST + sd(weights);
        if counts { share } else { 0.0 }
    }
}

/// A plane as it is along beams that lie farther from the middle column by a share of that. `column`:
/// the middle of its columns.
#[inline(never)]
pub(crate) fn seen(fitted: &Fitted, fan: &Fan, column: usize, share: f32) -> Fitted {
    let (angle_rad, middle_rad) = (fan.column_rad(column), fan.middle_rad());
    let (cos, sin) = cos_sin(angle_rad);
    // the row of its mean beam: its axis, and what is square to that
    let c = fitted.sums.c;
    let axis = fan.axis().map(f32::abs);
    let out = plus(c, -dot(c, axis), axis);
    let unit = lone_inverse_sqrt(dot(out, out)).copysign(cos);
    let ahead = out.map(|x| x * unit);
    let beam = plus(ahead.map(|x| x * cos), sin, axis);
    let along = plus(ahead.map(|x| -x * sin), cos, axis);
    let across = cross(axis, ahead);
    // how far beams move, and how that changes from beam to beam: along the row, and across it, where rows
    // draw near each other
    let by = share * (angle_rad - middle_rad);
    let turned = plus(along.map(|x| share * x), -by, beam);
    let nearer = if cos.abs() > 0.1 { -by * sin / cos } else { 0.0 };
    let row = |[of_along, of_turned, of_across]: [f32; 3]| {
        let row = plus(beam.map(|x| by * of_along * x), of_turned, along);
        plus(row, nearer * of_across, across)
    };
    let ([ax, ay, az], [tx, ty, tz], [cx, cy, cz]) = (along, turned, across);
    fitted.seen_along(&[row([ax, tx, cx]), row([ay, ty, cy]), row([az, tz, cz])])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::less;
    use crate::beam::{Beams, Columns, TurnAxis};
    use crate::row::fan::RowBeam;
    use crate::weighted::fitted::tests::{Point, sums};
    use std::vec::Vec;

    const COLUMNS: usize = 181;
    const WEIGHT: f64 = 1e4;
    const ROWS: usize = if cfg!(miri) { 4 } else { 20 };

    /// The plane of the rows of a patch of the plane m, which is seen along the beams `right`, and which
    /// those of `said` are taken for.
    fn fitted(m: [f32; 3], columns: Range<usize>, right: &Fan, said: &Fan) -> Fitted {
        let mut fitted: Option<Fitted> = None;
        for row in 0..ROWS {
            let beams = RowBeam { row, beams: (0.3 + 0.01 * row as f32).into() };
            let ray = |fan: &Fan, column| fan.ray(&fan.frame(beams), column)[0];
            let point = |column| (ray(said, column).map(f64::from), f64::from(dot(ray(right, column), m)), WEIGHT);
            let points: Vec<Point> = columns.clone().map(point).collect();
            let (sums, errors) = sums(&points, fitted.map_or(m, |fitted| fitted.m));
            match &mut fitted {
                Some(fitted) => fitted.extend(&sums, &errors),
                None => fitted = Some(Fitted::first(sums, m, &errors)),
            }
        }
        fitted.unwrap()
    }

    /// A patch that beams see which lie a share too near the middle, changed by that share, is as right
    /// beams see it: its plane, its mean beam and its scatter.
    #[test]
    fn planes_change_as_their_beams() {
        let start_rad = -1.4;
        let columns = Columns::Even { start_rad, step_rad: 2.8 / (COLUMNS - 1) as f32 };
        let few = if cfg!(miri) { 1 } else { 3 };
        for (axis, m) in [(TurnAxis::Y, [0.4, 0.0, 0.3]), (TurnAxis::Z, [0.4, 0.3, 0.0])].into_iter().take(few) {
            for (mut columns_of, aside) in [(120..150, 0.4), (25..55, -0.3), (75..110, 0.1)].into_iter().take(few) {
                if cfg!(miri) {
                    columns_of.end = columns_of.start + 10;
                }
                let said = Fan::new(Beams::Nodding { columns, axis }, COLUMNS).unwrap();
                let (mut right, share) = (said, 0.02);
                right.stretch(share);
                let m = plus(m, aside, said.axis().map(f32::abs));
                let wrong = fitted(m, columns_of.clone(), &right, &said);
                let expected = fitted(m, columns_of.clone(), &right, &right);
                let found = seen(&wrong, &said, (columns_of.start + columns_of.end) / 2, share);
                let off = |fitted: &Fitted| {
                    let distance = |a: [f32; 3], b: [f32; 3]| dot(less(a, b), less(a, b)).sqrt();
                    let scatter = fitted.sums.s.iter().zip(expected.sums.s).map(|(a, b)| (a - b).powi(2)).sum::<f32>();
                    [distance(fitted.m, m), distance(fitted.sums.c, expected.sums.c), scatter.sqrt()]
                };
                let (before, after) = (off(&wrong), off(&found));
                std::println!("{axis:?} {columns_of:?}: {before:?} {after:?}");
                for (before, after) in before.into_iter().zip(after) {
                    assert!(after < 0.05 * before + 5e-4, "{axis:?} {columns_of:?}: {before} {after}");
                }
            }
        }
    }
}
