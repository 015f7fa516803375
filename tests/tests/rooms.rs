//! A box room has its six walls, and an image mirrored, turned over, transposed or rotated has the
//! same segments. Without a reference: the truth is the room. All is fixed, so that what does not
//! hold is counted.

use scanseg_core::AnyConfig;
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Rig, Scan};
use scanseg_tests::walls::{Drawn, Kind, View, Wall, agreement, by_edges, by_planes, by_regions, room, sizes};

type Approach = fn(f64) -> AnyConfig<'static>;

/// Room number `number`, walls 1 to 5 m away, every third square to the scanner and the others
/// turned, 1 deg between rows and columns, upward or downward, either way. A spinning scanner sees
/// 60 deg up and down, a nodding one all but a cone. Its walls as well.
fn seen(number: u64, kinds: &[Kind], noise_m: f64) -> (Drawn, Vec<Wall>) {
    let kind = kinds[number as usize % kinds.len()];
    let random = |what: usize| uniform(number, 1 << 20, what);
    let (rows, columns) = match kind {
        Kind::Around => (120, 360),
        Kind::Camera => (80, 80),
        _ => (300, 171),
    };
    let sign = |what: usize| if random(what) < 0.5 { -1f32.to_radians() } else { 1f32.to_radians() };
    let view = View { kind, rows, columns, column_rad: sign(0), row_rad: sign(1), middle_rad: 0.0 };
    let turned_rad = if random(2) < 0.33 { 0.0 } else { (3.0 + 84.0 * random(3)).to_radians() };
    let walls = room(std::array::from_fn(|i| 1.0 + 4.0 * random(4 + i)), turned_rad);
    (view.of(&walls, noise_m, number), walls)
}

/// Of the walls of so many rooms, those that are seen in 400 pixels or more at up to 75 deg of
/// incidence; and those of them that have a segment with nine of ten of these pixels, and nine of ten
/// of its own on the wall.
fn found(rooms: u64, approach: Approach, noise_m: f64) -> (usize, usize) {
    let (mut walls_seen, mut walls_found) = (0, 0);
    for number in 0..rooms {
        let (drawn, walls) = seen(number, &[Kind::Tilting, Kind::Panning, Kind::Around], noise_m);
        let labels = drawn.record(approach(noise_m)).labels();
        let near: Vec<_> = drawn.clone().within(&walls, 75f64.to_radians()).truth;
        for wall in 0..6 {
            let of = |truth: &[Option<usize>]| -> Vec<u32> {
                labels.iter().zip(truth).filter(|(_, truth)| **truth == Some(wall)).map(|(&label, _)| label).collect()
            };
            let (near, all) = (of(&near), of(&drawn.truth));
            if near.len() < 400 {
                continue;
            }
            walls_seen += 1;
            let Some(&(best, share)) = sizes(near.iter().copied()).first() else { continue };
            let own = labels.iter().filter(|&&label| label == best).count();
            let on_wall = all.iter().filter(|&&label| label == best).count();
            let is_found = 10 * share >= 9 * near.len() && 10 * on_wall >= 9 * own;
            walls_found += usize::from(is_found);
        }
    }
    println!("{walls_found} of {walls_seen} walls at {noise_m} m");
    (walls_found, walls_seen)
}

/// The pixels of an image in another order.
fn moved<T: Copy>(
    pixels: &[T],
    columns: usize,
    from: impl Fn(usize, usize) -> (usize, usize),
    to: (usize, usize),
) -> Vec<T> {
    (0..to.0)
        .flat_map(|row| (0..to.1).map(move |column| (row, column)))
        .map(|(row, column)| {
            let (row, column) = from(row, column);
            pixels[row * columns + column]
        })
        .collect()
}

