//! Each trouble of the simulated office does what it says, and nothing else.

use scanseg_sim::office::{Missing, Scene, Sensor, Set, SimulatedScan, Trouble};
use std::collections::{BTreeMap, BTreeSet};

const ROWS: usize = 100;
const COLUMNS: usize = 181;

fn scene() -> Scene {
    Scene::numbered(Set::Tuning, 26)
}

fn scan(trouble: Trouble) -> SimulatedScan {
    scene().troubled_scan(&Sensor::nodding(ROWS, COLUMNS), trouble, 0).unwrap()
}

/// Pairs of ranges with a return, the second one with the trouble, and their pixel.
fn pairs<'a>(plain: &'a SimulatedScan, troubled: &'a SimulatedScan) -> impl Iterator<Item = (usize, f64, f64)> + 'a {
    let pairs = plain.range_m.iter().zip(&troubled.range_m).map(|(&a, &b)| (f64::from(a), f64::from(b)));
    pairs.enumerate().filter(|(_, (a, b))| *a > 0.0 && *b > 0.0).map(|(i, (a, b))| (i, a, b))
}

/// Root of the mean square.
fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (n, sum) = values.fold((0.0, 0.0), |(n, sum), x| (n + 1.0, sum + x * x));
    (sum / n).sqrt()
}

#[test]
fn none_is_the_scan_itself() {
    let sensor = Sensor { range_noise_m: 0.005, mixed_pixels: 0.2, ..Sensor::nodding(ROWS, COLUMNS) };
    assert_eq!(scene().troubled_scan(&sensor, Trouble::None, 3), scene().scan(&sensor, 3));
}

#[test]
fn noise_grows_and_the_geometry_says_so() {
    let (plain, grown) = (scan(Trouble::None), scan(Trouble::GrowingNoise { constant_m: 0.001, per_m2: 0.0015 }));
    let (near, far): (Vec<_>, Vec<_>) = pairs(&plain, &grown).partition(|(_, range, _)| *range < 2.0);
    for part in [near, far] {
        let units = part.iter().map(|(_, range, noisy)| (noisy - range) / (0.001 + 0.0015 * range * range));
        assert!((rms(units) - 1.0).abs() < 0.03, "{}", part.len());
    }
    assert_eq!((grown.geometry.range_noise_m, grown.geometry.noise.range_noise_per_m2), (Some(0.001), 0.0015));
    assert_eq!(grown.truth, plain.truth);
}

#[test]
fn disparities_come_in_steps() {
    let steps = Trouble::DisparitySteps { step_per_m: 0.00285, noise_per_m: 0.0005, alike_px: 1 };
    let (plain, stepped) = (scan(Trouble::None), scan(steps));
    let offs: Vec<f64> = pairs(&plain, &stepped).map(|(_, a, b)| (1.0 / b - 1.0 / a) / 0.00285).collect();
    for (_, _, range) in pairs(&plain, &stepped) {
        let steps = 1.0 / range / 0.00285;
        assert!((steps - steps.round()).abs() < 1e-3, "{steps}");
    }
    // rounding, and the noise before it
    let expected = (1.0f64 / 12.0 + (0.0005f64 / 0.00285).powi(2)).sqrt();
    assert!((rms(offs.into_iter()) - expected).abs() < 0.02);
    let noise = stepped.geometry.noise;
    assert_eq!((noise.range_noise_per_m2, noise.range_step_per_m2), (0.0005, 0.00285));
}

/// The noise is as large as that of single pixels, and that of neighbours the more alike the nearer they are.
#[test]
fn disparities_that_are_alike() {
    let of = |alike_px| scan(Trouble::DisparitySteps { step_per_m: 1e-6, noise_per_m: 0.001, alike_px });
    let (plain, alike) = (scan(Trouble::None), of(4));
    let errors: Vec<f64> = pairs(&plain, &alike).map(|(_, a, b)| (1.0 / b - 1.0 / a) / 0.001).collect();
    assert!((rms(errors.iter().copied()) - 1.0).abs() < 0.1);
    // a mean of 4 columns shares 3, 2, 1, and none with the next ones
    for (apart, expected) in [(1, 0.75), (2, 0.5), (3, 0.25), (4, 0.0), (6, 0.0)] {
        let products: f64 = errors.iter().zip(&errors[apart..]).map(|(a, b)| a * b).sum();
        let correlation = products / errors.len() as f64;
        assert!((correlation - expected).abs() < 0.12, "{apart} columns: {correlation}");
    }
    assert_eq!(alike.geometry.noise.noise_correlation_px, 4.0);
}

#[test]
fn mixed_pixels_are_no_part_of_the_truth() {
    let (plain, mixed) = (scan(Trouble::None), scan(Trouble::MixedPixels { probability: 0.3 }));
    let mut count = 0;
    for i in 0..plain.truth.len() {
        let changed = plain.range_m[i] != mixed.range_m[i];
        assert_eq!(mixed.truth[i], if changed { 0 } else { plain.truth[i] });
        count += usize::from(changed);
    }
    assert!((100..ROWS * COLUMNS / 10).contains(&count), "{count}");
}

