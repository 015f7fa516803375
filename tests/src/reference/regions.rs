//! Line-based region growing (paper, section 4: lines "are then merged based on thresholding the
//! distance of the segment endpoints to the growing region"), on the whole image, from the points
//! of each region.

use super::Image;
use super::beams::Beams;
use super::doubt::{Answer, Doubt};
use super::labels::Class;
use super::lines::{LEAST_M2, Line, RowLines, Thresholds, points, row_lines};
use nalgebra::{Matrix3, SymmetricEigen, Vector3};

/// Points are kept as whole multiples of this, metres.
const UNIT_M: f64 = 1.0 / 4096.0;

/// Standard deviations that an end point may be off.
const DISTANCE_SIGMAS: f64 = 4.0;

/// A way steeper than this against the beam is a step: the cotangent of 3 degrees.
const GRAZING_COT: f64 = 19.1;

/// What was found.
#[derive(Clone, Debug)]
pub struct Regions {
    /// What each pixel is; edges are on no line.
    pub classes: Vec<Class>,
    /// Pixels with a return that begin a line or are on none.
    pub breaks: Vec<bool>,
    /// The label of each pixel's region, from 1 in scan order of their first pixels; 0 in none.
    pub labels: Vec<u32>,
    /// The decisions that single precision may turn.
    pub doubt: Doubt,
}

/// Principal axes of points.
struct Axes {
    /// Number of points.
    points: f64,
    centroid: Vector3<f64>,
    /// Mean squared deviations along the axes, smallest first.
    squares_m2: [f64; 3],
    vectors: [Vector3<f64>; 3],
}

fn axes(points: &[Vector3<f64>]) -> Axes {
    let n = points.len() as f64;
    let centroid = points.iter().sum::<Vector3<f64>>() / n;
    let scatter: Matrix3<f64> = points.iter().map(|p| (p - centroid) * (p - centroid).transpose()).sum();
    let eigen = SymmetricEigen::new(scatter / n);
    let mut order = [0, 1, 2];
    order.sort_by(|&a, &b| eigen.eigenvalues[a].total_cmp(&eigen.eigenvalues[b]));
    Axes {
        points: n,
        centroid,
        squares_m2: order.map(|i| eigen.eigenvalues[i].max(0.0)),
        vectors: order.map(|i| eigen.eigenvectors.column(i).into_owned()),
    }
}

struct Grower<'a> {
    thresholds: &'a Thresholds,
    doubt: Doubt,
    /// The points of each region; empty where it was joined into another.
    regions: Vec<Vec<Vector3<f64>>>,
    joined_into: Vec<usize>,
}

impl Grower<'_> {
    fn root(&self, mut region: usize) -> usize {
        while self.joined_into[region] != region {
            region = self.joined_into[region];
        }
        region
    }

    fn has_plane(&self, axes: &Axes) -> Answer {
        let thin_m = self.thresholds.range_noise_m + 0.001;
        let threshold = thin_m * thin_m + 4e-6 * axes.squares_m2[2];
        // the middle one of three, of points rounded a little differently
        Answer::above(axes.squares_m2[1], threshold, 5e-7 * axes.squares_m2[2] + 0.02 * threshold)
    }

    /// Whether a point is near a plane.
    fn near(&self, plane: &Axes, point: &Vector3<f64>) -> Answer {
        let normal = plane.vectors[0];
        let distance_m = normal.dot(&(point - plane.centroid)).abs();
        let cos = normal.dot(&point.normalize()).abs();
        let tolerance_m = self.thresholds.plane_distance_m + DISTANCE_SIGMAS * self.thresholds.range_noise_m * cos;
        // one point of a hundred may be rounded to the next unit, and f32 has 5e-7 of the largest
        // square: both tilt the normal towards the other axes. Twice that, since it is no bound.
        let lever = point - plane.centroid;
        let tilted = |axis: usize| {
            let stiffness = (plane.squares_m2[axis] - plane.squares_m2[0]).max(1e-12);
            let tilt = 0.8 * UNIT_M / (plane.points * stiffness).sqrt() + 5e-7 * plane.squares_m2[2] / stiffness;
            tilt.min(2.0) * (lever.dot(&plane.vectors[axis]).abs() + DISTANCE_SIGMAS * self.thresholds.range_noise_m)
        };
        let margin = 1e-6 * point.norm() + 0.8 * UNIT_M / plane.points.sqrt() + tilted(1) + tilted(2);
        !Answer::above(distance_m, tolerance_m, 4.0 * margin)
    }

    /// Whether the way from a region without a plane to a point is a step.
    fn is_step(&self, region: &Axes, point: &Vector3<f64>) -> Answer {
        let (along, way) = (region.vectors[2], point - region.centroid);
        let off = way - along * along.dot(&way);
        let beam = point.normalize();
        let deep_m = off.dot(&beam).abs();
        let across_m = (off - beam * off.dot(&beam)).norm();
        let slack_m = self.thresholds.plane_distance_m + DISTANCE_SIGMAS * self.thresholds.range_noise_m;
        let turned = 1e-6 + 0.1 * UNIT_M / (region.squares_m2[2] - region.squares_m2[1]).max(1e-12).sqrt();
        let margin = 1e-3 * slack_m + 1e-3 * deep_m + (0.1 * UNIT_M + turned * way.norm()) * (1.0 + GRAZING_COT);
        Answer::above(deep_m, across_m * GRAZING_COT + slack_m, margin)
    }

    /// How well a region takes a line, if it does: whether it has a plane, and its points.
    fn takes(&mut self, region: usize, line: &[Vector3<f64>], ends: &[Vector3<f64>; 2]) -> Option<(bool, usize)> {
        let own = axes(&self.regions[region]);
        let has_plane = self.has_plane(&own);
        let planar = self.doubt.decide(has_plane);
        let [first, last] = if planar {
            ends.map(|end| self.near(&own, &end))
        } else {
            let both = axes(&[self.regions[region].as_slice(), line].concat());
            ends.map(|end| self.near(&both, &end).and(!self.is_step(&own, &end)))
        };
        let digits = ends.iter().all(|end| end.norm_squared() >= LEAST_M2);
        let takes = first.and(last);
        let takes = self.doubt.decide(Answer { sure: takes.sure && digits, ..takes });
        takes.then_some((planar, self.regions[region].len()))
    }

    /// Whether two regions are one, once something else says that they could be.
    fn meets(&mut self, one: usize, other: usize) -> bool {
        let (one, other) = (axes(&self.regions[one]), axes(&self.regions[other]));
        let goes_with = |plane: &Axes, other: &Axes| (!self.has_plane(plane)).or(self.near(plane, &other.centroid));
        let both = goes_with(&one, &other).and(goes_with(&other, &one));
        self.doubt.decide(both)
    }

    fn join(&mut self, into: usize, from: usize) {
        let points = std::mem::take(&mut self.regions[from]);
        self.regions[into].extend(points);
        self.joined_into[from] = into;
    }

    /// The region that a line belongs to. `line`: its points, rounded; `ends`: the first and the last of them, not rounded,
    /// since at a few units from the scanner rounding turns them. `above`: the regions of the lines of the row above that
    /// it touches, from the left, as they were when that row was done.
    fn place(&mut self, line: &[Vector3<f64>], ends: &[Vector3<f64>; 2], above: &[usize]) -> usize {
        let mut best: Option<((bool, usize), usize)> = None;
        for &region in above {
            let root = self.root(region);
            if best.is_some_and(|(_, best)| best == root) {
                continue;
            }
            if let Some(well) = self.takes(root, line, ends)
                && best.is_none_or(|(most, _)| well > most)
            {
                best = Some((well, root));
            }
        }
        let Some((_, region)) = best else {
            self.regions.push(line.to_vec());
            self.joined_into.push(self.regions.len() - 1);
            return self.regions.len() - 1;
        };
        for &other in above {
            let other = self.root(other);
            if other != region && self.takes(other, line, ends).is_some() && self.meets(region, other) {
                self.join(region, other);
            }
        }
        self.regions[region].extend_from_slice(line);
        region
    }
}

