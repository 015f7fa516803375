//! Ouster: packets to frames, and frames to range images.
//!
//! A frame is destaggered by whole columns, as Ouster's own software does it. What that leaves of the
//! rings' azimuths is their `row_offset_deg`. The axes are those of the lidar (`os_lidar`): x is
//! where the encoder is at 0, z the axis.

use crate::angles::Angles;
use crate::beside::Beside;
use crate::geometry::{Geometry, Kind};
use crate::lidar::ouster_metadata::{Metadata, Profile};
use crate::range_image::RangeImage;
use crate::sensors::Sensor;

/// What of one column of a packet is good.
pub struct Column<'a> {
    /// Number of the frame, as the packet counts them.
    pub frame: u32,
    /// Which column of the turn, less than their number.
    pub column: usize,
    pixels: &'a [u8],
    profile: Profile,
}

impl Column<'_> {
    /// The range of each ring from the top, millimetres; 0 where there is none.
    pub fn ranges_mm(&self) -> impl Iterator<Item = u32> + '_ {
        let (pixel_bytes, profile) = (pixel_bytes(self.profile), self.profile);
        self.pixels.chunks_exact(pixel_bytes).map(move |pixel| {
            let word = u32::from_le_bytes([pixel[0], pixel[1], pixel[2], pixel[3]]);
            match profile {
                Profile::Legacy => word & 0xF_FFFF,
                Profile::Headed { coarse: false, .. } => word & 0x7_FFFF,
                Profile::Headed { coarse: true, .. } => (word & 0x7FFF) << 3,
            }
        })
    }
}

fn pixel_bytes(profile: Profile) -> usize {
    match profile {
        Profile::Legacy => 12,
        Profile::Headed { pixel_bytes, .. } => pixel_bytes,
    }
}

/// Returns the columns of a packet that are good, none if it is no packet of this sensor.
pub fn columns<'a>(metadata: &'a Metadata, packet: &'a [u8]) -> impl Iterator<Item = Column<'a>> + 'a {
    let profile = metadata.profile;
    let (head, frame_of_packet) = match profile {
        // Each column has it, but Ouster's own writer sets, and its reader takes, that of the first one.
        Profile::Legacy => (0, packet.get(10..).and_then(u16_at).unwrap_or(0).into()),
        Profile::Headed { frame_at: 4, .. } => (32, packet.get(4..).and_then(u32_at).unwrap_or(0)),
        Profile::Headed { frame_at, .. } => (32, packet.get(frame_at..).and_then(u16_at).unwrap_or(0).into()),
    };
    let body = if packet.len() == metadata.packet_bytes() { &packet[head..] } else { &[] };
    let all = body.chunks_exact(metadata.column_bytes()).take(metadata.columns_per_packet);
    all.filter_map(move |bytes| {
        let column = usize::from(u16_at(&bytes[8..])?);
        let (good, pixels) = match profile {
            Profile::Legacy => {
                let (pixels, status) = bytes[16..].split_at(12 * metadata.rings());
                (u32_at(status)? == u32::MAX, pixels)
            }
            Profile::Headed { .. } => (u16_at(&bytes[10..])? & 1 == 1, &bytes[12..]),
        };
        let frame = frame_of_packet;
        (good && column < metadata.columns).then_some(Column { frame, column, pixels, profile })
    })
}

fn u16_at(bytes: &[u8]) -> Option<u16> {
    bytes.first_chunk().copied().map(u16::from_le_bytes)
}

fn u32_at(bytes: &[u8]) -> Option<u32> {
    bytes.first_chunk().copied().map(u32::from_le_bytes)
}

/// One turn of an Ouster.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OusterFrame {
    /// Rows and columns of a whole turn, destaggered, millimetres as sent; 0 where there is none.
    pub range_mm: Vec<u32>,
    /// Columns that came.
    pub came: usize,
}

/// Puts packets together to frames.
pub struct Assembler {
    metadata: Metadata,
    frame: Option<u32>,
    range_mm: Vec<u32>,
    came: Vec<bool>,
}

impl Assembler {
    /// For the packets of one sensor. Memory: four bytes a pixel.
    pub fn new(metadata: Metadata) -> Assembler {
        let (pixels, columns) = (metadata.rings() * metadata.columns, metadata.columns);
        Assembler { metadata, frame: None, range_mm: vec![0; pixels], came: vec![false; columns] }
    }

