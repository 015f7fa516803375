//! Organised point clouds: beams taken from the points.

pub(crate) mod e57;
mod lzf;
pub(crate) mod number;
pub(crate) mod pcd;
pub(crate) mod ply;

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
    /// Returns the scan. Limits and errors are those of the geometry file of the options, if there
    /// is one.
    pub fn into_scan(mut self, name: String, options: &ReadOptions) -> Result<Scan, Cause> {
        let unit_m = options.unit_m.unwrap_or(1.0);
        for point in &mut self.points {
            let far = point.map(|x| (f64::from(x) * unit_m) as f32);
            *point = if far.iter().all(|x| x.is_finite()) { far } else { [0.0; 3] };
        }
        let range_m: Vec<f32> = self.points.iter().map(length).collect();
        let measured = range_m.iter().filter(|&&range_m| range_m > 0.0).count();
        if measured == 0 {
            return Err(ScanError::NothingMeasured { pixels: range_m.len() }.into());
        }
        let mut geometry = match &options.geometry {
            Some(path) => Geometry::read(path)?,
            None => Geometry::of(Kind::Free { directions: vec![], columns: 0, wraps: false }),
        };
        geometry.unit_m = unit_m;
        geometry.no_return = vec![];
        geometry.kind = free(&self.points, self.columns);
        let mut image = RangeImage { rows: self.rows, columns: self.columns, range_m };
        image.keep_within(&geometry);
        Ok(Scan { name, image, geometry, measured, remarks: vec![] })
    }
}

fn length(point: &[f32; 3]) -> f32 {
    let squares = point.map(|x| f64::from(x) * f64::from(x));
    squares.iter().sum::<f64>().sqrt() as f32
}

/// Returns beams through the points.
fn free(points: &[[f32; 3]], columns: usize) -> Kind {
    let direction = |point: &[f32; 3]| {
        let range = length(point);
        if range > 0.0 { point.map(|x| x / range) } else { [1.0, 0.0, 0.0] }
    };
    Kind::Free { directions: points.iter().map(direction).collect(), columns, wraps: false }
}
