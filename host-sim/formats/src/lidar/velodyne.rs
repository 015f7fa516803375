//! Velodyne VLP-16, Puck Hi-Res and VLP-32C: packets to firings.
//!
//! Axes: x forward, where the encoder is at 0; y left; z up. Velodyne's azimuths go to the right.

use crate::geometry::Geometry;
use crate::scan_error::ScanError;
use crate::sensors::Sensor;

/// Bytes of a packet.
pub const PACKET_BYTES: usize = 1206;
/// From a firing of all lasers to the next, microseconds.
const FIRING_US: f64 = 55.296;
/// From a laser, or pair of lasers, to the next, microseconds.
const LASER_US: f64 = 2.304;
const BLOCKS: usize = 12;
const BLOCK_BYTES: usize = 100;
const DUAL: u8 = 0x39;
/// The most that a sensor turns from block to block, hundredths of a degree: at 1200 turns a minute it is
/// 80.
const MAX_BLOCK_HUNDREDTHS: u32 = 500;

/// A sensor of Velodyne.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Model {
    /// VLP-16, Puck LITE.
    Vlp16,
    /// Puck Hi-Res.
    HiRes,
    /// VLP-32C, Ultra Puck.
    Vlp32c,
}

/// Elevation of each laser of a VLP-32C, and how far to the right of the encoder it looks, degrees.
const VLP32C_DEG: [(f64, f64); 32] = [
    (-25.0, 1.4),
    (-1.0, -4.2),
    (-1.667, 1.4),
    (-15.639, -1.4),
    (-11.31, 1.4),
    (0.0, -1.4),
    (-0.667, 4.2),
    (-8.843, -1.4),
    (-7.254, 1.4),
    (0.333, -4.2),
    (-0.333, 1.4),
    (-6.148, -1.4),
    (-5.333, 4.2),
    (1.333, -1.4),
    (0.667, 4.2),
    (-4.0, -1.4),
    (-4.667, 1.4),
    (1.667, -4.2),
    (1.0, 1.4),
    (-3.667, -4.2),
    (-3.333, 4.2),
    (3.333, -1.4),
    (2.333, 1.4),
    (-2.667, -1.4),
    (-3.0, 1.4),
    (7.0, -1.4),
    (4.667, 1.4),
    (-2.333, -4.2),
    (-2.0, 4.2),
    (15.0, -1.4),
    (10.333, 1.4),
    (-1.333, -1.4),
];

impl Model {
    /// Returns the sensor of a packet, by its last byte.
    ///
    /// # Errors
    /// [`ScanError::Lacks`] of a packet of another sensor, or of none.
    pub fn of(packet: &[u8]) -> Result<Model, ScanError> {
        let none = || ScanError::lacks("a packet", "the length and the mark of a Velodyne's");
        if packet.len() != PACKET_BYTES || !packet.starts_with(&[0xFF, 0xEE]) {
            return Err(none());
        }
        match packet[PACKET_BYTES - 1] {
            0x22 => Ok(Model::Vlp16),
            0x24 => Ok(Model::HiRes),
            0x28 => Ok(Model::Vlp32c),
            other => {
                let name = match other {
                    0x21 => "HDL-32E",
                    0x31 => "VLP-32A or VLP-32B",
                    0xA1 => "VLS-128",
                    _ => "one that is not known",
                };
                let what = format!(
                    "packets that are read (VLP-16, Puck Hi-Res, VLP-32C): these are of kind 0x{other:02X}, {name}"
                );
                Err(ScanError::lacks("a capture of a Velodyne", what))
            }
        }
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Model::Vlp16 => "VLP-16",
            Model::HiRes => "Puck Hi-Res",
            Model::Vlp32c => "VLP-32C",
        }
    }

    /// Lasers.
    pub fn lasers(self) -> usize {
        if self == Model::Vlp32c { 32 } else { 16 }
    }

    /// Elevation of a laser, degrees.
    pub fn elevation_deg(self, laser: usize) -> f64 {
        let even = laser.is_multiple_of(2);
        let up = laser as f64;
        match self {
            Model::Vlp16 => {
                if even {
                    up - 15.0
                } else {
                    up
                }
            }
            Model::HiRes => (if even { up - 15.0 } else { up }) * 2.0 / 3.0,
            Model::Vlp32c => VLP32C_DEG[laser].0,
        }
    }

    /// How far to the right of the encoder a laser looks when it fires, with a turn of `step_deg` from
    /// firing to firing, degrees.
    pub fn right_deg(self, laser: usize, step_deg: f64) -> f64 {
        let (fired_us, right_deg) = match self {
            Model::Vlp16 | Model::HiRes => (laser as f64 * LASER_US, 0.0),
            Model::Vlp32c => ((laser / 2) as f64 * LASER_US, VLP32C_DEG[laser].1),
        };
        right_deg + step_deg * fired_us / FIRING_US
    }

    /// Metres of a count.
    pub fn unit_m(self) -> f64 {
        if self == Model::Vlp32c { 0.004 } else { 0.002 }
    }

    /// Returns a geometry with what is known of the errors of this sensor.
    pub(crate) fn with_errors(self, mut geometry: Geometry) -> Geometry {
        if let Some(sensor) = Sensor::named("velodyne-vlp16").filter(|_| self != Model::Vlp32c) {
            geometry.range_noise_m = Some(sensor.range_noise_m());
            geometry.noise = sensor.noise();
        }
        geometry
    }

    /// The lasers from the top.
    pub fn rings(self) -> Vec<usize> {
        let mut lasers: Vec<usize> = (0..self.lasers()).collect();
        lasers.sort_by(|a, b| self.elevation_deg(*b).total_cmp(&self.elevation_deg(*a)));
        lasers
    }
}

