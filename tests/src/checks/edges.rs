//! The edge-based segmenter against the reference, given the same bearing angles.

use crate::art::{Picture, canonical};
use crate::reference::Segmentation;
use crate::reference::planes::{self, Area};
use crate::stream::{Record, Scan, class};
use nalgebra::{Matrix3, Matrix4, SymmetricEigen, Vector3};
use scanseg_core::{EdgeConfig, POINT_UNIT_M, Pixel, Segment, live_labels};

/// Compares everything, with a table of live labels that is never full. Returns the segments
/// compared, those of them with a plane, and those whose covariance was compared.
pub fn assert_same(scan: &Scan, config: &EdgeConfig) -> [usize; 3] {
    let (record, expected) = assert_same_labels(scan, config);
    assert_segments(scan, config, &record, &expected)
}

/// Compares edges and labels, which do not depend on how well the beams are known.
pub fn assert_same_labels(scan: &Scan, config: &EdgeConfig) -> (Record, Segmentation) {
    let columns = scan.columns;
    let expected = scan.expected(config);
    let record = scan.record(*config, live_labels(columns));
    record.assert_order(scan.turn_rad.len());
    assert_eq!(Picture::bits(columns, &record.edges(columns)), Picture::bits(columns, &expected.edges));
    let classes: Vec<_> = record.pixels().into_iter().map(class).collect();
    assert_eq!(Picture::classes(columns, &classes), Picture::classes(columns, &expected.classes));
    assert_eq!(record.unlabelled(columns).iter().sum::<u32>(), 0, "pixels without a label");
    let labels = record.labels();
    assert_eq!(
        Picture::labels(columns, &classes, &canonical(&labels)),
        Picture::labels(columns, &expected.classes, &expected.labels)
    );
    // pictures have one character for all labels above 62
    assert_eq!(canonical(&labels), expected.labels);
    (record, expected)
}

/// The segments are the areas of the reference.
fn assert_segments(scan: &Scan, config: &EdgeConfig, record: &Record, expected: &Segmentation) -> [usize; 3] {
    let labels = record.labels();
    let segments = record.segments();
    assert_eq!(segments.len(), expected.areas.len());
    let (image, beams) = (scan.image(&config.ranging), scan.reference_beams());
    let mut compared = [segments.len(), 0, 0];
    for area in &expected.areas {
        let first = expected.labels.iter().position(|&label| label == area.label).unwrap();
        let segment = segments[&labels[first]];
        let rows = [segment.first_row, segment.last_row].map(usize::from);
        let columns = [segment.first_column, segment.last_column].map(usize::from);
        assert_eq!(segment.pixels() as usize, area.pixels);
        assert_eq!(rows, [area.first_row, area.last_row], "{segment:?}");
        assert_eq!(columns, [area.first_column, area.last_column], "{segment:?}");
        let point =
            |(pixel, _): ((usize, usize), &u32)| beams.direction(pixel) * f64::from(image.range(pixel).unwrap());
        let of_area = image.size.pixels().zip(&expected.labels).filter(|&(_, &label)| label == area.label);
        let points: Vec<_> = of_area.map(point).collect();
        let (plane, covariance) = assert_plane(&segment, area, &points);
        compared[1] += usize::from(plane);
        compared[2] += usize::from(covariance);
    }
    compared
}

