//! The memory that each approach asks for, and what is refused when a segmenter is made.

use scanseg_core::{
    AnyConfig, AnySegmenter, Approach, Area, Beams, Columns, ConfigError, EdgeConfig, EdgeSegmenter, MAX_COLUMNS,
    MAX_RANGE_M, MAX_TRACE_ROWS, MAX_TRACES, PlaneConfig, PlaneSegmenter, Ranging, RegionConfig, RegionSegmenter,
    Sizes, Trace, TurnAxis, buffers,
};
use scanseg_tests::stream::{Angles, Record, Rig, Room, Scan};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Mutex;

const RANGING: Ranging = Ranging::new(0.01);
const PLANE: PlaneConfig = PlaneConfig::new(RANGING);
const EDGE: EdgeConfig = EdgeConfig::paper();
const REGION: RegionConfig = RegionConfig::paper();
const APPROACHES: [AnyConfig; 3] = [AnyConfig::Plane(PLANE), AnyConfig::Edge(EDGE), AnyConfig::Region(REGION)];

const EVEN: Columns = Columns::Even { start_rad: -0.5, step_rad: 0.01 };
const BEAMS: Beams = Beams::Nodding { columns: EVEN, axis: TurnAxis::Y };

/// Bytes of the segmenter itself.
fn handle(approach: Approach) -> usize {
    match approach {
        Approach::Plane => size_of::<PlaneSegmenter>(),
        Approach::Edge => size_of::<EdgeSegmenter>(),
        Approach::Region => size_of::<RegionSegmenter>(),
    }
}

/// The figures of the README, for scanners of 1 deg and of 0.5 deg steps over 180 deg: the slices
/// and the segmenter itself, which is larger on a 64-bit host than with the shorter pointers of a
/// microcontroller.
#[test]
#[cfg(target_pointer_width = "64")]
fn bytes_of_each_approach() {
    let readme = include_str!("../../README.md");
    for (config, name, bytes) in [
        (APPROACHES[0], "default", [13_642, 26_362]),
        (APPROACHES[1], "edge-based", [13_072, 25_468]),
        (APPROACHES[2], "region-based", [11_682, 22_806]),
    ] {
        let found = [181, 361].map(|columns| config.sizes(columns).bytes() + handle(config.approach()));
        assert_eq!(found, bytes, "{name}");
        // in groups of three digits
        let [few, many] = bytes.map(|bytes| format!("{} {:03}", bytes / 1000, bytes % 1000));
        let line = format!("| {name} | {few} | {many} |");
        assert!(readme.contains(&line), "not in the README: {line}");
    }
    assert_eq!(size_of::<Area>(), 92);
    // chosen at run time, it is as large as the largest and says which it is
    let largest = APPROACHES.map(|config| handle(config.approach())).into_iter().max().unwrap();
    assert!(size_of::<AnySegmenter>() <= largest + 8);
}

/// On any host: 28 000 bytes for 361 columns, 14 000 for 181.
#[test]
fn fits_small_microcontrollers() {
    for config in APPROACHES {
        for (columns, most) in [(361, 28_000), (181, 14_000)] {
            let bytes = config.sizes(columns).bytes() + handle(config.approach());
            println!("{:?}, {columns} columns: {bytes} bytes", config.approach());
            assert!(bytes <= most, "{:?}, {columns} columns: {bytes} bytes", config.approach());
        }
    }
}

/// `bytes` is what the slices take, and grows with the columns and no faster.
#[test]
fn bytes_of_the_slices() {
    const DIAGONALS: &[Trace] = &[Trace::ROW, Trace::COLUMN.times(7), Trace::DIAGONAL];
    let more = AnyConfig::Edge(EDGE.with_traces(DIAGONALS));
    for config in APPROACHES.into_iter().chain([more]) {
        for columns in [1, 2, 31, 32, 33, 361, MAX_COLUMNS] {
            let sizes = config.sizes(columns);
            let Room { numbers, halves, words, areas } = Room::new(columns, config, sizes.areas);
            let bytes = size_of_val(&*numbers) + size_of_val(&*halves) + size_of_val(&*words) + size_of_val(&*areas);
            assert_eq!(sizes.bytes(), bytes);
            // rows of bearing angles are whole chunks of 32 columns, with room for one column more
            let padding = if let AnyConfig::Edge(config) = config { 32 * 4 * config.traces.len() } else { 0 };
            assert!(
                bytes <= columns * (8 + 28 + 2 * 6 + 88 * 5 / 7 + 3) + 400 + padding,
                "{:?}, {columns} columns: {bytes} bytes",
                config.approach()
            );
        }
    }
}

