//! The core alone on one scan, for counting its instructions (`tests/instructions.sh`).
//!
//! - `cost make ROWS COLUMNS nodding|spinning FILE` writes a scene of the simulated office.
//! - `cost run FILE nodding|spinning plane|edge|region REPEAT` segments it so many times.
//! - `cost recorded GEOMETRY IMAGE plane|edge|region REPEAT` the same with a range image and its
//!   geometry file.
//! - `cost hard SCENE COLUMNS plane|edge|region REPEAT` the same with 60 rows of one of [`HARD`].
//!
//! Each prints what it found; the first number is that of the pixels.
//!
//! A scene file is little endian: u32 rows, u32 columns, f32 column step, f32 row step (radians),
//! then rows x columns f32 ranges in metres, 0 for none; rows and columns centred on straight
//! ahead, the first row up, the first column left.
use std::ops::ControlFlow;
use std::{env, error, fs};

use scanseg_core::{
    AnyConfig, AnySegmenter, Beams, Columns, EdgeConfig, LabelRow, PlaneConfig, Ranging, RegionConfig, RowBeams,
    Segment, Segmenter, Sink, TurnAxis,
};
use scanseg_formats::{Angles, Geometry, GreyImage, Kind, RangeImage};
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_sim::segmentation::{OwnedMemory, ScanBeams, ranging};

/// Range at a row and column.
type RangeM = fn(usize, usize) -> f32;

/// Scenes that make much work, seen by a nodding scanner with 160 deg of columns and stated noise of
/// 1 cm.
const HARD: [(&str, RangeM); 5] = [
    ("vegetation", |row, column| {
        let leaf = uniform(row / 3, column / 5);
        if leaf < 0.3 { 12.0 + uniform(row, column) } else { 2.0 + 6.0 * leaf + 0.2 * uniform(row, column) }
    }),
    ("combs", |_, column| if (column / 3).is_multiple_of(2) { 2.0 } else { 4.0 }),
    ("chess-board", |row, column| if (row + column).is_multiple_of(2) { 2.0 } else { 0.0 }),
    ("noise", |row, column| 1.0 + 4.0 * uniform(row, column)),
    // a wall with 3 cm of normal noise
    ("third", |row, column| 3.0 + 0.03 * (0..12).map(|i| uniform(row, 12 * column + i) - 0.5).sum::<f32>()),
];

/// A number from 0 to 1.
fn uniform(a: usize, b: usize) -> f32 {
    let mut x = (a as u64) << 32 ^ b as u64 ^ 0x9e37_79b9_7f4a_7c15;
    for _ in 0..3 {
        x = (x ^ x >> 29).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    }
    (x >> 40) as f32 / (1 << 24) as f32
}

type Result<T> = std::result::Result<T, Box<dyn error::Error>>;

fn main() -> Result<()> {
    let args: Vec<String> = env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["make", rows, columns, kind, file] => make(rows.parse()?, columns.parse()?, kind, file),
        ["run", file, kind, approach, repeat] => run(file, kind, config(approach, NOISE)?, repeat.parse()?),
        ["recorded", geometry, image, approach, repeat] => recorded(geometry, image, approach, repeat.parse()?),
        ["hard", scene, columns, approach, repeat] => {
            hard(scene, columns.parse()?, config(approach, NOISE)?, repeat.parse()?)
        }
        _ => {
            Err("usage: cost make ROWS COLUMNS nodding|spinning FILE | cost run FILE nodding|spinning APPROACH REPEAT \
                  | cost recorded GEOMETRY IMAGE APPROACH REPEAT | cost hard SCENE COLUMNS APPROACH REPEAT"
                .into())
        }
    }
}

/// Ranges with 1 cm of noise.
const NOISE: Ranging = Ranging::new(0.01);

fn config(approach: &str, ranging: Ranging) -> Result<AnyConfig<'static>> {
    Ok(match approach {
        "plane" => PlaneConfig::new(ranging).into(),
        "edge" => EdgeConfig::paper().with_ranging(ranging).into(),
        "region" => RegionConfig::paper().with_ranging(ranging).into(),
        _ => return Err(format!("no approach {approach}: plane, edge or region").into()),
    })
}

