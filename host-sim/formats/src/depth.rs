//! Range images and depth images: a distance for each pixel, beside what says where it looks.

use crate::camera::{Camera, is_camera};
use crate::cloud::Cloud;
use crate::file::{Cause, FileError};
use crate::geometry::Geometry;
use crate::grey_image::GreyImage;
use crate::npy::{self, Array};
use crate::range_image::RangeImage;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;

const BENDS: &str = "the camera's file has coefficients of distortion, which are not taken out: straight lines must be straight in \
    the image";

/// Returns the scan of a grey image.
pub(crate) fn grey(name: String, counts: &GreyImage, options: &ReadOptions) -> Result<Scan, Cause> {
    let distances = || counts.values.iter().map(|count| f64::from(*count));
    scan(name, (counts.rows, counts.columns), distances, 0.001, options)
}

/// Returns the scan of an array.
pub(crate) fn npy(name: String, bytes: &[u8], options: &ReadOptions) -> Result<Scan, Cause> {
    match npy::read(bytes)? {
        Array::Points { rows, columns, points } => Cloud { rows, columns, points }.into_scan(name, options),
        Array::Depths { rows, columns, values, whole } => {
            let distances = || values.iter().map(|x| f64::from(*x));
            scan(name, (rows, columns), distances, if whole { 0.001 } else { 1.0 }, options)
        }
    }
}

/// Returns a scan of distances, in `usual_unit_m` metres unless it is said.
fn scan<I: Iterator<Item = f64>>(
    name: String,
    (rows, columns): (usize, usize),
    distances: impl Fn() -> I,
    usual_unit_m: f64,
    options: &ReadOptions,
) -> Result<Scan, Cause> {
    let mut remarks = vec![];
    let text = options.geometry_text()?;
    let mut geometry = match &text {
        Some((path, text)) if !is_camera(text) => {
            let geometry = Geometry::parse(text).map_err(|e| FileError::new(path, e))?;
            if Camera::default().overrule(&options.camera) {
                let message = "it says where the pixels look; --fx and the like are for images without it".into();
                return Err(ScanError::Misfit { geometry: path.to_path_buf(), message }.into());
            }
            geometry
        }
        of_camera => {
            let mut camera = of_camera.as_ref().map_or(Camera::default(), |(_, text)| Camera::parse(text));
            camera.overrule(&options.camera);
            if camera.bends {
                remarks.push(BENDS.into());
            }
            let mut geometry = Geometry::of(camera.kind(rows, columns)?);
            geometry.unit_m = camera.unit_m.unwrap_or(usual_unit_m);
            geometry
        }
    };
    geometry.unit_m = options.unit_m.unwrap_or(geometry.unit_m);
    geometry.check()?;
    let returned =
        |distance: &f64| *distance > 0.0 && !geometry.no_return.iter().any(|count| f64::from(*count) == *distance);
    let image =
        RangeImage::from_distances(rows, columns, distances().map(|x| if returned(&x) { x } else { 0.0 }), &geometry);
    let image = image.map_err(|e| match &options.geometry {
        Some(path) => Cause::from(ScanError::Misfit { geometry: path.clone(), message: e.to_string() }),
        None => e.into(),
    })?;
    let measured = distances().filter(returned).count();
    Ok(Scan { name, image, geometry, measured, remarks })
}
