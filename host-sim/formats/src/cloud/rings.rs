//! A list of points that say their ring becomes rows: the cloud of a spinning lidar whose driver leaves
//! out what has no return.
//!
//! Each ring is a row, the highest first. Columns are steps of the azimuth, from behind over the left
//! to the right; how wide they are, the points of the rings tell.

use std::collections::BTreeMap;
use std::f64::consts::TAU;

use crate::cloud::Cloud;
use crate::scan_error::ScanError;

/// What drivers call the ring of a point.
pub(crate) const NAMES: [&str; 2] = ["ring", "channel"];

/// No lidar has more.
const MAX_RINGS: usize = 1024;
const MAX_COLUMNS: usize = 16_384;
/// Points of one ring are no nearer to each other, but two returns of one shot: 0.005 degrees.
const LEAST_STEP_RAD: f64 = 8.7e-5;
/// Points of one ring that are nearer to each other are returns of one shot, columns.
const SAME_SHOT: f64 = 0.2;
/// A cloud with fewer points than one in so many pixels is none of rings.
const MOST_PIXELS_A_POINT: usize = 16;

/// Returns the rows of points, each with x, y, z as seen from the lidar and its ring.
pub(crate) fn rows_of(points: &[[f32; 4]], advice: &'static str) -> Result<Cloud, ScanError> {
    let refused = || ScanError::Unorganised { points: points.len(), advice };
    let mut rings: BTreeMap<u32, Vec<[f32; 3]>> = BTreeMap::new();
    for &[x, y, z, ring] in points {
        // where nothing was measured there is no azimuth
        let measured = (x * x + y * y) > 0.0 && [x, y, z].iter().all(|m| m.is_finite());
        if measured && ring >= 0.0 && ring.fract() == 0.0 {
            rings.entry(ring as u32).or_default().push([x, y, z]);
        }
    }
    if !(2..=MAX_RINGS).contains(&rings.len()) {
        return Err(refused());
    }
    let columns = columns(rings.values()).ok_or_else(refused)?;
    let mut rows: Vec<Vec<[f32; 3]>> = rings.into_values().collect();
    rows.sort_by(|a, b| elevation(b).total_cmp(&elevation(a)));
    let pixels = ScanError::check_pixels(rows.len(), columns)?;
    if pixels > points.len().saturating_mul(MOST_PIXELS_A_POINT) {
        return Err(refused());
    }
    let mut organised = vec![[f32::NAN; 3]; pixels];
    for (row, ring) in organised.chunks_exact_mut(columns).zip(&rows) {
        let phase = phase(ring, columns);
        for point in ring {
            let at = steps(point, columns) - phase;
            let nearest = at.round();
            let aside = if at < nearest { -1.0 } else { 1.0 };
            // azimuths are rounded: of two points near one column one is in the next
            for column in [nearest, nearest + aside] {
                let place = &mut row[column.rem_euclid(columns as f64) as usize % columns];
                if place[0].is_nan() {
                    *place = *point;
                }
                // of two returns of a shot the first counts
                if (steps(place, columns) - phase - at).abs() < SAME_SHOT {
                    break;
                }
            }
        }
    }
    Ok(Cloud { rows: rows.len(), columns, points: organised })
}

/// How far to the right from behind a point lies, in columns.
fn steps(point: &[f32; 3], columns: usize) -> f64 {
    let left_rad = f64::from(point[1]).atan2(f64::from(point[0]));
    (TAU / 2.0 - left_rad) / TAU * columns as f64
}

/// Returns where the points of a ring lie between two columns, on average.
fn phase(ring: &[[f32; 3]], columns: usize) -> f64 {
    let angles = ring.iter().map(|point| steps(point, columns) * TAU);
    let (sine, cosine) = angles.fold((0.0, 0.0), |(s, c), angle| (s + angle.sin(), c + angle.cos()));
    f64::atan2(sine, cosine) / TAU
}

/// The mean tangent of the elevation of a ring.
fn elevation(ring: &[[f32; 3]]) -> f64 {
    let tangent = |[x, y, z]: &[f32; 3]| f64::from(*z) / f64::from(*x).hypot(f64::from(*y));
    ring.iter().map(tangent).sum::<f64>() / ring.len() as f64
}

