//! The description of an Ouster: the JSON that its software saves beside a capture. All three kinds:
//! flat (firmware before 2.4), in groups (since), and the oldest, which does not describe packets.

use serde::Deserialize;

use crate::scan_error::ScanError;

/// How an Ouster sends ranges.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// Packets without a header; 20 bits of a millimetre.
    Legacy,
    /// Packets with a header of 32 bytes.
    Headed {
        /// Bytes of a pixel.
        pixel_bytes: usize,
        /// 15 bits of 8 mm instead of 19 bits of a millimetre.
        coarse: bool,
        /// Bytes before the number of the frame.
        frame_at: usize,
    },
}

/// What is known of an Ouster.
#[derive(Clone, Debug, PartialEq)]
pub struct Metadata {
    /// Name of the product, as `OS-1-128`; empty where it is not said.
    pub product: String,
    /// Elevation of each ring, degrees, from the top.
    pub elevation_deg: Vec<f64>,
    /// How far to the right of the encoder each ring looks, degrees.
    pub azimuth_deg: Vec<f64>,
    /// Where the beams begin: outwards from the axis, and up; metres.
    pub beam_origin_m: [f64; 2],
    /// Columns of a turn.
    pub columns: usize,
    /// Columns of a packet.
    pub columns_per_packet: usize,
    /// Columns by which each ring is late, 0 to less than `columns`.
    pub shifts: Vec<usize>,
    /// First and last column that is sent, both included; the first may be the larger one.
    pub window: [usize; 2],
    /// How ranges are sent.
    pub profile: Profile,
}

/// The largest file of metadata that is read.
pub const MAX_METADATA_BYTES: u64 = 1 << 20;

const FORMAT: &str = "metadata of an Ouster";

#[derive(Deserialize)]
struct File {
    beam_intrinsics: Option<Beams>,
    #[serde(flatten)]
    beams: Beams,
    data_format: Option<Format>,
    lidar_data_format: Option<Format>,
    lidar_mode: Option<String>,
    prod_line: Option<String>,
    sensor_info: Option<Info>,
    config_params: Option<Parameters>,
}

#[derive(Deserialize)]
struct Info {
    prod_line: Option<String>,
}

#[derive(Deserialize)]
struct Parameters {
    lidar_mode: Option<String>,
}

#[derive(Deserialize)]
struct Beams {
    beam_altitude_angles: Option<Vec<f64>>,
    beam_azimuth_angles: Option<Vec<f64>>,
    lidar_origin_to_beam_origin_mm: Option<f64>,
    beam_to_lidar_transform: Option<Vec<f64>>,
}

#[derive(Deserialize)]
struct Format {
    columns_per_frame: usize,
    columns_per_packet: usize,
    pixels_per_column: usize,
    pixel_shift_by_row: Option<Vec<i64>>,
    column_window: Option<[usize; 2]>,
    udp_profile_lidar: Option<String>,
}

