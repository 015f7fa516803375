//! Beams that do not lie where the turn angle alone says: lasers that look beside the others, a tilt
//! that moves while it measures a row, an origin beside the axis, free directions. A box room has its
//! planes, whatever scans it.

use core::ops::ControlFlow;
use scanseg_core::{
    AnyConfig, AnySegmenter, Approach, Beams, ColumnTurns, Columns, EdgeConfig, Join, LabelRow, Memory, Pixel,
    PlaneConfig, PlaneSegmenter, PushError, Ranging, RegionConfig, Row, RowBeams, Segment, Segmenter, Sink, Trace,
    TurnAxis, bearing_row,
};
use scanseg_tests::scenes::uniform;
use std::collections::BTreeMap;

type Vector = [f64; 3];

fn plus(a: Vector, k: f64, b: Vector) -> Vector {
    [0, 1, 2].map(|i| a[i] + k * b[i])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The planes n . p = 1 of a box room, turned by 10 deg.
fn walls() -> [Vector; 6] {
    let (sin, cos) = 10f64.to_radians().sin_cos();
    let turned = |x: f64, y: f64, d: f64| [(x * cos + y * sin) / d, (y * cos - x * sin) / d, 0.0];
    let [front, back] = [turned(1.0, 0.0, 4.0), turned(-1.0, 0.0, 3.0)];
    let [left, right] = [turned(0.0, 1.0, 3.0), turned(0.0, -1.0, 2.5)];
    [front, back, left, right, [0.0, 0.0, 1.0 / 1.6], [0.0, 0.0, -1.0]]
}

/// The plane that a beam meets, and at which range.
fn hit([direction, origin]: [Vector; 2]) -> (usize, f64) {
    let range = |n: Vector| (1.0 - dot(n, origin)) / dot(n, direction);
    let ranges = walls().map(range).into_iter().enumerate().filter(|(_, range_m)| *range_m > 0.0);
    ranges.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
}

/// A scan of the room: rows of beams, and where each beam points.
struct Scanner<'a> {
    beams: Beams<'a>,
    rows: Vec<RowBeams<'a>>,
    columns: usize,
    /// Direction and origin of a beam.
    ray: &'a dyn Fn(usize, usize) -> [Vector; 2],
}

#[derive(Default)]
struct Found {
    labels: Vec<u32>,
    segments: BTreeMap<u32, Segment>,
    joined: BTreeMap<u32, u32>,
}

impl Found {
    fn root(&self, mut label: u32) -> u32 {
        while let Some(&into) = self.joined.get(&label) {
            label = into;
        }
        label
    }
}

impl Sink for Found {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.labels.extend(row.pixels().map(|pixel| match pixel {
            Pixel::Segment(label) => label.0,
            _ => 0,
        }));
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.joined.insert(join.from.0, join.into.0);
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.insert(segment.label.0, *segment);
        ControlFlow::Continue(())
    }
}

fn segmented(config: AnyConfig<'_>, beams: Beams<'_>, rows: &[RowBeams], columns: usize, range_m: &[f32]) -> Found {
    let sizes = config.sizes_for(&beams, columns);
    let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
    let (mut words, mut areas) = (vec![0; sizes.words], vec![scanseg_core::Area::EMPTY; 2 * columns + 2]);
    let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
    let mut segmenter = AnySegmenter::new(config, beams, columns, memory).unwrap();
    let mut found = Found::default();
    for (row, ranges_m) in rows.iter().zip(range_m.chunks(columns)) {
        segmenter.push_row(ranges_m, *row, &mut found).unwrap();
    }
    segmenter.finish(&mut found);
    found
}

