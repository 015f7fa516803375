//! The extent and plane of each area.

use super::Image;
use super::beams::Beams;
use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector3};
use std::collections::BTreeMap;

/// Points are collinear where the sum of squared deviations along the second principal axis is at
/// most this times that along the first: a strip 30 000 times longer than wide. Points of a line
/// whose ranges were rounded to f32 deviate less if it is longer than some 1/200 of its range.
pub const COLLINEAR: f64 = 1e-9;

/// A plane n.x + d = 0 fitted to points by total least squares.
#[derive(Clone, Debug)]
pub struct Plane {
    /// n: unit length, towards the scanner, which is at the origin. Either way where the plane
    /// holds the origin.
    pub normal: Vector3<f64>,
    /// d: the distance of the plane from the origin, metres, never negative.
    pub distance_m: f64,
    /// Root of the mean of the squared distances of the points from the plane, metres.
    pub rms_m: f64,
    /// Covariance of (n, d), from the residuals.
    pub covariance: Matrix4<f64>,
}

/// One area of a label image.
#[derive(Clone, Debug)]
pub struct Area {
    /// Its label, not 0.
    pub label: u32,
    /// Number of pixels.
    pub pixels: usize,
    /// Least row.
    pub first_row: usize,
    /// Greatest row.
    pub last_row: usize,
    /// Least column index; 0 for an area across the seam of an image that wraps.
    pub first_column: usize,
    /// Greatest column index.
    pub last_column: usize,
    /// Mean of its points, metres.
    pub centroid_m: Vector3<f64>,
    /// Its plane, see [`fit_plane`].
    pub plane: Option<Plane>,
}

/// The areas of a label image, by label. Label 0 is no area, and neither is a pixel without a
/// return. Panics if there is not one label per pixel.
pub fn areas(image: &Image, beams: &Beams, labels: &[u32]) -> Vec<Area> {
    assert_eq!(labels.len(), image.range_m.len(), "one label per pixel");
    let mut pixels_of = BTreeMap::<u32, Vec<(usize, usize)>>::new();
    for (pixel, &label) in image.size.pixels().zip(labels) {
        if label != 0 && image.range(pixel).is_some() {
            pixels_of.entry(label).or_default().push(pixel);
        }
    }
    let area = |(label, pixels): (u32, Vec<(usize, usize)>)| {
        let point = |&pixel| Some(beams.direction(pixel) * f64::from(image.range(pixel)?));
        let points: Vec<_> = pixels.iter().filter_map(point).collect();
        let rows = || pixels.iter().map(|pixel| pixel.0);
        let columns = || pixels.iter().map(|pixel| pixel.1);
        Some(Area {
            label,
            pixels: pixels.len(),
            first_row: rows().min()?,
            last_row: rows().max()?,
            first_column: columns().min()?,
            last_column: columns().max()?,
            centroid_m: centroid(&points),
            plane: fit_plane(&points),
        })
    };
    pixels_of.into_iter().filter_map(area).collect()
}

/// The mean of the points; not a number for none.
pub fn centroid(points: &[Vector3<f64>]) -> Vector3<f64> {
    points.iter().sum::<Vector3<f64>>() / points.len() as f64
}