impl Metadata {
    /// Reads a file of metadata.
    ///
    /// # Errors
    /// [`ScanError::Damaged`] says what is missing or contradicts itself.
    pub fn parse(json: &str) -> Result<Metadata, ScanError> {
        let wrong = |what: &str| ScanError::damaged(FORMAT, what);
        let file: File = serde_json::from_str(json).map_err(|e| ScanError::damaged(FORMAT, e))?;
        let beams = file.beam_intrinsics.unwrap_or(file.beams);
        let (elevation_deg, azimuth_deg) = beams
            .beam_altitude_angles
            .zip(beams.beam_azimuth_angles)
            .ok_or_else(|| wrong("beam_altitude_angles or beam_azimuth_angles are missing"))?;
        let mode = file.lidar_mode.or(file.config_params.and_then(|parameters| parameters.lidar_mode));
        let format = match file.data_format.or(file.lidar_data_format) {
            Some(format) => format,
            None => of_mode(mode.as_deref(), elevation_deg.len())
                .ok_or_else(|| wrong("neither data_format nor lidar_mode is there"))?,
        };
        let columns = format.columns_per_frame;
        let rings = format.pixels_per_column;
        let sane = (1..=256).contains(&rings) && (1..=4096).contains(&columns);
        if !sane || !(1..=columns).contains(&format.columns_per_packet) {
            return Err(wrong("numbers of columns or pixels that no Ouster has"));
        }
        let angles = elevation_deg.iter().chain(&azimuth_deg);
        if elevation_deg.len() != rings || azimuth_deg.len() != rings || angles.into_iter().any(|a| a.abs() > 90.0) {
            return Err(wrong("not one beam angle within 90 degrees for each pixel of a column"));
        }
        let whole = |shift: i64| shift.rem_euclid(columns as i64) as usize;
        let shifts: Vec<usize> = match format.pixel_shift_by_row {
            Some(shifts) if shifts.len() != rings => return Err(wrong("pixel_shift_by_row is not one per ring")),
            Some(shifts) => shifts.into_iter().map(whole).collect(),
            None => azimuth_deg.iter().map(|deg| whole((deg * columns as f64 / 360.0).round() as i64)).collect(),
        };
        let window = format.column_window.unwrap_or([0, columns - 1]);
        if window.iter().any(|column| *column >= columns) {
            return Err(wrong("column_window is beyond the columns"));
        }
        let profile = match format.udp_profile_lidar {
            None => Profile::Legacy,
            Some(name) => Profile::named(&name)
                .ok_or_else(|| wrong(&format!("the profile {name} of its packets is not known")))?,
        };
        let beam_origin_m = match (beams.beam_to_lidar_transform.as_deref(), beams.lidar_origin_to_beam_origin_mm) {
            (Some(transform), _) if transform.len() == 16 => [transform[3] / 1000.0, transform[11] / 1000.0],
            (_, Some(out_mm)) => [out_mm / 1000.0, 0.0],
            _ => [0.0; 2],
        };
        if beam_origin_m.iter().any(|m| m.abs() > 1.0) {
            return Err(wrong("beams that begin more than a metre off the axis"));
        }
        let product = file.prod_line.or(file.sensor_info.and_then(|info| info.prod_line)).unwrap_or_default();
        let columns_per_packet = format.columns_per_packet;
        let made = Metadata {
            product,
            elevation_deg,
            azimuth_deg,
            beam_origin_m,
            columns,
            columns_per_packet,
            shifts,
            window,
            profile,
        };
        if made.packet_bytes() > usize::from(u16::MAX) {
            return Err(wrong("packets that are too long for UDP"));
        }
        Ok(made)
    }

    /// Rings, each a row of the image.
    pub fn rings(&self) -> usize {
        self.elevation_deg.len()
    }

    /// Bytes of a packet.
    pub fn packet_bytes(&self) -> usize {
        let around = if self.profile == Profile::Legacy { 0 } else { 64 };
        around + self.columns_per_packet * self.column_bytes()
    }

    /// Bytes of a column in a packet.
    pub fn column_bytes(&self) -> usize {
        match self.profile {
            Profile::Legacy => 16 + 12 * self.rings() + 4,
            Profile::Headed { pixel_bytes, .. } => 12 + pixel_bytes * self.rings(),
        }
    }
}

impl Profile {
    fn named(name: &str) -> Option<Profile> {
        let headed = |pixel_bytes, coarse| Some(Profile::Headed { pixel_bytes, coarse, frame_at: 2 });
        match name {
            "LEGACY" => Some(Profile::Legacy),
            "RNG19_RFL8_SIG16_NIR16" => headed(12, false),
            "RNG19_RFL8_SIG16_NIR16_DUAL" => headed(16, false),
            "RNG15_RFL8_NIR8" => headed(4, true),
            "RNG15_RFL8_NIR8_DUAL" => headed(8, true),
            "FIVE_WORD_PIXEL" => headed(20, false),
            "FUSA_RNG15_RFL8_NIR8_DUAL" => Some(Profile::Headed { pixel_bytes: 8, coarse: true, frame_at: 4 }),
            _ => None,
        }
    }
}

