//! Troubles of real scanners beyond the errors of a [`Sensor`]: what methods must stand, one at a
//! time.

use scanseg_formats::{Angles, Kind, Noise};

use crate::office::rng::Rng;
use crate::office::scene::Scene;
use crate::office::sensor::{Sensor, SensorError, SimulatedScan};

/// What goes wrong in a scan. The geometry of the scan tells the noise truly, and of the other
/// troubles nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trouble {
    /// Nothing but the errors of the sensor.
    None,
    /// In place of the noise of the sensor, one that grows with the square of the range.
    GrowingNoise {
        /// Standard deviation close by, metres.
        constant_m: f64,
        /// And for each square metre of range squared, 1 / m.
        per_m2: f64,
    },
    /// In place of the noise of the sensor, disparities: 1 / range in steps.
    DisparitySteps {
        /// Step of 1 / range, 1 / m.
        step_per_m: f64,
        /// Standard deviation of 1 / range before it is rounded, 1 / m.
        noise_per_m: f64,
        /// Rows and columns over which that error is a mean, as cameras match patches: 1 for none.
        alike_px: usize,
    },
    /// [`Sensor::mixed_pixels`] that are no part of the truth.
    MixedPixels {
        /// Probability next to a depth edge.
        probability: f64,
    },
    /// The turn of each row is off for itself.
    TurnOff {
        /// Standard deviation, degrees.
        sd_deg: f64,
    },
    /// Beams are at so many times the angle in their row that the geometry says.
    BearingScale(f64),
    /// Rows are at so many times the turn that the geometry says.
    TurnScale(f64),
    /// The ranges of each row are off by a constant: rings that are calibrated badly.
    RingOffsets {
        /// Standard deviation, metres.
        sd_m: f64,
    },
    /// Beams that return nothing.
    Missing(Missing),
    /// The floor is not flat: smooth bumps, as of gravel or a field.
    RoughGround {
        /// Standard deviation of its height, metres.
        sd_m: f64,
        /// Distance between bumps, metres.
        patch_m: f64,
    },
}

/// Which beams return nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Missing {
    /// Every second column.
    Columns,
    /// Every second row.
    Rows,
    /// One colour of a chess-board.
    Chess,
    /// Each with this probability.
    Share(f64),
}

/// Streams of random numbers, beside those of the sensor.
const TURNS: u64 = 16;
const RANGES: u64 = 17;
const RINGS: u64 = 18;
const GONE: u64 = 19;
const GROUND: u64 = 20;

impl Scene {
    /// Scans the scene as [`Scene::scan`] does, with a trouble. Angles can be wrong of nodding
    /// scanners only.
    ///
    /// # Errors
    /// As [`Scene::scan`].
    pub fn troubled_scan(&self, sensor: &Sensor, trouble: Trouble, seed: u64) -> Result<SimulatedScan, SensorError> {
        let exact = Sensor { range_noise_m: 0.0, ..sensor.clone() };
        let mut scan = match trouble {
            Trouble::GrowingNoise { .. } | Trouble::DisparitySteps { .. } => self.scan(&exact, seed)?,
            Trouble::MixedPixels { probability } => {
                let plain = self.scan(&Sensor { mixed_pixels: 0.0, ..sensor.clone() }, seed)?;
                let mut mixed = self.scan(&Sensor { mixed_pixels: probability, ..sensor.clone() }, seed)?;
                let changed = mixed.range_m.iter().zip(&plain.range_m).map(|(now, before)| now != before);
                mixed.truth.iter_mut().zip(changed).filter(|(_, changed)| *changed).for_each(|(id, _)| *id = 0);
                mixed
            }
            _ => self.scan_bent(sensor, seed, |kind| bend(kind, sensor, trouble, self.stream(seed, TURNS)))?,
        };
        match trouble {
            Trouble::GrowingNoise { constant_m, per_m2 } => {
                let mut rng = self.stream(seed, RANGES);
                each(&mut scan, |_, range| range + rng.normal() * (constant_m + per_m2 * range * range));
                scan.geometry.range_noise_m = Some(constant_m);
                scan.geometry.noise = Noise { range_noise_per_m2: per_m2, ..scan.geometry.noise };
            }
            Trouble::DisparitySteps { step_per_m, noise_per_m, alike_px } => {
                let errors = alike((scan.rows, scan.columns), alike_px, self.stream(seed, RANGES));
                let columns = scan.columns;
                each(&mut scan, |(row, column), range| {
                    let disparity = 1.0 / range + errors[row * columns + column] * noise_per_m;
                    1.0 / ((disparity / step_per_m).round() * step_per_m)
                });
                scan.geometry.noise = Noise {
                    range_noise_per_m2: noise_per_m,
                    range_step_per_m2: step_per_m,
                    noise_correlation_px: alike_px as f64,
                    ..scan.geometry.noise
                };
            }
            Trouble::RingOffsets { sd_m } => {
                let mut rng = self.stream(seed, RINGS);
                let off_m: Vec<f64> = (0..scan.rows).map(|_| rng.normal() * sd_m).collect();
                each(&mut scan, |(row, _), range| range + off_m[row]);
            }
            Trouble::Missing(missing) => {
                let mut rng = self.stream(seed, GONE);
                each(&mut scan, |(row, column), range| {
                    let gone = match missing {
                        Missing::Columns => column % 2 == 1,
                        Missing::Rows => row % 2 == 1,
                        Missing::Chess => (row + column) % 2 == 1,
                        Missing::Share(probability) => rng.chance(probability),
                    };
                    if gone { 0.0 } else { range }
                });
            }
            Trouble::RoughGround { sd_m, patch_m } => self.roughen(&mut scan, seed, sd_m, patch_m),
            _ => {}
        }
        Ok(scan)
    }

