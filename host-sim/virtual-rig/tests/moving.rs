//! What the turn angle of each beam buys in the rig: a scanner in steps of half a degree, two mirror
//! turns a row, on a tilt that moves at 0.5 rad/s above a floor.

use std::cell::RefCell;
use std::f64::consts::TAU;
use std::rc::Rc;

use scanseg_core::{Finished, PushError, RowBeams, Segmenter, Sink, Status};
use scanseg_hal::lms2xx::{Baud, Settings, Variant};
use scanseg_hal::rig::{OwnTurns, Rig, TiltLimits};
use scanseg_virtual_rig::{Chain, Motion, scanner_on_tilt};

use crate::tilted::{SETTINGS, Seen};

const FLOOR_M: f64 = 1.0;

/// Back and forth at 0.5 rad/s, 0.2 to 1.2 rad down.
fn steady(time_us: f64) -> f64 {
    let phase = (time_us / 1e6 * 0.5).rem_euclid(2.0);
    -(0.2 + if phase < 1.0 { phase } else { 2.0 - phase })
}

/// Sums of the squared distances of points from the floor, each beam at the turn that its row says,
/// and all of a row at their mean.
#[derive(Clone, Default)]
struct Floor(Rc<RefCell<[f64; 3]>>);

impl Segmenter for Floor {
    fn push_row<'r, S: Sink + ?Sized>(
        &mut self,
        ranges_m: &[f32],
        beams: impl Into<RowBeams<'r>>,
        _: &mut S,
    ) -> Result<Status, PushError> {
        let (beams, columns) = (beams.into(), ranges_m.len());
        let turn_rad = |column: usize| f64::from(beams.turn_rad) + f64::from(beams.column_turns.of(column));
        let mean_rad = (0..columns).map(turn_rad).sum::<f64>() / columns as f64;
        let mut sums = self.0.borrow_mut();
        for (column, &range_m) in ranges_m.iter().enumerate().filter(|(_, range_m)| **range_m > 0.0) {
            let cos = (0.5 * column as f64 - 90.0).to_radians().cos();
            let off_m = |turn_rad: f64| f64::from(range_m) * cos * turn_rad.sin() + FLOOR_M;
            sums[0] += off_m(turn_rad(column)).powi(2);
            sums[1] += off_m(mean_rad).powi(2);
            sums[2] += 1.0;
        }
        Ok(Status::Buffered)
    }

    fn finish<S: Sink + ?Sized>(&mut self, _: &mut S) -> Finished {
        Finished::Stopped
    }

    fn reset(&mut self) {}

    fn latency_rows(&self) -> usize {
        0
    }
}

/// The figures that the documentation of `rig` states.
#[test]
fn every_beam_at_its_own_turn() {
    let settings = Settings { variant: Variant::Deg180Step05, ..SETTINGS };
    let limits =
        TiltLimits { min_rate_rad_per_s: 0.4, max_rate_rad_per_s: 0.6, sweep_rad: f32::INFINITY, pause_us: 1_000_000 };
    let motion: Motion = Rc::new(steady);
    let floor = |bearing_deg: f64, turn_rad: f64| {
        let range_m = FLOOR_M / (-turn_rad.sin() * (bearing_deg - 90.0).to_radians().cos());
        if (0.0..6.0).contains(&range_m) { range_m } else { 0.0 }
    };
    let lms = scanner_on_tilt(settings, &motion, floor).running(Baud::B500000, settings.variant);
    let (found, mut rows_m) = (Floor::default(), vec![0.0; 2 * 361]);
    let rig = Rig::new(OwnTurns::new(settings), limits, found.clone(), &mut rows_m).unwrap();
    let mut chain = Chain::new(settings, lms, motion, rig);
    let mut seen = Seen::default();
    while chain.now_us() < (8e6 * TAU) as u64 {
        chain.step(&mut seen);
    }
    let [own, mean, points] = *found.0.borrow();
    let [own_mm, mean_mm] = [own, mean].map(|sum| 1000.0 * (sum / points).sqrt());
    println!("{points} points: {mean_mm:.2} mm, each beam at its own turn {own_mm:.2} mm");
    assert!(points > 100_000.0 && (5.0..6.5).contains(&mean_mm) && own_mm < 0.9, "{mean_mm} {own_mm}");
}
