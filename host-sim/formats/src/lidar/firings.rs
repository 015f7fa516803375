//! A spinning lidar as it comes: each firing of all lasers is a row.
//!
//! Rows turn to the right about the upright axis, columns are the rings from the top. Rings that look
//! to the right of the others wait for them, so that a row is what lies in one direction. A turn has no
//! fixed number of rows.

use std::collections::VecDeque;

use crate::angles::Angles;
use crate::beside::Beside;
use crate::geometry::{Geometry, Kind, TurnAxis};
use crate::lidar::ouster::columns;
use crate::lidar::ouster_metadata::Metadata;
use crate::lidar::velodyne::{Model, firings};
use crate::scan_error::ScanError;

/// A Velodyne that has not fired for so long has lost packets, in steps from firing to firing.
const GAP_STEPS: f64 = 1.5;
/// A sensor that turns so far without firing has been told to look elsewhere only, degrees.
const BLIND_DEG: f64 = 45.0;
/// The most firings by which a ring waits: an eighth of a turn of 4096.
const MOST_WAITS: i64 = 512;

/// A firing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiringRow<'a> {
    /// Where the sensor is in its turn, degrees: 0 down to more than -360.
    pub turn_deg: f64,
    /// Whether a turn begins with it.
    pub begins_turn: bool,
    /// Range of each ring from the top, metres; 0 where there is none.
    pub range_m: &'a [f32],
}

/// Makes rows of packets.
pub struct FiringRows {
    sensor: Sensor,
    /// Firings by which each ring waits, and how far to the right of the row it then looks, degrees.
    rings: Vec<Ring>,
    /// Where the last row was, degrees to the right.
    last_deg: Option<f64>,
    /// The last firings, the newest first, as many as the longest wait.
    fired_m: VecDeque<Vec<f32>>,
    /// Rows that did not come, or not in time.
    pub lost: u64,
    /// Packets of something else.
    pub other_packets: u64,
}

enum Sensor {
    Ouster(Box<Metadata>),
    Velodyne { model: Model, lasers: Vec<usize> },
}

/// A ring of a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ring {
    waits: usize,
    right_deg: f64,
}

/// Returns the rings that look so far to the right of the encoder when they fire.
fn rings(right_deg: impl Iterator<Item = f64> + Clone, step_deg: f64) -> Vec<Ring> {
    let firings = right_deg.clone().map(|deg| (deg / step_deg).round() as i64);
    let least = firings.clone().min().unwrap_or(0);
    let ring = |(firings, right_deg): (i64, f64)| {
        let waits = (firings - least).clamp(0, MOST_WAITS) as usize;
        Ring { waits, right_deg: right_deg - waits as f64 * step_deg }
    };
    firings.zip(right_deg).map(ring).collect()
}

impl FiringRows {
    /// For the sensor of a packet: a Velodyne tells itself, an Ouster needs its metadata.
    ///
    /// # Errors
    /// [`ScanError::Lacks`] if it is of no sensor that is known, or of another than the metadata says.
    pub fn of(packet: &[u8], metadata: Option<&Metadata>) -> Result<FiringRows, ScanError> {
        let (sensor, rings) = match metadata {
            Some(metadata) if packet.len() == metadata.packet_bytes() => {
                let step_deg = 360.0 / metadata.columns as f64;
                (Sensor::Ouster(Box::new(metadata.clone())), rings(metadata.azimuth_deg.iter().copied(), step_deg))
            }
            Some(metadata) => {
                let (came, expected) = (packet.len(), metadata.packet_bytes());
                return Err(ScanError::lacks(
                    "a packet",
                    format!("the {expected} bytes of this Ouster: it has {came}"),
                ));
            }
            None => {
                let (model, lasers) = (Model::of(packet)?, Model::of(packet)?.rings());
                let turning = firings(model, packet).map(|firing| firing.step_deg).find(|step_deg| *step_deg > 0.0);
                let step_deg = turning.unwrap_or(0.2);
                let right_deg = lasers.iter().map(|laser| model.right_deg(*laser, step_deg));
                let rings = rings(right_deg, step_deg);
                (Sensor::Velodyne { model, lasers }, rings)
            }
        };
        let fired_m = VecDeque::new();
        Ok(FiringRows { sensor, rings, last_deg: None, fired_m, lost: 0, other_packets: 0 })
    }