impl Scanner<'_> {
    /// Plane and range of each pixel; noise of so much.
    fn scan(&self, noise_m: f64) -> (Vec<usize>, Vec<f32>) {
        let pixels = (0..self.rows.len()).flat_map(|row| (0..self.columns).map(move |column| (row, column)));
        pixels
            .map(|(row, column)| {
                let (plane, range_m) = hit((self.ray)(row, column));
                let gauss = (0..12).map(|k| uniform(3, row * self.columns + column, k)).sum::<f64>() - 6.0;
                (plane, (range_m + noise_m * gauss) as f32)
            })
            .unzip()
    }

    /// The least share of the pixels of a plane of 500 and more that one segment has, and the
    /// farthest that its plane is from the truth, metres over the room.
    fn least(&self, config: AnyConfig<'_>, noise_m: f64) -> (f64, f64) {
        let (planes, range_m) = self.scan(noise_m);
        let found = segmented(config, self.beams, &self.rows, self.columns, &range_m);
        let (mut all, mut of_plane) = ([0; 6], BTreeMap::new());
        for (&plane, &label) in planes.iter().zip(&found.labels) {
            all[plane] += 1;
            *of_plane.entry((plane, found.root(label))).or_insert(0) += 1;
        }
        let (mut least, mut farthest) = (1.0, 0.0);
        for plane in (0..6).filter(|&plane| all[plane] > 500) {
            let most = of_plane.range((plane, 1)..(plane + 1, 0)).max_by_key(|(_, count)| **count);
            let Some((&(_, label), &count)) = most else { return (0.0, f64::MAX) };
            least = f64::min(least, f64::from(count) / f64::from(all[plane]));
            let Some(of) = found.segments.get(&label).and_then(Segment::plane) else { return (0.0, f64::MAX) };
            let n = of.normal.map(|n| f64::from(-n / of.distance_m));
            let wall = walls()[plane];
            // how far the plane is off, a metre to each side of its foot
            let foot = wall.map(|x| x / dot(wall, wall));
            let axis = if wall[2].abs() > 0.1 { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] };
            for k in [-1.0, 1.0] {
                let off = (dot(n, plus(foot, k, axis)) - 1.0) / dot(n, n).sqrt();
                farthest = f64::max(farthest, off.abs());
            }
        }
        (least, farthest)
    }
}

const NOISE_M: f32 = 0.005;

fn default() -> AnyConfig<'static> {
    PlaneConfig::new(Ranging::new(NOISE_M)).into()
}

/// Edges and regions without noise: what is tested is where beams point.
fn others() -> [AnyConfig<'static>; 2] {
    let ranging = Ranging::new(0.002);
    [EdgeConfig::paper().with_ranging(ranging).into(), RegionConfig::paper().with_ranging(ranging).into()]
}

/// The direction of a nodding scanner's beam.
fn nodding(beam_rad: f64, turn_rad: f64, axis: TurnAxis) -> Vector {
    let (out, along) = (beam_rad.cos(), beam_rad.sin());
    match axis {
        TurnAxis::Y => [out * turn_rad.cos(), along, out * turn_rad.sin()],
        TurnAxis::Z => [out * turn_rad.cos(), out * turn_rad.sin(), along],
    }
}

fn spinning(azimuth_rad: f64, elevation_rad: f64) -> Vector {
    let out = elevation_rad.cos();
    [out * azimuth_rad.cos(), out * azimuth_rad.sin(), elevation_rad.sin()]
}

const STEP_RAD: f32 = 0.0087;
const COLUMNS: usize = 361;

fn even() -> Columns<'static> {
    Columns::Even { start_rad: -1.57, step_rad: STEP_RAD }
}

fn beam_rad(column: usize) -> f64 {
    f64::from(-1.57f32) + column as f64 * f64::from(STEP_RAD)
}

fn turn_rad(row: usize) -> f32 {
    0.8 - 0.0087 * row as f32
}

