//! Planar surfaces that grow from row to row, as the core's default segmenter has them, from its
//! documentation: pixels [follow](super::follow) planes, what follows none is cut into
//! [lines](super::pieces), lines join surfaces or begin them, surfaces on one plane join.

use super::beams::{Beams, TurnAxis};
use super::doubt::Doubt;
use super::follow::{Row, Turns, follow};
use super::pieces::pieces;
use super::{Image, Size};
use nalgebra::{Matrix3, Vector2, Vector3};

/// Points are whole multiples of this, metres.
const UNIT_M: f64 = 1.0 / 4096.0;
/// Least standard deviation of a range, metres.
const LEAST_NOISE_M: f64 = 0.002;
/// Squares that a common plane may add by chance, and for each point; excess of a surface that is
/// near a plane.
const CHANCE: f64 = 20.0;
const UNEVEN: f64 = 0.1;
const BENT: f64 = 0.1;
/// Variances of the turn by which a surface may be bent, and the most of that.
const WOBBLE: f64 = 4.0;
const MOST: f64 = 9.0;
/// Surfaces that are one that the scanner bends: squared cosine, variances of the step, points,
/// rows.
const BEND: (f64, f64, usize, usize) = (0.99726, 9.0, 500, 4);
/// Points of surfaces that join across a gap.
const GAP_POINTS: usize = 20;
/// Surfaces above a line that are tried, and pairs of neighbours that are not tried again.
const TRIED: usize = 8;
const PAIRS: usize = 8;

/// What was found.
#[derive(Clone, Debug)]
pub struct Surfaces {
    /// The label of each pixel's surface, from 1 in scan order of their first pixels; 0 in none.
    pub labels: Vec<u32>,
    /// How sure the decisions were.
    pub doubt: Doubt,
}

/// Sums over points in metres.
#[derive(Clone, Copy)]
struct Sums {
    points: usize,
    first: Vector3<f64>,
    second: Matrix3<f64>,
}

/// The plane p . m = 1 through points, and the sum of (p . m - 1)^2.
struct Plane {
    m: Vector3<f64>,
    misfit: f64,
}

impl Sums {
    fn of(points: &[Vector3<f64>]) -> Sums {
        let second = points.iter().map(|p| p * p.transpose()).sum();
        Sums { points: points.len(), first: points.iter().sum(), second }
    }

    fn with(&self, other: &Sums) -> Sums {
        let points = self.points + other.points;
        Sums { points, first: self.first + other.first, second: self.second + other.second }
    }

    /// Of the equations of the plane.
    fn matrix(&self) -> Matrix3<f64> {
        self.second + Matrix3::identity() * (1e-9 * self.second.trace())
    }

    fn plane(&self) -> Option<Plane> {
        let m = self.matrix().cholesky().filter(|_| self.points > 2)?.solve(&self.first);
        Some(Plane { m, misfit: (self.points as f64 - m.dot(&self.first)).max(0.0) })
    }

    fn misfit_on(&self, plane: &Plane) -> f64 {
        self.points as f64 - 2.0 * plane.m.dot(&self.first) + (self.second * plane.m).dot(&plane.m)
    }

    fn mean_square_range_m2(&self) -> f64 {
        self.second.trace() / self.points as f64
    }
}

struct Surface {
    sums: Sums,
    /// Of its plane when last fitted.
    misfit: f64,
    m: Option<Vector3<f64>>,
    first_row: usize,
    last_row: usize,
    /// Where it stands among those that are remembered.
    place: usize,
    /// Logarithm of the points when it was last looked for other pieces of it.
    looked: u32,
    ended: bool,
    /// Not remembered any more.
    forgotten: bool,
    into: Option<usize>,
}

impl Surface {
    fn rows(&self) -> usize {
        self.last_row - self.first_row + 1
    }
}

struct Grower {
    surfaces: Vec<Surface>,
    /// Surfaces that are remembered at most.
    room: usize,
    row: usize,
    range_m2: f64,
    turn_rad2: f64,
    axis: Vector3<f64>,
    doubt: Doubt,
}

impl Grower {
    fn root(&self, mut surface: usize) -> usize {
        while let Some(into) = self.surfaces[surface].into {
            surface = into;
        }
        surface
    }

    /// Roots that are remembered, by their place.
    fn remembered(&self) -> Vec<usize> {
        let mut all: Vec<usize> = (0..self.surfaces.len()).collect();
        all.retain(|&s| !self.surfaces[s].forgotten && self.surfaces[s].into.is_none());
        all.sort_by_key(|&s| self.surfaces[s].place);
        all
    }

    fn plane(&self, surface: usize) -> Option<Vector3<f64>> {
        self.surfaces[surface].m.filter(|_| self.surfaces[surface].rows() > 1)
    }

