//! A join or a segment, and the plane of a segment.

use scanseg_core::{Fitted, Label, Moments, Plane, Segment, SegmentSums};

use crate::status::{SCANSEG_NO_PLANE, Status};

/// `kind` of an event: pixels labelled `label` in earlier rows belong to `into`, the smaller label.
pub const SCANSEG_JOIN: u32 = 1;
/// `kind` of an event: the segment `label` is complete. With `SCANSEG_PLANE` it may still be joined
/// with another one that turns out to be a part of the same surface; then it is given again when
/// that is complete, and the later one counts.
pub const SCANSEG_SEGMENT: u32 = 2;

/// Two areas are one, or a segment is complete. Of a join only `kind`, `label` and `into` are set,
/// the rest is 0.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Event {
    /// `SCANSEG_JOIN` or `SCANSEG_SEGMENT`.
    pub kind: u32,
    /// The segment's label, or the label that ends here. Labels count up from 1 and are never used
    /// twice within a scan.
    pub label: u32,
    /// Join: the label that goes on.
    pub into: u32,
    /// Segment: number of its pixels.
    pub pixels: u32,
    /// Segment: first row with a pixel of it.
    pub first_row: u16,
    /// Segment: last row with a pixel of it.
    pub last_row: u16,
    /// Segment: leftmost column with a pixel of it. Across the seam of a wrapped image: 0.
    pub first_column: u16,
    /// Segment: rightmost column with a pixel of it. Across the seam of a wrapped image: the last
    /// one.
    pub last_column: u16,
    /// Segment of `SCANSEG_EDGE` or `SCANSEG_REGION`: sums of x, y, z over its points, in units of
    /// 1/4096 m. By planes 0.
    pub first_moments: [i64; 3],
    /// The same: sums of xx, yy, zz, xy, xz, yz, in units of 1/4096 m squared. See
    /// `scanseg_fit_plane`.
    pub second_moments: [i64; 6],
    /// Segment of `SCANSEG_PLANE`: its plane with the sums that it was found from. Else 0.
    /// `scanseg_fit_plane` makes a plane of it with its covariance. With the beam u of a point, a
    /// unit vector, and its weight r^4 / sigma^2 of its range r and the standard deviation of that:
    /// the sum of the weights, less what errors that all pixels of a row share take of it, m^2; the
    /// sum of the weights, m^2; x, y, z of the weighted mean of the beams; xx, yy, zz, xy, xz,
    /// yz of their weighted scatter about it, m^2; x, y, z of the plane m, the points p with p . m =
    /// 1, 1 / m; the sum of the squared range errors in units of the noise.
    pub plane_sums: [f32; 15],
}

/// The plane of a segment: the points p with normal . p + distance = 0; x forward, y left, z up.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneFit {
    /// Mean of the points, metres. `SCANSEG_PLANE`: the middle of the points as the scanner sees
    /// them, on the plane; far points weigh more.
    pub centroid_m: [f32; 3],
    /// Unit normal towards the scanner.
    pub normal: [f32; 3],
    /// Distance of the plane from the scanner, metres; not negative.
    pub distance_m: f32,
    /// Root of the mean squared distance of the points from the plane, metres.
    pub rms_m: f32,
    /// Covariance of (normal x, y, z, distance): symmetric, in rad^2, rad m and m^2. Of rank 3. From
    /// the residuals, and where these are below 1/4096 m from the rounding of points; `SCANSEG_PLANE`: from the noise that the ranges are said or found to have, and
    /// from the residuals where these are larger.
    pub covariance: [[f32; 4]; 4],
}

/// The plane of the sums of an event.
pub(crate) fn fit_plane(event: &Event) -> Result<PlaneFit, Status> {
    // sums that no segment has
    if event.first_moments.contains(&i64::MIN) {
        return Err(SCANSEG_NO_PLANE);
    }
    let segment = segment_of(event);
    let Plane { normal, distance_m, rms_m, covariance } = segment.plane().ok_or(SCANSEG_NO_PLANE)?;
    Ok(PlaneFit { centroid_m: segment.centroid_m(), normal, distance_m, rms_m, covariance })
}

/// The segment that an event tells of.
fn segment_of(event: &Event) -> Segment {
    let sums = if event.plane_sums[0] > 0.0 {
        SegmentSums::Fitted { pixels: event.pixels, fitted: Fitted::from_numbers(event.plane_sums) }
    } else {
        let (first, second) = (event.first_moments, event.second_moments);
        SegmentSums::Moments(Moments { points: event.pixels, first, second })
    };
    Segment {
        label: Label(event.label),
        first_row: event.first_row,
        last_row: event.last_row,
        first_column: event.first_column,
        last_column: event.last_column,
        sums,
    }
}