#[test]
fn angles_are_wrong_and_the_geometry_does_not_know() {
    let plain = scan(Trouble::None);
    let off = |trouble| {
        let troubled = scan(trouble);
        assert_eq!(troubled.geometry, plain.geometry);
        troubled
    };
    // where a beam truly looks tells its range
    let told = |troubled: &SimulatedScan, row: usize, column: usize, [turn_deg, beam_deg]: [f64; 2]| {
        let ((st, ct), (sb, cb)) = (turn_deg.to_radians().sin_cos(), beam_deg.to_radians().sin_cos());
        let cast = scene().cast([cb * ct, sb, cb * st]).map_or(0.0, |(range_m, _)| range_m);
        assert!((cast - f64::from(troubled.range_m[row * COLUMNS + column])).abs() < 1e-5, "{row} {column}");
    };
    let (bearing, turn) = (off(Trouble::BearingScale(1.01)), off(Trouble::TurnScale(1.03)));
    for (row, column) in [(10, 20), (50, 90), (80, 150)] {
        let (turn_deg, beam_deg) = (50.0 - row as f64, column as f64 - 90.0);
        told(&bearing, row, column, [turn_deg, 1.01 * beam_deg]);
        told(&turn, row, column, [1.03 * turn_deg, beam_deg]);
    }
    // each row for itself: beams along the axis do not see it, others do
    let rows = off(Trouble::TurnOff { sd_deg: 0.3 });
    let change =
        |column: usize| rms(pairs(&plain, &rows).filter(|(i, ..)| i % COLUMNS == column).map(|(_, a, b)| b - a));
    assert!(change(0) < 1e-6 && change(90) > 0.01, "{} {}", change(0), change(90));
}

#[test]
fn rings_are_off_as_a_whole() {
    let (plain, rings) = (scan(Trouble::None), scan(Trouble::RingOffsets { sd_m: 0.02 }));
    let mut of_rows = vec![];
    for row in 0..ROWS {
        let offs: Vec<f64> =
            pairs(&plain, &rings).filter(|(i, ..)| i / COLUMNS == row).map(|(_, a, b)| b - a).collect();
        assert!(offs.iter().all(|off| (off - offs[0]).abs() < 1e-5), "row {row}");
        of_rows.push(offs[0]);
    }
    // four standard errors
    assert!((rms(of_rows.into_iter()) / 0.02 - 1.0).abs() < 4.0 / (2.0 * ROWS as f64).sqrt());
}

#[test]
fn beams_are_missing() {
    let plain = scan(Trouble::None);
    let kept = |missing| {
        let troubled = scan(Trouble::Missing(missing));
        for i in 0..plain.truth.len() {
            let here = troubled.range_m[i] > 0.0;
            let expected = if here { (plain.range_m[i], plain.truth[i]) } else { (0.0, 0) };
            assert_eq!((troubled.range_m[i], troubled.truth[i]), expected);
        }
        let returns: Vec<_> = (0..plain.truth.len()).filter(|&i| plain.range_m[i] > 0.0).collect();
        let kept: Vec<_> = returns.iter().copied().filter(|&i| troubled.range_m[i] > 0.0).collect();
        let share = kept.len() as f64 / returns.len() as f64;
        (kept, share)
    };
    assert!(kept(Missing::Columns).0.iter().all(|i| (i % COLUMNS).is_multiple_of(2)));
    assert!(kept(Missing::Rows).0.iter().all(|i| (i / COLUMNS).is_multiple_of(2)));
    assert!(kept(Missing::Chess).0.iter().all(|i| (i / COLUMNS + i % COLUMNS).is_multiple_of(2)));
    for (missing, share) in
        [(Missing::Columns, 0.5), (Missing::Rows, 0.5), (Missing::Chess, 0.5), (Missing::Share(0.6), 0.4)]
    {
        assert!((kept(missing).1 - share).abs() < 0.02, "{missing:?}");
    }
}

#[test]
fn a_scan_from_below_is_the_same_upside_down() {
    let sensor = Sensor::nodding(ROWS, COLUMNS);
    let (down, up) = (scan(Trouble::None), scene().scan(&sensor.clone().from_below(), 0).unwrap());
    let turned: Vec<u16> = up.truth.chunks(COLUMNS).rev().flatten().copied().collect();
    let same = turned.iter().zip(&down.truth).filter(|(a, b)| a == b).count();
    // but for rays on the edge of two surfaces: the angles are rounded otherwise
    assert!(same + 10 > ROWS * COLUMNS, "{same}");
    assert_eq!(sensor.clone().from_below().from_below().kind, sensor.kind);
}