    fn wobble(&self, plane: &Plane, part: &Sums) -> f64 {
        let centre = part.first / part.points as f64;
        let slope = self.axis.cross(&centre).dot(&plane.m);
        (WOBBLE * slope * slope * centre.norm_squared() * self.turn_rad2 / self.range_m2).min(MOST)
    }

    /// Margin of the squares of points, whose last digits may round otherwise: the more the farther
    /// a beam grazes.
    fn margin(&self, part: &Sums, plane: &Plane) -> f64 {
        let grazing = plane.m.norm() * part.mean_square_range_m2().sqrt();
        0.02 + 0.1 * grazing * UNIT_M / self.range_m2.sqrt() * (part.points as f64).sqrt()
    }

    fn takes(&mut self, surface: usize, line: &Sums, squares: f64) -> Option<f64> {
        let (own, of_own) = (self.surfaces[surface].sums, self.surfaces[surface].misfit);
        let plane = own.with(line).plane()?;
        let points = line.points as f64;
        let added = (plane.misfit - of_own) * line.mean_square_range_m2() / self.range_m2;
        let slack = UNEVEN * (own.points as f64).min(4.0 * points) + self.wobble(&plane, line) * points;
        let most = points.max(squares + CHANCE) + slack;
        let margin = self.margin(line, &plane) + 0.003 * most;
        (!self.doubt.above(added, most, margin)).then_some(added - squares)
    }

    fn begin(&mut self, line: &Sums, squares: f64) -> Option<usize> {
        let remembered = self.remembered();
        let taken: Vec<usize> = remembered.iter().map(|&s| self.surfaces[s].place).collect();
        let free = (0..self.room).find(|place| !taken.contains(place));
        let place = free.or_else(|| {
            let points = |s: usize| self.surfaces[s].sums.points;
            let smallest = remembered.into_iter().filter(|&s| self.surfaces[s].ended).min_by_key(|&s| points(s))?;
            self.surfaces[smallest].forgotten = true;
            Some(self.surfaces[smallest].place)
        });
        let Some(place) = place else {
            // no room: not compared
            self.doubt.above(0.0, 0.0, 1.0);
            return None;
        };
        let misfit = squares * self.range_m2 / line.mean_square_range_m2();
        let (row, looked) = (self.row, 0);
        let surface = Surface {
            sums: *line,
            misfit,
            m: None,
            first_row: row,
            last_row: row,
            place,
            looked,
            ended: false,
            forgotten: false,
            into: None,
        };
        self.surfaces.push(surface);
        Some(self.surfaces.len() - 1)
    }

    fn extend(&mut self, surface: usize, more: &Sums) {
        let surface = &mut self.surfaces[surface];
        (surface.sums, surface.last_row) = (surface.sums.with(more), self.row);
    }

    /// The surface of a line: of those above it the one that it fits best for each pixel that
    /// touches.
    fn place_line(&mut self, touching: &[usize], line: &Sums, squares: f64) -> Option<usize> {
        let mut above: Vec<(usize, usize)> = Vec::new();
        for &surface in touching {
            if let Some(known) = above.iter_mut().find(|known| known.0 == surface) {
                known.1 += 1;
            } else if above.len() < TRIED {
                above.push((surface, 1));
            }
        }
        let mut best: Option<(f64, usize)> = None;
        for (surface, pixels) in above {
            if pixels < 2 && line.points > 3 {
                continue;
            }
            let Some(badly) = self.takes(surface, line, squares) else { continue };
            let badly = badly / pixels as f64;
            let margin = 0.05 + 0.003 * badly.abs();
            if best.is_none_or(|(least, _)| self.doubt.above(least, badly, margin)) {
                best = Some((badly, surface));
            }
        }
        let Some((_, surface)) = best else { return self.begin(line, squares) };
        self.extend(surface, line);
        Some(surface)
    }

    /// The plane of two surfaces that are one.
    fn common(&mut self, one: usize, other: usize) -> Option<Plane> {
        let [a, b] = [one, other].map(|s| (self.surfaces[s].sums, self.surfaces[s].misfit));
        let plane = a.0.with(&b.0).plane()?;
        let small = if a.0.points < b.0.points { a.0 } else { b.0 };
        let per_noise = small.mean_square_range_m2() / self.range_m2;
        let added = (plane.misfit - a.1 - b.1) * per_noise;
        let most = CHANCE + (UNEVEN + self.wobble(&plane, &small)) * small.points as f64;
        let margin = self.margin(&small, &plane) + 0.003 * most;
        if !self.doubt.above(added, most, margin) {
            return Some(plane);
        }
        let mut near = |part: &Sums| {
            let squares = part.misfit_on(&plane) * part.mean_square_range_m2() / self.range_m2;
            let most = (1.0 + BENT + self.wobble(&plane, part)) * part.points as f64;
            let margin = self.margin(part, &plane) + 0.003 * most;
            !self.doubt.above(squares, most, margin)
        };
        (near(&a.0) && near(&b.0)).then_some(plane)
    }

