//! Geometry files: what is refused and how it is said, exact round trips.
use proptest::prelude::*;
use scanseg_formats::{Angles, Depth, Geometry, Kind, Noise, SENSORS, TurnAxis};

const SPINNING: &str = "version = 1
unit_m = 0.001
kind = 'spinning'
azimuth_deg = { start = 0, step = -0.5 }
elevation_deg = [1, 0.5, 0.0]
wraps = true
";
const NODDING: &str = "version = 1
unit_m = 0.001
no_return = [32767, 0]
min_range_m = 0.48
max_range_m = 80
range_noise_m = 0.01
kind = 'nodding'
beam_deg = { start = -90.0, step = 0.5 }
turn_deg = { start = -48.7, step = 0.516889 }
turn_axis = 'y'
";
const PINHOLE: &str = "version = 1
unit_m = 0.001
kind = 'pinhole'
depth = 'z'
fx = 519.226
fy = 479.462
cx = 522.23
cy = 272
";

#[test]
fn each_kind_is_read() {
    let spinning = Geometry::parse(SPINNING).unwrap();
    assert_eq!(
        spinning,
        Geometry {
            unit_m: 0.001,
            no_return: vec![],
            min_range_m: None,
            max_range_m: None,
            range_noise_m: None,
            noise: Noise::NONE,
            kind: Kind::Spinning {
                azimuth_deg: Angles::Even { start_deg: 0.0, step_deg: -0.5 },
                elevation_deg: Angles::Listed(vec![1.0, 0.5, 0.0]),
                wraps: true,
            },
        }
    );
    let nodding = Geometry::parse(NODDING).unwrap();
    assert_eq!(nodding.no_return, [32767, 0]);
    let limits = [nodding.min_range_m, nodding.max_range_m, nodding.range_noise_m];
    assert_eq!(limits, [Some(0.48), Some(80.0), Some(0.01)]);
    assert!(matches!(nodding.kind, Kind::Nodding { turn_axis: TurnAxis::Y, .. }));
    let pinhole = Geometry::parse(PINHOLE).unwrap();
    assert_eq!(
        pinhole.kind,
        Kind::Pinhole { fx_px: 519.226, fy_px: 479.462, cx_px: 522.23, cy_px: 272.0, depth: Depth::Z }
    );
    let no_wraps = Geometry::parse(&SPINNING.replace("wraps = true", "")).unwrap();
    assert!(matches!(no_wraps.kind, Kind::Spinning { wraps: false, .. }));
}

/// The message for `text` with `old` replaced by `new`, which must be one line.
#[track_caller]
fn refused(text: &str, old: &str, new: &str) -> String {
    assert!(text.contains(old), "the test replaces nothing");
    let message = Geometry::parse(&text.replace(old, new)).unwrap_err().to_string();
    assert!(!message.contains('\n'), "{message}");
    message
}

#[test]
fn what_is_missing_is_named() {
    for (text, line) in [
        (SPINNING, "version = 1"),
        (SPINNING, "unit_m = 0.001"),
        (SPINNING, "kind = 'spinning'"),
        (SPINNING, "azimuth_deg = { start = 0, step = -0.5 }"),
        (SPINNING, "elevation_deg = [1, 0.5, 0.0]"),
        (NODDING, "beam_deg = { start = -90.0, step = 0.5 }"),
        (NODDING, "turn_deg = { start = -48.7, step = 0.516889 }"),
        (NODDING, "turn_axis = 'y'"),
        (PINHOLE, "depth = 'z'"),
        (PINHOLE, "fx = 519.226"),
        (PINHOLE, "fy = 479.462"),
        (PINHOLE, "cx = 522.23"),
        (PINHOLE, "cy = 272"),
    ] {
        let key = line.split(' ').next().unwrap();
        assert_eq!(refused(text, line, ""), format!("missing key `{key}`"));
    }
    assert_eq!(refused(NODDING, "start = -90.0, ", ""), "missing key `beam_deg.start`");
    assert_eq!(refused(NODDING, ", step = 0.5 ", ""), "missing key `beam_deg.step`");
}

