//! The planes that the default reports: those of least squares of the range errors, and how far off
//! they say that they may be.

use nalgebra::{Matrix3, Matrix3x4, Matrix4, Matrix4x3, Vector3, Vector4};
use scanseg_core::{
    AnyConfig, EdgeConfig, Plane, PlaneConfig, Ranging, RegionConfig, Rules, Segment, SegmentSums, TurnAxis,
};
use scanseg_tests::checks::planes::{assert_sound, covariance};
use scanseg_tests::reference::weighted::{Fit, Noise, Return};
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Record, Rig, Scan};
use std::collections::BTreeMap;
use std::f64::consts::TAU;
use std::sync::OnceLock;

const ROWS: usize = 100;
const COLUMNS: usize = 181;
const NOISE_M: f64 = 0.005;
/// What the default adds to what is stated: ranges are rounded, walls are not quite flat.
const LEAST_NOISE_M: f64 = 0.0015;

/// A normal number of mean 0 and variance 1, the same for the same arguments.
fn normal(seed: u64, row: usize, column: usize) -> f64 {
    let [u, v] = [0, 1].map(|i| uniform(2 * seed + i, row, column));
    (-2.0 * (1.0 - u).ln()).sqrt() * (TAU * v).cos()
}

/// The points p with normal . p = distance_m; the normal away from the scanner.
#[derive(Clone, Copy)]
struct Wall {
    normal: Vector3<f64>,
    distance_m: f64,
}

/// The walls of a box with the scanner in it, askew.
fn walls() -> Vec<Wall> {
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let (x, y, z) = (Vector3::new(cos, -sin, 0.0), Vector3::new(sin, cos, 0.0), Vector3::z());
    let walls = [(x, 4.0), (-x, 3.0), (y, 3.0), (-y, 2.5), (z, 1.6), (-z, 1.0)];
    walls.map(|(normal, distance_m)| Wall { normal, distance_m }).to_vec()
}

/// A scan and the wall of each pixel.
struct Drawn {
    scan: Scan,
    walls: Vec<Wall>,
    truth: Vec<usize>,
}

/// What rows are off by, one standard deviation.
#[derive(Clone, Copy)]
enum Off {
    /// Rows of a tilting scanner by turns that it does not report.
    TurnRad(f64),
    /// Rings of a spinning one by offsets of their ranges.
    RingM(f64),
}

/// The room, drawn with noise by a scanner with a pixel each degree; with `panels` small ones hang in it, 8 rows by 9 columns, each
/// another way.
fn draw(seed: u64, panels: bool, noise_m: f64, off: Off) -> Drawn {
    let step_rad = 1f32.to_radians();
    let angles = Angles::Even { start_rad: -90.0 * step_rad, step_rad };
    let (rig, turn_off_rad, ring_off_m) = match off {
        Off::TurnRad(turn_off_rad) => (Rig::Nodding { angles, axis: TurnAxis::Y }, turn_off_rad, 0.0),
        Off::RingM(ring_off_m) => (Rig::Spinning { angles, wraps: false }, 0.0, ring_off_m),
    };
    let turn_rad: Vec<f32> = (0..ROWS).map(|row| (row as f32 - 50.0) * step_rad).collect();
    let of_row: Vec<f64> = (0..ROWS).map(|row| normal(seed + (1 << 32), row, COLUMNS)).collect();
    let true_rad = turn_rad.iter().zip(&of_row).map(|(turn, off)| turn + (turn_off_rad * off) as f32).collect();
    let mut scan = Scan { columns: COLUMNS, range_m: vec![], turn_rad: true_rad, rig };
    let (beams, mut walls) = (scan.reference_beams(), walls());
    let nearest = |walls: &[Wall], u: Vector3<f64>| {
        let inverse = |wall: &Wall| wall.normal.dot(&u) / wall.distance_m;
        (0..walls.len()).map(|i| (i, inverse(&walls[i]))).max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    };
    let mut panel_of = BTreeMap::new();
    for (i, j) in (0..6).flat_map(|i| (0..4).map(move |j| (i, j))).filter(|_| panels) {
        let (row, column) = (8 + 15 * i, 34 + 34 * j);
        let u = beams.direction((row + 4, column + 4));
        let tilted = u + Vector3::from_fn(|k, _| 0.8 * (uniform(9, i, 8 * k + j) - 0.5));
        let (normal, range_m) = (tilted.normalize(), 0.6 / nearest(&walls[..6], u).1);
        for pixel in (row..row + 8).flat_map(|row| (column..column + 9).map(move |column| (row, column))) {
            panel_of.insert(pixel, walls.len());
        }
        walls.push(Wall { normal, distance_m: range_m * normal.dot(&u) });
    }
    let mut truth = vec![];
    for (row, column) in scan.size().pixels() {
        let u = beams.direction((row, column));
        let wall = panel_of.get(&(row, column)).copied().unwrap_or_else(|| nearest(&walls[..6], u).0);
        let range_m = walls[wall].distance_m / walls[wall].normal.dot(&u);
        scan.range_m.push((range_m + noise_m * normal(seed, row, column) + ring_off_m * of_row[row]) as f32);
        truth.push(wall);
    }
    scan.turn_rad = turn_rad;
    Drawn { scan, walls, truth }
}