    /// The plane of two large surfaces that meet at a small angle along a beam, without a step.
    fn bends(&mut self, one: usize, other: usize, direction: &Vector3<f64>) -> Option<Plane> {
        let (cos_square, step, points, rows) = BEND;
        let large = |s: usize| self.surfaces[s].sums.points >= points && self.surfaces[s].rows() >= rows;
        let (a, b) = (self.plane(one)?, self.plane(other)?);
        if !large(one) || !large(other) || a.dot(&b) <= 0.0 {
            return None;
        }
        let aligned = self.doubt.above(a.dot(&b).powi(2) / (a.norm_squared() * b.norm_squared()), cos_square, 1e-5);
        let (near_m, far_m) = (1.0 / direction.dot(&a), 1.0 / direction.dot(&b));
        let square = (near_m - far_m).powi(2) / self.range_m2;
        (aligned && !self.doubt.above(square, step, 0.01 * step))
            .then(|| self.surfaces[one].sums.with(&self.surfaces[other].sums).plane())
            .flatten()
    }

    fn join(&mut self, one: usize, other: usize, plane: &Plane) {
        let (kept, gone) = (one.min(other), one.max(other));
        let [a, b] = [&self.surfaces[kept], &self.surfaces[gone]];
        let (sums, last_row) = (a.sums.with(&b.sums), a.last_row.max(b.last_row));
        let (first_row, ended) = (a.first_row.min(b.first_row), a.ended && b.ended);
        let looked = [a, b].iter().filter(|s| !s.ended).map(|s| s.looked).max().unwrap_or(0);
        let (m, misfit) = (Some(plane.m), plane.misfit);
        let place = a.place;
        self.surfaces[gone].into = Some(kept);
        self.surfaces[kept] =
            Surface { sums, misfit, m, first_row, last_row, place, looked, ended, forgotten: false, into: None };
    }

    /// Neighbours along the row, across one pixel or none, and from row to row.
    fn join_neighbours(&mut self, above: &[Option<usize>], here: &[Option<usize>], row: &Row) {
        let columns = here.len();
        let mut pairs = std::collections::VecDeque::new();
        for column in 0..columns {
            let Some(surface) = here[column] else { continue };
            let beside = |ahead: usize| {
                let column = column + ahead;
                if column < columns { here[column] } else { here[column - columns].filter(|_| row.wraps) }
            };
            for other in [beside(1).or_else(|| beside(2)), above[column]].into_iter().flatten() {
                let pair = (surface.min(other), surface.max(other));
                if other == surface || pairs.contains(&pair) {
                    continue;
                }
                pairs.push_back(pair);
                if pairs.len() > PAIRS {
                    pairs.pop_front();
                }
                let (one, other) = (self.root(surface), self.root(other));
                if one == other || self.surfaces[one].rows() < 2 || self.surfaces[other].rows() < 2 {
                    continue;
                }
                let plane = self.common(one, other).or_else(|| self.bends(one, other, &row.directions[column]));
                if let Some(plane) = plane {
                    self.join(one, other, &plane);
                }
            }
        }
    }

    /// Pieces of one surface across gaps, each time that it has twice the points.
    fn bridge(&mut self) {
        for surface in self.remembered() {
            let s = &self.surfaces[surface];
            let points = s.sums.points;
            let grown = s.into.is_none() && !s.ended && s.last_row == self.row && s.first_row < self.row;
            if !grown || points < GAP_POINTS || points.ilog2() <= s.looked {
                continue;
            }
            self.surfaces[surface].looked = points.ilog2();
            let mut surface = surface;
            for other in self.remembered() {
                let is_other = self.surfaces[other].into.is_none() && other != surface;
                if is_other
                    && self.surfaces[other].sums.points >= GAP_POINTS
                    && let Some(plane) = self.common(surface, other)
                {
                    self.join(surface, other, &plane);
                    surface = self.root(surface);
                }
            }
        }
    }

    fn refit(&mut self) {
        let row = self.row;
        for surface in self.surfaces.iter_mut().filter(|s| s.last_row == row && s.first_row < row && s.into.is_none()) {
            if let Some(plane) = surface.sums.plane() {
                (surface.m, surface.misfit) = (Some(plane.m), plane.misfit);
            }
        }
    }
}