    /// Returns the rings, which are the columns of a row.
    pub fn columns(&self) -> usize {
        self.rings.len()
    }

    /// Returns where the beams point, with the turn left out, and what is known of the errors.
    pub fn geometry(&self) -> Geometry {
        let (elevation_deg, lever_arm_m) = match &self.sensor {
            Sensor::Ouster(metadata) => (metadata.elevation_deg.clone(), metadata.beam_origin_m[0]),
            Sensor::Velodyne { model, lasers } => {
                (lasers.iter().map(|laser| model.elevation_deg(*laser)).collect(), 0.0)
            }
        };
        let (beam_deg, turn_deg) = (Angles::Listed(elevation_deg), Angles::Even { start_deg: 0.0, step_deg: -0.2 });
        let mut geometry = Geometry::of(Kind::Nodding { beam_deg, turn_deg, turn_axis: TurnAxis::Z });
        let left_deg = Angles::Listed(self.rings.iter().map(|ring| -ring.right_deg).collect());
        geometry.beside = Beside { column_offset_deg: Some(left_deg), lever_arm_m, ..Beside::NONE };
        match &self.sensor {
            Sensor::Ouster(metadata) => metadata.with_errors(geometry),
            Sensor::Velodyne { model, .. } => model.with_errors(geometry),
        }
    }

