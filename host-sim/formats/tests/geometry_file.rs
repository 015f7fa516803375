//! Geometry files: what is refused and how it is said, exact round trips.
use proptest::prelude::*;
use scanseg_formats::{Angles, Beside, Depth, Geometry, Kind, Noise, SENSORS, TurnAxis};

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
        Geometry::of(Kind::Spinning {
            azimuth_deg: Angles::Even { start_deg: 0.0, step_deg: -0.5 },
            elevation_deg: Angles::Listed(vec![1.0, 0.5, 0.0]),
            wraps: true,
        })
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
        let said = refused(text, line, "");
        assert!(said.starts_with(&format!("missing key `{key}`, ")), "{said}");
    }
    let degrees = "a number from -36000 to 36000 (degrees)";
    assert_eq!(refused(NODDING, "start = -90.0, ", ""), format!("missing key `beam_deg.start`, {degrees}"));
    let said = "missing key `beam_deg.step`, a number from -90 to 90 and not 0 (degrees)";
    assert_eq!(refused(NODDING, ", step = 0.5 ", ""), said);
}

#[test]
fn what_is_wrong_is_named() {
    let unit = "must be a number above 0, up to 1000 (metres of one count)";
    let degrees = "must be a number from -36000 to 36000 (degrees)";
    let step = "must be a number from -90 to 90 and not 0 (degrees)";
    let kinds = "must be one of nodding, spinning, pinhole";
    let angles = "must be a list of angles or { start, step } (degrees)";
    let count = "must be a whole number from 0 to 65535";
    let focal = "must be a number from 0.1 to 1000000, or from -1000000 to -0.1 (pixels)";
    let centre = "must be a number from -1000000 to 1000000 (pixels)";
    let cases = [
        (SPINNING, "version = 1", "version = 2", "`version` is 2, must be the whole number 1".to_string()),
        (SPINNING, "version = 1", "version = '1'", "`version` is \"1\", must be the whole number 1".to_string()),
        (SPINNING, "0.001", "'mm'", format!("`unit_m` is \"mm\", {unit}")),
        (SPINNING, "0.001", "0", format!("`unit_m` is 0.0, {unit}")),
        (SPINNING, "0.001", "-1", format!("`unit_m` is -1.0, {unit}")),
        (SPINNING, "0.001", "1001", format!("`unit_m` is 1001.0, {unit}")),
        (SPINNING, "0.001", "inf", format!("`unit_m` is inf, {unit}")),
        (SPINNING, "0.001", "nan", format!("`unit_m` is NaN, {unit}")),
        (SPINNING, "'spinning'", "'conic'", format!("`kind` is \"conic\", {kinds}")),
        (SPINNING, "'spinning'", "3", format!("`kind` is 3, {kinds}")),
        (SPINNING, "true", "1", "`wraps` is 1, must be true or false".to_string()),
        (SPINNING, "wraps", "warps", "`warps` is not a key of a spinning geometry (is `wraps` meant?)".to_string()),
        (SPINNING, "wraps = true", "fx = 1.0", "`fx` is not a key of a spinning geometry".to_string()),
        (SPINNING, "wraps", "Min_range", {
            "`Min_range` is not a key of a spinning geometry (is `min_range_m` meant?)".to_string()
        }),
        (SPINNING, "[1, 0.5, 0.0]", "[]", "`elevation_deg` is [], must be one angle or more".to_string()),
        (SPINNING, "[1, 0.5, 0.0]", "[1, '2']", format!("`elevation_deg[1]` is \"2\", {degrees}")),
        (SPINNING, "[1, 0.5, 0.0]", "[1, nan, 'x']", format!("`elevation_deg[1]` is NaN, {degrees}")),
        (SPINNING, "[1, 0.5, 0.0]", "7", format!("`elevation_deg` is 7, {angles}")),
        (NODDING, "step = 0.5 ", "step = 0 ", format!("`beam_deg.step` is 0.0, {step}")),
        (NODDING, "step = 0.5 ", "step = 100 ", format!("`beam_deg.step` is 100.0, {step}")),
        (NODDING, "step = 0.5 ", "step = false ", format!("`beam_deg.step` is false, {step}")),
        (NODDING, "start = -90.0", "start = -inf", format!("`beam_deg.start` is -inf, {degrees}")),
        (NODDING, "step = 0.5 ", "step = 0.5, n = 3 ", {
            "`beam_deg.n` is not a key of a { start, step } geometry".to_string()
        }),
        (NODDING, "'y'", "'x'", "`turn_axis` is \"x\", must be y or z".to_string()),
        (NODDING, "[32767, 0]", "32767", {
            "`no_return` is 32767, must be a list of whole numbers from 0 to 65535".to_string()
        }),
        (NODDING, "[32767, 0]", "[0, 65536]", format!("`no_return[1]` is 65536, {count}")),
        (NODDING, "[32767, 0]", "[-1]", format!("`no_return[0]` is -1, {count}")),
        (NODDING, "[32767, 0]", "[1.5]", format!("`no_return[0]` is 1.5, {count}")),
        (NODDING, "= 0.48", "= -0.5", "`min_range_m` is -0.5, must be a number from 0 to 500 (metres)".to_string()),
        (NODDING, "= 80", "= 0.48", {
            "`max_range_m` is 0.48, must be a number above 0 and above `min_range_m` (metres; beyond 500 nothing is used)"
                .to_string()
        }),
        (NODDING, "= 0.01", "= -0.01", "`range_noise_m` is -0.01, must be a number from 0 to 10 (metres)".to_string()),
        (NODDING, "range_noise_m = 0.01", "sensor = 3", {
            "`sensor` is 3, must be one of sick-lms200, kinect-v1, realsense-d435, azure-kinect, ouster-os0, ouster-os1, \
             velodyne-vlp16, ld06"
                .to_string()
        }),
        (PINHOLE, "519.226", "0.0", format!("`fx` is 0.0, {focal}")),
        (PINHOLE, "479.462", "0", format!("`fy` is 0.0, {focal}")),
        (PINHOLE, "522.23", "inf", format!("`cx` is inf, {centre}")),
        (PINHOLE, "272", "nan", format!("`cy` is NaN, {centre}")),
        (PINHOLE, "'z'", "'depth'", "`depth` is \"depth\", must be z or range".to_string()),
    ];
    for (text, old, new, message) in cases {
        assert_eq!(refused(text, old, new), message);
    }
}

