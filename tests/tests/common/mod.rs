//! Scans and configurations of all kinds, as proptest strategies.

use proptest::prelude::*;
use scanseg_core::{EdgeConfig, Element, PlaneConfig, Ranging, RegionConfig, Trace};
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::Scan;
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
