//! Scans of walls with noise, drawn from what the core's documentation says of beams: nothing here
//! is of the whole-image reference, which could share a fault with the core.

use crate::scenes::uniform;
use crate::stream::{Angles, Record, Rig, Scan};
use nalgebra::Vector3;
use scanseg_core::{AnyConfig, EdgeConfig, PlaneConfig, Ranging, RegionConfig, TurnAxis, live_labels};
use std::collections::BTreeMap;
use std::f32::consts::TAU;

/// A normal number of mean 0 and variance 1, the same for the same arguments.
pub fn normal(seed: u64, row: usize, column: usize) -> f64 {
    let [u, v] = [0, 1].map(|i| uniform(2 * seed + i, row, column));
    (-2.0 * (1.0 - u).ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}

/// The points p with `normal . p = distance_m`; the normal away from the scanner.
#[derive(Clone, Copy, Debug)]
#[expect(missing_docs)]
pub struct Wall {
    pub normal: Vector3<f64>,
    pub distance_m: f64,
}

/// The six walls of a box with the scanner in it: ahead, behind, left, right, above, below; the box
/// is turned to the left by so much.
pub fn room(distances_m: [f64; 6], turned_rad: f64) -> Vec<Wall> {
    let (sin, cos) = turned_rad.sin_cos();
    let (x, y, z) = (Vector3::new(cos, sin, 0.0), Vector3::new(-sin, cos, 0.0), Vector3::z());
    [x, -x, y, -y, z, -z].into_iter().zip(distances_m).map(|(normal, distance_m)| Wall { normal, distance_m }).collect()
}

/// Kinds of scanners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[expect(missing_docs)]
pub enum Kind {
    Tilting,
    Panning,
    Spinning,
    /// Spinning, and the last column neighbours the first.
    Around,
    Camera,
}

/// All of them.
pub const KINDS: [Kind; 5] = [Kind::Tilting, Kind::Panning, Kind::Spinning, Kind::Around, Kind::Camera];

/// How a scanner looks.
#[derive(Clone, Copy, Debug)]
pub struct View {
    /// What it is.
    pub kind: Kind,
    /// Rows of the image.
    pub rows: usize,
    /// Columns of the image.
    pub columns: usize,
    /// From a column to the next, radians, either way; [`Kind::Around`] takes its sign only.
    pub column_rad: f32,
    /// From a row to the next, radians: upward or downward. A camera has its rows downward, as far
    /// apart as its columns.
    pub row_rad: f32,
    /// Turn or elevation of the middle row, radians.
    pub middle_rad: f32,
}

impl View {
    /// Where the beams of its columns point.
    pub fn rig(&self) -> Rig {
        let View { kind, rows, columns, column_rad, .. } = *self;
        let even = |step_rad: f32| Angles::Even { start_rad: -0.5 * step_rad * (columns - 1) as f32, step_rad };
        match kind {
            Kind::Tilting => Rig::Nodding { angles: even(column_rad), axis: TurnAxis::Y },
            Kind::Panning => Rig::Nodding { angles: even(column_rad), axis: TurnAxis::Z },
            Kind::Spinning => Rig::Spinning { angles: even(column_rad), wraps: false },
            Kind::Around => Rig::Spinning { angles: even(TAU.copysign(column_rad) / columns as f32), wraps: true },
            Kind::Camera => {
                let (cx_px, cy_px) = (0.5 * (columns - 1) as f32, 0.5 * (rows - 1) as f32);
                Rig::Pinhole { fx_px: 1.0 / column_rad, fy_px: 1.0 / column_rad.abs(), cx_px, cy_px }
            }
        }
    }

    /// The turn angle of each row.
    pub fn turn_rad(&self) -> Vec<f32> {
        let half = 0.5 * (self.rows - 1) as f32;
        (0..self.rows).map(|row| self.middle_rad + self.row_rad * (row as f32 - half)).collect()
    }

    /// What it sees of walls, with noise of this standard deviation.
    pub fn of(&self, walls: &[Wall], noise_m: f64, seed: u64) -> Drawn {
        let scan = Scan { columns: self.columns, range_m: vec![], turn_rad: self.turn_rad(), rig: self.rig() };
        let mut drawn = Drawn { scan, truth: vec![] };
        for (row, column) in drawn.scan.size().pixels() {
            let u = direction(&drawn.scan.rig, drawn.scan.turn_rad[row], (row, column));
            let inverse = |wall: &Wall| wall.normal.dot(&u) / wall.distance_m;
            let nearest = (0..walls.len()).map(|i| (i, inverse(&walls[i]))).max_by(|a, b| a.1.total_cmp(&b.1));
            let seen = nearest.filter(|&(_, inverse)| inverse > 0.011);
            drawn.truth.push(seen.map(|(wall, _)| wall));
            let range_m = seen.map_or(f64::NAN, |(_, inverse)| 1.0 / inverse + noise_m * normal(seed, row, column));
            drawn.scan.range_m.push(range_m as f32);
        }
        drawn
    }
}

/// Where a beam points.
pub fn direction(rig: &Rig, turn_rad: f32, (row, column): (usize, usize)) -> Vector3<f64> {
    let angle = |angles: &Angles| match angles {
        Angles::Even { start_rad, step_rad } => f64::from(*start_rad) + column as f64 * f64::from(*step_rad),
        Angles::Listed(list) => list[column].into(),
    };
    let (sin_t, cos_t) = f64::from(turn_rad).sin_cos();
    match rig {
        Rig::Nodding { angles, axis } => {
            let (sin_b, cos_b) = angle(angles).sin_cos();
            match axis {
                TurnAxis::Y => Vector3::new(cos_b * cos_t, sin_b, cos_b * sin_t),
                TurnAxis::Z => Vector3::new(cos_b * cos_t, cos_b * sin_t, sin_b),
            }
        }
        Rig::Spinning { angles, .. } => {
            let (sin_a, cos_a) = angle(angles).sin_cos();
            Vector3::new(cos_t * cos_a, cos_t * sin_a, sin_t)
        }
        Rig::Pinhole { fx_px, fy_px, cx_px, cy_px } => {
            let [fx, fy, cx, cy] = [fx_px, fy_px, cx_px, cy_px].map(|&number| f64::from(number));
            Vector3::new(1.0, -(column as f64 - cx) / fx, -(row as f64 - cy) / fy).normalize()
        }
    }
}

/// A scan of walls.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// The ranges.
    pub scan: Scan,
    /// The wall of each pixel; none where no wall lies ahead within 90 m.
    pub truth: Vec<Option<usize>>,
}

