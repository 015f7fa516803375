//! What a whole row is off by, from the planes that it goes on with: of a turning scanner its turn
//! beyond what was reported, of a spinning one the offset of its ring.
//!
//! A row that was turned further than reported is off on every floor, ceiling and front wall at
//! once, and on each by the same angle; on side walls it does not show. The angle is found from the
//! weighted median over some pixels, then by least squares over those that agree with it. It must
//! explain much of the row's error to be believed, and on two planes at least, or be one by which
//! the scanner went on: a wall square to the scanner that begins where a floor ends looks like a
//! turn too, but back. Once a tenth of the rows, and
//! three, were off, surfaces are allowed to be uneven by as much.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::dot;
use crate::plane::areas::{Areas, FULL};
use crate::plane::median::weighted_median;
use crate::plane::rules::{Rules, TURN_PLANES, TURN_STRIDE};
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

/// What is known of the turn angles of a scan.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Turns {
    /// Rows that could tell, rows that were off, and the sum of the squares of the latter.
    told: u32,
    off: u32,
    squares_rad2: f32,
    /// Turn of the last row as reported, and what it was more.
    last_rad: [f32; 2],
}

impl Turns {
    /// Variance of the turn angle, rad^2.
    pub fn variance_rad2(&self) -> f32 {
        // two rows more, so that the first ones do not speak for all
        let rows = self.told + 2;
        if self.off >= 3 && 10 * self.off >= rows { self.squares_rad2 / rows as f32 } else { 0.0 }
    }

    /// Takes note of a turn that was not reported.
    pub fn learn(&mut self, turn_rad: f32) {
        self.off += 1;
        self.squares_rad2 += turn_rad * turn_rad;
    }

    /// What a row is off by: its turn beyond what was reported, radians; of a spinning scanner all
    /// its ranges, metres. `scratch` has [`scratch_len`] elements.
    pub fn of_row(
        &mut self,
        line: &Scanline,
        above: &[u16],
        areas: &Areas,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        let found = self.find(line, above, areas, turn_rad, scratch);
        self.last_rad = [turn_rad, found.unwrap_or(0.0)];
        found
    }

    /// Whether the scanner went on by a turn that one plane alone tells.
    fn went_on(&self, by: f32, turn_rad: f32, rules: &Rules) -> bool {
        let [last_rad, last_by] = self.last_rad;
        let step = turn_rad - last_rad;
        let share = (step + by - last_by) / step;
        step != 0.0 && share > rules.turn_alone_least && share < rules.turn_alone_most
    }

    fn find(
        &mut self,
        line: &Scanline,
        above: &[u16],
        areas: &Areas,
        turn_rad: f32,
        scratch: &mut [f32],
    ) -> Option<f32> {
        let rules = areas.rules;
        let turns = line.fan.axis() != [0.0; 3];
        if !turns && !line.fan.spins() {
            return None;
        }
        let expected = if turns { rules.turn_rad } else { rules.ring_m };
        let samples = samples(line, above, areas, expected, scratch);
        if samples.len() < 3 {
            return None;
        }
        self.told += 1;
        if is_as_reported(samples, rules) {
            return None;
        }
        let by = estimate(samples, expected, rules);
        let noise_rad = line.ranging.turn_noise_rad;
        let known = noise_rad * noise_rad + if turns { self.variance_rad2() } else { 0.0 };
        let (gain, several) = explained(samples, by, areas);
        let believed = gain > rules.turn_gain
            && gain > rules.turn_gain_per_pixel * samples.len() as f32
            && by.abs() < 2.0 * expected
            && (several || self.went_on(by, turn_rad, rules) || by * by <= 9.0 * known);
        if believed && turns {
            self.learn(by);
        }
        believed.then_some(by)
    }
}

/// The pixels that tell: those on a large plane, near enough to it for it to be off by what is
/// expected, and which are then off by more than noise.
fn samples<'s>(
    line: &Scanline,
    above: &[u16],
    areas: &Areas,
    expected: f32,
    scratch: &'s mut [f32],
) -> &'s mut [Sample] {
    let rules = areas.rules;
    let turns = line.fan.axis() != [0.0; 3];
    let samples = scratch.as_chunks_mut().0;
    let mut count = 0;
    let (mut known, mut along) = (FULL, None);
    let (mut cached, mut column) = (Cached::EMPTY, 0);
    while column < above.len() {
        let slot = at(above, column);
        if slot != known {
            let (rows, points) = if slot < FULL { areas.size(slot) } else { (0, 0) };
            let large = rows >= rules.turn_rows && points >= rules.turn_points;
            known = slot;
            along = if large { areas.plane(slot).map(|plane| line.along(plane)) } else { None };
        }
        if let Some(Along { a, b, k, turned }) = along {
            let pixel = cached.at(line, column);
            let range_m = pixel.range_m;
            let inverse = 1.0 / libm::sqrtf(line.variance.at(range_m));
            let error = inverse * range_m * (range_m * (pixel.cos * a + pixel.sin * b + k) - 1.0);
            let slope = inverse * if turns { range_m * range_m * pixel.cos * turned } else { -1.0 };
            let tells = slope * slope * expected * expected >= 1.0;
            if range_m > 0.0 && tells && error.abs() <= slope.abs() * (2.0 * expected) {
                put(samples, count, [error, slope, f32::from(slot)]);
                count += 1;
            }
        }
        column += stride(above.len());
    }
    part_mut(samples, 0..count)
}

/// Whether a row is where it is said to be, as most rows are: nine of ten samples are on their
/// plane, and on the whole to neither side.
fn is_as_reported(samples: &[Sample], rules: &Rules) -> bool {
    let (mut products, mut squares, mut far) = (0.0, 1.0, 0);
    for [error, slope, _] in samples.iter() {
        if error * error < rules.turn_off {
            products += error * slope;
            squares += slope * slope;
        } else {
            far += 1;
        }
    }
    products * products < rules.turn_gain * squares && 10 * far < samples.len()
}

/// Square of what is left of an error once the row is off by so much.
fn rest(sample: &Sample, by: f32) -> f32 {
    let rest = sample[0] + by * sample[1];
    rest * rest
}

/// What most samples agree on that the row is off by.
fn estimate(samples: &mut [Sample], expected: f32, rules: &Rules) -> f32 {
    let half = 0.5 * samples.iter().map(|[_, slope, _]| slope.abs()).sum::<f32>();
    let median = weighted_median(samples, |[error, slope, _]| -error / slope, |[_, slope, _]| slope.abs(), half);
    let (mut products, mut squares) = (0.0, 1.0 / (expected * expected));
    for sample in samples.iter().filter(|sample| rest(sample, median) < rules.turn_off) {
        products -= sample[0] * sample[1];
        squares += sample[1] * sample[1];
    }
    products / squares
}

/// Squares that it explains that the row is off by so much, and whether it explains some on two
/// planes that are not parallel.
fn explained(samples: &[Sample], by: f32, areas: &Areas) -> (f32, bool) {
    let rules = areas.rules;
    let mut planes = [(0.0f32, NONE); TURN_PLANES];
    let mut gain = 0.0;
    for sample in samples {
        let more = rest(sample, 0.0).min(rules.turn_off) - rest(sample, by).min(rules.turn_off);
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
