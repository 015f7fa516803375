//! Packets of a Velodyne: VelodyneScan.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::file::Cause;
use crate::lidar::velodyne::Model;
use crate::lidar::{Turn, Turns};
use crate::ros::cdr::decode;
use crate::ros::messages::{VelodynePacket, VelodyneScan};
use crate::ros::recording::{Recording, Topic};
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::streamed::{Stream, scan_of};

/// The packets of a topic as turns.
pub struct VelodynePackets {
    pub name: String,
    pub options: ReadOptions,
    pub recording: Box<dyn Recording>,
    pub topic: Arc<Topic>,
    pub packets: VecDeque<VelodynePacket>,
    /// Begun with the first packet.
    pub turns: Option<Turns>,
    pub turn: Option<Turn>,
}

impl VelodynePackets {
    fn next_packet(&mut self) -> Result<Option<Vec<u8>>, Cause> {
        while self.packets.is_empty() {
            let Some(message) = self.recording.next_message()? else { return Ok(None) };
            if message.topic == self.topic {
                self.packets = decode::<VelodyneScan>("VelodyneScan", &message.data)?.packets.into();
            }
        }
        Ok(self.packets.pop_front().map(|packet| packet.data))
    }
}

impl Stream for VelodynePackets {
    fn advance(&mut self) -> Result<bool, Cause> {
        self.turn = None;
        while self.turn.is_none() {
            match (self.next_packet()?, &mut self.turns) {
                (Some(packet), Some(turns)) => self.turn = turns.push(&packet),
                (Some(packet), None) => self.turn = self.turns.insert(Turns::new(Model::of(&packet)?)).push(&packet),
                (None, turns) => {
                    self.turn = turns.as_mut().and_then(Turns::finish);
                    break;
                }
            }
        }
        Ok(self.turn.is_some())
    }

    fn scan(&self) -> Result<Scan, Cause> {
        let turn = self.turn.as_ref().ok_or(ScanError::Unknown)?;
        scan_of(self.name.clone(), turn.image(), &self.options, turn.remarks())
    }
}

/// Recorded packets against the points that another program (tier4/nebula) made of them.
#[cfg(test)]
#[cfg(feature = "db3")]
mod tests {
    use super::*;
    use std::collections::HashMap;
    use std::path::{Path, PathBuf};

    use crate::lidar::velodyne::{Firing, firings};
    use crate::ros::db3::Db3Recording;
    use crate::scan_file::ScanFile;

    fn recorded(name: &str) -> Option<PathBuf> {
        let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/velodyne")).join(name);
        if !path.exists() {
            println!("skipped: no {}", path.display());
            return None;
        }
        Some(path)
    }

    /// The packets of a recording.
    fn packets(path: &Path) -> Vec<Vec<u8>> {
        let mut recording = Db3Recording::open(path).unwrap();
        let mut packets = vec![];
        while let Some(message) = recording.next_message().unwrap() {
            let scan: VelodyneScan = decode("VelodyneScan", &message.data).unwrap();
            packets.extend(scan.packets.into_iter().map(|packet| packet.data));
        }
        packets
    }

    /// The same packet, but of two returns the first one is the other one.
    fn with_the_other_return(packet: &[u8]) -> Vec<u8> {
        let mut packet = packet.to_vec();
        if packet[1204] == 0x39 {
            packet[..1200].chunks_exact_mut(200).for_each(|pair| pair.rotate_left(100));
        }
        packet
    }

    /// The points of a binary PCD.
    fn points(path: &Path, point_bytes: usize) -> Vec<Vec<u8>> {
        let bytes = std::fs::read(path).unwrap();
        let data = b"DATA binary\n";
        let start = bytes.windows(data.len()).position(|window| window == data).unwrap() + data.len();
        bytes[start..].chunks_exact(point_bytes).map(<[u8]>::to_vec).collect()
    }

    fn f32_at(point: &[u8], at: usize) -> f64 {
        f32::from_le_bytes(point[at..at + 4].try_into().unwrap()).into()
    }

    /// The azimuths to the right of the points of each laser and count.
    type Found = HashMap<(usize, u16), Vec<f64>>;