    /// The sensor.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// Adds a packet. Returns the frame before it, if it begins another. A packet that is late by a
    /// frame is passed over.
    pub fn push(&mut self, packet: &[u8]) -> Option<OusterFrame> {
        let Assembler { metadata, frame: current, range_mm, came } = self;
        let mut done = None;
        for column in columns(metadata, packet) {
            // numbers of frames go round
            let next = [column.frame.wrapping_add(1), column.frame.wrapping_add(1) & 0xFFFF];
            if current.is_some_and(|current| next.contains(&current)) {
                continue;
            }
            if *current != Some(column.frame) && current.replace(column.frame).is_some() {
                done = done.or(take(range_mm, came));
            }
            came[column.column] = true;
            for ((row, shift), mm) in (0..).zip(&metadata.shifts).zip(column.ranges_mm()) {
                range_mm[row * metadata.columns + (column.column + shift) % metadata.columns] = mm;
            }
        }
        done
    }

    /// Returns the last frame, if anything of it came.
    pub fn finish(&mut self) -> Option<OusterFrame> {
        self.frame = None;
        take(&mut self.range_mm, &mut self.came)
    }
}

fn take(range_mm: &mut [u32], came: &mut [bool]) -> Option<OusterFrame> {
    let columns = came.iter().filter(|came| **came).count();
    let frame = (columns > 0).then(|| OusterFrame { range_mm: range_mm.to_vec(), came: columns });
    range_mm.fill(0);
    came.fill(false);
    frame
}

impl Metadata {
    /// Columns of the image: those of the window.
    fn image_columns(&self) -> Vec<usize> {
        let [first, last] = self.window;
        let count = (last + self.columns - first) % self.columns + 1;
        (0..count).map(|i| (first + i) % self.columns).collect()
    }

    /// Returns the range image of a frame and where its beams point.
    ///
    /// Ouster counts a range from the axis along the beam's way, whose first part leads outwards to
    /// where the beams begin. Here a range is how far along the beam the point lies from the origin.
    /// What remains is that the beam passes beside the origin, by up to 20 mm (OS0, steep rings).
    pub fn image(&self, frame: &OusterFrame) -> (RangeImage, Geometry) {
        let columns = self.image_columns();
        let step_deg = 360.0 / self.columns as f64;
        let offsets: Vec<f64> =
            self.shifts.iter().zip(&self.azimuth_deg).map(|(shift, deg)| *shift as f64 * step_deg - deg).collect();
        let offsets: Vec<f64> = offsets.into_iter().map(|deg| (deg + 180.0).rem_euclid(360.0) - 180.0).collect();
        let mut range_m = Vec::with_capacity(self.rings() * columns.len());
        for row in 0..self.rings() {
            let more_m = self.beam_begins_m(row);
            let of_row = &frame.range_mm[row * self.columns..(row + 1) * self.columns];
            range_m.extend(columns.iter().map(|column| match of_row[*column] {
                0 => 0.0,
                mm => (f64::from(mm) / 1000.0 + more_m).max(0.0) as f32,
            }));
        }
        let image = RangeImage { rows: self.rings(), columns: columns.len(), range_m };
        let start_deg = -(columns[0] as f64) * step_deg;
        let mut geometry = Geometry::of(Kind::Spinning {
            azimuth_deg: Angles::Even { start_deg, step_deg: -step_deg },
            elevation_deg: Angles::Listed(self.elevation_deg.clone()),
            wraps: columns.len() == self.columns,
        });
        geometry.beside = Beside { row_offset_deg: Some(Angles::Listed(offsets)), ..Beside::NONE };
        (image, self.with_errors(geometry))
    }

    /// Returns a geometry with what is known of the errors of this sensor.
    pub(crate) fn with_errors(&self, mut geometry: Geometry) -> Geometry {
        if let Some(sensor) = self.sensor() {
            geometry.range_noise_m = Some(sensor.range_noise_m());
            geometry.noise = sensor.noise();
            if matches!(self.profile, Profile::Headed { coarse: true, .. }) {
                geometry.noise.range_step_m = 0.008;
            }
        }
        geometry
    }

    /// How much farther from the origin a point lies along a ring's beam than Ouster's count says,
    /// metres.
    fn beam_begins_m(&self, row: usize) -> f64 {
        let [out_m, up_m] = self.beam_origin_m;
        let (elevation_rad, azimuth_rad) = (self.elevation_deg[row].to_radians(), self.azimuth_deg[row].to_radians());
        let counted_m = out_m.hypot(up_m);
        out_m * elevation_rad.cos() * azimuth_rad.cos() + up_m * elevation_rad.sin() - counted_m
    }

