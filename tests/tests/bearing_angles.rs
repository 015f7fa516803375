//! Bearing angles: how far f32 is from f64.

use scanseg_core::{BeamAngle, MAX_ERROR_RAD, Ranging, Trace, TurnAxis, bearing_angle_rad};
use scanseg_tests::checks::bearings::{self, MICROMATH, NEAR_RAD};
use scanseg_tests::reference::bearing::bearing_angle;
use scanseg_tests::scenes::uniform;
use scanseg_tests::stream::{Angles, Rig, Scan};

/// Largest and root mean square error.
#[derive(Default)]
struct Errors {
    max: f64,
    squares: f64,
    count: u32,
}

impl Errors {
    fn add(&mut self, error: f64) {
        assert!(!error.is_nan());
        self.max = self.max.max(error.abs());
        self.squares += error * error;
        self.count += 1;
    }

    fn rms(&self) -> f64 {
        (self.squares / f64::from(self.count)).sqrt()
    }
}

/// Every beam angle in 0.05 deg steps to 10 deg, those of the usual scanners among them, and some
/// up to 120 deg.
fn beam_angles_deg() -> impl Iterator<Item = f64> {
    let fine = (1..=200).map(|i| f64::from(i) * 0.05);
    fine.chain([0.01, 0.1125, 0.3515625, 12.0, 20.0, 30.0, 45.0, 60.0, 89.9, 90.0, 90.1, 120.0])
}

/// `bearing_angle_rad` errs by less than `MAX_ERROR_RAD` from 0.1 m to 80 m: for surfaces at any
/// angle of incidence, from perpendicular to grazing by 0.01 deg, and for jumps between any two
/// ranges.
#[test]
fn error_of_one_angle() {
    let (mut surfaces, mut jumps) = (Errors::default(), Errors::default());
    let check = |errors: &mut Errors, range_m: f32, previous_m: f32, angle: BeamAngle, phi_rad: f64| {
        let found = f64::from(bearing_angle_rad(range_m, previous_m, angle));
        let error = found - bearing_angle(range_m.into(), previous_m.into(), phi_rad);
        errors.add(error);
        assert!(error.abs() <= MAX_ERROR_RAD.into(), "{range_m} {previous_m} {phi_rad}: {error}");
    };
    // 2^(1/8) apart, then some that are no round numbers
    let ranges_m: Vec<f32> = (0..78).map(|i| 0.1 * (f32::from(i as u8) / 8.0).exp2()).filter(|&r| r <= 80.0).collect();
    for phi_deg in beam_angles_deg() {
        // of the beam angle in f32, so that this error is not counted
        let phi = phi_deg.to_radians() as f32;
        let (phi_rad, angle) = (f64::from(phi), BeamAngle::from_rad(phi));
        for (i, &previous_m) in ranges_m.iter().enumerate() {
            // the law of sines: a surface whose bearing angle is `bearing`
            let grazing = [0.01, 0.1, 1.0].into_iter().flat_map(|deg| [deg, 180.0 - deg - phi_deg]);
            for bearing_deg in grazing.chain((1..18).map(|j| 10.0 * f64::from(j) - phi_deg)) {
                let bearing = bearing_deg.to_radians();
                let range_m = f64::from(previous_m) * (bearing + phi_rad).sin() / bearing.sin();
                if bearing_deg > 0.0 && (0.1..=80.0).contains(&range_m) {
                    check(&mut surfaces, range_m as f32, previous_m, angle, phi_rad);
                }
            }
            for &range_m in ranges_m[i % 3..].iter().step_by(3) {
                check(&mut jumps, range_m, previous_m, angle, phi_rad);
            }
        }
    }
    for (name, errors) in [("surfaces", &surfaces), ("jumps", &jumps)] {
        let [max, rms] = [errors.max, errors.rms()].map(f64::to_degrees);
        println!("{name}: {} angles, error at most {max:.6} deg, rms {rms:.6} deg", errors.count);
        assert!(errors.count > 50_000);
    }
    // the bound is of the right order
    assert!(surfaces.max.max(jumps.max) > f64::from(MAX_ERROR_RAD) / 10.0);
}

#[test]
fn bound_in_degrees() {
    let bound_deg = f64::from(MAX_ERROR_RAD).to_degrees();
    let stated_deg = if MICROMATH { 0.17 } else { 0.001 };
    assert!(bound_deg > 0.0 && bound_deg <= 1.01 * stated_deg, "{bound_deg}");
}