/// One firing of all lasers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Firing {
    /// Where the encoder was when the first laser fired, degrees to the right, 0 to less than 360.
    pub azimuth_deg: f64,
    /// How far it turns until the next firing, degrees.
    pub step_deg: f64,
    /// Counts of each laser, 0 where there is no return; the last return of several.
    pub counts: [u16; 32],
}

/// Returns the firings of a packet of a model, none of what is no such packet. The packet tells where
/// the encoder was at each other firing of a VLP-16, or at each of a VLP-32C; between, it turns evenly.
pub fn firings(model: Model, packet: &[u8]) -> impl Iterator<Item = Firing> + '_ {
    let body = if Model::of(packet) == Ok(model) { &packet[..BLOCKS * BLOCK_BYTES] } else { &[] };
    // of the two returns of a firing the first block has the last one
    let apart = if packet.get(PACKET_BYTES - 2) == Some(&DUAL) { 2 } else { 1 };
    let blocks: Vec<&[u8]> = body.chunks_exact(BLOCK_BYTES).step_by(apart).collect();
    let azimuths: Vec<u32> = blocks.iter().map(|block| u16::from_le_bytes([block[2], block[3]]).into()).collect();
    let good = |i: usize| blocks[i].starts_with(&[0xFF, 0xEE]) && azimuths[i] < 36000;
    // A sensor that is told to look at a part of its turn jumps over the rest.
    let turned = |i: usize| {
        let there = i + 1 < blocks.len() && good(i) && good(i + 1);
        let hundredths = there.then(|| (36000 + azimuths[i + 1] - azimuths[i]) % 36000);
        hundredths.filter(|hundredths| *hundredths <= MAX_BLOCK_HUNDREDTHS)
    };
    let per_block = 32 / model.lasers();
    let mut made = Vec::with_capacity(2 * blocks.len());
    for i in (0..blocks.len()).filter(|i| good(*i)) {
        let Some(hundredths) = turned(i).or_else(|| turned(i.checked_sub(1)?)) else { continue };
        let step_deg = f64::from(hundredths) / 100.0 / per_block as f64;
        for firing in 0..per_block {
            let mut counts = [0; 32];
            let start = 4 + 3 * model.lasers() * firing;
            for (count, channel) in counts.iter_mut().zip(blocks[i][start..].chunks_exact(3)).take(model.lasers()) {
                *count = u16::from_le_bytes([channel[0], channel[1]]);
            }
            let azimuth_deg = (f64::from(azimuths[i]) / 100.0 + firing as f64 * step_deg) % 360.0;
            made.push(Firing { azimuth_deg, step_deg, counts });
        }
    }
    made.into_iter()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lidar::made_up::velodyne_packet as packet;

    #[test]
    fn firings_of_each_model() {
        for (model, per_block) in [(Model::Vlp16, 2), (Model::HiRes, 2), (Model::Vlp32c, 1)] {
            for dual in [false, true] {
                let bytes = packet(model, 35980, 40, dual);
                assert_eq!(Model::of(&bytes), Ok(model));
                let firings: Vec<Firing> = firings(model, &bytes).collect();
                assert_eq!(firings.len(), per_block * if dual { 6 } else { 12 });
                for (i, firing) in firings.iter().enumerate() {
                    let step_deg = 0.4 / per_block as f64;
                    let azimuth_deg = (359.8 + i as f64 * step_deg) % 360.0;
                    assert!((firing.azimuth_deg - azimuth_deg).abs() < 1e-9, "{model:?} {i}: {firing:?}");
                    assert!((firing.step_deg - step_deg).abs() < 1e-9);
                    let lasers = 0..model.lasers();
                    assert!(lasers.clone().all(|laser| firing.counts[laser] == (1000 + 100 * i + laser) as u16));
                }
            }
        }
    }

    #[test]
    fn rings_go_down_and_lasers_fire_in_turn() {
        for model in [Model::Vlp16, Model::HiRes, Model::Vlp32c] {
            let rings = model.rings();
            assert!(rings.windows(2).all(|pair| model.elevation_deg(pair[0]) > model.elevation_deg(pair[1])));
        }
        assert_eq!(Model::Vlp16.rings()[..3], [15, 13, 11]);
        assert_eq!((Model::HiRes.elevation_deg(0), Model::HiRes.elevation_deg(15)), (-10.0, 10.0));
        assert!((Model::Vlp16.right_deg(15, 0.2) - 0.125).abs() < 1e-9);
        assert!((Model::Vlp32c.right_deg(31, 0.2) - (0.125 - 1.4)).abs() < 1e-9);
    }

    #[test]
    fn what_is_no_packet_has_no_firings() {
        let bytes = packet(Model::Vlp16, 0, 40, false);
        assert_eq!(firings(Model::Vlp16, &bytes[..1205]).count(), 0);
        assert_eq!(firings(Model::Vlp32c, &bytes).count(), 0);
        let mut other = bytes.clone();
        other[1205] = 0x21;
        assert!(Model::of(&other).unwrap_err().to_string().contains("HDL-32E"));
        // a block without its mark, and one that turned by more than a turn
        let mut broken = bytes;
        broken[100] = 0;
        broken[502..504].copy_from_slice(&36000u16.to_le_bytes());
        let azimuths: Vec<f64> = firings(Model::Vlp16, &broken).map(|firing| firing.azimuth_deg).collect();
        assert!(!azimuths.contains(&0.4) && !azimuths.contains(&2.0) && azimuths.len() == 2 * 9, "{azimuths:?}");
    }
}