/// Grows regions: rows from the first, lines from the left. `given`: how the first decisions that
/// are in doubt are to be decided.
pub fn regions(image: &Image, beams: &Beams, thresholds: &Thresholds, given: Vec<bool>) -> Regions {
    let size = image.size;
    let doubt = Doubt { given, ..Doubt::default() };
    let mut grower = Grower { thresholds, doubt, regions: Vec::new(), joined_into: Vec::new() };
    let mut region_of = vec![None; size.rows * size.columns];
    let mut breaks = vec![false; size.rows * size.columns];
    let mut above: Vec<(Line, usize)> = Vec::new();
    for row in 0..size.rows {
        grower.doubt.row = row;
        let exact = points(image, beams, row);
        let RowLines { lines, seam } = row_lines(&exact, size, thresholds, &mut grower.doubt);
        let unit = |point: Vector3<f64>| point.map(|c| (c / UNIT_M).round() * UNIT_M);
        let mut current = Vec::new();
        for column in (0..size.columns).filter(|&column| exact[column].is_some()) {
            let inside = lines.iter().any(|line| line.start < column && column < line.end);
            breaks[size.index(row, column)] = !inside;
        }
        for line in lines {
            let of_line: Vec<_> = exact[line.start..line.end].iter().map(|point| unit(point.unwrap())).collect();
            let touching = above.iter().filter(|(a, _)| a.start < line.end && line.start < a.end);
            let ends = [line.start, line.end - 1].map(|column| exact[column].unwrap());
            let region = grower.place(&of_line, &ends, &touching.map(|&(_, region)| region).collect::<Vec<_>>());
            current.push((line, region));
        }
        if let [(first, one), .., (last, other)] = current[..]
            && seam
            && (first.start, last.end) == (0, size.columns)
        {
            let (one, other) = (grower.root(one), grower.root(other));
            if one != other && grower.meets(one, other) {
                grower.join(one, other);
            }
        }
        for (line, region) in &mut current {
            *region = grower.root(*region);
            for column in line.start..line.end {
                region_of[size.index(row, column)] = Some(*region);
            }
        }
        above = current;
    }
    let labels: Vec<u32> =
        region_of.iter().map(|region| region.map_or(0, |region| grower.root(region) as u32 + 1)).collect();
    let class = |(pixel, &label): ((usize, usize), &u32)| match (image.range(pixel), label) {
        (None, _) => Class::NoReturn,
        (Some(_), 0) => Class::Edge,
        _ => Class::Area,
    };
    let classes = size.pixels().zip(&labels).map(class).collect();
    Regions { classes, breaks, labels: crate::art::canonical(&labels), doubt: grower.doubt }
}