fn make(rows: usize, columns: usize, kind: &str, file: &str) -> Result<()> {
    let (h_deg, v_deg) = (160.0 / columns as f64, 80.0 / rows as f64);
    let angles = |n: usize, step: f64| Angles::Even { start_deg: (n as f64 - 1.0) / 2.0 * step, step_deg: -step };
    let mut sensor = Sensor::nodding(rows, columns);
    sensor.kind = match (kind, sensor.kind) {
        ("nodding", Kind::Nodding { turn_axis, .. }) => {
            Kind::Nodding { beam_deg: angles(columns, h_deg), turn_deg: angles(rows, v_deg), turn_axis }
        }
        _ => {
            let (azimuth_deg, elevation_deg) = (angles(columns, h_deg), angles(rows, v_deg));
            Kind::Spinning { azimuth_deg, elevation_deg, wraps: false }
        }
    };
    // 3 % of the distance between neighbouring points at 4 m: noise that the paper's method stands
    // at any resolution
    sensor.range_noise_m = 0.03 * 4.0 * h_deg.min(v_deg).to_radians();
    let scan = Scene::numbered(Set::Tuning, 0).scan(&sensor, 1)?;
    let mut bytes = Vec::new();
    bytes.extend((rows as u32).to_le_bytes());
    bytes.extend((columns as u32).to_le_bytes());
    bytes.extend((h_deg.to_radians() as f32).to_le_bytes());
    bytes.extend((v_deg.to_radians() as f32).to_le_bytes());
    bytes.extend(scan.range_m.iter().flat_map(|range_m| range_m.to_le_bytes()));
    Ok(fs::write(file, bytes)?)
}

#[derive(Default)]
struct Found {
    segments: usize,
    planes: usize,
    pixels: usize,
}

impl Sink for Found {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.pixels += row.runs().map(|(run, _)| run.len()).sum::<usize>();
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments += 1;
        self.planes += usize::from(segment.plane().is_some());
        ControlFlow::Continue(())
    }
}

fn run(file: &str, kind: &str, config: AnyConfig<'_>, repeat: usize) -> Result<()> {
    let bytes = fs::read(file)?;
    let words: Vec<u32> = bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let [rows, columns, h_step, v_step, ref data @ ..] = words[..] else { return Err("no scene".into()) };
    let (rows, columns) = (rows as usize, columns as usize);
    let (h_rad, v_rad) = (f32::from_bits(h_step), f32::from_bits(v_step));
    let range_m: Vec<f32> = data.iter().map(|&bits| f32::from_bits(bits)).collect();
    let beam = Columns::Even { start_rad: middle(columns, h_rad), step_rad: -h_rad };
    let beams = match kind {
        "nodding" => Beams::Nodding { columns: beam, axis: TurnAxis::Y },
        _ => Beams::Spinning { columns: beam, wraps: false },
    };
    let rows: Vec<RowBeams> = (0..rows).map(|row| (middle(rows, v_rad) - row as f32 * v_rad).into()).collect();
    segment(config, beams, &rows, &range_m, repeat)
}

fn recorded(geometry: &str, image: &str, approach: &str, repeat: usize) -> Result<()> {
    let geometry = Geometry::read(geometry)?;
    let scan = RangeImage::from_grey(&GreyImage::read(image)?, &geometry)?;
    let beams = ScanBeams::new(&geometry, scan.rows, scan.columns)?;
    let config = config(approach, ranging(geometry.range_noise_m.unwrap_or(0.01) as f32, &geometry.noise))?;
    let rows: Vec<RowBeams> = (0..scan.rows).map(|row| beams.row(row)).collect();
    segment(config, beams.beams(), &rows, &scan.range_m, repeat)
}

fn hard(scene: &str, columns: usize, config: AnyConfig<'_>, repeat: usize) -> Result<()> {
    let (_, at) = HARD.iter().find(|(name, _)| *name == scene).ok_or_else(|| format!("no scene {scene}"))?;
    let (rows, h_rad, v_rad) = (60, 160f32.to_radians() / columns as f32, 0.005);
    let range_m: Vec<f32> = (0..rows * columns).map(|i| at(i / columns, i % columns)).collect();
    let beam = Columns::Even { start_rad: middle(columns, h_rad), step_rad: -h_rad };
    let rows: Vec<RowBeams> = (0..rows).map(|row| (row as f32 * v_rad).into()).collect();
    segment(config, Beams::Nodding { columns: beam, axis: TurnAxis::Y }, &rows, &range_m, repeat)
}

/// The first of so many angles in steps, which are centred on 0.
fn middle(n: usize, step_rad: f32) -> f32 {
    (n as f32 - 1.0) / 2.0 * step_rad
}

fn segment(config: AnyConfig<'_>, beams: Beams<'_>, rows: &[RowBeams], range_m: &[f32], repeat: usize) -> Result<()> {
    let columns = range_m.len() / rows.len();
    let mut memory = OwnedMemory::new(config, columns, None);
    let mut segmenter = AnySegmenter::new(config, beams, columns, memory.memory())?;
    let mut found = Found::default();
    for _ in 0..repeat {
        found = Found::default();
        for (range_m, &row) in range_m.chunks_exact(columns).zip(rows) {
            segmenter.push_row(range_m, row, &mut found)?;
        }
        segmenter.finish(&mut found);
    }
    let Found { segments, planes, pixels } = found;
    println!("{} pixels, {pixels} of them in {segments} segments, {planes} planes", range_m.len());
    Ok(())
}
