//! How good the default is, and how far from what is possible: correct detections (Hoover, regions
//! of 30 pixels up) on the tuning and the validation scenes at 0, 5 and 10 mm of range noise,
//! beside what perfect answers would reach; the default under the troubles of real scanners; and the
//! recorded scans of `../shared/data`, where they are there: planes that are known, and of the others whether what is found is
//! found again with more noise.
//!
//! `quality` prints all, `quality default` the default on the simulated scenes and the recorded
//! scans only, `quality troubles` the table of troubles only. `quality default RULE=NUMBER ...`
//! changes tuned numbers of the default, as `tests/ablation.sh` does, and so does `quality troubles
//! RULE=NUMBER ...`.
mod troubles;

use std::collections::BTreeMap;
use std::ops::Range;
use std::path::Path;
use std::str::FromStr;
use std::sync::OnceLock;
use std::{env, error};

use scanseg_core::{PlaneConfig, Ranging, Rules};
use scanseg_formats::{Geometry, GreyImage, RangeImage};
use scanseg_sim::hoover::{Hoover, Overlaps};
use scanseg_sim::office::{Rng, SCENES, Scene, Sensor, Set, SimulatedScan};
use scanseg_sim::parallel::in_parallel;
use scanseg_sim::segmentation::{Segmentation, ranging};

const MIN_PIXELS: usize = 30;

/// Draws of noise on top of the recorded scans.
const DRAWS: u32 = 16;

/// Recorded scans of which the planes are not known.
const UNKNOWN: [(&str, &str); 3] = [
    ("ouster-os0", "range.pgm"),
    ("office-room-scan", "room_scan1.range_mm.pgm"),
    ("office1-kinect", "office1.depth_mm.pgm"),
];

/// Standard deviation of the jumps of the turn angle that the encoder does not tell: more than half
/// of a row.
const SEAMS_DEG: f64 = 0.3;

/// The tuned numbers, with those changed that the command line names.
static RULES: OnceLock<Rules> = OnceLock::new();

type Labels = fn(&RangeImage, &Geometry, &[u16]) -> Vec<u16>;

fn main() -> Result<(), Box<dyn error::Error>> {
    let part = env::args().nth(1);
    RULES.set(rules(env::args().skip(2))?).expect("set here only");
    match part.as_deref() {
        Some("troubles") => troubles::print(),
        Some("default") => {
            office(false);
            recorded()?;
        }
        _ => {
            office(true);
            troubles::print();
            recorded()?;
        }
    }
    Ok(())
}

/// The table of the numbered scenes: of `all` methods, or of the default.
fn office(all: bool) {
    let default: Labels = |ranges, geometry, _| segmented(ranges, geometry, stated(geometry, 1.0));
    let methods: &[(&str, Labels)] = &[
        ("default", default),
        ("default, servo seams", default),
        ("perfect pieces", |ranges, _, truth| pieces(ranges, truth, |_| true)),
        ("perfect edges, given back", |ranges, _, truth| edges(ranges, truth, true)),
        ("perfect edges", |ranges, _, truth| edges(ranges, truth, false)),
    ];
    println!("{:<26} {:<10} {:>5} {:>8} {:>8} {:>8} {:>8}", "", "set", "mm", "T = 0.8", "T = 0.9", "under", "noise");
    for (i, (name, labels)) in methods.iter().enumerate().filter(|(i, _)| all || *i == 0) {
        let (segments, seams_deg) = (i < 2, if i == 1 { SEAMS_DEG } else { 0.0 });
        for (set, set_name) in SETS {
            // perfect answers do not depend on the noise
            for noise_mm in [0.0, 5.0, 10.0].into_iter().take(if segments { 3 } else { 1 }) {
                let sensor = Sensor {
                    range_noise_m: noise_mm / 1e3,
                    turn_misreported_deg: seams_deg,
                    ..Sensor::nodding(200, 361)
                };
                let one = |scene| {
                    let scan = Scene::numbered(set, scene).scan(&sensor, 0).expect("a sensor that works");
                    let ranges = as_from_a_file(&scan);
                    classes(&scan.truth, &labels(&ranges, &scan.geometry, &scan.truth))
                };
                let found = of_each(0..SCENES, one);
                let Shares { good, fine, under, noise } = Shares::of(&found);
                println!("{name:<26} {set_name:<10} {noise_mm:>5} {good:>8.1} {fine:>8.1} {under:>8.3} {noise:>8.3}");
            }
        }
    }
}