/// Rings that look up to 4.2 deg beside the others, as those of a VLP-32C.
#[test]
fn rings_beside_one_another() {
    let offset_rad = |row: usize| [-4.2f32, 1.4, -1.4, 4.2][row % 4].to_radians();
    let elevation_rad = |row: usize| (15.0 - row as f32).to_radians();
    let step_rad = core::f32::consts::TAU / 900.0;
    let columns = Columns::Even { start_rad: 0.0, step_rad };
    let ray = |row: usize, column: usize| {
        let azimuth_rad = column as f64 * f64::from(step_rad) + f64::from(offset_rad(row));
        [spinning(azimuth_rad, elevation_rad(row).into()), [0.0; 3]]
    };
    let rows = (0..40).map(|row| RowBeams::from(elevation_rad(row)).with_offset_rad(offset_rad(row))).collect();
    let scanner = Scanner { beams: Beams::Spinning { columns, wraps: true }, rows, columns: 900, ray: &ray };
    let (least, farthest) = scanner.least(default(), NOISE_M.into());
    assert!(least > 0.97 && farthest < 0.003, "{least} {farthest}");
    // as it would be without
    let rows = (0..40).map(|row| RowBeams::from(elevation_rad(row))).collect();
    let (least, _) = Scanner { rows, ..scanner }.least(default(), NOISE_M.into());
    assert!(least < 0.5, "{least}");
}

/// A tilt that turns on by 0.4 deg from one set of columns to the next, as a complete scan line of a
/// SICK LMS at 0.5 rad/s.
#[test]
fn tilt_that_moves() {
    let turns = ColumnTurns { step_rad: -9e-6, sets: 2, set_rad: -0.0066 };
    let ray = |row: usize, column: usize| {
        let turn_rad = f64::from(turn_rad(row)) + f64::from(turns.of(column));
        [nodding(beam_rad(column), turn_rad, TurnAxis::Y), [0.0; 3]]
    };
    let rows = (0..160).map(|row| RowBeams::from(turn_rad(row)).with_column_turns(turns)).collect();
    let beams = Beams::Nodding { columns: even(), axis: TurnAxis::Y };
    let scanner = Scanner { beams, rows, columns: COLUMNS, ray: &ray };
    let (least, farthest) = scanner.least(default(), NOISE_M.into());
    assert!(least > 0.97 && farthest < 0.001, "{least} {farthest}");
    let rows = (0..160).map(|row| RowBeams::from(turn_rad(row))).collect();
    let (_, without) = Scanner { rows, ..scanner }.least(default(), NOISE_M.into());
    assert!(without > 0.004, "{without}");
}

/// A scanner that pans 77 mm beside its axis, upright and lying.
#[test]
fn origin_beside_the_axis() {
    for axis in [TurnAxis::Y, TurnAxis::Z] {
        let ray = |row: usize, column: usize| {
            let turn_rad = f64::from(turn_rad(row));
            let out = nodding(0.0, turn_rad, axis);
            [nodding(beam_rad(column), turn_rad, axis), plus([0.0; 3], 0.077, out)]
        };
        let rows = (0..160).map(|row| RowBeams::from(turn_rad(row)).with_lever_arm_m(0.077)).collect();
        let beams = Beams::Nodding { columns: even(), axis };
        let scanner = Scanner { beams, rows, columns: COLUMNS, ray: &ray };
        let (least, farthest) = scanner.least(default(), NOISE_M.into());
        assert!(least > 0.97 && farthest < 0.001, "{axis:?} {least} {farthest}");
        for config in others() {
            let (_, farthest) = scanner.least(config, 0.0);
            assert!(farthest < 0.001, "{axis:?} {:?} {farthest}", config.approach());
        }
        let rows = (0..160).map(|row| RowBeams::from(turn_rad(row))).collect();
        let (_, without) = Scanner { rows, ..scanner }.least(default(), NOISE_M.into());
        assert!(without > 0.02, "{axis:?} {without}");
    }
}

