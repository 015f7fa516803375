//! The core alone on one scene, for counting its instructions (`tests/instructions.sh`).
//!
//! `cost make ROWS COLUMNS nodding|spinning FILE` writes a scene of the simulated office; `cost run
//! FILE nodding|spinning plane|edge|region REPEAT` segments it so many times and prints what it
//! found.
//!
//! A scene file is little endian: u32 rows, u32 columns, f32 column step, f32 row step (radians),
//! then rows x columns f32 ranges in metres, 0 for none; rows and columns centred on straight
//! ahead, the first row up, the first column left.
use std::ops::ControlFlow;
use std::{env, error, fs};

use scanseg_core::{
    AnyConfig, AnySegmenter, Beams, Columns, EdgeConfig, LabelRow, PlaneConfig, RegionConfig, Segment, Segmenter, Sink,
    TurnAxis,
};
use scanseg_formats::{Angles, Kind};
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_sim::segmentation::OwnedMemory;

fn main() -> Result<(), Box<dyn error::Error>> {
    let args: Vec<String> = env::args().skip(1).collect();
    match args.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["make", rows, columns, kind, file] => make(rows.parse()?, columns.parse()?, kind, file),
        ["run", file, kind, "plane", repeat] => run(PlaneConfig::new(EdgeConfig::paper().ranging).into(), file, kind, repeat.parse()?),
        ["run", file, kind, "edge", repeat] => run(EdgeConfig::paper().into(), file, kind, repeat.parse()?),
        ["run", file, kind, "region", repeat] => run(RegionConfig::paper().into(), file, kind, repeat.parse()?),
        _ => Err(
            "usage: cost make ROWS COLUMNS nodding|spinning FILE | cost run FILE nodding|spinning plane|edge|region REPEAT"
                .into(),
        ),
    }
}

fn make(rows: usize, columns: usize, kind: &str, file: &str) -> Result<(), Box<dyn error::Error>> {
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

fn run(config: AnyConfig<'_>, file: &str, kind: &str, repeat: usize) -> Result<(), Box<dyn error::Error>> {
    let bytes = fs::read(file)?;
    let words: Vec<u32> = bytes.as_chunks().0.iter().map(|word| u32::from_le_bytes(*word)).collect();
    let [rows, columns, h_step, v_step, ref data @ ..] = words[..] else { return Err("no scene".into()) };
    let (rows, columns) = (rows as usize, columns as usize);
    let (h_rad, v_rad) = (f32::from_bits(h_step), f32::from_bits(v_step));
    let range_m: Vec<f32> = data.iter().map(|&bits| f32::from_bits(bits)).collect();
    let start = |n: usize, step: f32| (n as f32 - 1.0) / 2.0 * step;
    let beam = Columns::Even { start_rad: start(columns, h_rad), step_rad: -h_rad };
    let beams = match kind {
        "nodding" => Beams::Nodding { columns: beam, axis: TurnAxis::Y },
        _ => Beams::Spinning { columns: beam, wraps: false },
    };
    let mut memory = OwnedMemory::new(config, columns, None);
    let mut segmenter = AnySegmenter::new(config, beams, columns, memory.memory())?;
    let mut found = Found::default();
    for _ in 0..repeat {
        found = Found::default();
        for (row, range_m) in range_m.chunks_exact(columns).enumerate() {
            segmenter.push_row(range_m, start(rows, v_rad) - row as f32 * v_rad, &mut found)?;
        }
        segmenter.finish(&mut found);
    }
    println!("{} segments, {} planes, {} of {} pixels", found.segments, found.planes, found.pixels, rows * columns);
    Ok(())
}