impl Drawn {
    fn record(&self, turn_noise_rad: f32, rules: &'static Rules) -> Record {
        let ranging = Ranging::new(NOISE_M as f32).with_turn_noise_rad(turn_noise_rad);
        self.scan.record(PlaneConfig::new(ranging).with_rules(rules), 2 * COLUMNS)
    }

    /// For each wall the segment that is it, but for a tenth.
    fn found(&self, record: &Record) -> Vec<(usize, Segment)> {
        let (labels, segments) = (record.labels(), record.segments());
        let mut both = BTreeMap::<(usize, u32), usize>::new();
        let mut of_wall = vec![0; self.walls.len()];
        for (&wall, &label) in self.truth.iter().zip(&labels) {
            *both.entry((wall, label)).or_default() += 1;
            of_wall[wall] += 1;
        }
        let is_it = |((wall, label), both): ((usize, u32), usize)| {
            let segment = *segments.get(&label)?;
            let either = of_wall[wall] + segment.pixels() as usize - both;
            (10 * both > 9 * either).then_some((wall, segment))
        };
        both.into_iter().filter_map(is_it).collect()
    }
}

/// How far off a plane is.
#[derive(Clone, Copy, Debug)]
struct Error {
    /// The squared error in units of its covariance: of three degrees of freedom.
    square: f64,
    distance_m: f64,
    normal_rad: f64,
}

fn error(plane: &Plane, wall: &Wall) -> Error {
    let n = -wall.normal;
    let a = n.cross(&if n.z.abs() < 0.9 { Vector3::z() } else { Vector3::x() }).normalize();
    let b = n.cross(&a);
    let tangents = Matrix3x4::from_fn(|i, j| match (i, j) {
        (0, 0..3) => a[j],
        (1, 0..3) => b[j],
        (2, 3) => 1.0,
        _ => 0.0,
    });
    let covariance = tangents * covariance(plane) * tangents.transpose();
    let [x, y, z] = plane.normal.map(f64::from);
    let error = Vector4::new(x - n.x, y - n.y, z - n.z, f64::from(plane.distance_m) - wall.distance_m);
    let error = tangents * error;
    let square = (error.transpose() * covariance.try_inverse().expect("of rank 3") * error)[0];
    Error { square, distance_m: error[2], normal_rad: error[0].hypot(error[1]) }
}

/// How far off planes are, by wall. What else holds of every plane is asserted.
fn errors(draws: u64, panels: bool, off: Off) -> BTreeMap<usize, Vec<Error>> {
    let mut errors = BTreeMap::<usize, Vec<Error>>::new();
    let turn_noise_rad = if let Off::TurnRad(off) = off { off as f32 } else { 0.0 };
    for seed in 0..draws {
        let drawn = draw(100 + seed, panels, NOISE_M, off);
        for (wall, segment) in drawn.found(&drawn.record(turn_noise_rad, &Rules::TUNED)) {
            let plane = segment.plane().expect("several rows");
            assert_sound(&plane);
            errors.entry(wall).or_default().push(error(&plane, &drawn.walls[wall]));
        }
    }
    errors
}