/// How well the segments of rooms agree with those of the same image moved: the least, and the mean.
fn agreements(rooms: u64, approach: Approach, noise_m: f64, kinds: &[Kind], how: &str) -> (f64, f64) {
    let mut all = Vec::new();
    for number in 0..rooms {
        let scan = seen(number, kinds, noise_m).0.scan;
        let (rows, columns) = (scan.turn_rad.len(), scan.columns);
        let (size, mut other) = ((rows, columns), scan.clone());
        type From = Box<dyn Fn(usize, usize) -> (usize, usize)>;
        let (from, back, to): (From, From, _) = match how {
            // beams are even, from -x to x
            "mirrored" => {
                (Box::new(move |r, c| (r, columns - 1 - c)), Box::new(move |r, c| (r, columns - 1 - c)), size)
            }
            "turned over" => {
                other.turn_rad.reverse();
                (Box::new(move |r, c| (rows - 1 - r, c)), Box::new(move |r, c| (rows - 1 - r, c)), size)
            }
            "transposed" => {
                let Rig::Pinhole { fx_px, fy_px, cx_px, cy_px } = scan.rig else { panic!("a camera") };
                other.rig = Rig::Pinhole { fx_px: fy_px, fy_px: fx_px, cx_px: cy_px, cy_px: cx_px };
                other.turn_rad = vec![0.0; columns];
                (Box::new(|r, c| (c, r)), Box::new(|r, c| (c, r)), (columns, rows))
            }
            _ => {
                let by = 1 + (uniform(number, 7, 7) * 300.0) as usize;
                let Rig::Spinning { angles: Angles::Even { start_rad, step_rad }, .. } = scan.rig else {
                    panic!("around")
                };
                let start_rad = (start_rad + step_rad * by as f32) % std::f32::consts::TAU;
                other.rig = Rig::Spinning { angles: Angles::Even { start_rad, step_rad }, wraps: true };
                (
                    Box::new(move |r, c| (r, (c + by) % columns)),
                    Box::new(move |r, c| (r, (c + columns - by) % columns)),
                    size,
                )
            }
        };
        other.range_m = moved(&scan.range_m, columns, from, to);
        other.columns = to.1;
        let labels = |scan: &Scan| scan.record(approach(noise_m), 2 * scan.columns).labels();
        let agreed = agreement(&labels(&scan), &moved(&labels(&other), to.1, back, size));
        all.push(agreed);
    }
    let (least, mean) = (all.iter().copied().fold(1.0, f64::min), all.iter().sum::<f64>() / all.len() as f64);
    println!("{how}, {noise_m} m: {least:.4}, {mean:.4} on average");
    (least, mean)
}

const ALL: &[Kind] = &[Kind::Tilting, Kind::Panning, Kind::Around];

/// All but one. (Of the 356 walls of 60 rooms 352, 353 and 352 at 0, 5 and 10 mm of noise. Those that are not found: a wall beside the axis of a panning
/// scanner, which rows hardly cut (room 55); one that two rows take for a turn (7); and walls that
/// come in two pieces.)
#[test]
fn the_default_finds_the_walls() {
    for noise_m in [0.0, 0.01] {
        let (walls, of) = found(24, by_planes, noise_m);
        assert!(of > 130 && walls + 1 >= of, "{walls} of {of} at {noise_m} m");
    }
}

/// Without noise eight of ten, 289 of the 356 of 60 rooms. Edges belong to nobody, and cut walls where they graze; at 5 mm of noise 111 of 356
/// walls are found, at 10 mm none.
#[test]
fn edges_find_the_walls() {
    let (walls, of) = found(24, by_edges, 0.0);
    assert!(of > 130 && 10 * walls >= 8 * of, "{walls} of {of}");
}

/// Nine of ten at 5 mm of noise; of the 356 of 60 rooms 331, at 10 mm 327. A region that does not get its line in one row ends there;
/// without noise stated, what is rounded decides, and 262 are found.
#[test]
fn regions_find_the_walls() {
    let (walls, of) = found(24, by_regions, 0.005);
    assert!(of > 130 && 10 * walls >= 9 * of, "{walls} of {of}");
}

/// 98 % of the pixels, in any room; but for one turned over without noise (room 7: 0.960). 30
/// rooms of each kind hold the same.
#[test]
fn the_default_sees_the_same_in_moved_images() {
    for (noise_m, turned_over) in [(0.0, 0.95), (0.01, 0.98)] {
        for (how, kinds, least) in [
            ("mirrored", ALL, 0.98),
            ("turned over", ALL, turned_over),
            ("transposed", &[Kind::Camera], 0.98),
            ("rotated", &[Kind::Around], 0.98),
        ] {
            let agreed = agreements(12, by_planes, noise_m, kinds, how);
            assert!(agreed.0 >= least && agreed.1 >= 0.99, "{how}: {agreed:?} at {noise_m} m");
        }
    }
}

/// Without noise: transposed and rotated exactly, mirrored 98 % (a bearing angle is kept at the later
/// pixel of its pair), turned over 97 %, and 98 % on average. At 5 mm of noise the last two are 87 %.
#[test]
fn edges_are_the_same_in_moved_images() {
    assert_eq!(agreements(12, by_edges, 0.0, &[Kind::Camera], "transposed").0, 1.0);
    assert_eq!(agreements(12, by_edges, 0.0, &[Kind::Around], "rotated").0, 1.0);
    assert!(agreements(12, by_edges, 0.0, ALL, "mirrored").0 >= 0.98);
    let (least, mean) = agreements(12, by_edges, 0.0, ALL, "turned over");
    assert!(least >= 0.97 && mean >= 0.98, "{least} {mean}");
}

/// At 5 mm of noise, on average. Single rooms go down to 91 % where a region breaks in one of the two,
/// and without noise to 51 %: whether a line joins a region is then up to rounding.
#[test]
fn regions_are_the_same_in_moved_images() {
    for (how, kinds) in
        [("mirrored", ALL), ("turned over", ALL), ("transposed", &[Kind::Camera]), ("rotated", &[Kind::Around])]
    {
        let (least, mean) = agreements(12, by_regions, 0.005, kinds, how);
        assert!(least >= 0.9 && mean >= 0.98, "{how}: {least} {mean}");
    }
}