    /// Raises and lowers the floor.
    fn roughen(&self, scan: &mut SimulatedScan, seed: u64, sd_m: f64, patch_m: f64) {
        let mut ids = scan.truth.clone();
        ids.sort_unstable();
        ids.dedup();
        // of what faces up, the floor is farthest below
        let faces_up = ids.into_iter().filter_map(|id| Some((id, self.plane(id)?))).filter(|(_, (n, _))| n[2] > 0.999);
        let Some((floor, (_, below_m))) = faces_up.min_by(|a, b| a.1.1.total_cmp(&b.1.1)) else { return };
        let height_m = |x: i64, y: i64| {
            let [x, y] = [x, y].map(|i| (i + (1 << 20)) as u64);
            self.stream(seed, GROUND << 48 | x << 24 | y).normal() * sd_m
        };
        let (truth, geometry) = (scan.truth.clone(), scan.geometry.clone());
        let columns = scan.columns;
        each(scan, |(row, column), range| {
            if truth[row * columns + column] != floor {
                return range;
            }
            let [x, y, _] = geometry.direction(row, column).map(|d| d * range / patch_m);
            let (i, j) = (x.floor(), y.floor());
            let (u, v) = (x - i, y - j);
            let (i, j) = (i as i64, j as i64);
            let near = (1.0 - u) * height_m(i, j) + u * height_m(i + 1, j);
            let far = (1.0 - u) * height_m(i, j + 1) + u * height_m(i + 1, j + 1);
            // between bumps heights are means: two thirds of their standard deviation
            let height_m = 1.5 * ((1.0 - v) * near + v * far);
            range * (1.0 + height_m / below_m)
        });
    }
}

/// Turns the beams of a nodding scanner away from where they are meant to point.
fn bend(kind: &mut Kind, sensor: &Sensor, trouble: Trouble, mut rng: Rng) {
    let Kind::Nodding { beam_deg, turn_deg, .. } = kind else { return };
    let list = |angles: &Angles, count: usize, change: &mut dyn FnMut(f64) -> f64| {
        Angles::Listed((0..count).map(|i| change(angles.at(i))).collect())
    };
    match trouble {
        Trouble::TurnOff { sd_deg } => {
            *turn_deg = list(turn_deg, sensor.rows, &mut |deg| deg + rng.normal() * sd_deg);
        }
        Trouble::TurnScale(scale) => *turn_deg = list(turn_deg, sensor.rows, &mut |deg| deg * scale),
        Trouble::BearingScale(scale) => *beam_deg = list(beam_deg, sensor.columns, &mut |deg| deg * scale),
        _ => {}
    }
}

/// Errors of variance 1 for an image of so many rows and columns, each the mean of `size` x `size` neighbours.
fn alike((rows, columns): (usize, usize), size: usize, mut rng: Rng) -> Vec<f64> {
    let wide = columns + size - 1;
    let single: Vec<f64> = (0..wide * (rows + size - 1)).map(|_| rng.normal()).collect();
    let along: Vec<f64> = single.chunks(wide).flat_map(|row| row.windows(size).map(|near| near.iter().sum())).collect();
    let down = |at: usize| (0..size).map(|row| along[at + row * columns]).sum::<f64>() / size as f64;
    (0..rows * columns).map(down).collect()
}

/// Changes each range, metres, by its row and column. What is not above 0, or infinite, is no
/// return afterwards.
fn each(scan: &mut SimulatedScan, mut change: impl FnMut((usize, usize), f64) -> f64) {
    for (i, (range_m, id)) in scan.range_m.iter_mut().zip(&mut scan.truth).enumerate() {
        if *range_m > 0.0 {
            let changed = change((i / scan.columns, i % scan.columns), f64::from(*range_m)) as f32;
            *range_m = if changed > 0.0 && changed.is_finite() { changed } else { 0.0 };
        }
        if *range_m == 0.0 {
            *id = 0;
        }
    }
}
