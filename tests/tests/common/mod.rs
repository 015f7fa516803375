//! Scans and configurations of all kinds, as proptest strategies.

use proptest::prelude::*;
use scanseg_core::{Config, Element, Trace};
use scanseg_tests::scenes::scan_of;
use scanseg_tests::stream::Scan;

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

prop_compose! {
    /// Configurations of all kinds.
    pub fn configs()(
        traces in prop::sample::select(TRACES.as_slice()),
        square in any::<bool>(),
        roof_deg in prop::sample::select([20.0f32, 4.0, 60.0, 180.0].as_slice()),
        step_deg in prop::sample::select([6.0f32, 0.0, 30.0, 90.0].as_slice()),
        range_noise_m in prop::sample::select([0.01f32, 0.0, 0.3].as_slice()),
        limits in prop::sample::select([(0.05f32, 100.0f32), (1.0, 5.0)].as_slice()),
    ) -> Config<'static> {
        Config {
            range_noise_m,
            min_range_m: limits.0,
            max_range_m: limits.1,
            traces,
            roof_angle_rad: roof_deg.to_radians().min(std::f32::consts::PI),
            step_angle_rad: step_deg.to_radians().min(std::f32::consts::FRAC_PI_2),
            closing: if square { Element::Square } else { Element::Plus },
            ..Config::paper()
        }
    }
}
