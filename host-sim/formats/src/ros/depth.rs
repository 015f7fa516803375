//! Depth images with their camera: Image and CameraInfo.

use crate::file::Cause;
use crate::geometry::{Depth, Geometry, Kind};
use crate::range_image::RangeImage;
use crate::ros::cdr::decode;
use crate::ros::messages::{CameraInfo, Image};
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;
use crate::streamed::scan_of;

const FORMAT: &str = "a depth image";

/// How depths are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// Millimetres, 16 bits.
    Millimetres,
    /// Metres, `f32`.
    Metres,
}

/// Returns how an encoding stores depths, `None` of one that does not.
pub fn sample(encoding: &str) -> Option<Sample> {
    match encoding {
        "16UC1" | "mono16" => Some(Sample::Millimetres),
        "32FC1" => Some(Sample::Metres),
        _ => None,
    }
}

/// Returns the topic beside that of images which says their camera.
pub fn camera_topic(topic: &str) -> String {
    format!("{}/camera_info", topic.rsplit_once('/').map_or("", |(parent, _)| parent))
}

/// Returns the camera of the images of a topic: the one beside it by name, or the only one.
pub fn camera<'a>(topic: &str, cameras: &'a [(String, CameraInfo)]) -> Result<&'a CameraInfo, ScanError> {
    let beside = camera_topic(topic);
    let named = cameras.iter().find(|(name, _)| *name == beside);
    match (named, cameras) {
        (Some((_, camera)), _) => Ok(camera),
        (None, [(_, camera)]) => Ok(camera),
        _ => Err(ScanError::lacks("a recording", format!("{beside}, which says the camera of {topic}"))),
    }
}

/// Returns the scan of a message.
pub fn scan(name: String, data: &[u8], camera: &CameraInfo, options: &ReadOptions) -> Result<Scan, Cause> {
    let message: Image<'_> = decode("Image", data)?;
    let geometry = Geometry::of(pinhole(camera)?);
    geometry.check()?;
    let (rows, columns) = (message.height as usize, message.width as usize);
    let pixels = ScanError::check_pixels(rows, columns)?;
    let sample = sample(&message.encoding).ok_or_else(|| ScanError::lacks(FORMAT, "depths"))?;
    let (bytes, unit_m) = match sample {
        Sample::Millimetres => (2, 0.001),
        Sample::Metres => (4, 1.0),
    };
    let unit_m = options.unit_m.unwrap_or(unit_m);
    let step = message.step as usize;
    if step < bytes * columns || step.checked_mul(rows).is_none_or(|all| all > message.data.len()) {
        return Err(ScanError::damaged(FORMAT, "its rows are longer than its data").into());
    }
    let big = message.is_bigendian != 0;
    let depth = |at: &[u8]| match (sample, big) {
        (Sample::Millimetres, false) => u16::from_le_bytes([at[0], at[1]]).into(),
        (Sample::Millimetres, true) => u16::from_be_bytes([at[0], at[1]]).into(),
        (Sample::Metres, false) => f32::from_le_bytes([at[0], at[1], at[2], at[3]]).into(),
        (Sample::Metres, true) => f32::from_be_bytes([at[0], at[1], at[2], at[3]]).into(),
    };
    let mut range_m = Vec::with_capacity(pixels);
    for (row, line) in message.data.chunks_exact(step).take(rows).enumerate() {
        for (column, at) in line.chunks_exact(bytes).take(columns).enumerate() {
            let depth: f64 = depth(at);
            let range = depth * unit_m / geometry.direction(row, column)[0];
            let good = range > 0.0 && range.is_finite();
            range_m.push(if good { range as f32 } else { 0.0 });
        }
    }
    let image = RangeImage { rows, columns, range_m };
    let bends = camera.d.iter().any(|d| *d != 0.0);
    let remark = "the lens is taken as not bending straight lines, though CameraInfo says it does";
    scan_of(name, (image, geometry), options, if bends { vec![remark.into()] } else { vec![] })
}