/// Returns how many columns a turn has. A quarter of the steps within the rings are one column or less.
fn columns<'a>(rings: impl Iterator<Item = &'a Vec<[f32; 3]>>) -> Option<usize> {
    let mut steps_rad = vec![];
    for ring in rings {
        let mut left_rad: Vec<f64> = ring.iter().map(|point| f64::from(point[1]).atan2(f64::from(point[0]))).collect();
        left_rad.sort_by(f64::total_cmp);
        steps_rad.extend(left_rad.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > LEAST_STEP_RAD));
    }
    if steps_rad.is_empty() {
        return None;
    }
    let quarter = steps_rad.len() / 4;
    let (_, quarter_rad, _) = steps_rad.select_nth_unstable_by(quarter, f64::total_cmp);
    // of those that are one step
    let (least_rad, most_rad) = (*quarter_rad / 2.0, *quarter_rad * 1.5);
    steps_rad.retain(|step_rad| (least_rad..most_rad).contains(step_rad));
    let middle = steps_rad.len() / 2;
    let (_, middle_rad, _) = steps_rad.select_nth_unstable_by(middle, f64::total_cmp);
    let (least_rad, most_rad) = (*middle_rad * 0.8, *middle_rad * 1.2);
    steps_rad.retain(|step_rad| (least_rad..most_rad).contains(step_rad));
    let columns = (TAU * steps_rad.len() as f64 / steps_rad.iter().sum::<f64>()).round();
    (columns >= 2.0 && columns <= MAX_COLUMNS as f64).then_some(columns as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ELEVATION_DEG: [f64; 4] = [-15.0, 1.0, -13.0, 3.0];

    /// Points of a cylinder in the order of a driver: firing by firing, each laser a bit later, some missing.
    fn cylinder(step_deg: f64) -> Vec<[f32; 4]> {
        let mut points = vec![];
        for firing in 0..(360.0 / step_deg) as usize {
            for (ring, up_deg) in ELEVATION_DEG.iter().enumerate() {
                let right_deg = step_deg * (firing as f64 + 0.1 * ring as f64) + 33.0;
                let (sine, cosine) = (-right_deg.to_radians()).sin_cos();
                if (firing * 7 + ring) % 5 < 3 {
                    let z = 2.0 * up_deg.to_radians().tan();
                    points.push([(2.0 * cosine) as f32, (2.0 * sine) as f32, z as f32, ring as f32]);
                }
            }
        }
        points
    }

    #[test]
    fn rings_become_rows_from_the_top_and_keep_every_point() {
        for step_deg in [0.2, 0.4] {
            let points = cylinder(step_deg);
            let cloud = rows_of(&points, "").unwrap();
            assert_eq!((cloud.rows, cloud.columns), (4, (360.0 / step_deg) as usize));
            let kept = cloud.points.iter().filter(|point| point[0].is_finite()).count();
            assert_eq!(kept, points.len());
            for (row, ring) in cloud.points.chunks(cloud.columns).zip([3, 1, 2, 0]) {
                let up = 2.0 * ELEVATION_DEG[ring].to_radians().tan();
                assert!(row.iter().all(|point| point[2].is_nan() || (f64::from(point[2]) - up).abs() < 1e-6));
                // to the right, column by column
                let steps: Vec<f64> = row.iter().map(|point| steps(point, cloud.columns)).collect();
                let off = |(column, step): (usize, &f64)| (step - column as f64).rem_euclid(cloud.columns as f64);
                let offs: Vec<f64> = steps.iter().enumerate().filter(|(_, step)| step.is_finite()).map(off).collect();
                assert!(offs.iter().all(|off| *off < 0.6 || *off > cloud.columns as f64 - 0.6), "{offs:?}");
            }
        }
    }

    #[test]
    fn two_returns_of_a_shot_are_one_and_what_is_not_of_rings_is_refused() {
        let mut points = cylinder(0.4);
        let both: Vec<_> = points.iter().map(|[x, y, z, ring]| [2.0 * x, 2.0 * y, 2.0 * z, *ring]).collect();
        let count = points.len();
        points.extend(both);
        let cloud = rows_of(&points, "").unwrap();
        let kept: Vec<_> = cloud.points.iter().filter(|point| point[0].is_finite()).collect();
        assert!(kept.len() == count && kept.iter().all(|point| point[0].hypot(point[1]) < 2.1));

        assert!(rows_of(&[], "").is_err());
        assert!(rows_of(&[[f32::NAN; 4]; 100], "").is_err());
        let one: Vec<_> = points.iter().map(|[x, y, z, _]| [*x, *y, *z, 0.0]).collect();
        assert!(rows_of(&one, "").is_err());
        // few points must not claim many pixels
        let few: Vec<_> = (0..1000).map(|ring| [1.0, 2e-4 * (ring % 2) as f32, 0.0, (ring / 2) as f32]).collect();
        assert!(rows_of(&few, "").is_err());
    }
}
