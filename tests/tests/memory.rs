//! The memory that a segmenter asks for, and what is refused when it is made.

use scanseg_core::{
    Area, Beams, Columns, Config, ConfigError, EdgeSegmenter, MAX_COLUMNS, MAX_RANGE_M, MAX_TRACE_ROWS, MAX_TRACES,
    PlaneSegmenter, RegionSegmenter, Sizes, Trace, TurnAxis, buffers, live_labels,
};
use scanseg_tests::stream::{Angles, Record, Rig, Room, Scan};
use std::f32::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Mutex;

const CONFIG: Config = Config::paper();
const EVEN: Columns = Columns::Even { start_rad: -0.5, step_rad: 0.01 };
const BEAMS: Beams = Beams::Nodding { columns: EVEN, axis: TurnAxis::Y };

/// A scanner of 0.5 deg steps over 180 deg in 24 KiB, one of 1 deg steps in 12 KiB, all told: the slices and the segmenter
/// itself, which is larger here than with the shorter pointers of a microcontroller.
#[test]
fn fits_small_microcontrollers() {
    for (columns, kib) in [(361, 24), (181, 12)] {
        let segmenter = size_of::<EdgeSegmenter>().max(size_of::<RegionSegmenter>());
        let bytes = Sizes::of(columns, &CONFIG).bytes() + segmenter;
        println!("{columns} columns: {bytes} bytes");
        assert!(bytes <= kib * 1024, "{columns} columns: {bytes} bytes");
    }
}

/// The plane segmenter makes do with the same slices: its bytes, on a 64-bit host.
#[test]
#[cfg(target_pointer_width = "64")]
fn planes_in_the_same_memory() {
    for (columns, most, bytes) in [(361, 40 * 1024, 23_868), (181, 14 * 1024, 12_192)] {
        let found = Sizes::of(columns, &CONFIG).bytes() + size_of::<PlaneSegmenter>();
        assert_eq!(found, bytes, "{columns} columns");
        assert!(bytes <= most);
    }
}

/// `bytes` is what the slices take, and grows with the columns and no faster.
#[test]
fn bytes_of_the_slices() {
    let diagonals = Config { traces: &[Trace::ROW, Trace::COLUMN.times(7), Trace::DIAGONAL], ..CONFIG };
    for config in [CONFIG, diagonals] {
        for columns in [1, 2, 31, 32, 33, 361, MAX_COLUMNS] {
            let sizes = Sizes::of(columns, &config);
            let Room { ranges, bearings, words, areas } = Room::new(columns, &config, sizes.areas);
            let bytes = size_of_val(&*ranges) + size_of_val(&*bearings) + size_of_val(&*words) + size_of_val(&*areas);
            assert_eq!(sizes.bytes(), bytes);
            // rows of bearing angles are whole chunks of 32 columns, with room for one column more
            let padding = 32 * 4 * config.traces.len();
            assert!(
                bytes <= columns * (8 + 28 + 2 * 6 + 84 / 2 + 3) + 200 + padding,
                "{columns} columns: {bytes} bytes"
            );
        }
    }
}

/// Two statics, one with a table of four live labels, both filled by other scans before.
#[test]
fn buffers_in_statics() {
    static FULL: Mutex<buffers!(33, CONFIG)> = Mutex::new(<buffers!(33, CONFIG)>::EMPTY);
    static SMALL: Mutex<buffers!(33, CONFIG, 4)> = Mutex::new(<buffers!(33, CONFIG, 4)>::EMPTY);
    let rig = Rig::Nodding { angles: Angles::Even { start_rad: -0.5, step_rad: 0.01 }, axis: TurnAxis::Y };
    // every second column has a return, every fifth row all
    let hit = |i: usize| (i % 33).is_multiple_of(2) || (i / 33).is_multiple_of(5);
    let range_m = (0..33 * 12).map(|i| if hit(i) { 2.0 } else { 0.0 }).collect();
    let scan = Scan { columns: 33, range_m, turn_rad: (0..12).map(|row| 0.01 * row as f32).collect(), rig };
    for _ in 0..2 {
        let (mut full, mut small) = (FULL.lock().unwrap(), SMALL.lock().unwrap());
        for (memory, areas) in [(full.memory(), live_labels(33)), (small.memory(), 4)] {
            assert_eq!(memory.areas.len(), areas);
            let mut segmenter = EdgeSegmenter::new(CONFIG, scan.beams(), 33, memory).unwrap();
            let mut record = Record::default();
            scan.feed(&mut segmenter, &mut record).unwrap();
            assert_eq!(record, scan.record(&CONFIG, areas));
            assert!(!record.segments().is_empty());
        }
        for (memory, areas) in [(full.memory(), live_labels(33)), (small.memory(), 4)] {
            let mut segmenter = RegionSegmenter::new(CONFIG, scan.beams(), 33, memory).unwrap();
            let mut record = Record::default();
            scan.feed(&mut segmenter, &mut record).unwrap();
            assert_eq!(record, scan.record_regions(&CONFIG, areas));
        }
        for (memory, areas) in [(full.memory(), live_labels(33)), (small.memory(), 4)] {
            let mut segmenter = PlaneSegmenter::new(CONFIG, scan.beams(), 33, memory).unwrap();
            let mut record = Record::default();
            scan.feed(&mut segmenter, &mut record).unwrap();
            assert_eq!(record, scan.record_planes(&CONFIG, areas));
        }
    }
}