    /// Adds a packet, and calls `row` for each of its firings. One that comes after a later one is lost.
    pub fn push(&mut self, packet: &[u8], mut row: impl FnMut(FiringRow<'_>)) {
        let FiringRows { sensor, rings, last_deg, fired_m, lost, other_packets } = self;
        let waits = rings.iter().map(|ring| ring.waits).max().unwrap_or(0);
        let mut came = 0;
        let mut row_m = vec![0.0; rings.len()];
        let mut take = |deg: f64, step_deg: f64, ranges_m: Vec<f32>| {
            came += 1;
            let moved_deg = last_deg.map(|last_deg| (deg - last_deg).rem_euclid(360.0));
            if moved_deg.is_some_and(|moved_deg| moved_deg > 360.0 - BLIND_DEG) {
                *lost += 1;
                return;
            }
            let missing = moved_deg.map_or(0, |moved_deg| (moved_deg / step_deg).round() as usize).saturating_sub(1);
            if moved_deg.is_some_and(|moved_deg| (GAP_STEPS * step_deg..BLIND_DEG).contains(&moved_deg)) {
                *lost += missing as u64;
            }
            // what did not come has no ranges
            (0..missing.min(waits)).for_each(|_| fired_m.push_front(vec![]));
            fired_m.push_front(ranges_m);
            fired_m.truncate(waits + 1);
            for ((column, ring), range_m) in rings.iter().enumerate().zip(&mut row_m) {
                *range_m = fired_m.get(ring.waits).and_then(|fired| fired.get(column)).copied().unwrap_or(0.0);
            }
            let begins_turn = last_deg.is_none_or(|last_deg| deg < last_deg);
            *last_deg = Some(deg);
            row(FiringRow { turn_deg: -deg, begins_turn, range_m: &row_m });
        };
        match sensor {
            Sensor::Ouster(metadata) => {
                let step_deg = 360.0 / metadata.columns as f64;
                let out_m = metadata.beam_origin_m[0].hypot(metadata.beam_origin_m[1]);
                for column in columns(metadata, packet) {
                    let metres = |mm| if mm == 0 { 0.0 } else { (f64::from(mm) / 1000.0 - out_m).max(0.0) as f32 };
                    take(column.column as f64 * step_deg, step_deg, column.ranges_mm().map(metres).collect());
                }
            }
            Sensor::Velodyne { model, lasers } => {
                for firing in firings(*model, packet) {
                    let metres = |laser: &usize| (f64::from(firing.counts[*laser]) * model.unit_m()) as f32;
                    take(firing.azimuth_deg, firing.step_deg.max(0.01), lasers.iter().map(metres).collect());
                }
            }
        }
        if came == 0 {
            *other_packets += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::made_up::velodyne_packet;
    use crate::lidar::turns::Turns;

    /// Where the points of rows lie.
    fn points(rows: &FiringRows, turn_deg: f64, range_m: &[f32]) -> Vec<[f64; 3]> {
        let mut geometry = rows.geometry();
        let Kind::Nodding { turn_deg: turns, .. } = &mut geometry.kind else { panic!() };
        *turns = Angles::Listed(vec![turn_deg]);
        let point = |(column, range_m): (usize, &f32)| {
            let (origin, direction) = (geometry.origin(0, column), geometry.direction(0, column));
            [0, 1, 2].map(|i| origin[i] + direction[i] * f64::from(*range_m))
        };
        range_m.iter().enumerate().map(point).collect()
    }

    #[test]
    fn firings_lie_where_the_image_of_the_turn_has_them() {
        for model in [Model::Vlp16, Model::Vlp32c] {
            let packets: Vec<Vec<u8>> =
                (0..76).map(|i| velodyne_packet(model, ((i * 12 * 40) % 36000) as u16, 40, false)).collect();
            let mut rows = FiringRows::of(&packets[0], None).unwrap();
            let mut found = vec![];
            for packet in &packets[..75] {
                let mut came = vec![];
                rows.push(packet, |row| came.push((row.turn_deg, row.range_m.to_vec())));
                found.extend(came);
            }
            assert_eq!((rows.lost, found.len()), (0, 75 * 12 * 32 / model.lasers()));
            let mut turns = Turns::new(model);
            let turn = packets.iter().find_map(|packet| turns.push(packet)).unwrap();
            let (image, geometry) = turn.image();
            let waits: Vec<usize> = rows.rings.iter().map(|ring| ring.waits).collect();
            assert_eq!(waits.iter().max(), Some(&if model == Model::Vlp16 { 1 } else { 22 }));
            let step_deg = 0.4 * model.lasers() as f64 / 32.0;
            for (at, (turn_deg, range_m)) in found.iter().enumerate().skip(22) {
                for (ring, point) in points(&rows, *turn_deg, range_m).into_iter().enumerate() {
                    let right_deg = model.right_deg(model.rings()[ring], step_deg);
                    let to = (at - waits[ring]) as f64 + (right_deg / step_deg).round();
                    let to = to.rem_euclid(image.columns as f64) as usize;
                    let m = f64::from(image.range_m[ring * image.columns + to]);
                    let same = geometry.direction(ring, to).map(|u| u * m);
                    assert!((0..3).all(|i| (point[i] - same[i]).abs() < 1e-5), "{at} {ring}: {point:?} {same:?}");
                }
            }
        }
    }

    #[test]
    fn what_is_lost_and_where_turns_begin_is_said() {
        let packet = |azimuth: u32| velodyne_packet(Model::Vlp32c, (azimuth % 36000) as u16, 40, false);
        let mut rows = FiringRows::of(&packet(0), None).unwrap();
        let mut begun = vec![];
        let mut count = 0;
        // one is lost, one comes late
        for azimuth in [35000, 35960, 36440, 35960, 36920] {
            rows.push(&packet(azimuth), |row| {
                if row.begins_turn {
                    begun.push(count);
                }
                count += 1;
            });
        }
        rows.push(&[0; 512], |_| panic!("no packet"));
        assert_eq!((rows.lost, rows.other_packets, count), (12 + 12, 1, 48));
        assert_eq!(begun, [0, 13]);
        assert!(FiringRows::of(&[0; 1206], None).is_err());
    }
}
