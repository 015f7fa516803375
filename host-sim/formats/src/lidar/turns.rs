//! Velodyne: firings to turns, and turns to range images.
//!
//! A row is a ring, a column a firing. Lasers that look beside the encoder are put into the column
//! into which they look; what is left of it is their `row_offset_deg`. The turn is measured in
//! hundredths of a degree and is not quite even, so that an azimuth is right to some hundredths.

use crate::angles::Angles;
use crate::beside::Beside;
use crate::geometry::{Geometry, Kind};
use crate::lidar::velodyne::{Firing, Model, firings};
use crate::range_image::RangeImage;

/// The most firings of a turn: at 300 turns a minute there are 3617.
const MAX_FIRINGS: usize = 8192;
/// A sensor that turns so far without firing has been told to look elsewhere only, degrees.
const BLIND_DEG: f64 = 45.0;
/// Fewer firings are no scan.
const LEAST_FIRINGS: usize = 32;

/// One turn of a Velodyne.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The sensor.
    pub model: Model,
    /// Its firings, to the right.
    pub firings: Vec<Firing>,
    /// Whether it goes all the way round.
    pub whole: bool,
}

/// Puts packets together to turns. The first turn begins with the first packet, wherever it looks.
pub struct Turns {
    model: Model,
    firings: Vec<Firing>,
    turned_deg: f64,
}

impl Turns {
    /// For the packets of one sensor.
    pub fn new(model: Model) -> Turns {
        Turns { model, firings: vec![], turned_deg: 0.0 }
    }

    /// Adds a packet. Returns the turn that it completes.
    pub fn push(&mut self, packet: &[u8]) -> Option<Turn> {
        let mut done = None;
        for firing in firings(self.model, packet) {
            let last_deg = self.firings.last().map_or(firing.azimuth_deg, |last| last.azimuth_deg);
            let moved_deg = (firing.azimuth_deg - last_deg).rem_euclid(360.0);
            self.turned_deg += moved_deg;
            let whole = self.turned_deg >= 360.0 && moved_deg <= BLIND_DEG;
            if whole || moved_deg > BLIND_DEG || self.firings.len() == MAX_FIRINGS {
                done = done.or(self.take(whole));
                self.turned_deg = 0.0;
            }
            self.firings.push(firing);
        }
        done
    }

    /// Returns the last turn, if it is one.
    pub fn finish(&mut self) -> Option<Turn> {
        let step_deg = self.firings.last().map_or(0.0, |last| last.step_deg);
        let whole = self.turned_deg + 1.5 * step_deg >= 360.0;
        self.turned_deg = 0.0;
        self.take(whole)
    }

    fn take(&mut self, whole: bool) -> Option<Turn> {
        let firings = std::mem::take(&mut self.firings);
        (firings.len() >= LEAST_FIRINGS).then_some(Turn { model: self.model, firings, whole })
    }
}

impl Turn {
    /// Returns the range image of the turn and where its beams point.
    pub fn image(&self) -> (RangeImage, Geometry) {
        let (model, columns) = (self.model, self.firings.len());
        let step_deg = self.step_deg();
        let rings = model.rings();
        let mut range_m = vec![0.0; rings.len() * columns];
        let mut offsets_deg = Vec::with_capacity(rings.len());
        for (row, laser) in range_m.chunks_exact_mut(columns).zip(&rings) {
            let right_deg = model.right_deg(*laser, step_deg);
            let shift = (right_deg / step_deg).round();
            let mut beside_deg = 0.0;
            let mut counted = 0u32;
            for (from, firing) in self.firings.iter().enumerate() {
                let to = from as f64 + shift;
                let inside = (0.0..columns as f64).contains(&to);
                if !inside && !self.whole {
                    continue;
                }
                let to = to.rem_euclid(columns as f64) as usize;
                row[to] = (f64::from(firing.counts[*laser]) * model.unit_m()) as f32;
                if inside {
                    let turned_deg = firing.azimuth_deg - self.firings[to].azimuth_deg;
                    beside_deg += (turned_deg + 180.0).rem_euclid(360.0) - 180.0 + right_deg;
                    counted += 1;
                }
            }
            offsets_deg.push(-beside_deg / f64::from(counted.max(1)));
        }
        let image = RangeImage { rows: rings.len(), columns, range_m };
        let elevation_deg = rings.iter().map(|laser| model.elevation_deg(*laser)).collect();
        let mut geometry = Geometry::of(Kind::Spinning {
            azimuth_deg: Angles::Listed(self.firings.iter().map(|firing| -firing.azimuth_deg).collect()),
            elevation_deg: Angles::Listed(elevation_deg),
            wraps: self.whole,
        });
        geometry.beside = Beside { row_offset_deg: Some(Angles::Listed(offsets_deg)), ..Beside::NONE };
        (image, model.with_errors(geometry))
    }

