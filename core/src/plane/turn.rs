//! What a whole row is off by, from the planes that it goes on with: of a turning scanner its turn
//! beyond what was reported, of a spinning one the offset of its ring.
//!
//! A row that was turned further than reported is off on every floor, ceiling and front wall at
//! once, and on each by the same angle; on side walls it does not show. The angle is found from the
//! weighted median over some pixels, then by least squares over those that agree with it. It must
//! explain much of the row's error to be believed, and on two planes at least, or be one by which
//! the scanner went on: a wall square to the scanner that begins where a floor ends looks like a
//! turn too, but back.
//!
//! How far rows are off is learned from one row to the next, less what noise makes of it: what all
//! rows are off by alike is how planes are tilted. Sums forgive so much, and surfaces may bend by
//! it.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::{dot, lone_inverse_sqrt};
use crate::plane::areas::{Areas, FULL};
use crate::plane::median::weighted_median;
use crate::plane::rules::{MOST_TOLD, PRIOR_ROWS, Rules, TURN_PLANES, TURN_STRIDE};
use crate::plane::scanline::{Along, Cached, Scanline};
use crate::row::slots::NONE;
use crate::row::within::{at, part_mut, put};

/// A pixel that tells: its error, how that changes with what the row is off by, both in units of
/// the noise, and its slot.
type Sample = [f32; 3];

/// Every so many pixels are looked at, some 90 to 180 in all.
const fn stride(columns: usize) -> usize {
    let least = columns / 64;
    if least < TURN_STRIDE { TURN_STRIDE } else { least }
}

/// Numbers of scratch for images of so many columns.
pub(crate) const fn scratch_len(columns: usize) -> usize {
    size_of::<Sample>() / size_of::<f32>() * columns.div_ceil(stride(columns))
}

/// What a row is off by.
#[derive(Clone, Copy, Debug)]
struct Off {
    by: f32,
    /// Variance of that by the noise of its pixels.
    variance: f32,
    /// Whether it is more than noise, and believed. Then the row is looked for there.
    is_off: bool,
}

/// What is known of the turn angles of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turns {
    /// Rows that could tell, as did the row before; each counts by how well it tells.
    told: f32,
    /// Sum of the variances that they told, weighted alike.
    squares2: f32,
    /// What the last row was off by, if it told.
    last: Option<Off>,
    /// Turn of the last row as reported, and what it was more.
    last_rad: [f32; 2],
    /// Rows of the oldest plane that tells of the last row.
    pub rows: u16,
}

impl Turns {
    /// Variance of what rows are off by: of the turn angle, rad^2; of a spinning scanner of the
    /// offsets of its rings, m^2. `expected2`: before any row tells.
    fn variance(&self, expected2: f32) -> f32 {
        // a row more, so that the first ones do not speak for all
        let variance = (PRIOR_ROWS * expected2 + self.squares2) / (PRIOR_ROWS + self.told);
        if variance > 0.0 { variance } else { 0.0 }
    }

    /// Takes note of a row that is off by so much more than the one before, where noise alone makes
    /// it so much, as a variance. What all rows are off by alike is no noise: planes may be tilted
    /// by as much.
    fn learn(&mut self, more: f32, noise2: f32, expected2: f32) {
        let ratio = expected2 / (expected2 + noise2);
        let weight = ratio * ratio;
        // two rows of independent turns differ by twice the variance
        let told2 = 0.5 * (more * more - noise2);
        // one row alone does not speak for all either
        let known2 = self.variance(expected2);
        let most2 = MOST_TOLD * if known2 > expected2 { known2 } else { expected2 };
        self.told += weight;
        self.squares2 += weight * if told2 < most2 { told2 } else { most2 };
    }

    /// Takes note of a turn that was found between two areas, radians.
    pub fn learn_turn(&mut self, turn_rad: f32, line: &Scanline, rules: &Rules) {
        self.learn(turn_rad, 0.0, expected2(line, rules));
    }

    /// Variance of what rows of this scanner are off by, as the scan tells it.
    pub fn told2(&self, line: &Scanline, rules: &Rules) -> f32 {
        let known = line.fan.spins() || line.fan.turns();
        if known { self.variance(expected2(line, rules)) } else { 0.0 }
    }

