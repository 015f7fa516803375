//! The default under the troubles of real scanners, on scenes beyond the usual ones.

use std::ops::Range;

use scanseg_core::Ranging;
use scanseg_sim::office::{Missing, Scene, Sensor, Set, Trouble};

use crate::{SETS, Shares, as_from_a_file, classes, of_each, segmented, stated};

/// Scenes of each set: those after the usual ones.
const SCENES: Range<u32> = 25..37;

/// A line of the table: scenes, sensor, what goes wrong, and what is said of it.
struct Line {
    name: &'static str,
    scene: fn(Set, u32) -> Scene,
    sensor: Sensor,
    trouble: Trouble,
    /// The constant noise that is stated, over the true one.
    stated: f64,
    /// Further changes of what is stated.
    said: fn(Ranging) -> Ranging,
}

impl Line {
    /// An office at 5 mm of noise, all of it said.
    fn new(name: &'static str, trouble: Trouble) -> Line {
        Line {
            name,
            scene: Scene::numbered,
            sensor: noisy(Sensor::nodding(200, 361)),
            trouble,
            stated: 1.0,
            said: |r| r,
        }
    }

    fn stated(name: &'static str, factor: f64) -> Line {
        Line { stated: factor, ..Line::new(name, Trouble::None) }
    }

    fn missing(name: &'static str, missing: Missing) -> Line {
        Line::new(name, Trouble::Missing(missing))
    }
}

fn noisy(sensor: Sensor) -> Sensor {
    Sensor { range_noise_m: 0.005, ..sensor }
}

fn lines() -> Vec<Line> {
    let nodding = || Sensor::nodding(200, 361);
    let spinning = || noisy(Sensor::spinning(128, 1024));
    let grown = Trouble::GrowingNoise { constant_m: 0.001, per_m2: 0.0015 };
    let steps = Trouble::DisparitySteps { step_per_m: 0.00285, noise_per_m: 0.0005, alike_px: 1 };
    let camera = || Sensor::pinhole(480, 640);
    let patches = Trouble::DisparitySteps { step_per_m: 0.00285, noise_per_m: 0.00116, alike_px: 5 };
    let constant: fn(Ranging) -> Ranging = |_| Ranging::new(0.004);
    let silent: fn(Ranging) -> Ranging = |_| Ranging::new(0.0);
    let rings = Trouble::RingOffsets { sd_m: 0.02 };
    let off = Trouble::TurnOff { sd_deg: 0.3 };
    let rough = Trouble::RoughGround { sd_m: 0.02, patch_m: 0.2 };
    let millimetres = Sensor { quantisation_m: 0.001, ..noisy(nodding()) };
    vec![
        Line::new("5 mm", Trouble::None),
        Line::stated("noise stated at 0.3 of it", 0.3),
        Line::stated("noise stated at 0.5 of it", 0.5),
        Line::stated("noise stated twice", 2.0),
        Line::stated("noise stated 3 times", 3.0),
        Line::stated("noise not stated", 0.0),
        Line::new("1 mm + 1.5 mm r^2, stated", grown),
        Line { said: silent, ..Line::new("1 mm + 1.5 mm r^2, unsaid", grown) },
        Line::new("steps 2.85 mm r^2, stated", steps),
        Line { said: silent, ..Line::new("steps 2.85 mm r^2, unsaid", steps) },
        Line { sensor: camera(), ..Line::new("Kinect v1, stated", patches) },
        Line { sensor: camera(), said: constant, ..Line::new("Kinect v1, 4 mm stated", patches) },
        Line { sensor: camera(), said: silent, ..Line::new("Kinect v1, unsaid", patches) },
        Line { sensor: noisy(camera()), ..Line::new("camera 480 x 640", Trouble::None) },
        Line::new("mixed pixels, 30 % of edges", Trouble::MixedPixels { probability: 0.3 }),
        Line::new("turns 0.3 deg off, unsaid", off),
        Line { said: |r| r.with_turn_noise_rad(0.3 * RADIAN), ..Line::new("turns 0.3 deg off, stated", off) },
        Line::new("bearings times 1.01", Trouble::BearingScale(1.01)),
        Line::new("bearings times 1.03", Trouble::BearingScale(1.03)),
        Line::new("bearings times 0.98", Trouble::BearingScale(0.98)),
        Line::new("turns times 1.03", Trouble::TurnScale(1.03)),
        Line::missing("every second column missing", Missing::Columns),
        Line::missing("every second row missing", Missing::Rows),
        Line::missing("a chess-board missing", Missing::Chess),
        Line::missing("60 % missing", Missing::Share(0.6)),
        Line { sensor: noisy(Sensor::nodding(400, 721)), ..Line::new("400 x 721", Trouble::None) },
        Line { sensor: spinning(), ..Line::new("spinning 128 x 1024", Trouble::None) },
        Line { sensor: spinning(), said: silent, ..Line::new("spinning 128 x 1024, unsaid", Trouble::None) },
        Line { sensor: spinning(), ..Line::new("spinning, rings 20 mm off", rings) },
        Line { sensor: noisy(nodding()).from_below(), ..Line::new("from below", Trouble::None) },
        Line {
            scene: |set, number| Scene::numbered(set, number).squared(),
            ..Line::new("walls square", Trouble::None)
        },
        Line { scene: Scene::hall, sensor: millimetres.clone(), ..Line::new("hall, 30 m", Trouble::None) },
        Line {
            scene: Scene::hall,
            sensor: millimetres.clone(),
            said: silent,
            ..Line::new("hall, 30 m, unsaid", Trouble::None)
        },
        Line::new("rough ground, 20 mm", rough),
        Line { scene: Scene::attic, ..Line::new("attic with stairs", Trouble::None) },
        Line { scene: Scene::street, sensor: millimetres.clone(), ..Line::new("street, trees", Trouble::None) },
        Line {
            scene: Scene::street,
            sensor: millimetres.clone(),
            said: silent,
            ..Line::new("street, trees, unsaid", Trouble::None)
        },
        Line { scene: Scene::street, sensor: millimetres, ..Line::new("street, rough road, 20 mm", rough) },
    ]
}

/// Radians in a degree.
const RADIAN: f32 = std::f32::consts::PI / 180.0;

/// Prints the table. The last two columns are for the truth with one region for each plane.
pub fn print() {
    println!(
        "{:<30} {:<10} {:>8} {:>8} {:>8} {:>8} {:>10} {:>8}",
        "", "set", "T = 0.8", "T = 0.9", "under", "noise", "planes 0.8", "0.9"
    );
    for line in lines() {
        for (set, set_name) in SETS {
            let one = |number| {
                let scene = (line.scene)(set, number);
                let scan = scene.troubled_scan(&line.sensor, line.trouble, 0).expect("a sensor that works");
                let ranging = (line.said)(stated(&scan.geometry, line.stated));
                let labels = segmented(&as_from_a_file(&scan), &scan.geometry, ranging);
                (classes(&scan.truth, &labels), classes(&scene.planes_of(&scan.truth), &labels))
            };
            let (surfaces, planes): (Vec<_>, Vec<_>) = of_each(SCENES, one).into_iter().unzip();
            let Shares { good, fine, under, noise } = Shares::of(&surfaces);
            let planes = Shares::of(&planes);
            println!(
                "{:<30} {set_name:<10} {good:>8.1} {fine:>8.1} {under:>8.3} {noise:>8.3} {:>10.1} {:>8.1}",
                line.name, planes.good, planes.fine
            );
        }
    }
}
