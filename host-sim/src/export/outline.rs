//! The outline of a segment on its plane.

use scanseg_core::{Plane, Segment};

use crate::export::convex::{area, hull};
use crate::export::segmented::{Segmented, dot};

/// The convex hull, in the plane of a segment, of its points dropped onto the plane: holes and bays are
/// filled.
#[derive(Clone, Debug, PartialEq)]
pub struct Outline {
    /// Its corners, three or more, metres, anticlockwise as seen from the scanner. The first is not
    /// repeated.
    pub corners_m: Vec<[f64; 3]>,
    /// The area within, square metres.
    pub area_m2: f64,
}

impl Outline {
    /// Returns the outline of points; none of points on a line.
    fn of(plane: &Plane, points: impl Iterator<Item = [f64; 3]>) -> Option<Outline> {
        // the normal points to the scanner, from where anticlockwise is seen
        let (normal, distance_m) = (plane.normal.map(f64::from), f64::from(plane.distance_m));
        let length = dot(normal, normal).sqrt();
        let (normal, distance_m) = (normal.map(|x| x / length), distance_m / length);
        let [u, v] = axes(normal);
        let mut flat: Vec<[f64; 2]> = points.map(|point| [dot(point, u), dot(point, v)]).collect();
        let corners = hull(&mut flat);
        if corners.len() < 3 {
            return None;
        }
        let in_space = |[a, b]: [f64; 2]| [0, 1, 2].map(|i| a * u[i] + b * v[i] - distance_m * normal[i]);
        let area_m2 = area(&corners);
        Some(Outline { corners_m: corners.into_iter().map(in_space).collect(), area_m2 })
    }
}

/// Returns an outline for each segment; none of one without a plane, or whose points lie on a line.
pub fn outlines_of(scan: &Segmented<'_>) -> Vec<Option<Outline>> {
    let outline = |(segment, pixels): (&Segment, &Vec<usize>)| {
        Outline::of(&segment.plane()?, pixels.iter().filter_map(|&pixel| scan.point_m(pixel)))
    };
    scan.segments.iter().zip(&scan.pixels()).map(outline).collect()
}

/// Returns two unit vectors across a third, such that the three are right-handed.
fn axes(normal: [f64; 3]) -> [[f64; 3]; 2] {
    // the axis that is farthest from the normal
    let least = (0..3).min_by(|&a, &b| normal[a].abs().total_cmp(&normal[b].abs())).unwrap_or(0);
    let mut axis = [0.0; 3];
    axis[least] = 1.0;
    let u = cross(axis, normal);
    let length = dot(u, u).sqrt();
    let u = u.map(|x| x / length);
    [u, cross(normal, u)]
}

fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