    /// Returns what is to be said of it.
    pub(crate) fn remarks(&self) -> Vec<String> {
        let part = format!("a part of a turn: {} firings", self.firings.len());
        if self.whole { vec![] } else { vec![part] }
    }

    /// From firing to firing, degrees: the median.
    fn step_deg(&self) -> f64 {
        let mut steps: Vec<f64> = self.firings.iter().map(|firing| firing.step_deg).collect();
        steps.sort_by(f64::total_cmp);
        // a sensor that stands still has no turn
        steps[steps.len() / 2].max(0.001)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::made_up::velodyne_packet as packet;

    #[test]
    fn turns_end_where_they_began() {
        // blocks of half a degree: 12 of them a packet, 60 packets a turn
        let mut turns = Turns::new(Model::Vlp32c);
        let mut done = vec![];
        for i in 0..130 {
            done.extend(turns.push(&packet(Model::Vlp32c, ((12345 + i * 12 * 50) % 36000) as u16, 50, false)));
        }
        let counts: Vec<_> = done.iter().map(|turn| (turn.firings.len(), turn.whole)).collect();
        assert_eq!(counts, [(720, true), (720, true)]);
        assert_eq!(done[1].firings[0].azimuth_deg, 123.45);
        assert_eq!(turns.finish().map(|turn| (turn.firings.len(), turn.whole)), Some((120, false)));
        assert_eq!(turns.finish(), None);
    }

    #[test]
    fn each_point_lies_where_its_laser_looked() {
        for model in [Model::Vlp16, Model::Vlp32c] {
            let mut turns = Turns::new(model);
            let turn =
                (0..80).find_map(|i| turns.push(&packet(model, ((i * 12 * 40) % 36000) as u16, 40, false))).unwrap();
            let (image, geometry) = turn.image();
            geometry.check().unwrap();
            geometry.fits(image.rows, image.columns).unwrap();
            let step_deg = 0.4 * model.lasers() as f64 / 32.0;
            for (row, laser) in model.rings().into_iter().enumerate() {
                let right_deg = model.right_deg(laser, step_deg);
                for (from, firing) in turn.firings.iter().enumerate() {
                    let to = (from as f64 + (right_deg / step_deg).round()).rem_euclid(image.columns as f64) as usize;
                    let range_m = f64::from(image.range_m[row * image.columns + to]);
                    assert!((range_m - f64::from(firing.counts[laser]) * model.unit_m()).abs() < 1e-5);
                    let [x, y, z] = geometry.direction(row, to);
                    let azimuth_deg = (-y).atan2(x).to_degrees();
                    let off_deg = (firing.azimuth_deg + right_deg - azimuth_deg + 180.0).rem_euclid(360.0) - 180.0;
                    assert!(off_deg.abs() < 1e-6, "{model:?} {row} {from}: {off_deg}");
                    assert!((z.asin().to_degrees() - model.elevation_deg(laser)).abs() < 1e-9);
                }
            }
            let Some(Angles::Listed(offsets)) = geometry.beside.row_offset_deg else { panic!() };
            assert!(offsets.iter().all(|deg| deg.abs() <= step_deg / 2.0 + 1e-9), "{offsets:?}");
        }
    }

    #[test]
    fn a_sensor_that_looks_at_a_part_of_its_turn() {
        let mut turns = Turns::new(Model::Vlp32c);
        let mut done = vec![];
        // 20 packets of 6 degrees each, then nothing until it comes round
        for i in 0..60 {
            let azimuth = 30000 + 600 * (i % 20);
            done.extend(turns.push(&packet(Model::Vlp32c, (azimuth % 36000) as u16, 50, false)));
        }
        let counts: Vec<_> = done.iter().map(|turn| (turn.firings.len(), turn.whole)).collect();
        assert_eq!(counts, [(240, false), (240, false)]);
        let (image, geometry) = done[1].image();
        assert_eq!((image.rows, image.columns), (32, 240));
        assert!(matches!(geometry.kind, Kind::Spinning { wraps: false, .. }));
    }

    #[test]
    fn a_sensor_that_stands_still_makes_no_endless_turn() {
        let mut turns = Turns::new(Model::Vlp16);
        let turn = (0..1000).find_map(|_| turns.push(&packet(Model::Vlp16, 500, 0, false))).unwrap();
        assert_eq!(turn.firings.len(), MAX_FIRINGS);
        let (image, _) = turn.image();
        assert_eq!(image.columns, MAX_FIRINGS);
    }
}