/// Returns the beams of a camera.
fn pinhole(camera: &CameraInfo) -> Result<Kind, ScanError> {
    let [fx, _, cx, _, fy, cy, ..] = camera.k;
    if fx == 0.0 || fy == 0.0 {
        return Err(ScanError::lacks("CameraInfo", "a focal length"));
    }
    let [by_x, by_y] = [camera.binning_x, camera.binning_y].map(|n| f64::from(n.max(1)));
    let [left, top] = [camera.roi.x_offset, camera.roi.y_offset].map(f64::from);
    Ok(Kind::Pinhole {
        fx_px: fx / by_x,
        fy_px: fy / by_y,
        cx_px: (cx - left) / by_x,
        cy_px: (cy - top) / by_y,
        depth: Depth::Z,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ros::made_up;
    use crate::ros::messages::Header;

    fn camera_info() -> CameraInfo {
        CameraInfo { k: [100.0, 0.0, 1.0, 0.0, 50.0, 0.5, 0.0, 0.0, 1.0], ..CameraInfo::default() }
    }

    fn image<'a>(encoding: &str, is_bigendian: u8, step: u32, data: &'a [u8]) -> Image<'a> {
        let header = Header::default();
        Image { header, height: 2, width: 3, encoding: encoding.into(), is_bigendian, step, data }
    }

    fn read(image: &Image<'_>) -> Result<Scan, Cause> {
        scan("x".into(), &made_up::cdr(image), &camera_info(), &ReadOptions::default())
    }

    #[test]
    fn depths_of_every_encoding_become_ranges() {
        let mm = [1000u16, 2000, 0, 500, 1500, 3000];
        let counts = |bytes: fn(u16) -> [u8; 2]| mm.iter().flat_map(|mm| bytes(*mm)).collect::<Vec<u8>>();
        let metres = |mm: &u16| if *mm == 0 { f32::NAN } else { f32::from(*mm) / 1000.0 };
        let floats: Vec<u8> = mm.iter().flat_map(|mm| metres(mm).to_le_bytes()).collect();
        let (little, big) = (counts(u16::to_le_bytes), counts(u16::to_be_bytes));
        for image in [image("16UC1", 0, 6, &little), image("mono16", 1, 6, &big), image("32FC1", 0, 12, &floats)] {
            let scan = read(&image).unwrap();
            for (i, range_m) in (0..).zip(&scan.image.range_m) {
                let depth_m = f64::from(*range_m) * scan.geometry.direction(i / 3, i % 3)[0];
                assert!((depth_m * 1000.0 - f64::from(mm[i])).abs() < 1e-3, "{} {i}", image.encoding);
            }
            assert_eq!(scan.measured, 5);
        }
    }

    #[test]
    fn what_is_too_short_or_no_depth_is_refused() {
        assert!(read(&image("16UC1", 0, 6, &[0; 11])).is_err());
        assert!(read(&image("16UC1", 0, 5, &[0; 12])).is_err());
        assert!(read(&image("16UC1", 0, u32::MAX, &[0; 12])).is_err());
        assert!(read(&image("rgb8", 0, 9, &[0; 18])).is_err());
        assert!(pinhole(&CameraInfo::default()).is_err());
    }

    #[test]
    fn the_camera_is_beside_its_images_or_the_only_one() {
        let cameras =
            [("/a/camera_info".to_string(), camera_info()), ("/b/camera_info".to_string(), CameraInfo::default())];
        assert_eq!(camera("/a/image_raw", &cameras).unwrap().k[0], 100.0);
        assert_eq!(camera("/c/image", &cameras[..1]).unwrap().k[0], 100.0);
        assert!(camera("/c/image", &cameras).unwrap_err().to_string().contains("/c/camera_info"));
        let part = CameraInfo { binning_x: 2, binning_y: 1, ..camera_info() };
        assert!(matches!(pinhole(&part), Ok(Kind::Pinhole { fx_px: 50.0, fy_px: 50.0, cx_px: 0.5, .. })));
    }
}
