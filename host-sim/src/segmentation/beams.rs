//! The beams of a range image as the core wants them.

use scanseg_core::{Beams, Columns, RowBeams};
use scanseg_formats::{Angles, Geometry, GeometryError, Kind};

/// The beams of a scan, as the core wants them: `f32`, radians.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanBeams {
    kind: Kind,
    /// Column angles, if they are listed.
    columns_rad: Vec<f32>,
    /// How much more than its row each column is turned, if any is.
    turns_rad: Vec<f32>,
    /// One angle per row: turn, elevation, or 0 for a pinhole.
    rows_rad: Vec<f32>,
    /// What is added to the angles of the columns of each row.
    offsets_rad: Vec<f32>,
    lever_arm_m: f32,
}

impl ScanBeams {
    /// Returns the beams of an image of `rows` x `columns` pixels. Even azimuths that go round, but
    /// not exactly once, become a list, so that the angle across the seam is the true one.
    ///
    /// # Errors
    /// If the geometry does not fit the image, see [`Geometry::fits`].
    pub fn new(geometry: &Geometry, rows: usize, columns: usize) -> Result<ScanBeams, GeometryError> {
        geometry.fits(rows, columns)?;
        let list = |angles: &Angles, count| (0..count).map(|i| radians(angles.at(i))).collect::<Vec<_>>();
        let beside = &geometry.beside;
        let turned = beside.column_offset_deg.is_some();
        let (rows_rad, columns_rad) = match &geometry.kind {
            Kind::Nodding { beam_deg, turn_deg, .. } => {
                let listed = turned || matches!(beam_deg, Angles::Listed(_));
                (list(turn_deg, rows), if listed { list(beam_deg, columns) } else { vec![] })
            }
            Kind::Spinning { azimuth_deg, elevation_deg, wraps } => {
                let listed = match azimuth_deg {
                    Angles::Listed(_) => true,
                    Angles::Even { step_deg, .. } => {
                        *wraps && (step_deg.abs() * columns as f64 - 360.0).abs() > 0.009 * step_deg.abs()
                    }
                };
                (list(elevation_deg, rows), if listed { list(azimuth_deg, columns) } else { vec![] })
            }
            Kind::Pinhole { .. } | Kind::Free { .. } => (vec![0.0; rows], vec![]),
        };
        let turns = if turned { columns } else { 0 };
        Ok(ScanBeams {
            kind: geometry.kind.clone(),
            columns_rad,
            turns_rad: (0..turns).map(|column| radians(beside.column_deg(column))).collect(),
            rows_rad,
            offsets_rad: (0..rows).map(|row| radians(beside.row_deg(row))).collect(),
            lever_arm_m: beside.lever_arm_m as f32,
        })
    }

    /// Returns the beams for the core.
    pub fn beams(&self) -> Beams<'_> {
        let columns = |angles: &Angles| match *angles {
            Angles::Even { start_deg, step_deg } if self.columns_rad.is_empty() => {
                Columns::Even { start_rad: radians(start_deg), step_rad: step_deg.to_radians() as f32 }
            }
            _ if self.turns_rad.is_empty() => Columns::Listed(&self.columns_rad),
            _ => Columns::Beside { angles_rad: &self.columns_rad, turns_rad: &self.turns_rad },
        };
        match &self.kind {
            Kind::Nodding { beam_deg, turn_axis, .. } => {
                Beams::Nodding { columns: columns(beam_deg), axis: *turn_axis }
            }
            Kind::Spinning { azimuth_deg, wraps, .. } => {
                Beams::Spinning { columns: columns(azimuth_deg), wraps: *wraps }
            }
            &Kind::Pinhole { fx_px, fy_px, cx_px, cy_px, .. } => {
                let [fx_px, fy_px, cx_px, cy_px] = [fx_px, fy_px, cx_px, cy_px].map(|px| px as f32);
                Beams::Pinhole { fx_px, fy_px, cx_px, cy_px }
            }
            Kind::Free { wraps, .. } => Beams::Free { wraps: *wraps },
        }
    }

    /// Returns what to push with a row, 0 to less than the number of rows.
    pub fn row(&self, row: usize) -> RowBeams<'_> {
        match &self.kind {
            Kind::Free { directions, columns, .. } => RowBeams::free(&directions[row * columns..(row + 1) * columns]),
            _ => RowBeams::from(self.rows_rad[row])
                .with_offset_rad(self.offsets_rad[row])
                .with_lever_arm_m(self.lever_arm_m),
        }
    }
}

/// Within one turn, where `f32` is finest.
fn radians(deg: f64) -> f32 {
    (deg % 360.0).to_radians() as f32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn even_angles_stay_even_unless_the_seam_would_be_wrong() {
        let spinning = |step, columns, wraps| {
            let azimuth_deg = Angles::Even { start_deg: 540.0, step_deg: step };
            let elevation_deg = Angles::Listed(vec![10.0, -5.0]);
            let kind = Kind::Spinning { azimuth_deg, elevation_deg, wraps };
            ScanBeams::new(&Geometry::of(kind), 2, columns).unwrap()
        };
        let closed = spinning(-3.6, 100, true);
        let Beams::Spinning { columns: Columns::Even { start_rad, step_rad }, wraps: true } = closed.beams() else {
            panic!("{closed:?}");
        };
        assert_eq!((start_rad, step_rad), (std::f32::consts::PI, (-3.6f64).to_radians() as f32));
        let elevations_rad = [0, 1].map(|row| closed.row(row).turn_rad);
        assert_eq!(elevations_rad, [10f64, -5.0].map(|deg| deg.to_radians() as f32));
        // half a step is missing at the seam
        let open = spinning(-3.582, 100, true);
        let Beams::Spinning { columns: Columns::Listed(list), wraps: true } = open.beams() else { panic!("{open:?}") };
        assert_eq!((list.len(), list[99]), (100, (540.0f64 - 99.0 * 3.582).to_radians() as f32));
        let apart = spinning(-3.582, 100, false);
        assert!(matches!(apart.beams(), Beams::Spinning { columns: Columns::Even { .. }, wraps: false }));
    }
}