/// The memory of the larger of two is enough for both.
#[test]
fn memory_for_any_approach() {
    let [one, other, third] = APPROACHES.map(|config| config.sizes(33));
    let sizes = one.max(other).max(third);
    assert_eq!(sizes, third.max(one).max(other));
    let lengths = |sizes: Sizes| [sizes.numbers, sizes.halves, sizes.words, sizes.areas];
    for (i, length) in lengths(sizes).into_iter().enumerate() {
        assert_eq!([one, other, third].map(|sizes| lengths(sizes)[i]).into_iter().max(), Some(length));
    }
    let mut room = Room::of(sizes);
    for config in APPROACHES {
        assert!(AnySegmenter::new(config, BEAMS, 33, room.memory()).is_ok());
    }
}

/// Debug output tells the lengths of the slices, and not all that they hold.
#[test]
fn memory_as_text() {
    let mut buffers = <buffers!(33, PLANE, 4)>::EMPTY;
    let Sizes { numbers, halves, words, .. } = PLANE.sizes(33);
    let lengths = [numbers, halves, words, 4];
    assert_eq!(format!("{buffers:?}"), format!("Buffers({lengths:?})"));
    assert_eq!(format!("{:?}", buffers.memory()), format!("Memory({lengths:?})"));
}

/// A scan for statics: every second column has a return, every fifth row all.
fn grid() -> Scan {
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.5, step_rad: 0.01 }, axis: TurnAxis::Y };
    let hit = |i: usize| (i % 33).is_multiple_of(2) || (i / 33).is_multiple_of(5);
    let range_m = (0..33 * 12).map(|i| if hit(i) { 2.0 } else { 0.0 }).collect();
    Scan { columns: 33, range_m, turn_rad: (0..12).map(|row| 0.01 * row as f32).collect(), rig }
}

/// Two statics for a configuration, one with a table of four live labels: each has what the
/// approach needs and no more, and segments as any other memory, also once other scans have filled
/// it.
macro_rules! assert_statics {
    ($config:ident) => {{
        static FULL: Mutex<buffers!(33, $config)> = Mutex::new(<buffers!(33, $config)>::EMPTY);
        static SMALL: Mutex<buffers!(33, $config, 4)> = Mutex::new(<buffers!(33, $config, 4)>::EMPTY);
        let (scan, needed) = (grid(), $config.sizes(33));
        for _ in 0..2 {
            let (mut full, mut small) = (FULL.lock().unwrap(), SMALL.lock().unwrap());
            for (memory, needed) in [(full.memory(), needed), (small.memory(), $config.sizes_with(33, 4))] {
                let lengths = [memory.numbers.len(), memory.halves.len(), memory.words.len(), memory.areas.len()];
                let Sizes { numbers, halves, words, areas } = needed;
                assert_eq!(lengths, [numbers, halves, words, areas]);
                let mut segmenter = AnySegmenter::new($config, scan.beams(), 33, memory).unwrap();
                let mut record = Record::default();
                scan.feed(&mut segmenter, &mut record).unwrap();
                assert_eq!(record, scan.record($config, areas));
                assert!(!record.segments().is_empty());
            }
        }
        size_of_val(&*FULL.lock().unwrap())
    }};
}

#[test]
fn buffers_in_statics() {
    const CHOSEN: AnyConfig = AnyConfig::Region(REGION);
    let bytes = [assert_statics!(PLANE), assert_statics!(EDGE), assert_statics!(REGION), assert_statics!(CHOSEN)];
    // no approach pays for another one, but for what alignment adds
    let needed = APPROACHES.map(|config| config.sizes(33).bytes());
    for (bytes, needed) in bytes.into_iter().zip([needed[0], needed[1], needed[2], needed[2]]) {
        assert!((needed..needed + 4).contains(&bytes), "{bytes} {needed}");
    }
}