/// A spinning lidar whose rows are its firings: lasers up to 0.4 deg beside one another. It does not
/// matter where in the turn the encoder has its 0.
#[test]
fn firings() {
    for encoder_deg in [0.0f32, 3.0, -20.0] {
        let angles_rad: Vec<f32> = (0..64).map(|i| (20.0 - 0.6 * i as f32).to_radians()).collect();
        let turns_rad: Vec<f32> =
            (0..64).map(|i| ([-0.4f32, 0.1, 0.4, -0.1][i % 4] + encoder_deg).to_radians()).collect();
        let azimuth_rad = |row: usize| 0.0061 * row as f32 - encoder_deg.to_radians();
        let ray = |row: usize, column: usize| {
            let turn_rad = f64::from(azimuth_rad(row)) + f64::from(turns_rad[column]);
            [nodding(angles_rad[column].into(), turn_rad, TurnAxis::Z), [0.0; 3]]
        };
        let columns = Columns::Beside { angles_rad: &angles_rad, turns_rad: &turns_rad };
        let rows = (0..1030).map(|row| RowBeams::from(azimuth_rad(row))).collect();
        let beams = Beams::Nodding { columns, axis: TurnAxis::Z };
        let scanner = Scanner { beams, rows, columns: 64, ray: &ray };
        let (least, farthest) = scanner.least(default(), NOISE_M.into());
        assert!(least > 0.97 && farthest < 0.002, "{encoder_deg}: {least} {farthest}");
    }
}

/// Turn after turn of a lidar that begins in the middle of a wall: the wall is one segment, and each
/// turn is as the first.
#[test]
fn full_turns() {
    let angles_rad: Vec<f32> = (0..64).map(|i| (20.0 - 0.6 * i as f32).to_radians()).collect();
    let azimuth_rad = |row: usize| core::f32::consts::TAU / 1024.0 * row as f32;
    let ray = |row: usize, column: usize| {
        [nodding(angles_rad[column].into(), azimuth_rad(row).into(), TurnAxis::Z), [0.0; 3]]
    };
    let beams = Beams::Nodding { columns: Columns::Listed(&angles_rad), axis: TurnAxis::Z };
    let rows = (0..1024).map(|row| RowBeams::from(azimuth_rad(row))).collect();
    let scanner = Scanner { beams, rows, columns: 64, ray: &ray };
    let config = PlaneConfig::new(Ranging::new(NOISE_M));
    let (least, farthest) = scanner.least(config.with_full_turns().into(), NOISE_M.into());
    assert!(least > 0.97 && farthest < 0.001, "{least} {farthest}");
    let (cut, _) = scanner.least(config.into(), NOISE_M.into());
    assert!(cut < 0.8, "{cut}");

    let (_, range_m) = scanner.scan(NOISE_M.into());
    let mut buffers = <scanseg_core::buffers!(64, TURNS)>::EMPTY;
    let mut segmenter = PlaneSegmenter::new(TURNS, beams, 64, buffers.memory()).unwrap();
    let turns = [(); 3].map(|()| {
        let mut found = Found::default();
        for (row, ranges_m) in scanner.rows.iter().zip(range_m.chunks(64)) {
            segmenter.push_row(ranges_m, *row, &mut found).unwrap();
        }
        segmenter.finish(&mut found);
        (found.labels, found.segments)
    });
    assert!(turns[0].1.len() > 5 && turns[1] == turns[0] && turns[2] == turns[0]);
}

const TURNS: PlaneConfig = PlaneConfig::new(Ranging::new(NOISE_M)).with_full_turns();

