//! What lies beside where the angles of rows and columns alone point.

use crate::angles::Angles;

/// Rows, columns and an origin that lie beside the others: `row_offset_deg`, `column_offset_deg` and
/// `lever_arm_m` of the geometry file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Beside {
    /// Added to the beam angles (nodding) or azimuths (spinning) of a row, degrees, one per row: lasers
    /// that look beside the others.
    pub row_offset_deg: Option<Angles>,
    /// Added to the turn of a column of a nodding scanner, degrees, one per column.
    pub column_offset_deg: Option<Angles>,
    /// Distance of a nodding scanner's origin from the axis about which it turns, along the beam at
    /// angle 0, metres.
    pub lever_arm_m: f64,
}

impl Beside {
    /// Nothing does.
    pub const NONE: Beside = Beside { row_offset_deg: None, column_offset_deg: None, lever_arm_m: 0.0 };

    /// Returns what is added to the beam angles or azimuths of a row, degrees.
    pub fn row_deg(&self, row: usize) -> f64 {
        self.row_offset_deg.as_ref().map_or(0.0, |angles| angles.at(row))
    }

    /// Returns what is added to the turn of a column, degrees.
    pub fn column_deg(&self, column: usize) -> f64 {
        self.column_offset_deg.as_ref().map_or(0.0, |angles| angles.at(column))
    }
}