    fn nearest_deg(found: &Found, laser: usize, count: u16, azimuth_deg: f64) -> f64 {
        let off = |own: &f64| ((own - azimuth_deg + 180.0).rem_euclid(360.0) - 180.0).abs();
        found.get(&(laser, count)).into_iter().flatten().map(off).fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn channel_azimuth_elevation_and_distance_of_a_vlp_16() {
        let Some(recording) = recorded("vlp16_1673400471837873222_0.db3") else { return };
        let Some(cloud) = recorded("vlp16_1673400472138016708.pcd") else { return };
        let model = Model::Vlp16;
        // Of two returns the other program gives the second one the azimuth of the next firing, and
        // within the last firings of a packet it does not interpolate.
        let (mut last, mut other) = (Found::new(), Found::new());
        for packet in packets(&recording) {
            let all: Vec<Firing> = firings(model, &packet).collect();
            assert_eq!(all.len(), 12, "two returns");
            let others: Vec<Firing> = firings(model, &with_the_other_return(&packet)).collect();
            for i in 0..12 {
                for laser in 0..16 {
                    let block_deg = |i: usize| all[i].azimuth_deg - (i % 2) as f64 * all[i].step_deg;
                    let interpolated = all[i].azimuth_deg + model.right_deg(laser, all[i].step_deg);
                    let azimuth_deg = if i >= 10 { block_deg(i) } else { interpolated };
                    last.entry((laser, all[i].counts[laser])).or_default().push(azimuth_deg);
                    let next_deg = block_deg((i + 2).min(11));
                    other.entry((laser, others[i].counts[laser])).or_default().push(next_deg);
                }
            }
        }
        let mut of_last = 0;
        let rings = model.rings();
        let theirs = points(&cloud, 32);
        assert_eq!(theirs.len(), 14831);
        for point in theirs {
            let laser = rings[15 - usize::from(u16::from_le_bytes([point[14], point[15]]))];
            // the field called elevation is its sine
            let elevation_deg = f32_at(&point, 20).asin().to_degrees();
            assert!((elevation_deg - model.elevation_deg(laser)).abs() < 0.2, "{elevation_deg} of {laser}");
            let height_m = f32_at(&point, 8);
            let distance_m = f32_at(&point, 24);
            let at_deg = (height_m / distance_m).asin().to_degrees();
            assert!((at_deg - model.elevation_deg(laser)).abs() < 0.01, "{at_deg} of {laser}");
            let count = (distance_m / model.unit_m()).round() as u16;
            let azimuth_deg = f32_at(&point, 16).to_degrees();
            // they round to hundredths
            let is_of = |found| nearest_deg(found, laser, count, azimuth_deg) < 0.0051;
            of_last += usize::from(is_of(&last));
            assert!(is_of(&last) || is_of(&other), "laser {laser}, count {count}, azimuth {azimuth_deg}");
        }
        println!("{of_last} of 14831 points are last returns");
        assert!(of_last > 14000);
    }

    #[test]
    fn points_of_a_vlp_32c() {
        let Some(recording) = recorded("vlp32_1713492677464078412_0.db3") else { return };
        let Some(cloud) = recorded("vlp32_1713492677464078412.pcd") else { return };
        let model = Model::Vlp32c;
        let mut found = Found::new();
        for packet in packets(&recording) {
            // The other program takes the lasers as fired one after the other, which are fired in pairs,
            // and does not interpolate within the last firing of a packet.
            for (i, firing) in firings(model, &packet).enumerate() {
                for laser in 0..32 {
                    let fired_deg = if i == 11 { 0.0 } else { firing.step_deg * laser as f64 * 2.304 / 55.296 };
                    let azimuth_deg = firing.azimuth_deg + model.right_deg(laser, 0.0) + fired_deg;
                    found.entry((laser, firing.counts[laser])).or_default().push(azimuth_deg);
                }
            }
        }
        let theirs = points(&cloud, 12);
        assert_eq!(theirs.len(), 26216);
        for point in theirs {
            let [x, y, z] = [0, 4, 8].map(|at| f32_at(&point, at));
            let distance_m = (x * x + y * y + z * z).sqrt();
            let elevation_deg = (z / distance_m).asin().to_degrees();
            let off = |laser: &usize| (model.elevation_deg(*laser) - elevation_deg).abs();
            let laser = (0..32).min_by(|a, b| off(a).total_cmp(&off(b))).unwrap();
            assert!(off(&laser) < 0.002, "{elevation_deg}");
            let count = (distance_m / model.unit_m()).round() as u16;
            let azimuth_deg = (-y).atan2(x).to_degrees();
            let off_deg = nearest_deg(&found, laser, count, azimuth_deg);
            // they round to hundredths
            assert!(off_deg < 0.0052, "laser {laser}, count {count}, azimuth {azimuth_deg}: {off_deg}");
        }
    }

    #[test]
    fn recorded_turns_are_scans() {
        // the VLP-32C is set to send the half of a turn that lies before it
        for (name, rows, columns, wraps) in [
            ("vlp16_1673400471837873222_0.db3", 16, 1790..1820, true),
            ("vlp32_1713492677464078412_0.db3", 32, 895..925, false),
        ] {
            let Some(path) = recorded(name) else { return };
            let mut file = ScanFile::open(&path, &ReadOptions::default()).unwrap();
            let mut as_expected = 0;
            for n in 0..file.frames() {
                let scan = file.frame(n).unwrap();
                scan.geometry.check().unwrap();
                scan.geometry.fits(scan.image.rows, scan.image.columns).unwrap();
                println!("{name} {n}: {} columns, {:?}", scan.image.columns, scan.remarks);
                let whole = scan.remarks.is_empty();
                as_expected += usize::from(columns.contains(&scan.image.columns) && whole == wraps);
                assert_eq!(scan.image.rows, rows);
            }
            assert!(as_expected >= 3 && file.frames() <= as_expected + 2, "{as_expected} of {}", file.frames());
        }
    }
}