/// Rigs with which beams come near to the axis, go past it, and go around.
fn rigs(columns: usize) -> Vec<Rig> {
    let even = |start_deg: f32, step_deg: f32| Angles::Even {
        start_rad: start_deg.to_radians(),
        step_rad: step_deg.to_radians(),
    };
    let step_deg = 180.0 / (columns - 1) as f32;
    let listed = |spread_deg: f32| {
        let angle = |c: usize| (c as f32 / (columns - 1) as f32 - 0.5) * spread_deg + 0.2 * (c as f32).sin();
        Angles::Listed((0..columns).map(|c| angle(c).to_radians()).collect())
    };
    vec![
        // to the axis on both sides, and past it
        Rig::Nodding { angles: even(-90.0, step_deg), axis: TurnAxis::Y },
        Rig::Nodding { angles: even(100.0, -1.1 * step_deg), axis: TurnAxis::Z },
        Rig::Nodding { angles: even(88.0, 0.02), axis: TurnAxis::Y },
        Rig::Nodding { angles: even(-15.0, 0.1), axis: TurnAxis::Y },
        Rig::Nodding { angles: listed(170.0), axis: TurnAxis::Z },
        Rig::Spinning {
            angles: Angles::Even { start_rad: 1.0, step_rad: std::f32::consts::TAU / columns as f32 },
            wraps: true,
        },
        Rig::Spinning { angles: even(-20.0, 0.1), wraps: false },
        Rig::Spinning { angles: listed(300.0), wraps: true },
        Rig::Pinhole { fx_px: 570.0, fy_px: 570.0, cx_px: 0.5 * columns as f32, cy_px: 10.0 },
        Rig::Pinhole { fx_px: 80.0, fy_px: -75.0, cx_px: 0.5 * columns as f32, cy_px: -40.0 },
    ]
}

/// The whole chain from ranges and row angles to counts agrees with the reference: beams of every
/// kind, every trace.
#[test]
fn whole_chain() {
    let columns = 181;
    let turns_deg: Vec<f32> = (0..20).map(|row| -30.0 + 0.7 * row as f32 + 0.3 * (row as f32).sin()).collect();
    let ranging = Ranging::new(0.01);
    let traces = [
        Trace::ROW,
        Trace::COLUMN,
        Trace::DIAGONAL,
        Trace::ANTIDIAGONAL,
        Trace::ROW.times(5),
        Trace::COLUMN.times(4),
        Trace { rows: 2, columns: -33 },
        Trace { rows: 1, columns: 64 },
    ];
    let mut errors = [Errors::default(), Errors::default()];
    let mut none = 0;
    for (number, rig) in rigs(columns).into_iter().enumerate() {
        let turn_rad: Vec<f32> = turns_deg.iter().map(|deg| deg.to_radians()).collect();
        let mut scan = Scan::of(columns, turn_rad, rig, |[x, y, z]| {
            // a room with a pillar
            let walls = [x / 3.0, -x / 4.0, y / 2.5, -y / 3.5, z / 1.5, -z / 1.2];
            let pillar = if (y.atan2(x) - 0.3).abs() < 0.05 { 1.0 } else { 0.0 };
            1.0 / walls.into_iter().fold(pillar, f64::max)
        });
        for (i, range_m) in scan.range_m.iter_mut().enumerate() {
            *range_m += 0.02 * (uniform(9, number, i) as f32 - 0.5);
            if uniform(10, number, i) < 0.02 {
                *range_m = f32::NAN;
            }
        }
        for trace in traces {
            bearings::assert_same(&scan, &ranging, trace, |phi, found, off| {
                none += u32::from(found == 0);
                errors[usize::from(phi < NEAR_RAD)].add(off);
            });
        }
    }
    for (name, errors) in ["0.05 deg apart and more", "nearer"].iter().zip(&errors) {
        println!("beams {name}: {} angles, error at most {} counts, rms {}", errors.count, errors.max, errors.rms());
        assert!(errors.count > 1000);
    }
    assert!(none > 1000);
}

/// Rows that are far apart, as where a scanner skips some: along a column the angle between two
/// beams is that of their turns, up to a right angle and beyond.
#[test]
fn rows_far_apart() {
    let columns = 61;
    let (mut largest, mut angles) = (0f64, 0);
    for axis in [TurnAxis::Y, TurnAxis::Z] {
        for turn_deg in [5.0f32, 15.0, 16.0, 16.2, 20.0, 30.0, 45.0, 60.0, 73.0, 75.0, 90.0, 120.0, -30.0, -60.0] {
            let angles_of_beams = Angles::Even { start_rad: -0.6, step_rad: 0.02 };
            let turn_rad = [0.2, 0.2 + turn_deg.to_radians()].to_vec();
            let rig = Rig::Nodding { angles: angles_of_beams, axis };
            let mut scan = Scan::of(columns, turn_rad, rig, |_| 2.0);
            for (i, range_m) in scan.range_m.iter_mut().enumerate() {
                *range_m += uniform(11, i, 0) as f32;
            }
            bearings::assert_same(&scan, &Ranging::new(0.01), Trace::COLUMN, |_, found, off| {
                angles += u32::from(found > 0);
                largest = largest.max(off.abs());
            });
        }
    }
    println!("{angles} angles, error at most {largest} counts");
    assert_eq!(angles, 2 * 14 * 61);
}