fn mean(values: impl IntoIterator<Item = f64>) -> f64 {
    let (sum, count) = values.into_iter().fold((0.0, 0.0), |(sum, count), value| (sum + value, count + 1.0));
    sum / count
}

fn mean_square<'a>(errors: impl IntoIterator<Item = &'a Error>) -> f64 {
    mean(errors.into_iter().map(|error| error.square))
}

/// Prints how far off each of the six walls is.
fn print_walls(errors: &BTreeMap<usize, Vec<Error>>) {
    for (wall, errors) in errors.range(..6) {
        let root = |of: fn(&Error) -> f64| mean(errors.iter().map(|error| of(error).powi(2))).sqrt();
        let [mm, mrad] = [root(|error| error.distance_m), root(|error| error.normal_rad)].map(|off| 1e3 * off);
        let (square, draws) = (mean_square(errors), errors.len());
        println!("wall {wall}: {square:.2} of {draws} draws, off by {mm:.2} mm and {mrad:.2} mrad");
    }
}

/// The mean squared error of each wall; so many draws have 0.17 of chance in it.
fn assert_walls(errors: &BTreeMap<usize, Vec<Error>>, least: f64, most: f64) {
    print_walls(errors);
    assert_eq!(errors.range(..6).count(), 5, "walls that are seen");
    for errors in errors.range(..6).map(|(_, errors)| errors) {
        assert!(errors.len() > DRAWS as usize * 9 / 10);
        assert!((least..most).contains(&mean_square(errors)));
    }
}

/// Walls without noise, square to the scanner and askew by less and more than points are rounded
/// (0.24 mm), by all approaches: how far planes are off is within what their covariances say.
#[test]
fn walls_without_noise_have_a_covariance() {
    let rig = Rig::Pinhole { fx_px: 60.0, fy_px: 60.0, cx_px: 29.5, cy_px: 19.5 };
    let ranging = Ranging::new(0.0);
    let approaches: [AnyConfig<'_>; 3] = [
        PlaneConfig::new(ranging).into(),
        EdgeConfig::paper().with_ranging(ranging).into(),
        RegionConfig::paper().with_ranging(ranging).into(),
    ];
    for config in approaches {
        let mut squares = vec![];
        for draw in 0..100 {
            let tilt = [0.0, 1e-5, 1e-4, 1e-3, 1e-1][draw % 5];
            let [y, z] = [0, 1].map(|k| tilt * (2.0 * uniform(11, draw, k) - 1.0));
            let normal = Vector3::new(1.0, y, z).normalize();
            let wall = Wall { normal, distance_m: 1.0 + 3.0 * uniform(11, draw, 2) };
            let range_m = |u: [f64; 3]| wall.distance_m / wall.normal.dot(&Vector3::from(u));
            let scan = Scan::of(60, vec![0.0; 40], rig.clone(), range_m);
            let record = scan.record(config, 120);
            let largest = record.segments().into_values().max_by_key(Segment::pixels).expect("a wall");
            let plane = largest.plane().expect("of a plane");
            assert_sound(&plane);
            squares.push(error(&plane, &wall).square);
        }
        let most = squares.iter().copied().fold(0.0, f64::max);
        let mean = mean(squares.iter().copied());
        println!("{:?}: {mean:.2} on average, {most:.2} at most", config.approach());
        assert!(mean < 3.0 && most < 12.0, "{squares:?}");
    }
}

