//! What the page works on: a scan, and its segmentation.

use scanseg_core::{AnyConfig, Approach};
use scanseg_formats::{CameraOptions, FileError, Geometry, RangeImage, ReadOptions, Scan, ScanError, ScanFile};
use scanseg_sim::export::point_m;
use scanseg_sim::office::{Scene, Sensor, SensorError, Set};
use scanseg_sim::overview::{View, usual_ranges_m};
use scanseg_sim::segmentation::{SegmentationError, numbered, ranging_of, usual_config};
use scanseg_sim::view::{ToldSegment, palette};
use serde::Serialize;

use crate::live::Live;
use crate::told::{ToldError, ToldScan, ToldState};

/// Smaller segments are not listed, as by the command.
const MIN_PIXELS: u32 = 30;
/// The noise is told at this range, metres.
const TOLD_RANGE_M: f32 = 3.0;

/// What the page works on.
#[derive(Default)]
pub struct Page {
    inputs: [Vec<u8>; 4],
    scan: Option<Scan>,
    live: Option<Live>,
    text: String,
    array: Vec<u8>,
}

impl Page {
    /// Returns where `length` bytes of an input may be written; see `input` of the interface.
    pub fn input(&mut self, which: usize, length: usize) -> *mut u8 {
        let input = &mut self.inputs[which];
        *input = vec![0; length];
        input.as_mut_ptr()
    }

    /// Makes a scan of the simulated office, as `scanseg demo` does.
    pub fn office(&mut self, number: u32, range_noise_m: f64) {
        let name = format!("simulated office {number}");
        let scan = simulated(name, number, range_noise_m).map_err(|e| e.to_string());
        self.take(scan);
    }

    /// Reads the scan of the inputs.
    pub fn read(&mut self, fx_px: f64) {
        let [file, name, geometry, geometry_name] = std::mem::take(&mut self.inputs);
        let text = |bytes: Vec<u8>| String::from_utf8_lossy(&bytes).into_owned();
        let with_geometry = !geometry.is_empty();
        let options = ReadOptions {
            geometry: with_geometry.then(|| text(geometry_name).into()),
            geometry_text: with_geometry.then(|| text(geometry)),
            camera: CameraOptions { fx_px: (fx_px > 0.0).then_some(fx_px), ..CameraOptions::default() },
            ..ReadOptions::default()
        };
        let scan = ScanFile::of_bytes(&text(name), &file, &options).and_then(|mut file| file.frame(0));
        self.take(scan.map_err(|e| said(&e)));
    }

    fn take(&mut self, scan: Result<Scan, String>) {
        match scan {
            Ok(scan) => {
                self.live = None;
                self.tell(&told(&scan));
                self.scan = Some(scan);
            }
            Err(error) => self.tell(&ToldError { error }),
        }
    }

    /// Begins to segment the scan.
    pub fn begin(&mut self, approach: u32, range_noise_m: f64) {
        let Some(scan) = &self.scan else { return };
        let approach = [Approach::Plane, Approach::Edge, Approach::Region][approach as usize % 3];
        let begun = Live::new(scan, config(scan, approach, (range_noise_m >= 0.0).then_some(range_noise_m)));
        match begun {
            Ok(live) => {
                self.live = Some(live);
                self.tell_state();
            }
            Err(e) => self.refuse(&e),
        }
    }

    /// Pushes up to so many rows.
    pub fn push(&mut self, rows: usize) {
        let (Some(scan), Some(live)) = (&self.scan, &mut self.live) else { return };
        match live.push(scan, rows) {
            Ok(()) => self.tell_state(),
            Err(e) => self.refuse(&e),
        }
    }

    fn refuse(&mut self, e: &SegmentationError) {
        self.live = None;
        self.tell(&ToldError { error: e.to_string() });
    }

    fn tell_state(&mut self) {
        let Some(live) = &self.live else { return };
        let listed = live.segments().into_iter().take_while(|segment| segment.pixels() >= MIN_PIXELS);
        self.tell(&ToldState {
            row: live.row,
            complete: live.is_complete(),
            noise_m: live.noise_m(TOLD_RANGE_M),
            segments: listed.map(|segment| ToldSegment::of(&segment)).collect(),
        });
    }

    fn tell(&mut self, what: &impl Serialize) {
        self.text = serde_json::to_string(what).unwrap_or_default();
    }

    /// Returns what the last call told.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// Returns where an array is; see `array` of the interface.
    pub fn array(&mut self, which: usize) -> *const u8 {
        let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect();
        let Some(scan) = &self.scan else { return self.array.as_ptr() };
        let metres = |metres: f32| metres.to_le_bytes();
        let RangeImage { columns, range_m, .. } = &scan.image;
        self.array = match (which, &self.live) {
            (0, _) => range_m.iter().copied().flat_map(metres).collect(),
            (1, _) => {
                let point = |(i, range_m): (usize, &f32)| match *range_m > 0.0 {
                    true => point_m(&scan.geometry, i / columns, i % columns, *range_m).map(|x| x as f32),
                    false => [f32::NAN; 3],
                };
                range_m.iter().enumerate().flat_map(point).flat_map(metres).collect()
            }
            (2, Some(live)) => words(&live.labels()),
            (_, Some(live)) => words(&numbered(&live.labels(), &live.segments(), MIN_PIXELS)),
            (_, None) => vec![0; 4 * range_m.len()],
        };
        self.array.as_ptr()
    }
}

/// Returns what is wrong with a file, in terms of the page.
fn said(e: &FileError) -> String {
    match e.cause.downcast_ref() {
        Some(ScanError::NoGeometry) => format!(
            "{}: an image alone does not say where its pixels look: drop its geometry file (TOML, or the camera's YAML or \
             JSON) together with it, or give the focal length",
            e.path.display()
        ),
        _ => e.to_string(),
    }
}

fn simulated(name: String, number: u32, range_noise_m: f64) -> Result<Scan, SensorError> {
    let sensor = Sensor { range_noise_m, ..Sensor::nodding(200, 361) };
    let simulated = Scene::numbered(Set::Tuning, number).scan(&sensor, u64::from(number))?;
    let image = RangeImage { rows: simulated.rows, columns: simulated.columns, range_m: simulated.range_m };
    // as from a file, in counts
    let grey = image.to_grey(&simulated.geometry).expect("the ranges of an office are within 16 bits");
    let image = RangeImage::from_grey(&grey, &simulated.geometry).expect("its own geometry");
    let measured = image.range_m.iter().filter(|range_m| **range_m > 0.0).count();
    Ok(Scan { name, image, geometry: simulated.geometry, measured, remarks: vec![] })
}

fn told(scan: &Scan) -> ToldScan<'_> {
    let RangeImage { rows, columns, range_m } = &scan.image;
    let View { transpose, flip, mirror } = View::of(&scan.geometry, *rows, *columns);
    let (near_m, far_m) = usual_ranges_m(&scan.image);
    ToldScan {
        name: &scan.name,
        rows: *rows,
        columns: *columns,
        returns: range_m.iter().filter(|range_m| **range_m > 0.0).count(),
        remarks: &scan.remarks,
        range_noise_m: scan.geometry.range_noise_m.unwrap_or(0.0),
        transpose,
        flip,
        mirror,
        palette: palette(),
        near_m,
        far_m,
    }
}

fn config(scan: &Scan, approach: Approach, range_noise_m: Option<f64>) -> AnyConfig<'static> {
    let stated = Geometry { range_noise_m: range_noise_m.or(scan.geometry.range_noise_m), ..scan.geometry.clone() };
    usual_config(approach, ranging_of(&stated, approach))
}
