//! The simulated scanner: where its beams point, and what it gets wrong.

use std::{error, fmt};

use scanseg_formats::{Angles, Beside, Depth, Geometry, Kind, Noise, TurnAxis};

use crate::office::rng::Rng;
use crate::office::scene::Scene;

/// Metres per count of a scan whose ranges are not quantised: 65535 counts reach 16 m.
const UNIT_M: f64 = 0.000_25;

/// Neighbouring beams on different surfaces are at a depth edge from this difference of range on.
const DEPTH_EDGE_M: f64 = 0.1;

/// A scanner and its errors. The constructors give one without errors; each error is 0 for none,
/// and is drawn from a stream of its own, so that switching one on leaves the others as they were.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensor {
    /// Rows; the angles of `kind` must cover them.
    pub rows: usize,
    /// Columns; the angles of `kind` must cover them.
    pub columns: usize,
    /// Where its beams are meant to point.
    pub kind: Kind,
    /// Standard deviation of one range, metres, 0 or more. Normal, the same at every range.
    pub range_noise_m: f64,
    /// Ranges are rounded to a multiple of this, metres, 0 or more.
    pub quantisation_m: f64,
    /// Probability that a beam returns nothing, 0 to 1.
    pub drop_out: f64,
    /// Probability, 0 to 1, that a beam next to a depth edge (one of its four neighbours is on
    /// another surface and 0.1 m or more nearer or farther) returns a range uniformly between the
    /// two. Its truth stays the surface it points at.
    pub mixed_pixels: f64,
    /// Returns farther than this are lost, metres, above 0. Infinite for no limit.
    pub max_range_m: f64,
    /// Standard deviation of each row's turn angle about the even one, degrees, 0 or more; the
    /// geometry reports it truly. Nodding scanners only.
    pub turn_uneven_deg: f64,
    /// Standard deviation of the turn angle's misreporting, degrees, 0 or more: a servo's seams.
    /// Every 25 rows or so the true angle jumps to a new difference from the one in the geometry.
    /// Nodding scanners only.
    pub turn_misreported_deg: f64,
}

impl Sensor {
    fn ideal(rows: usize, columns: usize, kind: Kind) -> Self {
        Self {
            rows,
            columns,
            kind,
            range_noise_m: 0.0,
            quantisation_m: 0.0,
            drop_out: 0.0,
            mixed_pixels: 0.0,
            max_range_m: f64::INFINITY,
            turn_uneven_deg: 0.0,
            turn_misreported_deg: 0.0,
        }
    }

    /// Returns the paper's set-up: a 2D scanner that nods. Columns go from -90 (right) to +90
    /// degrees (left) inclusive; rows turn through 100 degrees, from 50 up downwards. 200 rows x
    /// 361 columns make steps of 0.5 degrees.
    pub fn nodding(rows: usize, columns: usize) -> Self {
        let kind = Kind::Nodding {
            beam_deg: Angles::Even { start_deg: -90.0, step_deg: 180.0 / columns.saturating_sub(1).max(1) as f64 },
            turn_deg: Angles::Even { start_deg: 50.0, step_deg: -100.0 / rows.max(1) as f64 },
            turn_axis: TurnAxis::Y,
        };
        Self::ideal(rows, columns, kind)
    }

    /// Returns a spinning scanner: columns go once round from straight behind by the left, so that
    /// forward is in the middle; rows go from 45 degrees up to 45 down.
    pub fn spinning(rows: usize, columns: usize) -> Self {
        let kind = Kind::Spinning {
            azimuth_deg: Angles::Even { start_deg: 180.0, step_deg: -360.0 / columns.max(1) as f64 },
            elevation_deg: Angles::Even { start_deg: 45.0, step_deg: -90.0 / rows.saturating_sub(1).max(1) as f64 },
            wraps: true,
        };
        Self::ideal(rows, columns, kind)
    }

    /// Returns a camera that looks forward, 70 degrees wide, with square pixels.
    pub fn pinhole(rows: usize, columns: usize) -> Self {
        let f_px = columns.max(1) as f64 / 2.0 / libm::tan(35f64.to_radians());
        let (cx_px, cy_px) = ((columns as f64 - 1.0) / 2.0, (rows as f64 - 1.0) / 2.0);
        Self::ideal(rows, columns, Kind::Pinhole { fx_px: f_px, fy_px: f_px, cx_px, cy_px, depth: Depth::Range })
    }