/// What a row shares it shares across missing pixels: a floor of which every sixth column is missing
/// is known as well as the whole one, where the turns of its rows are what is not known.
#[test]
fn rows_with_missing_pixels_share_their_turn() {
    let distance_m2 = |is_missing: fn(usize) -> bool| {
        let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.5, step_rad: 1.0 / 60.0 }, axis: TurnAxis::Y };
        let turn_rad = (0..30).map(|row| (row as f32 - 50.0).to_radians()).collect();
        let mut scan = Scan::of(61, turn_rad, rig, |[_, _, z]| -1.0 / z);
        for (_, range_m) in scan.range_m.iter_mut().enumerate().filter(|(i, _)| is_missing(i % 61)) {
            *range_m = 0.0;
        }
        let ranging = Ranging::new(NOISE_M as f32).with_turn_noise_rad(0.01);
        let segments = scan.record(PlaneConfig::new(ranging), 122).segments();
        let plane = segments[&1].plane().expect("a floor");
        plane.covariance[3][3]
    };
    let (whole, holed) = (distance_m2(|_| false), distance_m2(|column| column % 6 == 3));
    assert!((0.9..1.2).contains(&(holed / whole)), "{whole} {holed}");
}

const DRAWS: u64 = 200;

/// At noise alone. 3 would be right; less is expected, because the default adds to the noise that is
/// stated: to ranges, to beams where they graze, and to the turn of each row, which shows on floor
/// and ceiling.
#[test]
fn large_planes_tell_how_far_off_they_are() {
    let errors = errors(DRAWS, false, Off::TurnRad(0.0));
    assert_walls(&errors, 1.1, 3.3);
    let all = mean_square(errors.values().flatten());
    assert!((1.9..2.9).contains(&all), "{all}");
}

/// Rows whose turn is off by 0.05 deg, as is stated: what all pixels of a row share is in the
/// covariance. Unsaid, the squared errors of the floor would be in the hundreds.
#[test]
fn turns_are_in_the_covariance() {
    assert_walls(&errors(DRAWS, false, Off::TurnRad(0.05f64.to_radians())), 2.0, 6.5);
}

/// Rings of a spinning scanner whose ranges nobody calibrated, 3 mm off: planes stand on all of them, not on
/// the first ones, and what these are off by on average is in the covariance. Else the squared errors of walls
/// are in the thousands.
#[test]
fn rings_are_in_the_covariance() {
    assert_walls(&errors(DRAWS, false, Off::RingM(0.003)), 2.1, 3.5);
}

/// The same of rings so far off that walls come in pieces, which are not counted: of four walls, the ceiling among them, and 200
/// draws so many come whole, with a mean squared error below `most`, and nearly all are less off than a ring.
fn assert_rings(off_m: f64, least: usize, most: f64) {
    let errors = errors(DRAWS, false, Off::RingM(off_m));
    print_walls(&errors);
    let walls: Vec<&Error> = errors.range(..5).flat_map(|(_, errors)| errors).collect();
    let (count, square) = (walls.len(), mean_square(walls.iter().copied()));
    println!("rings {} mm off: {square:.2} of {count} walls", 1e3 * off_m);
    assert!(count >= least && square < most);
    assert!(walls.iter().filter(|error| error.distance_m.abs() > off_m).count() * 20 < count);
}

#[test]
fn rings_10_mm_off() {
    assert_rings(0.01, 740, 2.9);
}

#[test]
fn rings_20_mm_off() {
    assert_rings(0.02, 590, 4.6);
}

/// Rings that are not off, which nobody said: 5 mm are expected before they tell better.
#[test]
fn rings_that_are_not_off_cost_little() {
    assert_walls(&errors(DRAWS, false, Off::RingM(0.0)), 0.8, 3.3);
}

/// Of small planes one of twenty is to be beyond the 95 % bound of three degrees of freedom.
#[test]
fn small_planes_tell_how_far_off_they_are() {
    let errors = errors(DRAWS / 2, true, Off::TurnRad(0.0));
    let small: Vec<f64> = errors.range(6..).flat_map(|(_, errors)| errors).map(|error| error.square).collect();
    let beyond = small.iter().filter(|&&square| square > 7.815).count() as f64 / small.len() as f64;
    let mean = mean(small.iter().copied());
    println!("{} panels: mean {mean:.2}, {beyond:.3} beyond the bound", small.len());
    assert!(small.len() as u64 > 22 * DRAWS / 2 && (2.4..3.2).contains(&mean) && beyond < 0.1);
}

