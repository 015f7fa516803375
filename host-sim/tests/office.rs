//! The simulated office keeps its promises: repeatable, true to its surfaces, with the errors asked
//! for.

use std::collections::{BTreeMap, BTreeSet};

use scanseg_formats::{Angles, Kind, TurnAxis};
use scanseg_sim::office::{SCENES, Scene, Sensor, SensorError, Set, SimulatedScan};

/// FNV-1a of ranges in whole millimetres and of the truth.
fn hash(scan: &SimulatedScan) -> u64 {
    let mm = scan.range_m.iter().map(|r| (f64::from(*r) * 1000.0).round() as u16);
    mm.chain(scan.truth.iter().copied())
        .flat_map(u16::to_le_bytes)
        .fold(0xcbf2_9ce4_8422_2325, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3))
}

fn pixels_by_id(scan: &SimulatedScan) -> BTreeMap<u16, usize> {
    let mut pixels = BTreeMap::new();
    scan.truth.iter().filter(|&&id| id != 0).for_each(|&id| *pixels.entry(id).or_insert(0) += 1);
    pixels
}

fn scan(set: Set, number: u32, sensor: &Sensor) -> SimulatedScan {
    Scene::numbered(set, number).scan(sensor, 7).unwrap()
}

/// Worst distance of a pixel's point from the plane of its surface, metres; curved surfaces are
/// left out.
fn off_plane_m(scene: &Scene, scan: &SimulatedScan) -> f64 {
    let mut worst = 0f64;
    for (i, (&range, &id)) in scan.range_m.iter().zip(&scan.truth).enumerate() {
        if let Some((normal, offset)) = scene.plane(id) {
            let beam = scan.geometry.direction(i / scan.columns, i % scan.columns);
            let along: f64 = (0..3).map(|k| normal[k] * beam[k]).sum();
            worst = worst.max((along * f64::from(range) - offset).abs());
        }
    }
    worst
}

#[test]
fn scenes_are_the_same_on_every_platform() {
    let mut noisy = Sensor::nodding(200, 361);
    noisy.range_noise_m = 0.005;
    noisy.turn_misreported_deg = 0.2;
    let of = |set, sensor: &Sensor| hash(&scan(set, 0, sensor));
    let hashes = [
        of(Set::Tuning, &Sensor::nodding(200, 361)),
        of(Set::Validation, &Sensor::nodding(200, 361)),
        of(Set::Tuning, &noisy),
        of(Set::Tuning, &Sensor::spinning(64, 512)),
        of(Set::Tuning, &Sensor::pinhole(120, 160)),
    ];
    assert_eq!(
        hashes,
        [0xbfe9827f0a00650f, 0xa0bec08158689663, 0xd878d9d0f859b498, 0xa033b1da4185be72, 0xd482e008f07d02a0]
    );
}

#[test]
fn points_lie_on_the_planes_of_their_surfaces() {
    for (set, number) in [(Set::Tuning, 1), (Set::Validation, 2)] {
        for sensor in [Sensor::nodding(100, 181), Sensor::spinning(64, 512), Sensor::pinhole(120, 160)] {
            let scene = Scene::numbered(set, number);
            let scan = scene.scan(&sensor, 0).unwrap();
            assert!(off_plane_m(&scene, &scan) < 1e-5);
            let flat = scan.truth.iter().filter(|&&id| scene.plane(id).is_some()).count();
            assert!(flat * 10 > scan.truth.len() * 8, "{flat}");
        }
    }
}