    /// The same from the last row to the first: a nodding scanner that turns upward.
    #[must_use]
    pub fn from_below(mut self) -> Self {
        let rows = self.rows;
        if let Kind::Nodding { turn_deg, .. } = &mut self.kind {
            *turn_deg = match turn_deg {
                Angles::Even { start_deg, step_deg } => {
                    let last_deg = *start_deg + rows.saturating_sub(1) as f64 * *step_deg;
                    Angles::Even { start_deg: last_deg, step_deg: -*step_deg }
                }
                Angles::Listed(list) => Angles::Listed(list.iter().rev().copied().collect()),
            };
        }
        self
    }

    fn check(&self) -> Result<(), SensorError> {
        let at_least_0 = |name, value| match value >= 0.0 && f64::is_finite(value) {
            true => Ok(()),
            false => Err(SensorError::Value { name, value }),
        };
        let probability = |name, value| match (0.0..=1.0).contains(&value) {
            true => Ok(()),
            false => Err(SensorError::Value { name, value }),
        };
        let angles = |angles: &Angles, needed| match angles {
            Angles::Listed(list) if list.len() < needed => Err(SensorError::Angles { listed: list.len(), needed }),
            _ => Ok(()),
        };
        at_least_0("range_noise_m", self.range_noise_m)?;
        at_least_0("quantisation_m", self.quantisation_m)?;
        at_least_0("turn_uneven_deg", self.turn_uneven_deg)?;
        at_least_0("turn_misreported_deg", self.turn_misreported_deg)?;
        probability("drop_out", self.drop_out)?;
        probability("mixed_pixels", self.mixed_pixels)?;
        if self.max_range_m.is_nan() || self.max_range_m <= 0.0 {
            return Err(SensorError::Value { name: "max_range_m", value: self.max_range_m });
        }
        match &self.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => {
                angles(beam_deg, self.columns)?;
                angles(turn_deg, self.rows)
            }
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => {
                angles(azimuth_deg, self.columns)?;
                angles(elevation_deg, self.rows)
            }
            Kind::Pinhole { .. } => Ok(()),
            Kind::Free { directions, columns, .. } => {
                let (listed, needed) = (directions.len(), self.rows * self.columns);
                let fits = listed == needed && *columns == self.columns;
                if fits { Ok(()) } else { Err(SensorError::Angles { listed, needed }) }
            }
        }
    }
}

/// A simulated range image, row by row.
#[derive(Clone, Debug, PartialEq)]
pub struct SimulatedScan {
    /// Rows.
    pub rows: usize,
    /// Columns.
    pub columns: usize,
    /// Range along the beam of each pixel, metres; 0 where nothing came back.
    pub range_m: Vec<f32>,
    /// Id of the surface that the middle of each beam met, 0 where nothing came back. A flat face
    /// of a body has one id, a curved side has one; parts of it that other things separate share
    /// it. Ids count from 1 with gaps.
    pub truth: Vec<u16>,
    /// Where the beams point, as far as the scanner knows. Its unit is the quantisation, or 0.25 mm
    /// without one.
    pub geometry: Geometry,
}

/// Why a sensor cannot scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorError {
    /// A field is not in its range.
    Value {
        /// The field.
        name: &'static str,
        /// What it holds.
        value: f64,
    },
    /// A list of angles is shorter than the rows or columns.
    Angles {
        /// Angles listed.
        listed: usize,
        /// Rows or columns.
        needed: usize,
    },
}

impl fmt::Display for SensorError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            SensorError::Value { name, value } => write!(f, "sensor: {name} = {value} is out of range"),
            SensorError::Angles { listed, needed } => write!(f, "sensor: {listed} angles listed, {needed} needed"),
        }
    }
}

impl error::Error for SensorError {}

impl Scene {
    /// Scans the scene. The same scene, sensor and seed give the same scan on every platform;
    /// another seed gives other errors. Fails only where a field of the sensor is out of its range.
    pub fn scan(&self, sensor: &Sensor, seed: u64) -> Result<SimulatedScan, SensorError> {
        self.scan_bent(sensor, seed, |_| ())
    }

    /// Returns the random numbers of an error.
    pub(super) fn stream(&self, seed: u64, error: u64) -> Rng {
        Rng::new([seed, (self.set as u64) << 32 | u64::from(self.number), error])
    }