/// Whoever writes a geometry file mends it once.
#[test]
fn all_that_is_wrong_is_told_at_once() {
    let text = "version = 1\nunit = 0.001\nmin_range_m = 'near'\nrange_noise_m = 20\nno_return = [-1]\n\
         kind = 'nodding'\nbeam_deg = { start = 'left', stop = 90 }\nturn_deg = [1, nan]\n";
    let said = Geometry::parse(text).unwrap_err().to_string();
    let expected = "missing key `unit_m`, a number above 0, up to 1000 (metres of one count); \
         `no_return[0]` is -1, must be a whole number from 0 to 65535; \
         `min_range_m` is \"near\", must be a number from 0 to 500 (metres); \
         `range_noise_m` is 20.0, must be a number from 0 to 10 (metres); \
         `beam_deg.start` is \"left\", must be a number from -36000 to 36000 (degrees); \
         missing key `beam_deg.step`, a number from -90 to 90 and not 0 (degrees); \
         `beam_deg.stop` is not a key of a { start, step } geometry (is `step` meant?); \
         `turn_deg[1]` is NaN, must be a number from -36000 to 36000 (degrees); \
         missing key `turn_axis`, y or z; \
         `unit` is not a key of a nodding geometry (is `unit_m` meant?)";
    assert_eq!(said, expected);
    // of another version nothing else is known
    let said = Geometry::parse(&text.replace("version = 1", "version = 2")).unwrap_err().to_string();
    assert_eq!(said, "`version` is 2, must be the whole number 1");
    // without the kind its keys are known, and others are not
    let said = Geometry::parse("version = 1\nunit_m = 1\nfx = 3\ncolour = 'red'\n").unwrap_err().to_string();
    let expected = "missing key `kind`, one of nodding, spinning, pinhole; `colour` is not a key of any geometry";
    assert_eq!(said, expected);
    // a message has an end
    let keys: String = (0..500).map(|i| format!("{}{i} = 1\n", "k".repeat(100))).collect();
    let said = Geometry::parse(&format!("{PINHOLE}{keys}")).unwrap_err().to_string();
    assert!(said.len() < 2000 && said.ends_with("; and 484 more"), "{said}");
}

