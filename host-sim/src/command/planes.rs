//! What `scanseg segment` says of planes that are not to be relied on.

use scanseg_core::{Plane, Segment};

/// From this standard deviation of its normal on a plane is uncertain.
const UNCERTAIN_DEG: f32 = 5.0;

/// Returns how many segments have no plane, or one that is not to be relied on, in one line; none if
/// there is no such segment. The points of one row lie in the plane of measurement, which is a plane
/// of their own that no surface need have.
pub fn weak(segments: &[Segment]) -> Option<String> {
    let planes: Vec<_> = segments.iter().filter_map(|segment| Some((segment, segment.plane()?))).collect();
    let none = segments.len() - planes.len();
    let of_one_row = planes.iter().filter(|(segment, _)| is_one_row(segment)).count();
    let uncertain = planes.iter().filter(|(segment, plane)| !is_one_row(segment) && is_uncertain(plane)).count();
    let parts = [
        (none, "have none".to_string()),
        (of_one_row, "lie in one row".to_string()),
        (uncertain, format!("are uncertain by {UNCERTAIN_DEG} deg or more")),
    ];
    let parts: Vec<_> =
        parts.iter().filter(|(count, _)| *count > 0).map(|(count, what)| format!("{count} {what}")).collect();
    (!parts.is_empty()).then(|| format!("planes of {} segments: {}\n", segments.len(), parts.join(", ")))
}

fn is_one_row(segment: &Segment) -> bool {
    segment.first_row == segment.last_row
}

fn is_uncertain(plane: &Plane) -> bool {
    let variance: f32 = (0..3).map(|i| plane.covariance[i][i]).sum();
    variance.sqrt() >= UNCERTAIN_DEG.to_radians() || variance.is_nan()
}