#[test]
fn halls_are_long() {
    let sensor = Sensor { quantisation_m: 0.001, ..Sensor::nodding(ROWS, COLUMNS) };
    for number in 0..10 {
        let hall = Scene::hall(Set::Validation, number).scan(&sensor, 0).unwrap();
        let farthest_m = hall.range_m.iter().copied().fold(0.0, f32::max);
        assert!((18.0..40.0).contains(&farthest_m), "{number}: {farthest_m}");
        let mut ids = hall.truth;
        ids.sort_unstable();
        ids.dedup();
        assert!(ids.len() > 15, "{number}: {} surfaces", ids.len());
    }
}

/// A unit normal, and how far along it a plane is.
type Flat = ([f64; 3], f64);

/// Pixels of each surface of a scan, and its plane.
fn planes_seen(scene: &Scene, scan: &SimulatedScan) -> Vec<(usize, Option<Flat>)> {
    let mut pixels = BTreeMap::new();
    scan.truth.iter().filter(|&&id| id != 0).for_each(|&id| *pixels.entry(id).or_insert(0) += 1);
    pixels.into_iter().map(|(id, pixels)| (pixels, scene.plane(id))).collect()
}

#[test]
fn attics_have_sloped_roofs_and_stairs() {
    for number in 0..10 {
        let attic = Scene::attic(Set::Validation, number);
        let scan = attic.scan(&Sensor::nodding(200, 361), 0).unwrap();
        let large = planes_seen(&attic, &scan).into_iter().filter(|(pixels, _)| *pixels >= 30);
        let planes: Vec<_> = large.filter_map(|(pixels, plane)| Some((pixels, plane?))).collect();
        let slopes = planes.iter().filter(|(pixels, (n, _))| *pixels > 1000 && n[2] < -0.6 && n[2] > -0.9).count();
        assert_eq!(slopes, 2, "{number}");
        // at a common incline: what faces up lies ever higher
        let levels: BTreeSet<_> =
            planes.iter().filter(|(_, (n, _))| n[2] > 0.999).map(|(_, (_, d))| (d * 100.0).round() as i64).collect();
        assert!(levels.len() >= 3, "{number}: {levels:?}");
        assert!(scan.range_m.iter().all(|&range_m| range_m == 0.0 || range_m > 0.25), "{number}: in something");
    }
}

#[test]
fn streets_have_fronts_pavements_trees_and_a_sky() {
    for number in 0..10 {
        let street = Scene::street(Set::Validation, number);
        let sensor = Sensor { quantisation_m: 0.001, ..Sensor::nodding(200, 361) };
        let scan = street.scan(&sensor, 0).unwrap();
        let planes = planes_seen(&street, &scan);
        let fronts = planes
            .iter()
            .filter(|(pixels, plane)| *pixels > 500 && plane.is_some_and(|(n, _)| n[2].abs() < 1e-9))
            .count();
        assert!(fronts >= 3, "{number}: {fronts}");
        let ground = planes.iter().filter(|(pixels, plane)| *pixels > 500 && plane.is_some_and(|(n, _)| n[2] > 0.999));
        let mut depths_m: Vec<_> = ground.map(|(_, plane)| plane.unwrap().1).collect();
        depths_m.sort_by(f64::total_cmp);
        assert!(depths_m.len() >= 2 && (depths_m[1] - depths_m[0] - 0.12).abs() < 1e-9, "{number}: {depths_m:?}");
        let sky = scan.truth.iter().filter(|&&id| id == 0).count();
        assert!((4000..40_000).contains(&sky), "{number}: {sky}");
        assert!(scan.range_m.iter().all(|&range_m| range_m == 0.0 || range_m > 0.5), "{number}: in something");
    }
    // leaves are too small to count
    let street = Scene::street(Set::Validation, 0);
    let scan = street.scan(&Sensor::nodding(200, 361), 0).unwrap();
    let small = planes_seen(&street, &scan).into_iter().filter(|(pixels, _)| *pixels < 30).count();
    assert!(small > 100, "{small}");
}

#[test]
fn rough_ground_is_the_floor_alone() {
    let (plain, rough) = (scan(Trouble::None), scan(Trouble::RoughGround { sd_m: 0.03, patch_m: 0.3 }));
    let scene = scene();
    let mut heights = vec![];
    let mut floors = vec![];
    for (i, range, bumped) in pairs(&plain, &rough) {
        if range != bumped {
            let [.., z] = plain.geometry.direction(i / COLUMNS, i % COLUMNS);
            heights.push((bumped - range) * z);
            floors.push(plain.truth[i]);
        }
    }
    floors.dedup();
    floors.sort_unstable();
    floors.dedup();
    assert!(matches!(floors[..], [floor] if scene.plane(floor).is_some_and(|(n, _)| n[2] > 0.999)), "{floors:?}");
    let sd_m = rms(heights.into_iter());
    assert!((0.02..0.04).contains(&sd_m), "{sd_m}");
}