    /// Scans the scene with beams that `bend` turns away from where the geometry says.
    pub(super) fn scan_bent(
        &self,
        sensor: &Sensor,
        seed: u64,
        bend: impl FnOnce(&mut Kind),
    ) -> Result<SimulatedScan, SensorError> {
        sensor.check()?;
        let stream = |error| self.stream(seed, error);
        let (reported, mut pointed) = turned(sensor, &mut stream(1), &mut stream(2));
        bend(&mut pointed);
        let (ideal_m, mut truth) = self.ideal(sensor, &pointed);
        let (mut mixing, mut noise, mut dropping) = (stream(3), stream(4), stream(5));
        let mut range_m = Vec::with_capacity(truth.len());
        for i in 0..truth.len() {
            // Each stream is drawn once per pixel, whatever the pixel saw.
            let (mixed, share) = (mixing.chance(sensor.mixed_pixels), mixing.unit());
            let error_m = noise.normal() * sensor.range_noise_m;
            let dropped = dropping.chance(sensor.drop_out);
            let mut range = ideal_m[i];
            if mixed && let Some(other_m) = across_edge(sensor, &ideal_m, &truth, i) {
                range += share * (other_m - range);
            }
            range += error_m;
            if sensor.quantisation_m > 0.0 {
                range = (range / sensor.quantisation_m).round() * sensor.quantisation_m;
            }
            let returned = truth[i] != 0 && !dropped && range > 0.0 && range <= sensor.max_range_m;
            range_m.push(if returned { range as f32 } else { 0.0 });
        }
        truth.iter_mut().zip(&range_m).filter(|(_, range)| **range == 0.0).for_each(|(id, _)| *id = 0);
        let geometry = Geometry {
            unit_m: if sensor.quantisation_m > 0.0 { sensor.quantisation_m } else { UNIT_M },
            no_return: vec![],
            min_range_m: None,
            max_range_m: sensor.max_range_m.is_finite().then_some(sensor.max_range_m),
            range_noise_m: (sensor.range_noise_m > 0.0).then_some(sensor.range_noise_m),
            noise: Noise::NONE,
            kind: reported,
            beside: Beside::NONE,
        };
        Ok(SimulatedScan { rows: sensor.rows, columns: sensor.columns, range_m, truth, geometry })
    }

    /// Ranges and surface ids without errors of range; 0 where nothing comes back.
    fn ideal(&self, sensor: &Sensor, kind: &Kind) -> (Vec<f64>, Vec<u16>) {
        let beams = Directions::new(kind, sensor.rows, sensor.columns);
        let pixels = (0..sensor.rows).flat_map(|row| (0..sensor.columns).map(move |column| (row, column)));
        pixels.map(|(row, column)| self.cast(beams.direction(row, column)).unwrap_or((0.0, 0))).unzip()
    }
}

/// Returns the beams as reported and as they truly point.
fn turned(sensor: &Sensor, uneven: &mut Rng, misreported: &mut Rng) -> (Kind, Kind) {
    let (mut reported, mut pointed) = (sensor.kind.clone(), sensor.kind.clone());
    if let (Kind::Nodding { turn_deg: said, .. }, Kind::Nodding { turn_deg: done, .. }) = (&mut reported, &mut pointed)
    {
        let mut turns: Vec<f64> = (0..sensor.rows).map(|row| said.at(row)).collect();
        if sensor.turn_uneven_deg > 0.0 {
            turns.iter_mut().for_each(|turn| *turn += uneven.normal() * sensor.turn_uneven_deg);
            *said = Angles::Listed(turns.clone());
            *done = said.clone();
        }
        if sensor.turn_misreported_deg > 0.0 {
            let mut off_deg = 0.0;
            for turn in &mut turns {
                if misreported.chance(1.0 / 25.0) {
                    off_deg = misreported.normal() * sensor.turn_misreported_deg;
                }
                *turn += off_deg;
            }
            *done = Angles::Listed(turns);
        }
    }
    (reported, pointed)
}