const SETS: [(Set, &str); 2] = [(Set::Tuning, "tuning"), (Set::Validation, "validation")];

/// What a table says of many scans.
struct Shares {
    /// Correct detections at T = 0.8, per cent of the truth.
    good: f64,
    /// The same at T = 0.9.
    fine: f64,
    /// Instances of under-segmentation for each region of the truth, at T = 0.8.
    under: f64,
    /// Segments that are noise for each region of the truth, at T = 0.8.
    noise: f64,
}

impl Shares {
    fn of(found: &[[Hoover; 2]]) -> Shares {
        let sum = |count: fn(&Hoover) -> usize, at: usize| found.iter().map(|f| count(&f[at])).sum::<usize>() as f64;
        let truth = sum(|h| h.truth_regions, 0);
        let [good, fine] = [0, 1].map(|at| 100.0 * sum(|h| h.correct, at) / truth);
        Shares { good, fine, under: sum(|h| h.under_segmented, 0) / truth, noise: sum(|h| h.noise, 0) / truth }
    }
}

fn rules(changes: impl Iterator<Item = String>) -> Result<Rules, Box<dyn error::Error>> {
    fn set<T: FromStr<Err: error::Error + 'static>>(to: &mut T, number: &str) -> Result<(), Box<dyn error::Error>> {
        *to = number.parse()?;
        Ok(())
    }
    let mut rules = Rules::TUNED;
    for change in changes {
        match change.split_once('=').ok_or("RULE=NUMBER is wanted")? {
            ("least_noise_m", number) => set(&mut rules.least_noise_m, number)?,
            ("least_beam_rad", number) => set(&mut rules.least_beam_rad, number)?,
            ("leave_price", number) => set(&mut rules.leave_price, number)?,
            ("line_price", number) => set(&mut rules.line_price, number)?,
            ("gap_columns", number) => set(&mut rules.gap_columns, number)?,
            ("chance", number) => set(&mut rules.chance, number)?,
            ("uneven", number) => set(&mut rules.uneven, number)?,
            ("bent", number) => set(&mut rules.bent, number)?,
            ("rougher", number) => set(&mut rules.rougher, number)?,
            ("rough", number) => set(&mut rules.rough, number)?,
            ("gap_points", number) => set(&mut rules.gap_points, number)?,
            ("hidden", number) => set(&mut rules.hidden, number)?,
            ("ring_prior_m", number) => set(&mut rules.ring_prior_m, number)?,
            ("seam_uneven", number) => set(&mut rules.seam_uneven, number)?,
            ("turn_prior_rad", number) => set(&mut rules.turn_prior_rad, number)?,
            ("bend_step", number) => set(&mut rules.bend_step, number)?,
            ("most_wobble", number) => set(&mut rules.most_wobble, number)?,
            ("wobble", number) => set(&mut rules.wobble, number)?,
            ("seam_rad", number) => set(&mut rules.seam_rad, number)?,
            ("turn_gain", number) => set(&mut rules.turn_gain, number)?,
            ("turn_other", number) => set(&mut rules.turn_other, number)?,
            ("noise_less", number) => set(&mut rules.noise_less, number)?,
            ("noise_trust", number) => set(&mut rules.noise_trust, number)?,
            ("noise_most", number) => set(&mut rules.noise_most, number)?,
            (rule, _) => return Err(format!("no rule {rule}").into()),
        }
    }
    Ok(rules)
}

/// One for each number, on all cores.
fn of_each<T: Send>(numbers: Range<u32>, one: impl Fn(u32) -> T + Sync) -> Vec<T> {
    in_parallel(numbers.len(), |i| one(numbers.start + i as u32))
}

/// The ranges as they would be read.
fn as_from_a_file(scan: &SimulatedScan) -> RangeImage {
    let SimulatedScan { rows, columns, range_m, geometry, .. } = scan;
    let ranges = RangeImage { rows: *rows, columns: *columns, range_m: range_m.clone() };
    RangeImage::from_grey(&ranges.to_grey(geometry).expect("ranges that fit"), geometry).expect("an image that fits")
}