/// Compares centroid, plane and covariance with those of the true points. Returns whether there
/// were planes, and whether they were well enough conditioned for their covariance to be compared.
///
/// The core rounds each point to whole [`POINT_UNIT_M`] and takes its direction in f32, so that it
/// is off by at most `e`: half a unit along each axis, and 1e-6 of the range. The deviations of n
/// points from their centroid, a matrix D of n x 3, are then off by at most sqrt(n) e (Frobenius,
/// hence spectral norm). With D's singular values s1 >= s2 >= s3 it follows that
/// - s3, and with it the rms residual s3 / sqrt(n), moves by at most sqrt(n) e and e (Weyl);
/// - the normal tilts by at most sin = sqrt(n) e / (s2 - s3 - sqrt(n) e) (Wedin);
/// - the distance, -n.c, moves by at most e + tilt |c|.
fn assert_plane(segment: &Segment, area: &Area, points: &[Vector3<f64>]) -> (bool, bool) {
    let n = points.len() as f64;
    let farthest_m = points.iter().map(|point| point.norm()).fold(0.0, f64::max);
    let per_axis_m = 0.5 * f64::from(POINT_UNIT_M) + 1e-6 * farthest_m;
    let e = 3f64.sqrt() * per_axis_m;
    let centroid = Vector3::from(segment.centroid_m().map(f64::from));
    let off = centroid - area.centroid_m;
    assert!(off.amax() <= per_axis_m + 1e-7 * farthest_m, "{segment:?}: centroid off by {off}");

    let mean = planes::centroid(points);
    let scatter: Matrix3<f64> = points.iter().map(|point| (point - mean) * (point - mean).transpose()).sum();
    let mut singular = SymmetricEigen::new(scatter).eigenvalues.map(|value| value.max(0.0).sqrt());
    singular.as_mut_slice().sort_by(f64::total_cmp);
    let (s3, s2, noise) = (singular[0], singular[1], n.sqrt() * e);
    // the core gives no plane where s2 <= sqrt(n) units
    let threshold = n.sqrt() * f64::from(POINT_UNIT_M);
    let Some(found) = segment.plane() else {
        assert!(n < 4.0 || s2 <= threshold + noise, "no plane of {n} points, s2 {s2}: {segment:?}");
        return (false, false);
    };
    assert!(n >= 4.0 && s2 >= threshold - noise, "a plane of {n} points, s2 {s2}: {segment:?}");
    let Some(expected) = &area.plane else {
        // a thin strip, long enough to be a line for the reference
        return (false, false);
    };
    let unit = found.normal.iter().map(|&c| f64::from(c).powi(2)).sum::<f64>().sqrt();
    assert!((unit - 1.0).abs() < 1e-6 && found.distance_m >= 0.0, "{found:?}");
    assert!((f64::from(found.rms_m) - expected.rms_m).abs() <= e + 1e-6, "{found:?} {expected:?}");
    let sine = noise / (s2 - s3 - noise);
    if !(0.0..0.5).contains(&sine) {
        return (true, false);
    }
    let tilt = sine.asin();
    let normal = Vector3::from(found.normal.map(f64::from));
    // where the plane holds the scanner the normal may point either way
    let sign = if normal.dot(&expected.normal) < 0.0 { -1.0 } else { 1.0 };
    let reach = e + 2.0 * tilt * mean.norm() + 1e-6 * farthest_m;
    assert!(sign > 0.0 || expected.distance_m <= reach, "{found:?} {expected:?}");
    let turned = normal.cross(&expected.normal).norm().atan2(sign * normal.dot(&expected.normal));
    assert!(turned <= tilt + 1e-6, "turned by {turned}, at most {tilt}: {found:?} {expected:?}");
    let moved = (sign * f64::from(found.distance_m) - expected.distance_m).abs();
    assert!(moved <= reach, "moved by {moved}, at most {reach}: {found:?} {expected:?}");

    // 2 % of the rms and of s2 are 4 % of their squares each
    let conditioned = sine < 0.02 && expected.rms_m > 50.0 * e;
    if conditioned {
        let covariance = Matrix4::from_fn(|i, j| f64::from(found.covariance[i][j]));
        assert_eq!(covariance, covariance.transpose());
        let off = (covariance - expected.covariance).norm();
        assert!(off <= 0.1 * expected.covariance.norm(), "{found:?} {expected:?}");
    }
    (true, conditioned)
}

/// With a table of any size: what is labelled is right, and what is not had no room.
pub fn assert_consistent(scan: &Scan, config: &EdgeConfig, areas: usize) -> usize {
    let columns = scan.columns;
    let expected = scan.expected(config);
    let record = scan.record(*config, areas);
    record.assert_order(scan.turn_rad.len());
    assert_eq!(record.edges(columns), expected.edges);
    let pixels = record.pixels();
    let classes: Vec<_> = pixels.iter().map(|&pixel| class(pixel)).collect();
    assert_eq!(Picture::classes(columns, &classes), Picture::classes(columns, &expected.classes));

    // each label lies in one area, and neighbours that have labels have the same
    let labels = record.labels();
    let mut area_of = std::collections::BTreeMap::new();
    for (&label, &area) in labels.iter().zip(&expected.labels) {
        if label != 0 {
            assert_eq!(*area_of.entry(label).or_insert(area), area, "label {label}");
        }
    }
    let size = scan.size();
    for (row, column) in size.pixels() {
        for (down, right) in [(0, 1), (1, 0)] {
            let Some(other) = size.neighbour((row, column), down, right) else { continue };
            let pair = [labels[size.index(row, column)], labels[size.index(other.0, other.1)]];
            assert!(pair.contains(&0) || pair[0] == pair[1], "{pair:?} at {row}, {column} and {other:?}");
        }
    }
    let mut counted = std::collections::BTreeMap::new();
    for &label in labels.iter().filter(|&&label| label != 0) {
        *counted.entry(label).or_insert(0) += 1;
    }
    let segments = record.segments();
    assert_eq!(
        segments.values().map(|s| (s.label.0, s.pixels())).collect::<std::collections::BTreeMap<_, _>>(),
        counted
    );

    // a run goes without only where nothing above it has a label, and where the runs that may still
    // be touched hold as many labels as the table has
    let runs_of = |row: usize| {
        let pixels = &pixels[row * columns..][..columns];
        let mut runs: Vec<(usize, usize, bool)> = Vec::new();
        for (column, &pixel) in pixels.iter().enumerate() {
            let labelled = match pixel {
                Pixel::Segment(_) => true,
                Pixel::Unlabelled => false,
                _ => continue,
            };
            match runs.last_mut() {
                Some((_, end, of_run)) if *end == column => {
                    assert_eq!(*of_run, labelled, "a run is labelled as a whole");
                    *end += 1;
                }
                _ => runs.push((column, column + 1, labelled)),
            }
        }
        runs
    };
    let mut above = Vec::new();
    for row in 0..size.rows {
        let runs = runs_of(row);
        for &(start, end, _) in runs.iter().filter(|run| !run.2) {
            assert!(
                !above.iter().any(|&(s, e, labelled)| labelled && s < end && start < e),
                "row {row}: {start}..{end}"
            );
            let left = runs.iter().filter(|run| run.2 && run.1 <= start).count();
            let right = above.iter().filter(|run| run.2 && run.1 > start).count();
            assert!(
                left + right >= areas,
                "row {row}: no label for {start}..{end}, {left} + {right} runs, {areas} areas"
            );
        }
        above = runs;
    }
    pixels.iter().filter(|&&pixel| pixel == Pixel::Unlabelled).count()
}
