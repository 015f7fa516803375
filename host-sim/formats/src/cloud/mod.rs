//! Organised point clouds: beams taken from the points.

mod angular;
pub(crate) mod e57;
mod fit;
mod lzf;
pub(crate) mod number;
pub(crate) mod pcd;
mod pinhole;
pub(crate) mod ply;
mod ply_header;
mod recognise;

use crate::cloud::fit::length;
use crate::cloud::pinhole::{FORWARD, GRAPHICS, OPTICAL};
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

impl Cloud {
    /// Returns the scan, x forward, y left, z up. Limits and errors are those of the geometry file of
    /// the options, if there is one.
    pub fn into_scan(mut self, name: String, options: &ReadOptions) -> Result<Scan, Cause> {
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
        let remarks = self.turn_forward();
        let arrangement = recognise::arrangement(&self.points, columns);
        (geometry.kind, geometry.beside) = (arrangement.kind, arrangement.beside);
        geometry.check()?;
        geometry.fits(rows, columns)?;
        let mut image = RangeImage { rows, columns, range_m };
        image.keep_within(&geometry);
        Ok(Scan { name, image, geometry, measured, remarks })
    }

    /// Turns a cloud in the axes of a camera. Returns what is to be said of it.
    fn turn_forward(&mut self) -> Vec<String> {
        let is = |axes| pinhole::looks(&self.points, self.columns, axes);
        if is(FORWARD) {
            return vec![];
        }
        let (backward, axes) = if is(OPTICAL) {
            (1.0, "x right, y down, z forward")
        } else if is(GRAPHICS) {
            (-1.0, "x right, y up, z backward")
        } else {
            return vec![];
        };
        self.points.iter_mut().for_each(|[x, y, z]| (*x, *y, *z) = (backward * *z, -*x, -backward * *y));
        vec![format!("its axes are those of a camera ({axes}); in the results x is forward, y left, z up")]
    }
}