/// What a geometry states, with so many times its constant noise.
fn stated(geometry: &Geometry, factor: f64) -> Ranging {
    ranging((geometry.range_noise_m.unwrap_or(0.0) * factor) as f32, &geometry.noise)
}

/// The classes at T = 0.8 and 0.9.
fn classes(truth: &[u16], labels: &[u16]) -> [Hoover; 2] {
    let overlaps = Overlaps::new(truth, labels, MIN_PIXELS).expect("one label per pixel");
    [0.8, 0.9].map(|tolerance| overlaps.at(tolerance).expect("a tolerance within range"))
}

fn segmented(ranges: &RangeImage, geometry: &Geometry, mut ranging: Ranging) -> Vec<u16> {
    ranging.min_range_m = geometry.min_range_m.map_or(ranging.min_range_m, |m| m as f32);
    let config = PlaneConfig::new(ranging).with_rules(RULES.get().expect("set at the start"));
    let found = Segmentation::of(ranges, geometry, config, None, || ()).expect("a scan that fits");
    found.numbers(MIN_PIXELS as u32).iter().map(|&number| number as u16).collect()
}

/// The 4-connected pieces of the truth, of the pixels that are `kept`.
fn pieces(ranges: &RangeImage, truth: &[u16], kept: impl Fn(usize) -> bool) -> Vec<u16> {
    let mut labels = vec![0; truth.len()];
    let mut last = 0;
    for first in 0..truth.len() {
        if truth[first] == 0 || labels[first] != 0 || !kept(first) {
            continue;
        }
        last += 1;
        labels[first] = last;
        let mut open = vec![first];
        while let Some(pixel) = open.pop() {
            for other in neighbours(ranges, pixel) {
                if truth[other] == truth[pixel] && labels[other] == 0 && kept(other) {
                    labels[other] = last;
                    open.push(other);
                }
            }
        }
    }
    labels
}

/// The pieces between pixels that have a neighbour on another surface; those pixels belong to
/// nobody, or are given back.
fn edges(ranges: &RangeImage, truth: &[u16], given_back: bool) -> Vec<u16> {
    let inner = |pixel: usize| neighbours(ranges, pixel).all(|other| truth[other] == truth[pixel]);
    let mut labels = pieces(ranges, truth, inner);
    loop {
        let take = |pixel: usize| neighbours(ranges, pixel).find(|&o| labels[o] != 0 && truth[o] == truth[pixel]);
        let free = (0..truth.len()).filter(|&pixel| labels[pixel] == 0 && truth[pixel] != 0);
        let given: Vec<_> = free.filter_map(|pixel| Some((pixel, labels[take(pixel)?]))).collect();
        if given.is_empty() || !given_back {
            return labels;
        }
        given.into_iter().for_each(|(pixel, label)| labels[pixel] = label);
    }
}

fn neighbours(ranges: &RangeImage, pixel: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (pixel / ranges.columns, pixel % ranges.columns);
    let (rows, columns) = (ranges.rows, ranges.columns);
    [(row.wrapping_sub(1), column), (row + 1, column), (row, column.wrapping_sub(1)), (row, column + 1)]
        .into_iter()
        .filter(move |&(row, column)| row < rows && column < columns)
        .map(move |(row, column)| row * columns + column)
}