    /// What a row is off by: its turn beyond what was reported, radians; of a spinning scanner all
    /// its ranges, metres. `None` for a row that is not off, or does not tell. The line has the
    /// variance that is stated of that; `scratch` has [`scratch_len`] elements.
    pub fn of_row(
        &mut self,
        line: &Scanline,
        above: &[u16],
        areas: &Areas,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        let found = self.find(line, above, areas, turn_rad, scratch);
        if let (Some(now), Some(last)) = (found, self.last) {
            self.learn(now.by - last.by, now.variance + last.variance, expected2(line, areas.rules));
        }
        self.last = found;
        let by = found.filter(|found| found.is_off).map(|found| found.by);
        self.last_rad = [turn_rad, by.unwrap_or(0.0)];
        by
    }

    /// Whether the scanner went on by a turn that one plane alone tells.
    fn went_on(&self, by: f32, turn_rad: f32, rules: &Rules) -> bool {
        let [last_rad, last_by] = self.last_rad;
        let step = turn_rad - last_rad;
        let share = (step + by - last_by) / step;
        step != 0.0 && share > rules.turn_alone_least && share < rules.turn_alone_most
    }

    /// What a row is off by; `None` if it does not tell, or if what it tells of a turn is not believed.
    fn find(
        &mut self,
        line: &Scanline,
        above: &[u16],
        areas: &Areas,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<Off> {
        let rules = areas.rules;
        let turns = line.fan.turns();
        if !turns && !line.fan.spins() {
            return None;
        }
        let expected = if turns { rules.turn_rad } else { rules.ring_m };
        let (samples, rows) = samples(line, above, areas, expected, scratch);
        self.rows = rows;
        if samples.len() < 3 {
            return None;
        }
        if let Some(off) = as_reported(samples, rules) {
            return Some(off);
        }
        let off = estimate(samples, expected, rules);
        let by = off.by;
        let known = self.told2(line, rules);
        let (gain, several) = explained(samples, by, areas);
        let told = gain > rules.turn_gain && gain > rules.turn_gain_per_pixel * samples.len() as f32;
        let is_off = several || turns && (self.went_on(by, turn_rad, rules) || by * by <= 9.0 * known);
        // of rings one plane tells how far they are off from one another, but not which of them is right
        (told && (is_off || !turns)).then_some(Off { is_off, ..off })
    }
}

/// Variance of what rows are expected to be off by before any row tells, at least what is stated.
fn expected2(line: &Scanline, rules: &Rules) -> f32 {
    let sd = if line.fan.spins() { rules.ring_prior_m } else { rules.turn_prior_rad };
    let expected2 = sd * sd;
    if expected2 > line.off2 { expected2 } else { line.off2 }
}

/// The pixels that tell: those on a large plane, near enough to it for it to be off by what is
/// expected, and which are then off by more than noise.
fn samples<'s>(
    line: &Scanline,
    above: &[u16],
    areas: &Areas,
    expected: f32,
    scratch: &'s mut [f32],
) -> (&'s mut [Sample], u16) {
    let rules = areas.rules;
    let turns = line.fan.turns();
    let samples = scratch.as_chunks_mut().0;
    let (mut count, mut oldest) = (0, 0);
    let (mut known, mut along, mut cached) = (FULL, None, Cached::empty());
    let mut column = 0;
    while column < above.len() {
        let slot = at(above, column);
        if slot != known {
            let (rows, points) = if slot < FULL { areas.size(slot) } else { (0, 0) };
            let large = rows >= rules.turn_rows && points >= rules.turn_points;
            known = slot;
            oldest = if large && rows > oldest { rows } else { oldest };
            along = if large { areas.plane(slot).map(|plane| line.along(plane)) } else { None };
        }
        if let Some(Along { a, b, k, turned }) = along {
            let pixel = cached.lone(line, column);
            let range_m = pixel.range_m;
            let inverse = lone_inverse_sqrt(line.variance.lone_at(range_m));
            let error =
                inverse * range_m * (range_m * (pixel.cos * a + pixel.sin * b + pixel.beside * turned + k) - 1.0);
            let slope = inverse * if turns { range_m * range_m * pixel.cos * turned } else { -1.0 };
            let tells = slope * slope * expected * expected >= 1.0;
            if range_m > 0.0 && tells && error.abs() <= slope.abs() * (2.0 * expected) {
                put(samples, count, [error, slope, f32::from(slot)]);
                count += 1;
            }
        }
        column += stride(above.len());
    }
    (part_mut(samples, 0..count), oldest)
}