/// A geometry that was not read is checked by the same rules.
#[test]
fn a_geometry_is_checked_as_its_file_is() {
    let mut geometry = Geometry::parse(NODDING).unwrap();
    assert_eq!(geometry.check(), Ok(()));
    (geometry.unit_m, geometry.max_range_m) = (-1.0, Some(0.1));
    geometry.noise = Noise { noise_correlation_px: 0.5, turn_noise_deg: 6.0, ..geometry.noise };
    geometry.kind = Kind::Spinning {
        azimuth_deg: Angles::Even { start_deg: f64::INFINITY, step_deg: 0.0 },
        elevation_deg: Angles::Listed(vec![]),
        wraps: false,
    };
    let parts = |e: scanseg_formats::GeometryError| {
        let mut parts: Vec<String> =
            e.to_string().split("; `").map(|part| part.trim_matches('`').to_string()).collect();
        parts.sort();
        parts
    };
    let (checked, read) = (geometry.check().unwrap_err(), Geometry::parse(&geometry.to_toml()).unwrap_err());
    assert_eq!(parts(checked), parts(read.clone()));
    assert!(matches!(read, scanseg_formats::GeometryError::Several(errors) if errors.len() == 7));
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
    let mut far = Geometry::parse(SPINNING).unwrap();
    if let Kind::Spinning { azimuth_deg, .. } = &mut far.kind {
        *azimuth_deg = Angles::Even { start_deg: 0.0, step_deg: 1e308 };
    }
    assert_eq!(far.fits(3, 2), Ok(()));
    assert_eq!(
        far.fits(3, 3).unwrap_err().to_string(),
        "the beam of row 0, column 2 has no direction: numbers too large"
    );
    let mut sharp = Geometry::parse(PINHOLE).unwrap();
    if let Kind::Pinhole { fx_px, .. } = &mut sharp.kind {
        *fx_px = 1e-320;
    }
    assert!(sharp.fits(2, 2).is_err());
}

#[test]
fn a_file_that_cannot_be_read_is_named() {
    let message = Geometry::read("no/such/geometry.toml").unwrap_err().to_string();
    assert!(message.starts_with("no/such/geometry.toml: "), "{message}");
}

fn angles() -> impl Strategy<Value = Angles> {
    let step = prop_oneof![1e-300..90.0, -90.0..-1e-300];
    prop_oneof![
        (degrees(), step).prop_map(|(start, step)| Angles::Even { start_deg: start, step_deg: step }),
        prop::collection::vec(degrees(), 1..20).prop_map(Angles::Listed),
    ]
}

fn degrees() -> impl Strategy<Value = f64> {
    -36e3..=36e3
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
        (0.1..1e6, 0.1..1e6, -1e6..1e6, -1e6..1e6, depth).prop_map(
            |(fx, fy, cx, cy, depth): (f64, f64, f64, f64, Depth)| Kind::Pinhole {
                fx_px: fx,
                fy_px: -fy,
                cx_px: cx,
                cy_px: cy,
                depth
            }
        ),
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
        unit_m in 1e-300..=1000.0,
        no_return in any::<Vec<u16>>(),
        min_range_m in prop::option::of(0.0..1.0),
        max_range_m in prop::option::of(1.0..1e9),
        range_noise_m in prop::option::of(0.0..1.0),
        noise in noise(),
        kind in kind(),
        beside in (prop::option::of(angles()), prop::option::of(angles()), -10.0..10.0),
    ) {
        let (row_offset_deg, column_offset_deg, lever_arm_m) = beside;
        let beside = match kind {
            Kind::Nodding { .. } => Beside { row_offset_deg, column_offset_deg, lever_arm_m },
            Kind::Spinning { .. } => Beside { row_offset_deg, ..Beside::NONE },
            _ => Beside::NONE,
        };
        let geometry = Geometry { unit_m, no_return, min_range_m, max_range_m, range_noise_m, noise, kind, beside };
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
    assert!(unknown.starts_with("`sensor` is \"kinect\", must be one of sick-lms200, kinect-v1, "), "{unknown}");
}

#[test]
fn examples_of_the_documentation_are_geometry_files() {
    let page = include_str!("../../../docs/scan-format.md");
    let examples: Vec<_> = page.split("```toml\n").skip(1).filter_map(|rest| rest.split("```").next()).collect();
    let kinds = examples.iter().map(|text| match Geometry::parse(text).unwrap().kind {
        Kind::Nodding { .. } => "nodding",
        Kind::Spinning { .. } => "spinning",
        Kind::Pinhole { .. } => "pinhole",
        Kind::Free { .. } => "free",
    });
    assert!(kinds.eq(["nodding", "pinhole", "spinning"]));
    for sensor in SENSORS {
        assert!(page.contains(&format!("\n| `{}` | ", sensor.name)), "{}", sensor.name);
    }
    // keys of the page are keys of the format
    let first = |line: &'static str| line.strip_prefix("| `")?.split('`').next();
    for key in page.lines().filter_map(first).filter(|key| !SENSORS.iter().any(|sensor| sensor.name == *key)) {
        let meant = [SPINNING, NODDING, PINHOLE].map(|text| {
            let said = Geometry::parse(&format!("{text}{key}_ = 1\n")).unwrap_err().to_string();
            said.contains(&format!("(is `{key}` meant?)"))
        });
        assert!(meant.contains(&true), "{key} is not a key");
    }
}