/// The packets of the oldest firmware: the mode, as `1024x10`, begins with the columns.
fn of_mode(mode: Option<&str>, rings: usize) -> Option<Format> {
    let columns_per_frame = mode?.split_once('x')?.0.parse().ok()?;
    Some(Format {
        columns_per_frame,
        columns_per_packet: 16,
        pixels_per_column: rings,
        pixel_shift_by_row: None,
        column_window: None,
        udp_profile_lidar: None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn metadata(json: &str) -> Result<Metadata, String> {
        Metadata::parse(json).map_err(|e| e.to_string())
    }

    const BEAMS: &str = r#""beam_altitude_angles": [10, -10.5], "beam_azimuth_angles": [2.8125, -2]"#;
    const FORMAT: &str = r#"{"columns_per_frame": 256, "columns_per_packet": 16, "pixels_per_column": 2,
        "pixel_shift_by_row": [2, -1], "column_window": [250, 5], "udp_profile_lidar": "RNG15_RFL8_NIR8"}"#;

    #[test]
    fn flat_and_in_groups_are_the_same() {
        let flat = format!(
            r#"{{{BEAMS}, "lidar_origin_to_beam_origin_mm": 15.5, "data_format": {FORMAT}, "prod_line": "OS-1-2"}}"#
        );
        let groups = format!(
            r#"{{"beam_intrinsics": {{{BEAMS}, "lidar_origin_to_beam_origin_mm": 15.5}}, "lidar_data_format": {FORMAT},
                "sensor_info": {{"prod_line": "OS-1-2"}}, "config_params": {{"lidar_mode": "256x10"}}}}"#
        );
        let read = metadata(&flat).unwrap();
        assert_eq!(metadata(&groups), Ok(read.clone()));
        assert_eq!((read.shifts.as_slice(), read.window, read.beam_origin_m), (&[2, 255][..], [250, 5], [0.0155, 0.0]));
        assert_eq!((read.product.as_str(), read.packet_bytes()), ("OS-1-2", 64 + 16 * (12 + 2 * 4)));
    }

    #[test]
    fn the_oldest_says_its_mode() {
        let read = metadata(&format!(r#"{{{BEAMS}, "lidar_mode": "512x20"}}"#)).unwrap();
        assert_eq!((read.columns, read.shifts.as_slice(), read.profile), (512, &[4, 509][..], Profile::Legacy));
        assert_eq!(read.packet_bytes(), 16 * (16 + 2 * 12 + 4));
    }

    #[test]
    fn what_contradicts_itself_is_refused() {
        let of = |format: &str| metadata(&format!(r#"{{{BEAMS}, "data_format": {format}}}"#)).unwrap_err();
        assert!(metadata("[]").unwrap_err().contains("metadata of an Ouster"));
        assert!(metadata("{}").unwrap_err().contains("beam_altitude_angles"));
        assert!(metadata(&format!("{{{BEAMS}}}")).unwrap_err().contains("lidar_mode"));
        for (from, to, says) in [
            ("256,", "5000000000,", "no Ouster"),
            ("_column\": 2", "_column\": 3", "beam angle"),
            ("[2, -1]", "[2]", "pixel_shift_by_row"),
            ("[250, 5]", "[256, 5]", "column_window"),
            ("RNG15_RFL8_NIR8", "RNG21", "profile RNG21"),
            ("_packet\": 16", "_packet\": 0", "no Ouster"),
        ] {
            let said = of(&FORMAT.replace(from, to));
            assert!(said.contains(says), "{from} -> {to}: {said}");
        }
    }
}
