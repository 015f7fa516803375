//! `scanseg office`: the simulated scenes as files.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use scanseg_formats::{GreyImage, RangeImage};
use scanseg_sim::office::{SCENES, Scene, Sensor, Set, SimulatedScan};
use scanseg_sim::overview::truth_and_depth;

use crate::command::output::{Failure, Files, print, write};
use crate::command::scene_set::SetName;

/// Write simulated offices with their ground truth
///
/// For scene N of a set: SET-NN.pgm (range image), SET-NN-truth.pgm (surface ids, 0 without a
/// return) and SET-NN.png (truth and depth side by side); and geometry.toml, the same for all.
#[derive(Args)]
pub struct Arguments {
    /// Folder for the files; made if it is not there
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// Which of the two sets of scenes
    #[arg(long, value_enum, default_value = "tuning")]
    set: SetName,
    /// Standard deviation of one range, metres
    #[arg(long, value_name = "M", default_value_t = 0.0, allow_negative_numbers = true)]
    noise_m: f64,
    /// The scanner: nodding 200 x 361, spinning 128 x 1024, pinhole 240 x 320 pixels
    #[arg(long, value_enum, default_value = "nodding")]
    sensor: SensorName,
    /// Only this scene; from 25 on further ones of the same kinds [default: 0 to 24]
    #[arg(long, value_name = "N")]
    scene: Option<u32>,
}

#[derive(Clone, Copy, ValueEnum)]
enum SensorName {
    /// A 2D scanner that nods
    Nodding,
    /// All round
    Spinning,
    /// A depth camera
    Pinhole,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let set = arguments.set.set();
    let set_name = match set {
        Set::Tuning => "tuning",
        Set::Validation => "validation",
    };
    let sensor = match arguments.sensor {
        SensorName::Nodding => Sensor::nodding(200, 361),
        SensorName::Spinning => Sensor::spinning(128, 1024),
        SensorName::Pinhole => Sensor::pinhole(240, 320),
    };
    let sensor = Sensor { range_noise_m: arguments.noise_m, ..sensor };
    let scenes = arguments.scene.map_or(0..=SCENES - 1, |scene| scene..=scene);
    let mut files = Files::new();
    let mut geometry_toml = String::new();
    for number in scenes.clone() {
        let SimulatedScan { rows, columns, range_m, truth, geometry } =
            Scene::numbered(set, number).scan(&sensor, 0)?;
        let ranges = RangeImage { rows, columns, range_m };
        let name = format!("{set_name}-{number:02}");
        let image = ranges.to_grey(&geometry).map_err(|e| format!("{name}: {e}"))?;
        let picture = truth_and_depth(&ranges, &geometry, &truth);
        let truth = GreyImage { rows, columns, max_value: 65535, values: truth };
        files.push((format!("{name}.pgm"), image.to_pgm()));
        files.push((format!("{name}-truth.pgm"), truth.to_pgm()));
        files.push((format!("{name}.png"), picture.to_png()));
        geometry_toml = geometry.to_toml();
    }
    files.push(("geometry.toml".to_string(), geometry_toml.into_bytes()));
    write(&arguments.out, &files)?;
    print(&format!("{} {set_name} scenes, {} x {} pixels\n", scenes.count(), sensor.rows, sensor.columns))
}