#[test]
fn what_is_wrong_is_named() {
    let cases = [
        (SPINNING, "version = 1", "version = 2", "`version` is 2, must be 1"),
        (SPINNING, "version = 1", "version = '1'", "`version` must be the integer 1, not a string"),
        (SPINNING, "0.001", "'mm'", "`unit_m` must be a number, not a string"),
        (SPINNING, "0.001", "0", "`unit_m` is 0.0, must be finite and above 0"),
        (SPINNING, "0.001", "-1", "`unit_m` is -1.0, must be finite and above 0"),
        (SPINNING, "0.001", "inf", "`unit_m` is inf, must be finite and above 0"),
        (SPINNING, "0.001", "nan", "`unit_m` is NaN, must be finite and above 0"),
        (SPINNING, "'spinning'", "'conic'", "`kind` is conic, must be one of nodding, spinning, pinhole"),
        (SPINNING, "'spinning'", "3", "`kind` must be one of nodding, spinning, pinhole, not an integer"),
        (SPINNING, "true", "1", "`wraps` must be true or false, not an integer"),
        (SPINNING, "wraps", "warps", "`warps` is not a key of a spinning geometry"),
        (SPINNING, "wraps = true", "fx = 1.0", "`fx` is not a key of a spinning geometry"),
        (SPINNING, "[1, 0.5, 0.0]", "[]", "`elevation_deg` is [], must be one angle or more"),
        (SPINNING, "[1, 0.5, 0.0]", "[1, '2']", "`elevation_deg[1]` must be a number, not a string"),
        (SPINNING, "[1, 0.5, 0.0]", "[1, nan]", "`elevation_deg[1]` is NaN, must be finite"),
        (SPINNING, "[1, 0.5, 0.0]", "7", "`elevation_deg` must be a list of angles or { start, step }, not an integer"),
        (NODDING, "step = 0.5 ", "step = 0 ", "`beam_deg.step` is 0.0, must be finite and not 0"),
        (NODDING, "step = 0.5 ", "step = false ", "`beam_deg.step` must be a number, not a boolean"),
        (NODDING, "start = -90.0", "start = -inf", "`beam_deg.start` is -inf, must be finite"),
        (NODDING, "step = 0.5 ", "step = 0.5, n = 3 ", "`beam_deg.n` is not a key of a { start, step } geometry"),
        (NODDING, "'y'", "'x'", "`turn_axis` is x, must be y or z"),
        (NODDING, "[32767, 0]", "32767", "`no_return` must be a list of counts, not an integer"),
        (NODDING, "[32767, 0]", "[0, 65536]", "`no_return[1]` is 65536, must be from 0 to 65535"),
        (NODDING, "[32767, 0]", "[-1]", "`no_return[0]` is -1, must be from 0 to 65535"),
        (NODDING, "[32767, 0]", "[1.5]", "`no_return[0]` must be an integer, not a float"),
        (NODDING, "= 0.48", "= -0.5", "`min_range_m` is -0.5, must be finite and not below 0"),
        (NODDING, "= 80", "= 0.48", "`max_range_m` is 0.48, must be finite and above 0 and above `min_range_m`"),
        (NODDING, "= 0.01", "= -0.01", "`range_noise_m` is -0.01, must be finite and not below 0"),
        (
            NODDING,
            "range_noise_m = 0.01",
            "sensor = 3",
            "`sensor` must be one of sick-lms200, kinect-v1, realsense-d435, \
          azure-kinect, ouster-os0, ouster-os1, velodyne-vlp16, ld06, not an integer",
        ),
        (PINHOLE, "519.226", "0.0", "`fx` is 0.0, must be finite and not 0"),
        (PINHOLE, "479.462", "0", "`fy` is 0.0, must be finite and not 0"),
        (PINHOLE, "522.23", "inf", "`cx` is inf, must be finite"),
        (PINHOLE, "272", "nan", "`cy` is NaN, must be finite"),
        (PINHOLE, "'z'", "'depth'", "`depth` is depth, must be z or range"),
    ];
    for (text, old, new, message) in cases {
        assert_eq!(refused(text, old, new), message);
    }
}

#[test]
fn what_is_not_toml_is_given_with_its_line() {
    assert!(refused(SPINNING, "wraps = true", "wraps = true\nwraps").starts_with("line 7: "));
    let twice = refused(SPINNING, "wraps = true", "wraps = true\nunit_m = 2");
    assert!(twice.starts_with("line 7: ") && twice.contains("duplicate key"), "{twice}");
}

#[test]
fn listed_angles_must_have_an_entry_each() {
    let spinning = Geometry::parse(SPINNING).unwrap();
    assert_eq!(spinning.fits(3, 1000), Ok(()));
    for rows in [2, 4] {
        assert_eq!(
            spinning.fits(rows, 1000).unwrap_err().to_string(),
            format!("`elevation_deg` lists 3 angles, the image has {rows} rows")
        );
    }
    let nodding = NODDING.replace("{ start = -90.0, step = 0.5 }", "[-90, 0, 80]");
    let nodding = Geometry::parse(&nodding).unwrap();
    assert_eq!(nodding.fits(7, 3), Ok(()));
    assert_eq!(nodding.fits(7, 4).unwrap_err().to_string(), "`beam_deg` lists 3 angles, the image has 4 columns");
}

#[test]
fn beams_without_direction_do_not_fit() {
    let far = Geometry::parse(&SPINNING.replace("start = 0, step = -0.5", "start = 0, step = 1e308")).unwrap();
    assert_eq!(far.fits(3, 2), Ok(()));
    assert_eq!(
        far.fits(3, 3).unwrap_err().to_string(),
        "the beam of row 0, column 2 has no direction: numbers too large"
    );
    let sharp = Geometry::parse(&PINHOLE.replace("519.226", "1e-320")).unwrap();
    assert!(sharp.fits(2, 2).is_err());
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let message = Geometry::read("no/such/geometry.toml").unwrap_err().to_string();
    assert!(message.starts_with("no/such/geometry.toml: "), "{message}");
}

