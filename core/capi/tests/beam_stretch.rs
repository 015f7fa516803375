//! The share by which beam angles are too small: as the core tells it, after each row and of an image.

use std::ptr::null;

use scanseg_capi::*;
use scanseg_capi_tests::{APPROACHES, Session, nodding, output};
use scanseg_core::{Beams, Columns, PlaneConfig, PlaneSegmenter, Ranging, Segmenter, TurnAxis, buffers};

use crate::results::Collected;

const COLUMNS: usize = 171;
const ROWS: usize = 90;
const STEP_RAD: f32 = 0.017_453_3;
const START_RAD: f32 = -85.0 * STEP_RAD;
const NOISE_M: f32 = 0.005;
const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(NOISE_M));

fn turn_rad(row: usize) -> f32 {
    (row as f32 - 44.5) * STEP_RAD
}

/// Ranges of a room, 3 m ahead, 2 m to either side, 1 m down and up, whose beams are 2 % farther apart than is said.
fn room_m(row: usize) -> Vec<f32> {
    let (turn_sin, turn_cos) = turn_rad(row).sin_cos();
    let range_m = |column: usize| {
        let (sin, cos) = (1.02 * (START_RAD + column as f32 * STEP_RAD)).sin_cos();
        let walls_m = [(3.0, cos * turn_cos), (2.0, sin.abs()), (1.0, (cos * turn_sin).abs())];
        walls_m.into_iter().filter(|wall| wall.1 > 0.0).map(|(away_m, along)| away_m / along).fold(f32::MAX, f32::min)
    };
    (0..COLUMNS).map(range_m).collect()
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn the_share_is_that_of_the_core() {
    let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;
    let columns = Columns::Even { start_rad: START_RAD, step_rad: STEP_RAD };
    let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
    let mut core = PlaneSegmenter::new(CONFIG, beams, COLUMNS, buffers.memory()).unwrap();
    let shares: Vec<f32> = (0..ROWS)
        .map(|row| {
            core.push_row(&room_m(row), turn_rad(row), &mut Collected::default()).unwrap();
            core.beam_stretch()
        })
        .collect();
    let share = shares[ROWS - 1];
    assert!(shares[0] == 0.0 && (share - 0.02).abs() < 0.003, "{share}");

    for approach in APPROACHES {
        let expected = |share| if approach == SCANSEG_PLANE { share } else { 0.0 };
        let mut session = Session::new(&Config {
            columns: COLUMNS as u32,
            column_start_rad: START_RAD,
            column_step_rad: STEP_RAD,
            range_noise_m: NOISE_M,
            ..nodding(approach)
        });
        // the next scan begins with 0
        for _ in 0..2 {
            for (row, &share) in shares.iter().enumerate() {
                assert_eq!(session.push(&room_m(row), turn_rad(row)), SCANSEG_OK);
                assert_eq!(session.beam_stretch, expected(share), "approach {approach}, row {row}");
            }
            assert_eq!((session.finish(), session.beam_stretch), (SCANSEG_OK, expected(share)));
            assert_eq!(session.reset(), SCANSEG_OK);
        }

        let ranges_m: Vec<f32> = (0..ROWS).flat_map(room_m).collect();
        let turns_rad: Vec<f32> = (0..ROWS).map(turn_rad).collect();
        let mut work = vec![0; 2 * (ranges_m.len() + 1)];
        let mut out = Output { beam_stretch: 1.0, ..output() };
        // SAFETY: the segmenter of the session, and arrays of these sizes.
        let status = unsafe {
            let (r, t, w, size) = (ranges_m.as_ptr(), turns_rad.as_ptr(), work.as_mut_ptr(), work.len());
            scanseg_segment_image(session.segmenter, r, ROWS, COLUMNS, t, null(), w, size, &mut out)
        };
        assert_eq!((status, out.beam_stretch), (SCANSEG_OK, expected(share)));
    }
}