/// Rings of a spinning lidar with half of the returns missing, given direction by direction: where beams
/// without a return are said to point does not matter, and walls are found.
#[test]
fn free_directions_without_a_return() {
    let elevation_rad = |row: usize| (15.0 - 2.0 * row as f32).to_radians();
    let ray = |row: usize, column: usize| {
        let azimuth_rad = core::f64::consts::TAU / COLUMNS as f64 * column as f64;
        [spinning(azimuth_rad, elevation_rad(row).into()), [0.0; 3]]
    };
    let rows = (0..16).map(|row| RowBeams::from(elevation_rad(row))).collect();
    let beams = Beams::Spinning { columns: even(), wraps: false };
    let (_, mut range_m) = Scanner { beams, rows, columns: COLUMNS, ray: &ray }.scan(NOISE_M.into());
    let mut state = 1u32;
    let mut missing = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        state >> 31 == 1
    };
    range_m.iter_mut().filter(|_| missing()).for_each(|range_m| *range_m = 0.0);
    let found = [[1.0, 0.0, 0.0], [0.0; 3], [f32::NAN; 3], [0.0, 0.0, -7.0]].map(|nowhere| {
        let mut found = Found::default();
        let config = PlaneConfig::new(Ranging::new(NOISE_M));
        let sizes = config.sizes_with(COLUMNS, 2 * COLUMNS);
        let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
        let (mut words, mut areas) = (vec![0; sizes.words], vec![scanseg_core::Area::EMPTY; sizes.areas]);
        let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
        let mut segmenter = PlaneSegmenter::new(config, Beams::Free { wraps: true }, COLUMNS, memory).unwrap();
        for (row, ranges_m) in range_m.chunks(COLUMNS).enumerate() {
            let direction = |(column, range_m): (usize, &f32)| {
                if *range_m > 0.0 { ray(row, column)[0].map(|x| x as f32) } else { nowhere }
            };
            let directions: Vec<_> = ranges_m.iter().enumerate().map(direction).collect();
            segmenter.push_row(ranges_m, RowBeams::free(&directions), &mut found).unwrap();
        }
        segmenter.finish(&mut found);
        (found.labels, found.segments)
    });
    assert!(found.iter().all(|other| other.0 == found[0].0 && other.1.len() == found[0].1.len()));
    let on_planes: u32 = found[0].1.values().filter(|s| s.plane().is_some()).map(|s| s.pixels()).sum();
    let returns = range_m.iter().filter(|range_m| **range_m > 0.0).count();
    assert!(f64::from(on_planes) > 0.9 * returns as f64, "{on_planes} of {returns}");
}

/// The directions of all pixels, given one by one, are as good as what made them.
#[test]
fn free_directions() {
    let pinhole = Beams::Pinhole { fx_px: 200.0, fy_px: 200.0, cx_px: 180.0, cy_px: 80.0 };
    let kinds = [
        Beams::Nodding { columns: even(), axis: TurnAxis::Y },
        Beams::Nodding { columns: even(), axis: TurnAxis::Z },
        Beams::Spinning { columns: even(), wraps: false },
        pinhole,
    ];
    for beams in kinds {
        let direction = |row: usize, column: usize| match beams {
            Beams::Nodding { axis, .. } => nodding(beam_rad(column), turn_rad(row).into(), axis),
            Beams::Spinning { .. } => spinning(beam_rad(column), turn_rad(row).into()),
            _ => {
                let v: Vector = [1.0, (180.0 - column as f64) / 200.0, (80.0 - row as f64) / 200.0];
                v.map(|x| x / dot(v, v).sqrt())
            }
        };
        let ray = |row: usize, column: usize| [direction(row, column), [0.0; 3]];
        let rows = (0..160).map(|row| RowBeams::from(turn_rad(row))).collect();
        let plain = Scanner { beams, rows, columns: COLUMNS, ray: &ray };
        let directions: Vec<[f32; 3]> =
            (0..160 * COLUMNS).map(|i| direction(i / COLUMNS, i % COLUMNS).map(|x| x as f32)).collect();
        let rows = directions.chunks(COLUMNS).map(RowBeams::free).collect();
        let free = Scanner { beams: Beams::Free { wraps: false }, rows, columns: COLUMNS, ray: &ray };
        for (config, noise_m) in [(default(), NOISE_M), (others()[0], 0.0), (others()[1], 0.0)] {
            let [one, other] = [&plain, &free].map(|scanner| scanner.least(config, noise_m.into()));
            let name = config.approach();
            assert!(other.0 > one.0 - 0.02, "{beams:?} {name:?}: {} instead of {}", other.0, one.0);
            assert!(other.1 < one.1 + 0.0005, "{beams:?} {name:?}: {} instead of {}", other.1, one.1);
        }
    }
}

