//! The scan that is sent: telegrams of the scanner, and where the tilt stands.

use std::path::Path;

use scanseg_firmware::run::{ASK_FOR_FIGURES, ROW_RAD};
use scanseg_formats::{Angles, GreyImage, Kind};
use scanseg_hal::lms2xx::{SCAN_LINE, Settings, Unit};
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_virtual_rig::telegrams::{frame, scan_payload};

use crate::Result;

/// Telegrams' times of silence before the scan, for the tilt to be sampled, and after it, for the
/// scan to end.
const LEAD: usize = 2;
const TRAIL: usize = 8;
/// Turn angle of the first row, radians.
const FIRST_RAD: f32 = -48.70 / 180.0 * core::f32::consts::PI;

/// Rows of each hard scene.
const HARD_ROWS: usize = 20;

/// Even numbers, 0 to 1, the same in every run.
fn uniform(a: usize, b: usize) -> f64 {
    let mut x = (a as u64) << 32 ^ b as u64;
    for _ in 0..2 {
        x = (x ^ x >> 31).wrapping_mul(0xBF58_476D_1CE4_E5B9).wrapping_add(0x9E37_79B9_7F4A_7C15);
    }
    (x >> 40) as f64 / f64::from(1 << 24)
}

const RECORDED: &str = "recorded corridor";

/// Rows of value words as the scanner sends them, 0.5 degree apart; their codes for "no return"
/// still in.
pub struct Recording {
    pub name: &'static str,
    rows: Vec<Vec<u16>>,
}

impl Recording {
    /// The recorded corridor, or where it is absent a simulated office.
    pub fn load() -> Result<Self> {
        let data = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../../shared/data/tilting-sick-corridor"));
        if !data.exists() {
            let absent = data.display();
            println!(
                "skipped: the recorded corridor (no {absent}); an office instead, without ceilings of instructions"
            );
            return Self::office();
        }
        let image = GreyImage::read(data.join("scan000.range_mm.pgm"))?;
        let rows = image.values.chunks(image.columns).map(<[u16]>::to_vec).collect();
        Ok(Self { name: RECORDED, rows })
    }

    fn office() -> Result<Self> {
        let mut sensor = Sensor::nodding(226, 361);
        sensor.range_noise_m = 0.001;
        if let Kind::Nodding { turn_deg, .. } = &mut sensor.kind {
            let degrees = |rad: f32| f64::from(rad).to_degrees();
            *turn_deg = Angles::Even { start_deg: degrees(FIRST_RAD), step_deg: degrees(ROW_RAD) };
        }
        let scan = Scene::numbered(Set::Tuning, 0).scan(&sensor, 1)?;
        let words = scan.range_m.iter().map(|range_m| match (range_m * 1000.0).round() as u16 {
            0 => 0x7FFF,
            range_mm => range_mm,
        });
        let words: Vec<u16> = words.collect();
        Ok(Self { name: "simulated office", rows: words.chunks(361).map(<[u16]>::to_vec).collect() })
    }

    /// Scenes that make much work, those of `tests/instructions.sh`, one below the other: leaves,
    /// combs, a chess-board, noise.
    pub fn hard() -> Self {
        let leaf = |row: usize, column: usize| match uniform(row / 3, column / 5) {
            leaf if leaf < 0.3 => 12.0 + uniform(row, column),
            leaf => 2.0 + 6.0 * leaf + 0.2 * uniform(row, column),
        };
        let comb = |_, column: usize| if (column / 3).is_multiple_of(2) { 2.0 } else { 4.0 };
        let chess = |row: usize, column: usize| if (row + column).is_multiple_of(2) { 2.0 } else { 0.0 };
        let noise = |row, column| 1.0 + 4.0 * uniform(row, column);
        let scenes: [&dyn Fn(usize, usize) -> f64; 4] = [&leaf, &comb, &chess, &noise];
        let word = |range_m: f64| if range_m > 0.0 { (range_m * 1000.0) as u16 } else { 0x7FFF };
        let row = |at: usize| (0..361).map(|column| word(scenes[at / HARD_ROWS](at, column))).collect();
        Self { name: "hard scenes", rows: (0..4 * HARD_ROWS).map(row).collect() }
    }

    pub fn is_recorded(&self) -> bool {
        self.name == RECORDED
    }

    pub fn rows(&self) -> usize {
        self.rows.len()
    }

    /// All that the scanner sends, for the variant set up: silence, the scan, silence, the request
    /// for the figures.
    pub fn stream(&self, settings: &Settings) -> Vec<u8> {
        let columns = usize::from(settings.variant.columns());
        let every = 360 / (columns - 1);
        let silence = vec![0; 2 * columns + 10];
        let mut stream = silence.repeat(LEAD);
        for row in &self.rows {
            let mut row: Vec<u16> = row.iter().step_by(every).copied().collect();
            // the recording lacks the last column
            row.resize(columns, 0x7FFF);
            stream.extend(telegram(&row));
        }
        stream.extend(silence.repeat(TRAIL));
        stream.extend(ASK_FOR_FIGURES);
        stream
    }

    /// Turns of the tilt at a time by the clock of the images.
    pub fn tilt_turns(settings: &Settings, time_us: u64) -> f64 {
        let rows = time_us as f64 / f64::from(settings.period_us()) - LEAD as f64;
        (f64::from(FIRST_RAD) + rows * f64::from(ROW_RAD)) / std::f64::consts::TAU
    }
}

/// The telegram of a complete scan line in millimetres, by a scanner without faults.
fn telegram(words: &[u16]) -> Vec<u8> {
    let millimetres = u16::from(Unit::Millimetre.code()) << 14;
    frame(&scan_payload(&[SCAN_LINE], words.len() as u16 | millimetres, words, &[], 0x10))
}
