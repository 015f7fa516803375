//! Convex hulls in the plane.

/// Returns the corners of the hull of some points, anticlockwise; fewer than three of points on a
/// line. The order of the points changes.
pub(super) fn hull(points: &mut Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    points.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    points.dedup();
    // the lower side from left to right, then the upper one back (Andrew 1979)
    let mut corners = side(points.iter());
    let upper = side(points.iter().rev());
    corners.pop();
    corners.extend(upper);
    corners.pop();
    corners
}

fn side<'a>(points: impl Iterator<Item = &'a [f64; 2]>) -> Vec<[f64; 2]> {
    let mut corners: Vec<[f64; 2]> = vec![];
    for &point in points {
        while let [.., a, b] = corners[..]
            && turn(a, b, point) <= 0.0
        {
            corners.pop();
        }
        corners.push(point);
    }
    corners
}

/// Above 0 where a, b, c turn to the left.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Returns the area within corners that go anticlockwise.
pub(super) fn area(corners: &[[f64; 2]]) -> f64 {
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>() / 2.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_lies_within_is_left_out() {
        let mut points = vec![[1.0, 1.0], [0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [1.0, 0.0], [0.0, 2.0], [0.0, 0.0]];
        let corners = hull(&mut points);
        assert_eq!(corners, [[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]]);
        assert_eq!(area(&corners), 4.0);
    }

    #[test]
    fn points_on_a_line_have_none() {
        assert!(hull(&mut vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]]).len() < 3);
        assert!(hull(&mut vec![[0.0, 0.0]]).len() < 3);
        assert!(hull(&mut vec![]).is_empty());
    }
}