impl Drawn {
    /// Removes the returns that meet a wall at more than this angle of incidence.
    #[must_use]
    pub fn within(mut self, walls: &[Wall], incidence_rad: f64) -> Drawn {
        for (pixel, (row, column)) in self.scan.size().pixels().enumerate() {
            let u = direction(&self.scan.rig, self.scan.turn_rad[row], (row, column));
            if self.truth[pixel].is_some_and(|wall| walls[wall].normal.dot(&u) < incidence_rad.cos()) {
                self.truth[pixel] = None;
                self.scan.range_m[pixel] = f32::NAN;
            }
        }
        self
    }

    /// What an approach finds, with room for all labels.
    pub fn record<'a>(&'a self, config: impl Into<AnyConfig<'a>>) -> Record {
        self.scan.record(config, (2 * self.scan.columns).max(live_labels(self.scan.columns)))
    }

    /// Pixels with a return.
    pub fn returns(&self) -> usize {
        self.truth.iter().flatten().count()
    }
}

/// Pixels of each label, the most first; 0 is no label.
pub fn sizes(labels: impl IntoIterator<Item = u32>) -> Vec<(u32, usize)> {
    let mut sizes = BTreeMap::<u32, usize>::new();
    for label in labels.into_iter().filter(|&label| label != 0) {
        *sizes.entry(label).or_default() += 1;
    }
    let mut sizes: Vec<_> = sizes.into_iter().collect();
    sizes.sort_by_key(|&(_, pixels)| std::cmp::Reverse(pixels));
    sizes
}

/// The share of pixels that two labelings of an image agree on, each label of one going with the
/// label of the other that it shares most pixels with: the lesser of the two directions.
pub fn agreement(one: &[u32], other: &[u32]) -> f64 {
    let share = |one: &[u32], other: &[u32]| {
        let mut shared = BTreeMap::<u32, BTreeMap<u32, usize>>::new();
        for (&a, &b) in one.iter().zip(other) {
            *shared.entry(a).or_default().entry(b).or_insert(0) += 1;
        }
        shared.values().filter_map(|of| of.values().max()).sum::<usize>() as f64 / one.len() as f64
    };
    share(one, other).min(share(other, one))
}

/// The approaches with their defaults for this noise.
pub fn by_planes(noise_m: f64) -> AnyConfig<'static> {
    PlaneConfig::new(Ranging::new(noise_m as f32)).into()
}

/// The paper's edge-based approach.
pub fn by_edges(noise_m: f64) -> AnyConfig<'static> {
    EdgeConfig::paper().with_ranging(Ranging::new(noise_m as f32)).into()
}

/// The paper's region-based approach.
pub fn by_regions(noise_m: f64) -> AnyConfig<'static> {
    RegionConfig::paper().with_ranging(Ranging::new(noise_m as f32)).into()
}
