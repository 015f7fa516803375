//! Planes go on where pixels are missing: the walls, the floor and the ceiling of a box room with
//! every second column, every second row, a chess-board, or 60 % of the pixels missing.

use scanseg_core::{PlaneConfig, Ranging, TurnAxis};
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Rig, Scan};
use std::collections::BTreeMap;

const COLUMNS: usize = 361;
const ROWS: usize = 200;

/// The plane of a box room, turned by 10 deg, that a beam meets, and at which range.
fn hit([x, y, z]: [f64; 3]) -> (usize, f64) {
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let (x, y) = (x * cos - y * sin, x * sin + y * cos);
    let inverses = [x / 4.0, -x / 3.0, y / 3.0, -y / 2.5, z / 1.6, -z];
    let (plane, inverse_m) = inverses.into_iter().enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap();
    (plane, 1.0 / inverse_m)
}

/// The least share of the pixels of a plane of 500 and more that one segment has; noise of 5 mm.
fn least_share(is_missing: impl Fn(usize, usize) -> bool) -> f64 {
    let angles = Angles::Even { start_rad: (-90f32).to_radians(), step_rad: 0.5f32.to_radians() };
    let rig = Rig::Nodding { angles, axis: TurnAxis::Y };
    let turn_rad = (0..ROWS).map(|row| (50.0 - 0.5 * row as f32).to_radians()).collect();
    let mut scan = Scan::of(COLUMNS, turn_rad, rig, |direction| hit(direction).1);
    let beams = scan.reference_beams();
    let mut planes = vec![0; scan.range_m.len()];
    for (i, pixel) in scan.size().pixels().enumerate() {
        planes[i] = hit(beams.direction(pixel).into()).0;
        let gauss = (0..12).map(|k| uniform(3, i, k)).sum::<f64>() - 6.0;
        scan.range_m[i] = if is_missing(pixel.0, pixel.1) { 0.0 } else { scan.range_m[i] + (0.005 * gauss) as f32 };
    }
    let labels = scan.record(PlaneConfig::new(Ranging::new(0.005)), 2 * COLUMNS).labels();
    let (mut all, mut of_plane) = ([0; 6], BTreeMap::new());
    for i in (0..planes.len()).filter(|&i| scan.range_m[i] > 0.0) {
        all[planes[i]] += 1;
        *of_plane.entry((planes[i], labels[i])).or_insert(0) += 1;
    }
    let most = |plane: usize| *of_plane.range((plane, 1)..(plane + 1, 0)).map(|(_, count)| count).max().unwrap_or(&0);
    (0..6)
        .filter(|&plane| all[plane] > 500)
        .map(|plane| f64::from(most(plane)) / f64::from(all[plane]))
        .fold(1.0, f64::min)
}

#[test]
fn nothing_missing() {
    let least = least_share(|_, _| false);
    assert!(least >= 0.95, "{least}");
}

#[test]
fn every_second_column() {
    let least = least_share(|_, column| column % 2 == 1);
    assert!(least >= 0.9, "{least}");
}

#[test]
fn every_second_row() {
    let least = least_share(|row, _| row % 2 == 1);
    assert!(least >= 0.9, "{least}");
}

#[test]
fn chess_board() {
    let least = least_share(|row, column| (row + column) % 2 == 1);
    assert!(least >= 0.9, "{least}");
}

#[test]
fn three_of_five() {
    let least = least_share(|row, column| uniform(7, row, column) < 0.6);
    assert!(least >= 0.8, "{least}");
}