fn recorded() -> Result<(), Box<dyn error::Error>> {
    let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/data"));
    let read = |folder: &str, image: &str, geometry: &str| -> Result<_, Box<dyn error::Error>> {
        let geometry = Geometry::read(data.join(folder).join(geometry))?;
        let ranges = RangeImage::from_grey(&GreyImage::read(data.join(folder).join(image))?, &geometry)?;
        Ok((ranges, geometry))
    };
    let (corridor, synpeb) = ("tilting-sick-corridor", "synpeb");
    for scan in ["scan000", "scan001"] {
        if !data.join(corridor).is_dir() {
            println!("skipped: {corridor} is absent");
            break;
        }
        let (ranges, geometry) = read(corridor, &format!("{scan}.range_mm.pgm"), "geometry.toml")?;
        let planes = GreyImage::read(data.join(corridor).join(format!("{scan}.planes.pgm")))?.values;
        let overlaps =
            |ranges: &RangeImage| best_overlaps(&planes, &segmented(ranges, &geometry, stated(&geometry, 1.0)), 3000);
        let mean = |best: &[f64]| best.iter().sum::<f64>() / best.len() as f64;
        let best = overlaps(&ranges);
        println!("{corridor} {scan}: mean best overlap {:.3} of {best:.2?}", mean(&best));
        let drawn = of_each(0..DRAWS, |draw| mean(&overlaps(&noisier(&ranges, draw, 0.0005))));
        println!("{corridor} {scan}: {:.3} on average of {DRAWS} draws of half a millimetre of noise", mean(&drawn));
    }
    if data.join(synpeb).is_dir() {
        let (ranges, geometry) = read(synpeb, "test_100.range_100um.pgm", "test_100.geometry.toml")?;
        let labels = segmented(&ranges, &geometry, stated(&geometry, 1.0));
        let truth = GreyImage::read(data.join(synpeb).join("test_100.gt_labels.pgm"))?.values;
        let truth: Vec<u16> = truth.iter().map(|&id| if id < 10 { 0 } else { id }).collect();
        let [at, _] = classes(&truth, &labels);
        println!("{synpeb}: {} of {} correct at T = 0.8", at.correct, at.truth_regions);
    } else {
        println!("skipped: {synpeb} is absent");
    }
    // of these nobody knows the truth: whether what is found is found again
    for (folder, image) in UNKNOWN {
        if !data.join(folder).is_dir() {
            println!("skipped: {folder} is absent");
            continue;
        }
        let (ranges, geometry) = read(folder, image, "geometry.toml")?;
        let labels = |ranges: &RangeImage| segmented(ranges, &geometry, stated(&geometry, 1.0));
        let found = labels(&ranges);
        let again = |draw| best_overlaps(&found, &labels(&noisier(&ranges, draw, 0.004)), 1000);
        let drawn: Vec<f64> = of_each(0..DRAWS, again).concat();
        let good = drawn.iter().filter(|&&overlap| overlap > 0.8).count();
        println!(
            "{folder}: of {} segments of 1000 pixels or more {:.2} come again, to 0.8, in {DRAWS} draws of 4 mm of noise",
            drawn.len() / DRAWS as usize,
            good as f64 / drawn.len() as f64
        );
    }
    Ok(())
}

/// Returns the ranges with more noise, of this standard deviation: the figures of one scan move by 0.05 with any constant.
fn noisier(ranges: &RangeImage, draw: u32, sd_m: f64) -> RangeImage {
    let mut rng = Rng::new([u64::from(draw), 0, 0]);
    let noisy = |&range_m: &f32| if range_m > 0.0 { range_m + (sd_m * rng.normal()) as f32 } else { range_m };
    RangeImage { range_m: ranges.range_m.iter().map(noisy).collect(), ..*ranges }
}

/// For each plane of so many pixels the intersection over union of the segment that fits best;
/// pixels on no plane do not count.
fn best_overlaps(planes: &[u16], labels: &[u16], pixels: u32) -> Vec<f64> {
    let (mut plane_of, mut segment_of, mut both) = (BTreeMap::new(), BTreeMap::new(), BTreeMap::new());
    for (&plane, &label) in planes.iter().zip(labels).filter(|(plane, _)| **plane != 0) {
        *plane_of.entry(plane).or_insert(0u32) += 1;
        *segment_of.entry(label).or_insert(0u32) += 1;
        *both.entry((plane, label)).or_insert(0u32) += 1;
    }
    let best = |plane: u16, size: u32| {
        let of_plane = both.iter().filter(|((p, label), _)| *p == plane && *label != 0);
        of_plane.map(|((_, label), &n)| f64::from(n) / f64::from(size + segment_of[label] - n)).fold(0.0, f64::max)
    };
    plane_of.iter().filter(|(_, size)| **size >= pixels).map(|(&plane, &size)| best(plane, size)).collect()
}