fn angles() -> impl Strategy<Value = Angles> {
    let step = any::<f64>().prop_filter("finite, not 0", |x| x.is_finite() && *x != 0.0);
    prop_oneof![
        (finite(), step).prop_map(|(start, step)| Angles::Even { start_deg: start, step_deg: step }),
        prop::collection::vec(finite(), 1..20).prop_map(Angles::Listed),
    ]
}

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |x| x.is_finite())
}

fn above_0() -> impl Strategy<Value = f64> {
    finite().prop_map(f64::abs).prop_filter("above 0", |x| *x > 0.0)
}

fn kind() -> impl Strategy<Value = Kind> {
    let axis = prop_oneof![Just(TurnAxis::Y), Just(TurnAxis::Z)];
    let depth = prop_oneof![Just(Depth::Z), Just(Depth::Range)];
    prop_oneof![
        (angles(), angles(), axis).prop_map(|(beam_deg, turn_deg, turn_axis)| Kind::Nodding {
            beam_deg,
            turn_deg,
            turn_axis
        }),
        (angles(), angles(), any::<bool>()).prop_map(|(azimuth_deg, elevation_deg, wraps)| Kind::Spinning {
            azimuth_deg,
            elevation_deg,
            wraps
        }),
        (above_0(), above_0(), finite(), finite(), depth).prop_map(|(fx, fy, cx, cy, depth)| Kind::Pinhole {
            fx_px: fx,
            fy_px: -fy,
            cx_px: cx,
            cy_px: cy,
            depth
        }),
    ]
}

/// Some of the errors of a scanner.
fn noise() -> impl Strategy<Value = Noise> {
    let some = || prop_oneof![Just(0.0), 1e-9..1.0];
    (some(), some(), some(), some(), some(), some(), prop_oneof![Just(1.0), 1.0..9.0]).prop_map(
        |(range_noise_per_m, range_noise_per_m2, range_step_m, beam_noise_deg, turn_noise_deg, flatness_m, px)| Noise {
            range_noise_per_m,
            range_noise_per_m2,
            range_step_m,
            range_step_per_m2: 0.5 * range_step_m,
            noise_correlation_px: px,
            beam_noise_deg,
            turn_noise_deg,
            flatness_m,
        },
    )
}

proptest! {
    #[test]
    fn a_geometry_survives_its_file(
        unit_m in above_0(),
        no_return in any::<Vec<u16>>(),
        min_range_m in prop::option::of(0.0..1.0),
        max_range_m in prop::option::of(1.0..1e9),
        range_noise_m in prop::option::of(0.0..1.0),
        noise in noise(),
        kind in kind(),
    ) {
        let geometry = Geometry { unit_m, no_return, min_range_m, max_range_m, range_noise_m, noise, kind };
        prop_assert_eq!(Geometry::parse(&geometry.to_toml()), Ok(geometry));
    }

    #[test]
    fn no_text_panics(text in "(version = 1\n)?[a-z_]{1,9} = [0-9a-z'{}\\[\\],. =-]{0,20}\n") {
        if let Err(e) = Geometry::parse(&text) {
            prop_assert!(!e.to_string().contains('\n'));
        }
    }
}

#[test]
fn a_named_sensor_states_what_the_file_does_not() {
    let with = |lines: &str| Geometry::parse(&NODDING.replace("range_noise_m = 0.01", lines));
    let Geometry { range_noise_m, noise, .. } = with("sensor = 'kinect-v1'").unwrap();
    let kinect =
        Noise { range_noise_per_m2: 0.00116, range_step_per_m2: 0.00285, noise_correlation_px: 4.0, ..Noise::NONE };
    assert_eq!((range_noise_m, noise), (Some(0.0), kinect));
    // the keys of the file win
    let lines = "sensor = 'kinect-v1'\nrange_noise_m = 0.002\nrange_step_per_m2 = 0\nturn_noise_deg = 0.1";
    let Geometry { range_noise_m, noise, .. } = with(lines).unwrap();
    assert_eq!((range_noise_m, noise), (Some(0.002), Noise { range_step_per_m2: 0.0, turn_noise_deg: 0.1, ..kinect }));
    // and read back as they were
    for sensor in SENSORS {
        let geometry = with(&format!("sensor = '{}'", sensor.name)).unwrap();
        assert_eq!(Geometry::parse(&geometry.to_toml()).unwrap(), geometry);
    }
    let unknown = with("sensor = 'kinect'").unwrap_err().to_string();
    assert!(unknown.starts_with("`sensor` is kinect, must be one of sick-lms200, kinect-v1, "), "{unknown}");
}

#[test]
fn examples_of_the_documentation_are_geometry_files() {
    let page = include_str!("../../../docs/scan-format.md");
    let examples: Vec<_> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let kinds = examples.iter().map(|text| match Geometry::parse(text).unwrap().kind {
        Kind::Nodding { .. } => "nodding",
        Kind::Spinning { .. } => "spinning",
        Kind::Pinhole { .. } => "pinhole",
    });
    assert!(kinds.eq(["nodding", "pinhole", "spinning"]));
    for sensor in SENSORS {
        assert!(page.contains(&format!("\n| `{}` | ", sensor.name)), "{}", sensor.name);
    }
}
