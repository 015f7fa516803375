//! Organised point clouds: beams taken from the points.

mod angular;
pub(crate) mod axes;
pub(crate) mod e57;
pub(crate) mod fit;
mod lzf;
pub(crate) mod number;
pub(crate) mod pcd;
mod pinhole;
pub(crate) mod ply;
mod ply_header;
pub(crate) mod recognise;
pub(crate) mod rings;

use std::error::Error;

use crate::cloud::axes::Axes;
use crate::cloud::fit::length;
use crate::file::Cause;
use crate::geometry::{Geometry, Kind};
use crate::range_image::RangeImage;
use crate::scan::{ReadOptions, Scan};
use crate::scan_error::ScanError;

/// Points in rows and columns, as seen from the origin.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cloud {
    pub rows: usize,
    pub columns: usize,
    /// `rows * columns` points, in the unit of the file. Where nothing was measured a coordinate is
    /// not finite, or all are 0.
    pub points: Vec<[f32; 3]>,
}

impl Scan {
    /// Returns the scan of an organised cloud: `rows * columns` points, row by row, in metres unless
    /// the options say otherwise. Where nothing was measured a coordinate is not finite, or all are 0.
    ///
    /// # Errors
    /// No pixel has a point, or a geometry file of the options that cannot be read.
    pub fn of_points(
        name: String,
        rows: usize,
        columns: usize,
        points: Vec<[f32; 3]>,
        options: &ReadOptions,
    ) -> Result<Scan, Box<dyn Error + Send + Sync>> {
        let pixels = ScanError::check_pixels(rows, columns)?;
        if points.len() != pixels {
            let what = format!("{rows} x {columns} points (it has {})", points.len());
            return Err(ScanError::lacks("a cloud", what).into());
        }
        Cloud { rows, columns, points }.into_scan(name, options)
    }
}

impl Cloud {
    /// Returns the scan, x forward, y left, z up. Limits and errors are those of the geometry file of
    /// the options, if there is one.
    pub fn into_scan(self, name: String, options: &ReadOptions) -> Result<Scan, Cause> {
        self.into_scan_with_axes(name, options).map(|(scan, _)| scan)
    }

    /// Returns the scan as [`Cloud::into_scan`] does, and the axes that the cloud had.
    pub fn into_scan_with_axes(mut self, name: String, options: &ReadOptions) -> Result<(Scan, Axes), Cause> {
        let Cloud { rows, columns, .. } = self;
        let mut geometry = match options.geometry()? {
            Some(geometry) => geometry,
            None => Geometry::of(Kind::Free { directions: vec![], columns: 0, wraps: false }),
        };
        (geometry.unit_m, geometry.no_return) = (options.unit_m.unwrap_or(1.0), vec![]);
        geometry.check()?;
        for point in &mut self.points {
            let far = point.map(|x| (f64::from(x) * geometry.unit_m) as f32);
            *point = if far.iter().all(|x| x.is_finite()) { far } else { [0.0; 3] };
        }
        let range_m: Vec<f32> = self.points.iter().map(|point| length(point) as f32).collect();
        let measured = range_m.iter().filter(|&&range_m| range_m > 0.0).count();
        if measured == 0 {
            return Err(ScanError::NothingMeasured { pixels: range_m.len() }.into());
        }
        let axes = Axes::of(&self.points, columns);
        self.points.iter_mut().for_each(|point| *point = axes.forward(*point));
        let arrangement = recognise::arrangement(&self.points, columns);
        (geometry.kind, geometry.beside) = (arrangement.kind, arrangement.beside);
        geometry.check()?;
        geometry.fits(rows, columns)?;
        let mut image = RangeImage { rows, columns, range_m };
        image.keep_within(&geometry);
        let remarks = axes.remark().into_iter().collect();
        Ok((Scan { name, image, geometry, measured, remarks }, axes))
    }
}