/// The plane through the centroid whose normal is the eigenvector of the smallest eigenvalue of the
/// points' scatter. `None` for fewer than 4 points and for [collinear](COLLINEAR) ones.
///
/// The covariance, with e1 and e2 the principal axes in the plane, L1 and L2 the sums of squared
/// deviations along them, c the centroid and s2 = (sum of squared residuals) / (points - 3), is
///
/// - cov(n) = s2 (e1 e1' / L1 + e2 e2' / L2)
/// - cov(n, d) = -cov(n) c
/// - var(d) = c' cov(n) c + s2 / points
///
/// which follows to first order from d = -n.c, as n turns about e1 and e2 only, independently of
/// the mean residual.
pub fn fit_plane(points: &[Vector3<f64>]) -> Option<Plane> {
    if points.len() < 4 {
        return None;
    }
    let count = points.len() as f64;
    let centroid = centroid(points);
    let deviations: Vec<_> = points.iter().map(|point| point - centroid).collect();
    let scatter: Matrix3<f64> = deviations.iter().map(|deviation| deviation * deviation.transpose()).sum();

    let eigen = SymmetricEigen::new(scatter);
    let mut axes = [0, 1, 2];
    axes.sort_by(|&a, &b| eigen.eigenvalues[b].total_cmp(&eigen.eigenvalues[a]));
    let [e1, e2, mut normal] = axes.map(|axis| eigen.eigenvectors.column(axis).into_owned());
    // The eigenvalues, summed anew: an eigenvalue far below the largest one has few correct digits.
    let along = |axis: Vector3<f64>| deviations.iter().map(|deviation| deviation.dot(&axis).powi(2)).sum::<f64>();
    let (sum1, sum2, residuals) = (along(e1), along(e2), along(normal));
    if sum2 <= COLLINEAR * sum1 {
        return None;
    }

    let mut distance_m = -normal.dot(&centroid);
    if distance_m < 0.0 {
        (normal, distance_m) = (-normal, -distance_m);
    }
    let variance = residuals / (count - 3.0);
    let normal_covariance = (e1 * e1.transpose() / sum1 + e2 * e2.transpose() / sum2) * variance;
    let cross = -normal_covariance * centroid;
    let mut covariance = Matrix4::zeros();
    covariance.fixed_view_mut::<3, 3>(0, 0).copy_from(&normal_covariance);
    covariance.fixed_view_mut::<3, 1>(0, 3).copy_from(&cross);
    covariance.fixed_view_mut::<1, 3>(3, 0).copy_from(&cross.transpose());
    covariance[(3, 3)] = centroid.dot(&(normal_covariance * centroid)) + variance / count;
    Some(Plane { normal, distance_m, rms_m: (residuals / count).sqrt(), covariance })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::art::Picture;

    /// Four points about (2, 3, 0), off the plane x = 2 by +-e crosswise. Worked out by hand: SSE =
    /// 4 e^2, s2 = 4 e^2, sums of squares along y and z are 4 and 16, so cov(n) = e^2 diag(0, 1,
    /// 1/4).
    #[test]
    fn plane_by_hand() {
        let e = 0.01;
        let points = [[2.0 + e, 4.0, 2.0], [2.0 - e, 4.0, -2.0], [2.0 - e, 2.0, 2.0], [2.0 + e, 2.0, -2.0]];
        for mirrored in [1.0, -1.0] {
            let plane = fit_plane(&points.map(|[x, y, z]| Vector3::new(mirrored * x, y, z))).unwrap();
            assert!((plane.normal - Vector3::new(-mirrored, 0.0, 0.0)).norm() < 1e-12, "{:?}", plane.normal);
            assert!((plane.distance_m - 2.0).abs() < 1e-12);
            assert!((plane.rms_m - e).abs() < 1e-12);
            #[rustfmt::skip]
            let expected = Matrix4::new(
                0.0,  0.0,  0.0,   0.0,
                0.0,  1.0,  0.0,  -3.0,
                0.0,  0.0,  0.25,  0.0,
                0.0, -3.0,  0.0,  10.0,
            );
            let covariance = plane.covariance / (e * e);
            assert!((covariance - expected).norm() < 1e-9, "{covariance}");
        }
    }

    #[test]
    fn no_plane() {
        let line = |i: f64| Vector3::new(1.0 + i, 2.0 - 2.0 * i, 0.5 * i);
        let mut points: Vec<_> = (0..20).map(|i| line(f64::from(i))).collect();
        assert!(fit_plane(&points).is_none());
        points[7].z += 0.1;
        assert!(fit_plane(&points).is_some());
        assert!(fit_plane(&[Vector3::new(1.0, 2.0, 3.0); 5]).is_none());
        assert!(fit_plane(&[]).is_none());
        let corners = [Vector3::new(1.0, 0.0, 0.0), Vector3::y(), Vector3::z(), Vector3::new(1.0, 1.0, -1.0)];
        assert!(fit_plane(&corners[..3]).is_none());
        // Four points of x + y + z = 1.
        let plane = fit_plane(&corners).unwrap();
        assert!((plane.normal + Vector3::repeat(1.0 / 3f64.sqrt())).norm() < 1e-12);
        assert!((plane.distance_m - 1.0 / 3f64.sqrt()).abs() < 1e-12);
        assert!(plane.rms_m < 1e-12);
    }

    /// The spread of (n, d) over 4000 noisy patches of an oblique plane is what the covariance
    /// says: 10 points each, off the plane by a sigma of 5 mm.
    #[test]
    fn covariance_is_the_spread() {
        let mut state = 1u64;
        let mut uniform = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        let mut gauss = || (0..12).map(|_| uniform()).sum::<f64>() - 6.0;
        let normal = Vector3::new(-2.0, 1.0, 2.0) / 3.0;
        let (u, v) = (Vector3::new(1.0, 2.0, 0.0) / 5f64.sqrt(), Vector3::new(4.0, -2.0, 5.0) / 45f64.sqrt());
        let centre = Vector3::new(3.0, 1.0, -0.5);
        let trials = 4000;
        let (mut spread, mut predicted) = (Matrix4::zeros(), Matrix4::zeros());
        for _ in 0..trials {
            let grid = (0..10).map(|i| (f64::from(i % 5) * 0.1, f64::from(i / 5) * 0.3));
            let points: Vec<_> = grid.map(|(a, b)| centre + u * a + v * b + normal * (0.005 * gauss())).collect();
            let plane = fit_plane(&points).unwrap();
            let mean_point = centre + u * 0.2 + v * 0.15;
            let error = (plane.normal - normal).push(plane.distance_m + normal.dot(&mean_point));
            spread += error * error.transpose() / f64::from(trials);
            predicted += plane.covariance / f64::from(trials);
        }
        for (spread, predicted) in spread.iter().zip(predicted.iter()) {
            let scale = predicted.abs().max(0.02 * 0.005f64.powi(2));
            assert!((spread - predicted).abs() < 0.1 * scale, "{spread:e} is not {predicted:e}");
        }
    }

    /// Two walls seen by a camera, x = 2 and x = 3, and an area too small for a plane.
    #[test]
    fn areas_of_an_image() {
        let picture = Picture::parse(
            "
            |aa#bbb|
            |aa#bbb|
            |aa#bb |
            |###   |
            |c#    |",
        );
        let beams = Beams::Pinhole { fx: 10.0, fy: 10.0, cx: 2.0, cy: 1.0 };
        let size = picture.size(false);
        let mut labels = picture.to_labels();
        // A label without a return counts for nothing.
        labels[size.index(3, 4)] = 2;
        let depth_m = picture.map(|pixel| match pixel {
            'b' => 3.0,
            ' ' => 0.0,
            _ => 2.0,
        });
        let range = |(pixel, depth_m): ((usize, usize), f64)| (depth_m / beams.direction(pixel).x) as f32;
        let image = Image::new(size, size.pixels().zip(depth_m).map(range).collect());
        let areas = areas(&image, &beams, &labels);

        let extent = |area: &Area| {
            (area.label, area.pixels, [area.first_row, area.last_row], [area.first_column, area.last_column])
        };
        let expected = [(1, 6, [0, 2], [0, 1]), (2, 8, [0, 2], [3, 5]), (3, 1, [4, 4], [0, 0])];
        assert_eq!(areas.iter().map(extent).collect::<Vec<_>>(), expected);
        for (area, depth_m) in areas.iter().zip([2.0, 3.0]) {
            let plane = area.plane.as_ref().unwrap();
            assert!((plane.normal + Vector3::x()).norm() < 1e-5);
            assert!((plane.distance_m - depth_m).abs() < 1e-5);
            assert!(plane.rms_m < 1e-6);
        }
        assert!(areas[2].plane.is_none());
        // Columns 0 and 1 lie 2 and 1 pixels to the left of the axis at 2 m: y = 0.4 and 0.2; the
        // rows are centred.
        assert!((areas[0].centroid_m - Vector3::new(2.0, 0.3, 0.0)).norm() < 1e-6);
        // Row 4, column 0.
        assert!((areas[2].centroid_m - Vector3::new(2.0, 0.4, -0.6)).norm() < 1e-6);
    }
}