/// Why a segmenter of 33 columns cannot be made; `None` if it can. The same whether it is chosen at
/// run time or not.
fn refused(config: AnyConfig, beams: Beams, columns: usize, memory: Sizes) -> Option<ConfigError> {
    let mut room = Room::of(memory);
    let own = match config {
        AnyConfig::Plane(config) => PlaneSegmenter::new(config, beams, columns, room.memory()).err(),
        AnyConfig::Edge(config) => EdgeSegmenter::new(config, beams, columns, room.memory()).err(),
        AnyConfig::Region(config) => RegionSegmenter::new(config, beams, columns, room.memory()).err(),
        _ => panic!("an approach without a test: {config:?}"),
    };
    let chosen = AnySegmenter::new(config, beams, columns, room.memory()).err();
    // by their text, because NaN does not equal itself
    assert_eq!(format!("{own:?}"), format!("{chosen:?}"));
    own
}

/// [`refused`] with enough memory.
fn refused_by(config: impl Into<AnyConfig<'static>>, beams: Beams, columns: usize) -> Option<ConfigError> {
    // memory is looked at last, and columns that are not possible need none
    let config = config.into();
    refused(config, beams, columns, config.sizes_with(columns.min(MAX_COLUMNS), 1))
}

/// [`refused_by`] every approach alike.
fn refused_by_all(ranging: Ranging, beams: Beams, columns: usize) -> Option<ConfigError> {
    let by_planes = refused_by(PLANE.with_ranging(ranging), beams, columns);
    let by_edges = refused_by(EDGE.with_ranging(ranging), beams, columns);
    let by_regions = refused_by(REGION.with_ranging(ranging), beams, columns);
    for other in [by_edges, by_regions] {
        assert_eq!(format!("{by_planes:?}"), format!("{other:?}"), "all approaches");
    }
    by_planes
}

/// What each approach needs is enough, also with a single area; an element less of any slice is
/// refused by the name of the slice and by both numbers, and more does no harm.
#[test]
fn too_small_memory() {
    for config in APPROACHES {
        let needed = config.sizes_with(33, 1);
        let with = |memory| refused(config, BEAMS, 33, memory);
        assert_eq!(with(needed), None);
        let less = [
            ("numbers", needed.numbers, Sizes { numbers: needed.numbers - 1, ..needed }),
            ("halves", needed.halves, Sizes { halves: needed.halves - 1, ..needed }),
            ("words", needed.words, Sizes { words: needed.words - 1, ..needed }),
            ("areas", 1, Sizes { areas: 0, ..needed }),
        ];
        for (field, needed, memory) in less {
            let error = ConfigError::Memory { field, needed, got: needed - 1 };
            assert_eq!(with(memory), Some(error), "{:?}", config.approach());
            let message = error.to_string();
            assert!(message.contains(field) && message.contains(&needed.to_string()), "{message}");
        }
        let Sizes { numbers, halves, words, .. } = config.sizes(33);
        let more = Sizes { numbers: numbers + 1, halves: halves + 1, words: words + 1, areas: 70_000 };
        assert_eq!(with(more), None);
    }
}

/// A value of a configuration: the ends of its range are taken, what is beyond them is refused by
/// name and value.
fn assert_value(field: &'static str, good: &[f32], bad: &[f32], with: impl Fn(f32) -> Option<ConfigError>) {
    for &value in good {
        assert_eq!(with(value), None, "{field} {value}");
    }
    for value in bad.iter().copied().chain([f32::INFINITY, f32::NEG_INFINITY]) {
        assert_eq!(with(value), Some(ConfigError::Value { field, value }));
        let message = ConfigError::Value { field, value }.to_string();
        assert!(message.contains(field) && message.contains(&value.to_string()), "{message}");
    }
    assert_not_a_number(with(f32::NAN), field);
}