/// Weighted least squares in f64 of the pixels of a label.
fn exact(drawn: &Drawn, labels: &[u32], label: u32) -> Fit {
    let beams = drawn.scan.reference_beams();
    let pixels = drawn.scan.size().pixels().zip(labels).zip(&drawn.scan.range_m).filter(|((_, l), _)| **l == label);
    let one = |((pixel, _), &r): ((_, _), &f32)| Return { beam: beams.direction(pixel), range_m: r.into() };
    let noise = Noise { ranging: Ranging::new(NOISE_M as f32), least_m: LEAST_NOISE_M, least_rad: 0.0 };
    noise.fit(&pixels.map(one).collect::<Vec<_>>()).unwrap()
}

/// Covariance of normal and distance of a plane.
fn covariance_of(exact: &Fit) -> Matrix4<f64> {
    let distance_m = 1.0 / exact.m.norm();
    let n = -exact.m * distance_m;
    let to_normal = -distance_m * (Matrix3::identity() - n * n.transpose());
    let change = Matrix4x3::from_fn(|i, j| if i < 3 { to_normal[(i, j)] } else { n[j] * distance_m * distance_m });
    change * exact.information.try_inverse().unwrap() * change.transpose()
}

/// Planes of all sizes, found row by row and from pieces, are those of weighted least squares in
/// f64 of all their pixels, and so are their covariances, where the noise of ranges is all there is.
/// At less noise than is stated none is measured, and no row is found to be off.
#[test]
fn planes_are_those_of_weighted_least_squares() {
    static RANGES_ALONE: OnceLock<Rules> = OnceLock::new();
    let rules = RANGES_ALONE.get_or_init(|| {
        let mut rules = Rules::TUNED;
        (rules.least_beam_rad, rules.turn_prior_rad) = (0.0, 0.0);
        rules
    });
    let (mut compared, mut worst) = (0, 0f64);
    for seed in 0..4 {
        let drawn = draw(seed, true, 0.3 * NOISE_M, Off::TurnRad(0.0));
        let record = drawn.record(0.0, rules);
        let labels = record.labels();
        for (_, segment) in drawn.found(&record) {
            let exact = exact(&drawn, &labels, segment.label.0);
            let (plane, distance_m) = (segment.plane().unwrap(), 1.0 / exact.m.norm());
            let SegmentSums::Fitted { pixels, fitted } = segment.sums else { panic!("{segment:?}") };
            let [.., x, y, z, squares] = fitted.numbers();
            let off = Vector3::new(x, y, z).cast::<f64>() - exact.m;
            let off = (off.transpose() * exact.information * off)[0].sqrt();
            worst = worst.max(off);
            assert!(off < 0.05, "off by {off} standard deviations: {segment:?}");
            assert!((f64::from(squares) / exact.squares - 1.0).abs() < 0.02, "{squares} {}", exact.squares);
            let across = exact.m.dot(&exact.beam) * distance_m;
            let mean_m = (exact.squares / exact.weight).sqrt() / exact.m.dot(&exact.beam).powi(2);
            assert!((f64::from(plane.rms_m) / (mean_m * across) - 1.0).abs() < 0.02, "{plane:?} {mean_m} {across}");
            let centroid_m = exact.beam / exact.m.dot(&exact.beam);
            let centroid_off = Vector3::from(segment.centroid_m().map(f64::from)) - centroid_m;
            assert!(centroid_off.norm() < 0.01, "{centroid_off}");
            let scale = (exact.squares / f64::from(pixels - 3)).max(1.0);
            let (found, expected) = (covariance(&plane), covariance_of(&exact) * scale);
            for (i, j) in (0..4).flat_map(|i| (0..4).map(move |j| (i, j))) {
                // with the share of rounding
                let [one, other] = [i, j].map(|i| expected[(i, i)] + 1e-11);
                let size = (one * other).sqrt();
                assert!((found[(i, j)] - expected[(i, j)]).abs() < 0.03 * size, "{found} {expected}");
            }
            compared += 1;
        }
    }
    println!("{compared} planes, off by {worst:.3} standard deviations at most");
    assert!(compared > 4 * 22);
}
