//! Scans and configurations of all kinds, as proptest strategies; and simulated offices.

use proptest::prelude::*;
use scanseg_core::{EdgeConfig, Element, PlaneConfig, Ranging, RegionConfig, Trace, TurnAxis};
use scanseg_sim::office::{Scene, Sensor, Set};
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::{Angles, Rig, Scan};
use scanseg_tests::walls::Kind;
use std::f32::consts::{FRAC_PI_2, PI};

/// Numbers of columns, those around multiples of the chunk of 32 among them.
pub fn columns() -> impl Strategy<Value = usize> {
    prop_oneof![1usize..=40, prop::sample::select(vec![31usize, 32, 33, 63, 64, 65, 97])]
}

/// Scans of all kinds, of up to `rows` rows.
pub fn scans(rows: usize) -> impl Strategy<Value = Scan> {
    (1..=rows, columns(), 0usize..7, 0usize..6, any::<u64>())
        .prop_map(|(rows, columns, rig, scene, seed)| scan_of(rows, columns, rig, scene, seed))
}

const R: Trace = Trace::ROW;
const C: Trace = Trace::COLUMN;
const TRACES: [&[Trace]; 8] = [
    &[R, C],
    &[R],
    &[C],
    &[R, C, Trace::DIAGONAL, Trace::ANTIDIAGONAL],
    &[R.times(3), C.times(2)],
    &[Trace::ANTIDIAGONAL.times(4), R.times(40), Trace { rows: 1, columns: 70 }],
    &[C.times(16), Trace { rows: 2, columns: -33 }, R],
    &[R, R.times(2), R.times(3), R.times(4), C, C.times(2), C.times(3), C.times(4)],
];

/// A standard deviation of ranges in `noises_m`, with and without limits that matter.
fn rangings(noises_m: &'static [f32]) -> impl Strategy<Value = Ranging> {
    let limits_m = prop::sample::select([(0.05f32, 100.0f32), (1.0, 5.0)].as_slice());
    (prop::sample::select(noises_m), limits_m)
        .prop_map(|(noise_m, (min_m, max_m))| Ranging::new(noise_m).with_limits(min_m, max_m))
}

/// Configurations of the plane approach, down to no noise.
pub fn plane_configs() -> impl Strategy<Value = PlaneConfig> {
    rangings(&[0.01, 0.0, 0.002, 0.3]).prop_map(PlaneConfig::new)
}

prop_compose! {
    /// Configurations of the edge-based approach, of all kinds.
    pub fn edge_configs()(
        traces in prop::sample::select(TRACES.as_slice()),
        square in any::<bool>(),
        roof_deg in prop::sample::select([20.0f32, 4.0, 60.0, 180.0].as_slice()),
        step_deg in prop::sample::select([6.0f32, 0.0, 30.0, 90.0].as_slice()),
        ranging in rangings(&[0.01, 0.0, 0.3]),
    ) -> EdgeConfig<'static> {
        EdgeConfig::paper()
            .with_ranging(ranging)
            .with_traces(traces)
            .with_roof_angle_rad(roof_deg.to_radians().min(PI))
            .with_step_angle_rad(step_deg.to_radians().min(FRAC_PI_2))
            .with_closing(if square { Element::Square } else { Element::Plus })
    }
}

prop_compose! {
    /// Configurations of the region-based approach, of all kinds.
    pub fn region_configs()(
        line_deg in prop::sample::select([3.0f32, 10.0, 45.0, 90.0].as_slice()),
        plane_distance_m in prop::sample::select([0.005f32, 0.0, 0.05, 1.0].as_slice()),
        ranging in rangings(&[0.01, 0.0, 0.002, 0.3]),
    ) -> RegionConfig {
        RegionConfig::paper()
            .with_ranging(ranging)
            .with_line_angle_rad(line_deg.to_radians().min(FRAC_PI_2))
            .with_plane_distance_m(plane_distance_m)
    }
}

/// What a scanner of coarse columns, 1 deg and all around 1.5 deg, sees of a simulated office. [`Kind::Tilting`],
/// [`Kind::Around`] and [`Kind::Camera`] see one.
pub fn office(kind: Kind, scene: u32, noise_m: f64) -> Scan {
    let (rows, columns) = (100, if kind == Kind::Around { 240 } else { 181 });
    let even = |start_deg: f32, step_deg: f32| Angles::Even {
        start_rad: start_deg.to_radians(),
        step_rad: step_deg.to_radians(),
    };
    let down =
        |start_deg: f32, step_deg: f32| (0..rows).map(move |row| (start_deg - step_deg * row as f32).to_radians());
    let (sensor, rig, turn_rad) = match kind {
        Kind::Tilting => {
            let rig = Rig::Nodding { angles: even(-90.0, 1.0), axis: TurnAxis::Y };
            (Sensor::nodding(rows, columns), rig, down(50.0, 1.0).collect())
        }
        Kind::Around => {
            let rig = Rig::Spinning { angles: even(180.0, -1.5), wraps: true };
            (Sensor::spinning(rows, columns), rig, down(45.0, 90.0 / 99.0).collect())
        }
        Kind::Camera => {
            let f_px = 0.5 * columns as f32 / 35f32.to_radians().tan();
            let (cx_px, cy_px) = (0.5 * (columns - 1) as f32, 0.5 * (rows - 1) as f32);
            let rig = Rig::Pinhole { fx_px: f_px, fy_px: f_px, cx_px, cy_px };
            (Sensor::pinhole(rows, columns), rig, vec![0.0; rows])
        }
        Kind::Panning | Kind::Spinning => unimplemented!("{kind:?}"),
    };
    let sensor = Sensor { range_noise_m: noise_m, ..sensor };
    let range_m = Scene::numbered(Set::Tuning, scene).scan(&sensor, 1).unwrap().range_m;
    Scan { columns, range_m, turn_rad, rig }
}