/// Where a pixel is within its row, per metre of range.
fn place(beams: &Beams, column: usize, direction: &Vector3<f64>) -> Vector2<f64> {
    let angle = |angle: f64| Vector2::new(angle.cos(), angle.sin());
    match beams {
        Beams::Nodding { beam_rad, .. } => angle(beam_rad[column]),
        Beams::Spinning { azimuth_rad, .. } => angle(azimuth_rad[column]),
        Beams::Pinhole { .. } => Vector2::new(direction.x, direction.y),
    }
}

/// Grows surfaces row by row. `room`: surfaces that are remembered at most.
pub fn surfaces(image: &Image, beams: &Beams, range_noise_m: f64, room: usize) -> Surfaces {
    let Size { rows, columns, wraps } = image.size;
    let range_m2 = range_noise_m * range_noise_m + LEAST_NOISE_M * LEAST_NOISE_M;
    let axis = match beams {
        Beams::Nodding { axis: TurnAxis::Y, .. } => -Vector3::y(),
        Beams::Nodding { axis: TurnAxis::Z, .. } => Vector3::z(),
        _ => Vector3::zeros(),
    };
    let (surfaces, doubt) = (Vec::new(), Doubt::default());
    let mut grower = Grower { surfaces, room, row: 0, range_m2, turn_rad2: 0.0, axis, doubt };
    let mut turns = Turns::default();
    let (mut above, mut all) = (vec![None; columns], Vec::new());
    for number in 0..rows {
        grower.row = number;
        let directions: Vec<_> = (0..columns).map(|column| beams.direction((number, column))).collect();
        let ranges_m: Vec<_> = (0..columns).map(|column| image.range((number, column)).map(f64::from)).collect();
        let row = Row { directions, ranges_m, axis, wraps, range_m2 };
        let unit = |c: f64| (c / UNIT_M).round() * UNIT_M;
        let point = |column: usize| (row.directions[column] * row.ranges_m[column].unwrap()).map(unit);
        let sums = |columns: &mut dyn Iterator<Item = usize>| Sums::of(&columns.map(point).collect::<Vec<_>>());

        let mut doubt = std::mem::take(&mut grower.doubt);
        let settled = |s: &usize| grower.surfaces[*s].rows() >= 4 && grower.surfaces[*s].sums.points >= 50;
        let turn_rad =
            turns.of_row(&row, &above, |s| Some(s).filter(settled).and_then(|s| grower.plane(s)), &mut doubt);
        grower.turn_rad2 = turns.variance_rad2();
        let left = (turn_rad, 0.25 * grower.turn_rad2);
        let plane = |s: usize| {
            let m = grower.plane(s)?;
            let inverse = grower.surfaces[s].sums.matrix().cholesky().map(|matrix| matrix.inverse());
            // where there is none, nothing is sure
            let inverse = inverse.unwrap_or(Matrix3::repeat(f64::NAN));
            Some((m, inverse * (UNIT_M * UNIT_M * m.norm_squared())))
        };
        let mut here = follow(&row, &above, plane, left, &mut doubt);
        grower.doubt = doubt;

        for surface in 0..grower.surfaces.len() {
            let mut of_surface = (0..columns).filter(|&column| here[column] == Some(surface)).peekable();
            if of_surface.peek().is_some() {
                grower.extend(surface, &sums(&mut of_surface));
            }
        }
        let is_free: Vec<bool> = (0..columns).map(|c| here[c].is_none() && row.ranges_m[c].is_some()).collect();
        let mut start = 0;
        while start < columns {
            let end = start + is_free[start..].iter().take_while(|&&free| free).count();
            let at = |column: usize| place(beams, column, &row.directions[column]) * row.ranges_m[column].unwrap();
            let places: Vec<_> = (start..end).map(at).collect();
            for (line, squares) in pieces(start, &places, range_m2, &mut grower.doubt) {
                let near = line.start.saturating_sub(1)..columns.min(line.end + 1);
                let touching: Vec<usize> = above[near].iter().copied().flatten().collect();
                let found = grower.place_line(&touching, &sums(&mut (line.start..line.end)), squares);
                here[line.start..line.end].fill(found);
            }
            start = end.max(start + 1);
        }
        grower.refit();
        grower.join_neighbours(&above, &here, &row);
        grower.bridge();
        for surface in here.iter_mut().flatten() {
            *surface = grower.root(*surface);
        }
        for surface in &mut grower.surfaces {
            surface.ended |= surface.last_row < number;
        }
        all.extend_from_slice(&here);
        above = here;
    }
    let label = |surface: &Option<usize>| surface.map_or(0, |surface| grower.root(surface) as u32 + 1);
    let labels: Vec<u32> = all.iter().map(label).collect();
    Surfaces { labels: crate::art::canonical(&labels), doubt: grower.doubt }
}