/// Bearing angles of all of them are those of the paper, to 0.001 deg.
#[test]
fn bearing_angles() {
    let (columns, listed) = (90, (0..90).map(|c| -0.7 + 0.016 * c as f32).collect::<Vec<_>>());
    let beside: Vec<f32> = (0..90).map(|c| 0.01 * (c % 3) as f32).collect();
    let turns = ColumnTurns { step_rad: 1e-4, sets: 2, set_rad: 0.007 };
    let at = |row: usize| 0.3 + 0.02 * row as f32;
    let rows = [0, 1].map(|row| {
        RowBeams::from(at(row)).with_offset_rad(0.03 * row as f32).with_column_turns(turns).with_lever_arm_m(0.05)
    });
    let ray = |row: usize, column: usize| {
        let turn_rad = f64::from(at(row)) + f64::from(turns.of(column)) + f64::from(beside[column]);
        let direction = nodding(f64::from(listed[column]) + f64::from(0.03 * row as f32), turn_rad, TurnAxis::Z);
        [direction, plus([0.0; 3], f64::from(0.05f32), nodding(0.0, turn_rad, TurnAxis::Z))]
    };
    let ranges_m = [0, 1].map(|row| (0..columns).map(|column| hit(ray(row, column)).1 as f32).collect::<Vec<_>>());
    let columns_of = Columns::Beside { angles_rad: &listed, turns_rad: &beside };
    let beams = Beams::Nodding { columns: columns_of, axis: TurnAxis::Z };
    for trace in [Trace::ROW, Trace::COLUMN, Trace::DIAGONAL] {
        let row = |row: usize| Row { ranges_m: &ranges_m[row], beams: rows[row], row };
        let before = 1 - usize::from(trace.rows);
        let mut counts = vec![0; columns];
        bearing_row(&Ranging::new(0.01), beams, trace, row(1), row(before), &mut counts).unwrap();
        for (column, &count) in counts.iter().enumerate().skip(2) {
            let other = column - trace.columns as usize;
            let [[d, o], [d0, o0]] = [ray(1, column), ray(before, other)];
            let point = |o: Vector, row: usize, column: usize, d: Vector| plus(o, ranges_m[row][column].into(), d);
            let line = plus(point(o, 1, column, d), -1.0, point(o0, before, other, d0));
            let exact = (dot(d, line) / dot(line, line).sqrt()).acos();
            let found = f64::from(count) * core::f64::consts::PI / 65535.0;
            assert!((found - exact).abs().to_degrees() < 0.001 + 0.0014, "{trace:?} {column}: {found} {exact}");
        }
    }
}

/// What cannot be is refused, and the row before it stays.
#[test]
fn refused() {
    let config = default();
    let nodding = Beams::Nodding { columns: even(), axis: TurnAxis::Y };
    let spinning = Beams::Spinning { columns: even(), wraps: false };
    let free = Beams::Free { wraps: false };
    let push = |beams: Beams, row: RowBeams| {
        let sizes = config.sizes(COLUMNS);
        let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
        let (mut words, mut areas) = (vec![0; sizes.words], vec![scanseg_core::Area::EMPTY; sizes.areas]);
        let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
        let mut segmenter = AnySegmenter::new(config, beams, COLUMNS, memory).unwrap();
        segmenter.push_row(&[2.0; COLUMNS], row, &mut Found::default()).map(|_| ())
    };
    assert_eq!(config.approach(), Approach::Plane);
    let row = RowBeams::from(0.0);
    let field = |field, value| Err(PushError::RowBeams { field, value });
    assert_eq!(push(nodding, row.with_offset_rad(7.0)), field("offset_rad", 7.0));
    assert_eq!(push(nodding, row.with_lever_arm_m(11.0)), field("lever_arm_m", 11.0));
    assert_eq!(push(spinning, row.with_lever_arm_m(0.1)), field("lever_arm_m", 0.1));
    let turns = |sets, set_rad| ColumnTurns { step_rad: 0.0, sets, set_rad };
    assert_eq!(push(nodding, row.with_column_turns(turns(0, 0.0))), field("sets", 0.0));
    assert_eq!(push(nodding, row.with_column_turns(turns(2, 1.0))), field("set_rad", 2.0));
    assert_eq!(push(spinning, row.with_column_turns(turns(2, 0.1))), field("set_rad", 0.2));
    assert_eq!(push(free, row), Err(PushError::RowLength { expected: COLUMNS, got: 0 }));
    let mut directions = [[0.6, 0.8, 0.0]; COLUMNS];
    assert_eq!(push(free, RowBeams::free(&directions)), Ok(()));
    directions[17] = [f32::NAN, 0.0, 1.0];
    assert_eq!(push(free, RowBeams::free(&directions)), Err(PushError::Direction { column: 17 }));
    directions[17] = [2.0, 0.0, 0.0];
    assert_eq!(push(free, RowBeams::free(&directions)), Err(PushError::Direction { column: 17 }));
}