/// What is wrong with a segmenter of 33 columns; `None` if nothing is.
fn refused(config: Config, beams: Beams, columns: usize) -> Option<ConfigError> {
    // memory is looked at last, and traces and columns that are not possible need none
    let sane = Config { traces: &config.traces[..config.traces.len().min(MAX_TRACES)], ..config };
    let mut room = Room::new(columns.min(MAX_COLUMNS), &sane, 1);
    let by_regions = RegionSegmenter::new(config, beams, columns, room.memory()).err();
    let by_planes = PlaneSegmenter::new(config, beams, columns, room.memory()).err();
    let refused = EdgeSegmenter::new(config, beams, columns, room.memory()).err();
    // by their text, because NaN does not equal itself
    for other in [by_regions, by_planes] {
        assert_eq!(format!("{refused:?}"), format!("{other:?}"), "all segmenters");
    }
    refused
}

#[test]
fn too_small_memory() {
    let sizes = Sizes::of(33, &CONFIG);
    let with = |shrink: fn(&mut Room)| {
        let mut room = Room::new(33, &CONFIG, 1);
        shrink(&mut room);
        let by_regions = RegionSegmenter::new(CONFIG, BEAMS, 33, room.memory()).err();
        let by_planes = PlaneSegmenter::new(CONFIG, BEAMS, 33, room.memory()).err();
        let refused = EdgeSegmenter::new(CONFIG, BEAMS, 33, room.memory()).err();
        assert_eq!([refused; 2], [by_regions, by_planes]);
        refused
    };
    let memory = |field, needed| Some(ConfigError::Memory { field, needed, got: needed - 1 });
    assert_eq!(with(|_| {}), None);
    assert_eq!(with(|room| room.ranges.truncate(room.ranges.len() - 1)), memory("ranges", sizes.ranges));
    assert_eq!(with(|room| room.bearings.truncate(room.bearings.len() - 1)), memory("bearings", sizes.bearings));
    assert_eq!(with(|room| room.words.truncate(room.words.len() - 1)), memory("words", sizes.words));
    assert_eq!(with(|room| room.areas.truncate(room.areas.len() - 1)), memory("areas", 1));
    // more than is needed does no harm
    let more = |room: &mut Room| {
        room.ranges.push(0.0);
        room.bearings.push(0);
        room.words.push(0);
        room.areas.resize(70_000, Area::EMPTY);
    };
    assert_eq!(with(more), None);
}

/// Every number of a configuration: the ends of its range are taken, what is beyond them is refused by name and value.
#[test]
fn values_of_a_configuration() {
    type Set = fn(&mut Config, f32);
    let fields: [(&str, Set, &[f32], &[f32]); 7] = [
        ("range_noise_m", |c, v| c.range_noise_m = v, &[0.0, 10.0], &[-1e-6, 10.1]),
        ("min_range_m", |c, v| c.min_range_m = v, &[1e-6, 100.0], &[0.0, -1.0, 100.1]),
        ("max_range_m", |c, v| c.max_range_m = v, &[0.05, MAX_RANGE_M], &[0.0, -1.0, MAX_RANGE_M.next_up()]),
        ("roof_angle_rad", |c, v| c.roof_angle_rad = v, &[1e-6, PI], &[0.0, -0.1, PI.next_up()]),
        ("step_angle_rad", |c, v| c.step_angle_rad = v, &[0.0, FRAC_PI_2], &[-0.1, FRAC_PI_2.next_up()]),
        ("line_angle_rad", |c, v| c.line_angle_rad = v, &[1e-6, FRAC_PI_2], &[0.0, -0.1, FRAC_PI_2.next_up()]),
        ("plane_distance_m", |c, v| c.plane_distance_m = v, &[0.0, 1.0], &[-1e-6, 1.1]),
    ];
    for (field, set, good, bad) in fields {
        let with = |value| {
            let mut config = CONFIG;
            set(&mut config, value);
            refused(config, BEAMS, 33)
        };
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
}

fn assert_not_a_number(found: Option<ConfigError>, expected: &str) {
    match found {
        Some(ConfigError::Value { field, value }) => assert!(field == expected && value.is_nan()),
        other => panic!("{expected}: {other:?}"),
    }
}

#[test]
fn traces() {
    let with = |traces: &[Trace]| refused(Config { traces, ..CONFIG }, BEAMS, 33);
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
    assert_eq!(refused(CONFIG, BEAMS, 0), count(0));
    assert_eq!(refused(CONFIG, BEAMS, 1), None);
    assert_eq!(refused(CONFIG, BEAMS, MAX_COLUMNS), None);
    assert_eq!(refused(CONFIG, BEAMS, MAX_COLUMNS + 1), count(16_385));
}

/// Column angles, of nodding and of spinning beams.
#[test]
fn column_angles() {
    let both = |columns: Columns| {
        let nodding = refused(CONFIG, Beams::Nodding { columns, axis: TurnAxis::Z }, 33);
        let spinning = refused(CONFIG, Beams::Spinning { columns, wraps: false }, 33);
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

/// Even azimuths of an image that wraps go round once: 33 steps of 1 / 33 turn, either way, but for 1 % of a step.
#[test]
fn azimuths_that_wrap() {
    let with = |step_rad| {
        let beams = Beams::Spinning { columns: Columns::Even { start_rad: 0.0, step_rad }, wraps: true };
        refused(CONFIG, beams, 33)
    };
    let step_rad = TAU / 33.0;
    assert_eq!([with(step_rad), with(-step_rad)], [None, None]);
    for bad in [1.01 * step_rad, 0.99 * step_rad, 2.0 * step_rad, TAU / 32.0, TAU / 34.0] {
        assert_eq!(with(bad), Some(ConfigError::Value { field: "wraps: step_rad", value: bad }));
    }
}

#[test]
fn pinhole_parameters() {
    let with = |fx_px, fy_px, cx_px, cy_px| refused(CONFIG, Beams::Pinhole { fx_px, fy_px, cx_px, cy_px }, 33);
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