#[test]
fn neighbouring_surfaces_differ_in_their_planes() {
    for (set, number) in [Set::Tuning, Set::Validation].into_iter().flat_map(|s| (0..SCENES).map(move |n| (s, n))) {
        let scene = Scene::numbered(set, number);
        let scan = scene.scan(&Sensor::nodding(100, 181), 0).unwrap();
        let pixels: Vec<_> = scan.truth.iter().copied().zip(scan.range_m).collect();
        for (&(one, a), &(other, b)) in pixels.iter().zip(&pixels[1..]).chain(pixels.iter().zip(&pixels[181..])) {
            if one == other || (a - b).abs() > 0.1 {
                continue;
            }
            if let (Some((n, d)), Some((m, e))) = (scene.plane(one), scene.plane(other)) {
                let along: f64 = (0..3).map(|k| n[k] * m[k]).sum();
                let apart = along < 0.9999 || (d - e).abs() > 0.009;
                assert!(apart, "{set:?} {number}: {one} and {other} face along {n:?}");
            }
        }
    }
}

#[test]
fn up_is_up_and_the_floor_is_below() {
    for number in 0..SCENES {
        let scene = Scene::numbered(Set::Tuning, number);
        let scan = scene.scan(&Sensor::nodding(20, 37), 0).unwrap();
        // Straight ahead: the first row looks up, the last one down.
        let (top, bottom) = (scan.truth[18], scan.truth[19 * 37 + 18]);
        let (_, floor) = scene.cast([0.0, 0.0, -1.0]).unwrap();
        let (_, ceiling) = scene.cast([0.0, 0.0, 1.0]).unwrap();
        assert!(scene.plane(floor).unwrap().0[2] == 1.0 && scene.plane(ceiling).unwrap().0[2] == -1.0);
        let height_m = -scene.plane(floor).unwrap().1;
        assert!((0.5..=1.2).contains(&height_m), "scene {number}: {height_m}");
        assert!(scene.plane(top).is_none_or(|(n, _)| n[2] <= 0.2), "scene {number}: looks at a top from below");
        assert!(scene.plane(bottom).is_none_or(|(n, _)| n[2] >= -0.2), "scene {number}: looks at an underside");
    }
}

#[test]
fn every_scene_has_its_share_of_regions() {
    let count = |set| {
        let sensor = Sensor::nodding(200, 361);
        let of = |number| pixels_by_id(&scan(set, number, &sensor)).values().filter(|&&n| n >= 30).count();
        (0..SCENES).map(of).collect::<Vec<_>>()
    };
    let (tuning, validation) = std::thread::scope(|s| {
        let tuning = s.spawn(|| count(Set::Tuning));
        let validation = count(Set::Validation);
        (tuning.join().unwrap(), validation)
    });
    for counts in [&tuning, &validation] {
        assert!(counts.iter().all(|n| (13..=37).contains(n)), "{counts:?}");
    }
    assert_eq!((tuning.iter().sum::<usize>(), validation.iter().sum::<usize>()), (619, 656));
}

#[test]
fn no_two_scenes_are_alike() {
    let sensor = Sensor::nodding(20, 37);
    let sets = [Set::Tuning, Set::Validation];
    let hashes =
        sets.iter().flat_map(|&set| (0..SCENES).map(move |n| (set, n))).map(|(s, n)| hash(&scan(s, n, &sensor)));
    assert_eq!(hashes.collect::<BTreeSet<_>>().len(), 50);
}

