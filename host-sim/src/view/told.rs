//! What pages are told of a segment, as JSON.

use scanseg_core::Segment;
use serde::Serialize;

/// A segment.
#[derive(Serialize)]
pub struct ToldSegment {
    /// Its label by the core.
    pub label: u32,
    /// Number of pixels.
    pub pixels: u32,
    /// First row with a pixel of it.
    pub first_row: u16,
    /// Last row with a pixel of it.
    pub last_row: u16,
    /// Leftmost column with a pixel of it.
    pub first_column: u16,
    /// Rightmost column with a pixel of it.
    pub last_column: u16,
    /// Its plane, if it has one.
    pub plane: Option<ToldPlane>,
}

/// The plane of a segment.
#[derive(Serialize)]
pub struct ToldPlane {
    /// Unit normal towards the scanner.
    pub normal: [f32; 3],
    /// Distance from the scanner, metres.
    pub distance_m: f32,
    /// Root of the mean squared distance of the points, metres.
    pub rms_m: f32,
    /// Covariance of normal x, y, z and distance.
    pub covariance: [[f32; 4]; 4],
}

impl ToldSegment {
    /// Returns what is told of a segment.
    pub fn of(segment: &Segment) -> ToldSegment {
        let plane = segment.plane().map(|plane| ToldPlane {
            normal: plane.normal,
            distance_m: plane.distance_m,
            rms_m: plane.rms_m,
            covariance: plane.covariance,
        });
        ToldSegment {
            label: segment.label.0,
            pixels: segment.pixels(),
            first_row: segment.first_row,
            last_row: segment.last_row,
            first_column: segment.first_column,
            last_column: segment.last_column,
            plane,
        }
    }
}