/// Returns the range beyond a depth edge beside pixel `i`: of the neighbours across one, that which
/// differs most.
fn across_edge(sensor: &Sensor, range_m: &[f64], truth: &[u16], i: usize) -> Option<f64> {
    let (row, column) = (i / sensor.columns, i % sensor.columns);
    let neighbours = [
        (row > 0).then(|| i - sensor.columns),
        (row + 1 < sensor.rows).then(|| i + sensor.columns),
        (column > 0).then(|| i - 1),
        (column + 1 < sensor.columns).then(|| i + 1),
    ];
    let gap = |j: &usize| (range_m[*j] - range_m[i]).abs();
    let across = |j: &usize| truth[*j] != 0 && truth[*j] != truth[i] && gap(j) >= DEPTH_EDGE_M;
    let best = neighbours.into_iter().flatten().filter(across).max_by(|a, b| gap(a).total_cmp(&gap(b)));
    best.map(|j| range_m[j])
}

/// (cos a, sin a) of an angle.
type CosSin = (f64, f64);

/// Beam directions by the formulas of [`Geometry::direction`], with sines that are the same on
/// every platform.
enum Directions {
    /// The angles of rows and columns, and which formula joins them.
    Angular { rows: Vec<CosSin>, columns: Vec<CosSin>, join: fn(CosSin, CosSin) -> [f64; 3] },
    /// Focal lengths and centre, along a row and along a column.
    Pinhole { f_px: [f64; 2], c_px: [f64; 2] },
    /// One for each pixel, and the pixels of a row.
    Free(Vec<[f32; 3]>, usize),
}

impl Directions {
    fn new(kind: &Kind, rows: usize, columns: usize) -> Self {
        let table = |angles: &Angles, count: usize| {
            let radians = (0..count).map(|i| angles.at(i).to_radians());
            radians.map(|a| (libm::cos(a), libm::sin(a))).collect::<Vec<_>>()
        };
        match kind {
            Kind::Nodding { beam_deg, turn_deg, turn_axis } => Directions::Angular {
                rows: table(turn_deg, rows),
                columns: table(beam_deg, columns),
                join: match turn_axis {
                    TurnAxis::Y => |(ct, st), (cb, sb)| [cb * ct, sb, cb * st],
                    TurnAxis::Z => |(ct, st), (cb, sb)| [cb * ct, cb * st, sb],
                },
            },
            Kind::Spinning { azimuth_deg, elevation_deg, .. } => Directions::Angular {
                rows: table(elevation_deg, rows),
                columns: table(azimuth_deg, columns),
                join: |(ce, se), (ca, sa)| [ce * ca, ce * sa, se],
            },
            Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } => {
                Directions::Pinhole { f_px: [*fx_px, *fy_px], c_px: [*cx_px, *cy_px] }
            }
            Kind::Free { directions, columns, .. } => Directions::Free(directions.clone(), *columns),
        }
    }

    fn direction(&self, row: usize, column: usize) -> [f64; 3] {
        match self {
            Directions::Angular { rows, columns, join } => join(rows[row], columns[column]),
            Directions::Pinhole { f_px: f, c_px: c } => {
                let (u, v) = (-(column as f64 - c[0]) / f[0], -(row as f64 - c[1]) / f[1]);
                let n = libm::sqrt(1.0 + u * u + v * v);
                [1.0 / n, u / n, v / n]
            }
            Directions::Free(directions, columns) => directions[row * columns + column].map(f64::from),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::office::Set;

    #[test]
    fn beams_point_where_the_geometry_says() {
        let mut pan = Sensor::nodding(20, 31);
        if let Kind::Nodding { turn_axis, .. } = &mut pan.kind {
            *turn_axis = TurnAxis::Z;
        }
        for sensor in [Sensor::nodding(20, 31), pan, Sensor::spinning(20, 31), Sensor::pinhole(20, 31)] {
            let beams = Directions::new(&sensor.kind, 20, 31);
            let geometry = Scene::numbered(Set::Tuning, 0).scan(&sensor, 0).unwrap().geometry;
            for (row, column) in (0..20).flat_map(|row| (0..31).map(move |column| (row, column))) {
                let (ours, told) = (beams.direction(row, column), geometry.direction(row, column));
                assert!((0..3).all(|k| (ours[k] - told[k]).abs() < 1e-14), "{ours:?} {told:?}");
            }
        }
    }

    #[test]
    fn default_angles_are_those_of_the_paper() {
        let Kind::Nodding { beam_deg, turn_deg, .. } = Sensor::nodding(200, 361).kind else { unreachable!() };
        assert_eq!((beam_deg.at(0), beam_deg.at(1), beam_deg.at(360)), (-90.0, -89.5, 90.0));
        assert_eq!((turn_deg.at(0), turn_deg.at(1), turn_deg.at(199)), (50.0, 49.5, -49.5));
    }
}