#[test]
fn noise_is_as_asked() {
    let mut sensor = Sensor::nodding(100, 181);
    let ideal = scan(Set::Tuning, 4, &sensor);
    sensor.range_noise_m = 0.01;
    let noisy = scan(Set::Tuning, 4, &sensor);
    assert_eq!(noisy.truth, ideal.truth);
    assert_eq!(noisy.geometry.range_noise_m, Some(0.01));
    let pairs = noisy.range_m.iter().zip(&ideal.range_m).filter(|(_, r)| **r > 0.0);
    let errors: Vec<f64> = pairs.map(|(n, r)| f64::from(*n) - f64::from(*r)).collect();
    let n = errors.len() as f64;
    let mean = errors.iter().sum::<f64>() / n;
    let sd = (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt();
    // Four standard errors.
    assert!(mean.abs() < 4.0 * 0.01 / n.sqrt(), "{mean}");
    assert!((sd - 0.01).abs() < 4.0 * 0.01 / (2.0 * n).sqrt(), "{sd}");
    let beyond = errors.iter().filter(|e| e.abs() > 0.02).count() as f64 / n;
    assert!((beyond - 0.0455).abs() < 0.007, "4.55 % of a normal lie beyond two sigma: {beyond}");
}

#[test]
fn quantisation_drop_outs_and_maximum_range_are_as_asked() {
    let mut sensor = Sensor::nodding(100, 181);
    let ideal = scan(Set::Tuning, 4, &sensor);
    let returns = ideal.range_m.iter().filter(|r| **r > 0.0).count() as f64;

    sensor.quantisation_m = 0.01;
    let coarse = scan(Set::Tuning, 4, &sensor);
    assert_eq!(coarse.geometry.unit_m, 0.01);
    for (c, r) in coarse.range_m.iter().zip(&ideal.range_m) {
        assert!((c - r).abs() <= 0.005_001, "{c} {r}");
        assert!((c * 100.0 - (c * 100.0).round()).abs() < 1e-3, "{c}");
    }

    sensor = Sensor::nodding(100, 181);
    sensor.drop_out = 0.02;
    let holed = scan(Set::Tuning, 4, &sensor);
    let kept = holed.range_m.iter().zip(&ideal.range_m).filter(|(h, r)| h == r && **r > 0.0).count() as f64;
    let lost = holed.range_m.iter().zip(&ideal.range_m).filter(|(h, r)| **h == 0.0 && **r > 0.0).count() as f64;
    assert_eq!(kept + lost, returns);
    assert!((lost / returns - 0.02).abs() < 4.0 * (0.02 * 0.98 / returns).sqrt(), "{lost} of {returns}");
    assert!(holed.range_m.iter().zip(&holed.truth).all(|(r, id)| (*r == 0.0) == (*id == 0)));

    sensor = Sensor::nodding(100, 181);
    sensor.max_range_m = 3.0;
    let near = scan(Set::Tuning, 4, &sensor);
    assert_eq!(near.geometry.max_range_m, Some(3.0));
    for (n, r) in near.range_m.iter().zip(&ideal.range_m) {
        assert_eq!(*n, if *r <= 3.0 { *r } else { 0.0 });
    }
}

#[test]
fn mixed_pixels_lie_between_the_surfaces_of_a_depth_edge() {
    let mut sensor = Sensor::nodding(100, 181);
    let ideal = scan(Set::Tuning, 4, &sensor);
    sensor.mixed_pixels = 0.5;
    let mixed = scan(Set::Tuning, 4, &sensor);
    assert_eq!(mixed.truth, ideal.truth);
    let (mut edge, mut moved) = (0, 0);
    for i in 0..ideal.range_m.len() {
        let (row, column, here) = (i / 181, i % 181, ideal.range_m[i]);
        let beside = [
            (row > 0, i.wrapping_sub(181)),
            (row < 99, i + 181),
            (column > 0, i.wrapping_sub(1)),
            (column < 180, i + 1),
        ];
        let others: Vec<f32> = beside
            .iter()
            .filter(|(inside, j)| *inside && here > 0.0 && ideal.truth[*j] != 0 && ideal.truth[*j] != ideal.truth[i])
            .map(|(_, j)| ideal.range_m[*j])
            .filter(|r| (r - here).abs() >= 0.1)
            .collect();
        edge += usize::from(!others.is_empty());
        if mixed.range_m[i] != here {
            moved += 1;
            let between = |r: &f32| (mixed.range_m[i] - here) * (mixed.range_m[i] - r) <= 0.0;
            assert!(others.iter().any(between), "pixel {i}");
        }
    }
    let share = moved as f64 / edge as f64;
    assert!(edge > 200 && (share - 0.5).abs() < 4.0 * (0.25 / edge as f64).sqrt(), "{moved} of {edge}");
}

#[test]
fn uneven_turns_are_reported_and_servo_seams_are_not() {
    let scene = Scene::numbered(Set::Tuning, 4);
    let mut sensor = Sensor::nodding(100, 181);
    let even = sensor.kind.clone();
    sensor.turn_uneven_deg = 0.1;
    let uneven = scene.scan(&sensor, 0).unwrap();
    assert_ne!(uneven.geometry.kind, even);
    assert!(off_plane_m(&scene, &uneven) < 1e-5);

    sensor.turn_uneven_deg = 0.0;
    sensor.turn_misreported_deg = 0.3;
    let seamed = scene.scan(&sensor, 0).unwrap();
    assert_eq!(seamed.geometry.kind, even);
    assert!(off_plane_m(&scene, &seamed) > 0.01);
    // Rows before the first jump, and they alone, are as they were.
    let ideal = scene.scan(&Sensor::nodding(100, 181), 0).unwrap();
    let same = |row: usize| ideal.range_m[row * 181..][..181] == seamed.range_m[row * 181..][..181];
    let first = (0..100).position(|row| !same(row)).unwrap();
    assert!((first..100).all(|row| !same(row)), "from row {first}");
}

#[test]
fn errors_are_switched_singly_and_follow_the_seed() {
    let scene = Scene::numbered(Set::Validation, 3);
    let mut sensor = Sensor::nodding(50, 91);
    sensor.range_noise_m = 0.005;
    let first = scene.scan(&sensor, 1).unwrap();
    assert_eq!(scene.scan(&sensor, 1).unwrap(), first);
    assert_ne!(scene.scan(&sensor, 2).unwrap().range_m, first.range_m);
    sensor.drop_out = 0.1;
    let holed = scene.scan(&sensor, 1).unwrap();
    assert!(holed.range_m.iter().zip(&first.range_m).all(|(h, f)| h == f || *h == 0.0));
}

#[test]
fn bad_sensors_are_errors() {
    let scene = Scene::numbered(Set::Tuning, 0);
    let fails = |change: fn(&mut Sensor)| {
        let mut sensor = Sensor::nodding(4, 5);
        change(&mut sensor);
        scene.scan(&sensor, 0).unwrap_err().to_string()
    };
    assert_eq!(fails(|s| s.range_noise_m = -0.1), "sensor: range_noise_m = -0.1 is out of range");
    assert_eq!(fails(|s| s.quantisation_m = f64::NAN), "sensor: quantisation_m = NaN is out of range");
    assert_eq!(fails(|s| s.drop_out = 1.5), "sensor: drop_out = 1.5 is out of range");
    assert_eq!(fails(|s| s.mixed_pixels = -1.0), "sensor: mixed_pixels = -1 is out of range");
    assert_eq!(fails(|s| s.max_range_m = 0.0), "sensor: max_range_m = 0 is out of range");
    assert_eq!(fails(|s| s.turn_uneven_deg = f64::INFINITY), "sensor: turn_uneven_deg = inf is out of range");
    assert_eq!(fails(|s| s.turn_misreported_deg = -1.0), "sensor: turn_misreported_deg = -1 is out of range");
    let mut sensor = Sensor::nodding(4, 5);
    sensor.kind = Kind::Nodding {
        beam_deg: Angles::Listed(vec![0.0; 5]),
        turn_deg: Angles::Listed(vec![0.0; 3]),
        turn_axis: TurnAxis::Z,
    };
    assert_eq!(scene.scan(&sensor, 0), Err(SensorError::Angles { listed: 3, needed: 4 }));
    for (rows, columns) in [(0, 5), (4, 0), (1, 1)] {
        for sensor in [Sensor::nodding(rows, columns), Sensor::spinning(rows, columns), Sensor::pinhole(rows, columns)]
        {
            assert_eq!(scene.scan(&sensor, 0).unwrap().range_m.len(), rows * columns);
        }
    }
}