/// The little that a row is off by if it is where it is said to be, as most rows are: nine of ten
/// samples are on their plane, and on the whole to neither side. `None` if it is not.
fn as_reported(samples: &[Sample], rules: &Rules) -> Option<Off> {
    let (mut products, mut squares, mut far) = (0.0, 1.0, 0);
    for [error, slope, _] in samples.iter() {
        if error * error < rules.turn_off {
            products += error * slope;
            squares += slope * slope;
        } else {
            far += 1;
        }
    }
    let is_so = products * products < rules.turn_gain * squares && 10 * far < samples.len();
    is_so.then_some(Off { by: -products / squares, variance: 1.0 / squares, is_off: false })
}

/// Square of what is left of an error once the row is off by so much.
fn rest(sample: &Sample, by: f32) -> f32 {
    let rest = sample[0] + by * sample[1];
    rest * rest
}

/// What most samples agree on that the row is off by.
fn estimate(samples: &mut [Sample], expected: f32, rules: &Rules) -> Off {
    let half = 0.5 * samples.iter().map(|[_, slope, _]| slope.abs()).sum::<f32>();
    let median = weighted_median(samples, |[error, slope, _]| -error / slope, |[_, slope, _]| slope.abs(), half);
    let (mut products, mut squares) = (0.0, 1.0 / (expected * expected));
    for sample in samples.iter().filter(|sample| rest(sample, median) < rules.turn_off) {
        products -= sample[0] * sample[1];
        squares += sample[1] * sample[1];
    }
    Off { by: products / squares, variance: 1.0 / squares, is_off: true }
}

/// Squares that it explains that the row is off by so much, and whether it explains some on two
/// planes that are not parallel.
fn explained(samples: &[Sample], by: f32, areas: &Areas) -> (f32, bool) {
    let rules = areas.rules;
    let mut planes = [(0.0f32, NONE); TURN_PLANES];
    let mut gain = 0.0;
    for sample in samples {
        let [before, after] = [0.0, by].map(|by| {
            let rest = rest(sample, by);
            if rest < rules.turn_off { rest } else { rules.turn_off }
        });
        let more = before - after;
        gain += more;
        let slot = sample[2] as u16;
        if let Some(known) = planes.iter_mut().find(|plane| plane.1 == slot || plane.1 == NONE) {
            *known = (known.0 + more, slot);
        }
    }
    let best = planes.iter().fold((0.0, NONE), |best, plane| if plane.0 > best.0 { *plane } else { best });
    if best.1 == NONE {
        return (gain, false);
    }
    let one = areas.m(best.1);
    let several = planes.iter().filter(|&&(gain, slot)| slot != NONE && gain > rules.turn_other).any(|&(_, slot)| {
        let other = areas.m(slot);
        let cos = dot(one, other);
        cos * cos < rules.turn_cos_square * dot(one, one) * dot(other, other)
    });
    (gain, several)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::area::Area;
    use crate::plane::tried::Tried;
    use crate::weighted::fitted::Fitted;

    /// A turn that is seen on parallel planes and on one across them: on two planes, if that one is
    /// among the first eight.
    #[test]
    fn eight_planes_are_told_apart() {
        let (mut table, mut pairs) = ([Area::EMPTY; 9], [0; 16]);
        let mut areas = Areas::new(&mut table, Tried::new(&mut pairs), [0.0, -1.0, 0.0], &Rules::TUNED, false);
        areas.reset();
        let of_plane = |m: [f32; 3]| {
            let mut numbers = [0.0; 15];
            numbers[11..14].copy_from_slice(&m);
            Fitted::from_numbers(numbers)
        };
        for i in 0..8 {
            areas.begin(&(0..4), &of_plane([0.5 + 0.1 * i as f32, 0.0, 0.0]), 4);
        }
        let across = areas.begin(&(0..4), &of_plane([0.0, 0.5, 0.0]), 4);
        // of three standard deviations each
        let seen_on = |parallel: u16| {
            let samples: [Sample; 9] = core::array::from_fn(|i| {
                let slot = if i < usize::from(parallel) { i as u16 } else { across };
                [-3.0, 1.0, f32::from(slot)]
            });
            explained(&samples, 3.0, &areas)
        };
        assert_eq!((seen_on(7), seen_on(8)), ((81.0, true), (81.0, false)));
    }
}