/// Bearing angles of rows whose columns go on turning, at rates of their own, along every kind of
/// trace: those of the beams in double precision.
#[test]
fn bearing_angles_of_a_tilt_that_moves() {
    let even = Columns::Even { start_rad: -1.5, step_rad: 0.0087 };
    let listed: Vec<f32> = (0..COLUMNS).map(|c| -1.5 + 0.0087 * c as f32 + 0.002 * uniform(7, 0, c) as f32).collect();
    let still = ColumnTurns::NONE;
    let one = ColumnTurns { step_rad: 2e-5, sets: 1, set_rad: 0.0 };
    let two = |scale: f32| ColumnTurns { step_rad: -9e-6 * scale, sets: 2, set_rad: -0.0066 * scale };
    let fast = ColumnTurns { step_rad: 0.002, sets: 4, set_rad: 0.05 };
    let ranges_m: Vec<f32> = (0..2 * COLUMNS).map(|i| 3.0 + 0.5 * uniform(3, 0, i) as f32).collect();
    let (before_m, now_m) = ranges_m.split_at(COLUMNS);
    let traces = [Trace::ROW, Trace::COLUMN, Trace::DIAGONAL, Trace::ANTIDIAGONAL, Trace::DIAGONAL.times(3)];
    for columns in [even, Columns::Listed(&listed)] {
        for turns in [[one, one], [two(1.0), two(1.1)], [still, two(1.0)], [two(1.0), one], [fast, two(1.0)]] {
            for trace in traces {
                let of_row = if trace.rows == 0 { [turns[0], turns[0]] } else { turns };
                let turn_rad = if trace.rows == 0 { [0.3, 0.3] } else { [0.3, 0.29] };
                let rows = [0, 1].map(|i| RowBeams::from(turn_rad[i]).with_column_turns(of_row[i]));
                let before_m = if trace.rows == 0 { now_m } else { before_m };
                let row = |ranges_m, beams| Row { ranges_m, beams, row: 0 };
                let mut counts = [0; COLUMNS];
                let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
                let (now, before) = (row(now_m, rows[0]), row(before_m, rows[1]));
                bearing_row(&Ranging::new(0.01), beams, trace, now, before, &mut counts).unwrap();
                let angle_rad = |column: usize| match columns {
                    Columns::Listed(list) => f64::from(list[column]),
                    _ => -1.5f32 as f64 + column as f64 * f64::from(0.0087f32),
                };
                let beam = |i: usize, column: usize| {
                    let turn_rad = f64::from(turn_rad[i]) + f64::from(of_row[i].of(column));
                    nodding(angle_rad(column), turn_rad, TurnAxis::Y)
                };
                for (column, &count) in counts.iter().enumerate() {
                    let Some(other) = column.checked_add_signed(-isize::from(trace.columns)).filter(|&c| c < COLUMNS)
                    else {
                        assert_eq!(count, 0);
                        continue;
                    };
                    let apart = plus(beam(0, column), -1.0, beam(1, other));
                    // near the axis beams coincide
                    if dot(apart, apart).sqrt() < 2e-5 {
                        continue;
                    }
                    let (r1, r0) = (f64::from(now_m[column]), f64::from(before_m[other]));
                    let along = plus(beam(0, column).map(|x| x * r1), -r0, beam(1, other));
                    let cos = dot(along, beam(0, column)) / dot(along, along).sqrt();
                    let expected = cos.acos() * f64::from(scanseg_core::COUNTS_PER_RAD);
                    let off = (f64::from(count) - expected).abs();
                    assert!(off < 3.0, "{turns:?} {trace:?} column {column}: {count}, not {expected}");
                }
            }
        }
    }
}