/// What all approaches are told of the ranges.
#[test]
fn values_of_ranges() {
    let with = |ranging| refused_by_all(ranging, BEAMS, 33);
    let Ranging { range_noise_m, min_range_m, max_range_m, .. } = RANGING;
    assert_value("range_noise_m", &[0.0, 10.0], &[-1e-6, 10.1], |noise_m| {
        with(Ranging::new(noise_m).with_limits(min_range_m, max_range_m))
    });
    type With = fn(f32) -> Ranging;
    let further: [(&'static str, [f32; 2], [f32; 2], With); 8] = [
        ("range_noise_per_m", [0.0, 1.0], [-1e-6, 1.1], |b| RANGING.with_growing_noise(b, 0.0)),
        ("range_noise_per_m2", [0.0, 1.0], [-1e-6, 1.1], |c| RANGING.with_growing_noise(0.0, c)),
        ("range_step_m", [0.0, 10.0], [-1e-6, 10.1], |step_m| RANGING.with_steps(step_m, 0.0)),
        ("range_step_per_m2", [0.0, 1.0], [-1e-6, 1.1], |step| RANGING.with_steps(0.0, step)),
        ("noise_correlation_px", [1.0, 100.0], [0.9, 101.0], |px| RANGING.with_correlation_px(px)),
        ("beam_noise_rad", [0.0, 0.1], [-1e-6, 0.11], |rad| RANGING.with_beam_noise_rad(rad)),
        ("turn_noise_rad", [0.0, 0.1], [-1e-6, 0.11], |rad| RANGING.with_turn_noise_rad(rad)),
        ("flatness_m", [0.0, 10.0], [-1e-6, 10.1], |m| RANGING.with_flatness_m(m)),
    ];
    for (field, good, bad, ranging) in further {
        assert_value(field, &good, &bad, |value| with(ranging(value)));
    }
    assert_value("min_range_m", &[1e-6, 100.0], &[0.0, -1.0, 100.1], |min_m| {
        with(Ranging::new(range_noise_m).with_limits(min_m, max_range_m))
    });
    assert_value("max_range_m", &[0.05, MAX_RANGE_M], &[0.0, -1.0, MAX_RANGE_M.next_up()], |max_m| {
        with(Ranging::new(range_noise_m).with_limits(min_range_m, max_m))
    });
}

/// Thresholds of the paper's two approaches.
#[test]
fn values_of_thresholds() {
    assert_value("roof_angle_rad", &[1e-6, PI], &[0.0, -0.1, PI.next_up()], |angle_rad| {
        refused_by(EDGE.with_roof_angle_rad(angle_rad), BEAMS, 33)
    });
    assert_value("step_angle_rad", &[0.0, FRAC_PI_2], &[-0.1, FRAC_PI_2.next_up()], |angle_rad| {
        refused_by(EDGE.with_step_angle_rad(angle_rad), BEAMS, 33)
    });
    assert_value("line_angle_rad", &[1e-6, FRAC_PI_2], &[0.0, -0.1, FRAC_PI_2.next_up()], |angle_rad| {
        refused_by(REGION.with_line_angle_rad(angle_rad), BEAMS, 33)
    });
    assert_value("plane_distance_m", &[0.0, 1.0], &[-1e-6, 1.1], |distance_m| {
        refused_by(REGION.with_plane_distance_m(distance_m), BEAMS, 33)
    });
}

fn assert_not_a_number(found: Option<ConfigError>, expected: &str) {
    match found {
        Some(ConfigError::Value { field, value }) => assert!(field == expected && value.is_nan()),
        other => panic!("{expected}: {other:?}"),
    }
}

#[test]
fn traces() {
    // traces that are not possible need no memory
    let with = |traces: &[Trace]| {
        let possible = EDGE.with_traces(&traces[..traces.len().min(MAX_TRACES)]);
        let memory = possible.sizes_with(33, 1);
        refused(AnyConfig::Edge(EDGE.with_traces(traces)), BEAMS, 33, memory)
    };
    let count = |field, value| Some(ConfigError::Count { field, value });
    let trace = |rows, columns| Trace { rows, columns };
    assert_eq!(with(&[Trace::ROW; MAX_TRACES]), None);
    assert_eq!(with(&[]), count("traces", 0));
    assert_eq!(with(&[Trace::ROW; MAX_TRACES + 1]), count("traces", 9));
    assert_eq!(with(&[trace(MAX_TRACE_ROWS, -128), trace(0, 127)]), None);
    assert_eq!(with(&[Trace::ROW, trace(MAX_TRACE_ROWS + 1, 0)]), count("traces.rows", 17));
    assert_eq!(with(&[Trace::ROW, trace(0, 0)]), count("traces.columns", 0));
    assert_eq!(with(&[trace(0, -1)]), count("traces.columns", -1));
    assert_eq!(Trace::ANTIDIAGONAL.times(255), trace(255, -128));
    assert_eq!(Trace::ROW.times(200), trace(0, 127));
}

#[test]
fn numbers_of_columns() {
    let count = |value| Some(ConfigError::Count { field: "columns", value });
    assert_eq!(refused_by_all(RANGING, BEAMS, 0), count(0));
    assert_eq!(refused_by_all(RANGING, BEAMS, 1), None);
    assert_eq!(refused_by_all(RANGING, BEAMS, MAX_COLUMNS), None);
    assert_eq!(refused_by_all(RANGING, BEAMS, MAX_COLUMNS + 1), count(16_385));
}

/// Column angles, of nodding and of spinning beams.
#[test]
fn column_angles() {
    let both = |columns: Columns| {
        let nodding = refused_by_all(RANGING, Beams::Nodding { columns, axis: TurnAxis::Z }, 33);
        let spinning = refused_by_all(RANGING, Beams::Spinning { columns, wraps: false }, 33);
        // by their text, because NaN does not equal itself
        assert_eq!(format!("{nodding:?}"), format!("{spinning:?}"));
        nodding
    };
    let even = |start_rad, step_rad| both(Columns::Even { start_rad, step_rad });
    let value = |field, value| Some(ConfigError::Value { field, value });
    assert_eq!([even(TAU, FRAC_PI_2), even(-TAU, -FRAC_PI_2), even(0.0, 1e-6)], [None, None, None]);
    for bad in [TAU.next_up(), -7.0, f32::INFINITY, f32::NEG_INFINITY] {
        assert_eq!(even(bad, 0.01), value("start_rad", bad));
        assert_eq!(even(0.0, bad), value("step_rad", bad));
        let mut list = [0.1; 33];
        assert_eq!(both(Columns::Listed(&list)), None);
        list[32] = bad;
        assert_eq!(both(Columns::Listed(&list)), value("columns", bad));
    }
    assert_eq!(even(0.0, 0.0), value("step_rad", 0.0));
    assert_not_a_number(even(f32::NAN, 0.01), "start_rad");
    assert_not_a_number(even(0.0, f32::NAN), "step_rad");
    assert_not_a_number(both(Columns::Listed(&[f32::NAN; 33])), "columns");
    for got in [0, 32, 34] {
        assert_eq!(both(Columns::Listed(&vec![0.0; got])), Some(ConfigError::Listed { columns: 33, got }));
    }
}

/// Even azimuths of an image that wraps go round once: 33 steps of 1 / 33 turn, either way, but for
/// 1 % of a step.
#[test]
fn azimuths_that_wrap() {
    let with = |step_rad| {
        let beams = Beams::Spinning { columns: Columns::Even { start_rad: 0.0, step_rad }, wraps: true };
        refused_by_all(RANGING, beams, 33)
    };
    // the step with which the last column is nearer to the first by a share of a step
    let nearer = |share: f32| TAU / (33.0 - share);
    for share in [0.0, 0.009, -0.009] {
        assert_eq!([with(nearer(share)), with(-nearer(share))], [None, None], "{share}");
    }
    for share in [0.011, -0.011, 0.02, -0.02, 0.29, -0.29, 1.0, -1.0, 16.5] {
        for bad in [nearer(share), -nearer(share)] {
            let refused = Some(ConfigError::Value { field: "wraps: step_rad", value: bad });
            assert_eq!(with(bad), refused, "{share}");
        }
    }
}

#[test]
fn pinhole_parameters() {
    let with = |fx_px, fy_px, cx_px, cy_px| refused_by_all(RANGING, Beams::Pinhole { fx_px, fy_px, cx_px, cy_px }, 33);
    assert_eq!(with(0.1, -1e6, -1e6, 1e6), None);
    for bad in [1.1e6, -1.1e6, f32::INFINITY, f32::NEG_INFINITY] {
        for (found, field) in [
            (with(bad, 100.0, 0.0, 0.0), "fx_px"),
            (with(100.0, bad, 0.0, 0.0), "fy_px"),
            (with(100.0, 100.0, bad, 0.0), "cx_px"),
            (with(100.0, 100.0, 0.0, bad), "cy_px"),
        ] {
            assert_eq!(found, Some(ConfigError::Value { field, value: bad }));
        }
    }
    for zero in [0.0, -0.0, 0.05] {
        assert_eq!(with(zero, 100.0, 0.0, 0.0), Some(ConfigError::Value { field: "fx_px", value: zero }));
        assert_eq!(with(100.0, zero, 0.0, 0.0), Some(ConfigError::Value { field: "fy_px", value: zero }));
    }
    assert_not_a_number(with(f32::NAN, 100.0, 0.0, 0.0), "fx_px");
    assert_not_a_number(with(100.0, f32::NAN, 0.0, 0.0), "fy_px");
    assert_not_a_number(with(100.0, 100.0, f32::NAN, 0.0), "cx_px");
    assert_not_a_number(with(100.0, 100.0, 0.0, f32::NAN), "cy_px");
}