    fn sensor(&self) -> Option<Sensor> {
        let names = [("OS-0", "ouster-os0"), ("OS-1", "ouster-os1")];
        let (_, name) = names.into_iter().find(|(product, _)| self.product.starts_with(product))?;
        Sensor::named(name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Two rings, 32 columns, 4 columns a packet; the lower ring is two columns late.
    fn metadata(profile: &str, window: &str) -> Metadata {
        let format = format!(
            r#""data_format": {{"columns_per_frame": 32, "columns_per_packet": 4, "pixels_per_column": 2,
                "pixel_shift_by_row": [0, 2], "column_window": {window}, "udp_profile_lidar": "{profile}"}}"#
        );
        Metadata::parse(&format!(
            r#"{{"beam_altitude_angles": [30, -30], "beam_azimuth_angles": [0, 22], "prod_line": "OS-1-2",
                "lidar_origin_to_beam_origin_mm": 20, {format}}}"#
        ))
        .unwrap()
    }

    /// A packet of the columns from `first` on, whose ranges are 1000 + column and 2000 + column.
    fn packet(metadata: &Metadata, frame: u16, first: u16) -> Vec<u8> {
        let mut bytes = vec![];
        let headed = match metadata.profile {
            Profile::Legacy => false,
            Profile::Headed { frame_at, .. } => {
                bytes.resize(32, 0xEE);
                bytes[frame_at..frame_at + 2].copy_from_slice(&frame.to_le_bytes());
                true
            }
        };
        for column in first..first + 4 {
            bytes.extend([0; 8]);
            bytes.extend(column.to_le_bytes());
            if headed {
                bytes.extend([1, 0]);
            } else {
                bytes.extend(frame.to_le_bytes());
                bytes.extend([0; 4]);
            }
            for range_mm in [1000 + u32::from(column), 2000 + u32::from(column)] {
                let mut pixel = vec![0xFF; pixel_bytes(metadata.profile)];
                match metadata.profile {
                    Profile::Headed { coarse: true, .. } => {
                        pixel[..2].copy_from_slice(&(0x8000 | (range_mm / 8) as u16).to_le_bytes());
                    }
                    _ => pixel[..4].copy_from_slice(&(0xFF00_0000 | range_mm).to_le_bytes()),
                }
                // all but the range is of no use
                if !matches!(metadata.profile, Profile::Headed { coarse: true, .. }) {
                    pixel[2] &= 0x07;
                }
                bytes.extend(pixel);
            }
            if !headed {
                bytes.extend([0xFF; 4]);
            }
        }
        if headed {
            bytes.resize(bytes.len() + 32, 0);
        }
        bytes
    }

    #[test]
    fn frames_of_every_profile_are_destaggered() {
        for profile in [
            "LEGACY",
            "RNG19_RFL8_SIG16_NIR16",
            "RNG19_RFL8_SIG16_NIR16_DUAL",
            "RNG15_RFL8_NIR8",
            "RNG15_RFL8_NIR8_DUAL",
            "FIVE_WORD_PIXEL",
        ] {
            let metadata = metadata(profile, "[0, 31]");
            let coarse = matches!(metadata.profile, Profile::Headed { coarse: true, .. });
            let sent = |mm: usize| if coarse { mm / 8 * 8 } else { mm } as u32;
            let mut assembler = Assembler::new(metadata.clone());
            for first in (0..32).step_by(4) {
                assert_eq!(assembler.push(&packet(&metadata, 65535, first)), None, "{profile}");
            }
            // a packet late by a frame, one that is none
            let whole = assembler.push(&packet(&metadata, 0, 4)).unwrap();
            assert_eq!(assembler.push(&packet(&metadata, 65535, 8)), None);
            assert_eq!(assembler.push(&[0; 1206]), None);
            assert_eq!((whole.came, whole.range_mm.len()), (32, 64));
            for column in 0..32 {
                assert_eq!(whole.range_mm[column], sent(1000 + column), "{profile}");
                assert_eq!(whole.range_mm[32 + (column + 2) % 32], sent(2000 + column), "{profile}");
            }
            let next = assembler.finish().unwrap();
            assert_eq!((next.came, next.range_mm[4], next.range_mm[8]), (4, sent(1004), 0));
            assert_eq!(assembler.finish(), None);
        }
    }

    #[test]
    fn the_frame_is_that_of_the_first_column() {
        let metadata = metadata("LEGACY", "[0, 31]");
        let mut assembler = Assembler::new(metadata.clone());
        for first in (0..32).step_by(4) {
            let mut bytes = packet(&metadata, 7, first);
            for column in 1..4 {
                bytes[column * metadata.column_bytes() + 10..][..2].fill(0);
            }
            assert_eq!(assembler.push(&bytes), None);
        }
        assert_eq!(assembler.finish().map(|frame| frame.came), Some(32));
    }

    #[test]
    fn a_column_that_is_not_good_counts_for_nothing() {
        let metadata = metadata("LEGACY", "[0, 31]");
        let mut bytes = packet(&metadata, 1, 0);
        let end = metadata.column_bytes() - 1;
        bytes[end] = 0;
        // a column beyond the turn
        bytes[metadata.column_bytes() + 8] = 32;
        let mut assembler = Assembler::new(metadata);
        assert_eq!(assembler.push(&bytes), None);
        assert_eq!(assembler.finish().map(|frame| frame.came), Some(2));
    }

    #[test]
    fn points_lie_where_the_formula_of_ouster_says_but_for_the_beam_beside_the_origin() {
        let metadata = metadata("LEGACY", "[0, 31]");
        let mut assembler = Assembler::new(metadata.clone());
        for first in (0..32).step_by(4) {
            assembler.push(&packet(&metadata, 1, first));
        }
        let (image, geometry) = metadata.image(&assembler.finish().unwrap());
        geometry.check().unwrap();
        geometry.fits(image.rows, image.columns).unwrap();
        for row in 0..2 {
            for measured in 0..32 {
                // as Ouster's manual has it
                let encoder_rad = std::f64::consts::TAU * (1.0 - measured as f64 / 32.0);
                let azimuth_rad = -metadata.azimuth_deg[row].to_radians() + encoder_rad;
                let elevation_rad = metadata.elevation_deg[row].to_radians();
                let rest_m = (1000.0 * (row + 1) as f64 + measured as f64) / 1000.0 - 0.02;
                let x = rest_m * azimuth_rad.cos() * elevation_rad.cos() + 0.02 * encoder_rad.cos();
                let y = rest_m * azimuth_rad.sin() * elevation_rad.cos() + 0.02 * encoder_rad.sin();
                let z = rest_m * elevation_rad.sin();

                let column = (measured + metadata.shifts[row]) % 32;
                let range_m = f64::from(image.range_m[row * 32 + column]);
                let ours = geometry.direction(row, column).map(|u| u * range_m);
                let off_m = [ours[0] - x, ours[1] - y, ours[2] - z];
                // beside the beam, and no more than its way from the origin
                let along_m: f64 = off_m.iter().zip(geometry.direction(row, column)).map(|(m, u)| m * u).sum();
                let away_m = off_m.iter().map(|m| m * m).sum::<f64>().sqrt();
                assert!(along_m.abs() < 1e-6 && away_m < 0.013, "{row} {measured}: {off_m:?}");
            }
        }
        assert_eq!(geometry.range_noise_m, Sensor::named("ouster-os1").map(|sensor| sensor.range_noise_m()));
    }

    #[test]
    fn a_window_across_the_beginning_is_one_piece() {
        let metadata = metadata("LEGACY", "[30, 1]");
        let mut assembler = Assembler::new(metadata.clone());
        assembler.push(&packet(&metadata, 1, 0));
        assembler.push(&packet(&metadata, 1, 28));
        let (image, geometry) = metadata.image(&assembler.finish().unwrap());
        assert_eq!((image.rows, image.columns), (2, 4));
        // the first ring has no beam before its own column
        let first_m: Vec<f32> = image.range_m[..4].iter().map(|m| (m * 1000.0).round()).collect();
        let counted_mm = -20.0 + 20.0 * 30f64.to_radians().cos();
        assert_eq!(first_m, [1030.0, 1031.0, 1000.0, 1001.0].map(|mm: f64| (mm + counted_mm).round() as f32));
        let Kind::Spinning { wraps, .. } = geometry.kind else { panic!() };
        assert!(!wraps);
        let at = geometry.direction(0, 2);
        assert!((at[1]).abs() < 1e-9 && at[0] > 0.0, "{at:?}");
    }
}
