//! What comes out for C is what the core finds.

use std::collections::BTreeMap;
use std::ops::ControlFlow;
use std::ptr::null;

use scanseg_capi::*;
use scanseg_capi_tests::{ANY_APPROACH, APPROACHES, COLUMNS, ROWS, Session, nodding, output, room_m, state_size};
use scanseg_core::{
    AnyConfig, AnySegmenter, Area, Beams, Columns, EdgeConfig, Finished, Join, LabelRow, Memory, Pixel, PlaneConfig,
    Ranging, RegionConfig, Segment, Segmenter, Sink, TurnAxis,
};

#[derive(Default)]
pub struct Collected {
    labels: Vec<u32>,
    joins: Vec<(u32, u32)>,
    segments: Vec<Segment>,
}

impl Sink for Collected {
    fn row(&mut self, row: &LabelRow<'_>) -> ControlFlow<()> {
        self.labels.extend(row.pixels().map(|pixel| match pixel {
            Pixel::NoReturn => 0,
            Pixel::Edge => 0xFFFF_FFFF,
            Pixel::Unlabelled => 0xFFFF_FFFE,
            Pixel::Segment(label) => label.0,
        }));
        ControlFlow::Continue(())
    }

    fn join(&mut self, join: Join) -> ControlFlow<()> {
        self.joins.push((join.from.0, join.into.0));
        ControlFlow::Continue(())
    }

    fn segment(&mut self, segment: &Segment) -> ControlFlow<()> {
        self.segments.push(*segment);
        ControlFlow::Continue(())
    }
}

/// The settings of the core: the paper's, or for planes those of the C configuration.
fn core_config(config: &Config) -> AnyConfig<'static> {
    let ranging = Ranging::new(config.range_noise_m)
        .with_growing_noise(config.range_noise_per_m, config.range_noise_per_m2)
        .with_steps(config.range_step_m, config.range_step_per_m2)
        .with_correlation_px(config.noise_correlation_px)
        .with_beam_noise_rad(config.beam_noise_rad)
        .with_turn_noise_rad(config.turn_noise_rad)
        .with_flatness_m(config.flatness_m);
    match config.approach {
        SCANSEG_PLANE => PlaneConfig::new(ranging).into(),
        SCANSEG_EDGE => EdgeConfig::paper().into(),
        _ => RegionConfig::paper().into(),
    }
}

/// The core's own answer.
fn by_core(config: AnyConfig<'_>, beams: Beams<'_>, areas: usize, rows: &[Vec<f32>]) -> Collected {
    let sizes = config.sizes(COLUMNS);
    let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
    let (mut words, mut areas) = (vec![0; sizes.words], vec![Area::EMPTY; areas]);
    let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
    let mut found = Collected::default();
    let mut segmenter = AnySegmenter::new(config, beams, COLUMNS, memory).unwrap();
    for (row, ranges_m) in rows.iter().enumerate() {
        segmenter.push_row(ranges_m, turn_rad(row), &mut found).unwrap();
    }
    assert!(matches!(segmenter.finish(&mut found), Finished::Complete { .. }));
    found
}

fn turn_rad(row: usize) -> f32 {
    0.01 * row as f32 - 0.2
}

/// Two scans; gives the labels.
fn compare(config: &Config, beams: Beams<'_>, noise: f32) -> Vec<u32> {
    let rows: Vec<_> = (0..ROWS).map(|row| room_m(row, COLUMNS, noise)).collect();
    // a state has room for every approach
    let all = [PlaneConfig::new(Ranging::new(0.01)).into(), EdgeConfig::paper().into(), RegionConfig::paper().into()]
        .map(|config: AnyConfig<'_>| config.sizes(COLUMNS).areas);
    let all = all.into_iter().max().unwrap();
    let areas = if config.max_labels == 0 { all } else { config.max_labels as usize };
    let core = by_core(core_config(config), beams, areas, &rows);
    let mut session = Session::new(config);
    for scan in 0..if cfg!(miri) { 1 } else { 2 } {
        for (row, ranges_m) in rows.iter().enumerate() {
            assert_eq!(session.push(ranges_m, turn_rad(row)), SCANSEG_OK);
        }
        assert_eq!(session.finish(), SCANSEG_OK);
        assert_eq!(session.labels, core.labels, "scan {scan}");
        let joins: Vec<_> =
            session.events.iter().filter(|e| e.kind == SCANSEG_JOIN).map(|e| (e.label, e.into)).collect();
        assert_eq!(joins, core.joins);
        let segments: Vec<_> = session.events.iter().filter(|e| e.kind == SCANSEG_SEGMENT).collect();
        assert_eq!(segments.len(), core.segments.len());
        for (event, segment) in segments.iter().zip(&core.segments) {
            assert_eq!((event.label, event.pixels), (segment.label.0, segment.pixels()));
            assert_eq!(
                (event.first_row, event.last_row, event.first_column, event.last_column),
                (segment.first_row, segment.last_row, segment.first_column, segment.last_column)
            );
            let mut fit = PlaneFit::default();
            // SAFETY: references.
            let status = unsafe { scanseg_fit_plane(*event, &mut fit) };
            let Some(plane) = segment.plane() else {
                assert_eq!((status, fit), (SCANSEG_NO_PLANE, PlaneFit::default()));
                continue;
            };
            assert_eq!((status, fit.centroid_m), (SCANSEG_OK, segment.centroid_m()));
            assert_eq!((fit.normal, fit.distance_m, fit.rms_m), (plane.normal, plane.distance_m, plane.rms_m));
            assert_eq!(fit.covariance, plane.covariance);
        }
        assert!(!core.segments.is_empty());
        assert_eq!(session.reset(), SCANSEG_OK);
    }
    core.labels
}

const EVEN: Columns<'_> = Columns::Even { start_rad: -0.9, step_rad: 0.01 };

#[test]
fn nodding_as_the_core() {
    for approach in APPROACHES {
        for (beams, axis) in [(SCANSEG_NODDING_Y, TurnAxis::Y), (SCANSEG_NODDING_Z, TurnAxis::Z)] {
            if cfg!(miri) && beams != SCANSEG_NODDING_Y {
                continue;
            }
            compare(&Config { beams, ..nodding(approach) }, Beams::Nodding { columns: EVEN, axis }, 0.01);
        }
    }
}

/// Each setting of the noise reaches the core, and changes a plane.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn noise_as_the_core() {
    let with: [fn(&mut Config); 9] = [
        |_| (),
        |c| c.range_noise_per_m = 0.01,
        |c| c.range_noise_per_m2 = 0.01,
        |c| c.range_step_m = 0.1,
        |c| c.range_step_per_m2 = 0.1,
        |c| c.noise_correlation_px = 2.0,
        |c| c.beam_noise_rad = 0.02,
        |c| c.turn_noise_rad = 0.02,
        |c| c.flatness_m = 0.1,
    ];
    let mut seen = std::collections::BTreeSet::new();
    for change in with {
        let mut config = nodding(SCANSEG_PLANE);
        change(&mut config);
        compare(&config, Beams::Nodding { columns: EVEN, axis: TurnAxis::Y }, 0.02);
        let mut session = Session::new(&config);
        for row in 0..ROWS {
            assert_eq!(session.push(&room_m(row, COLUMNS, 0.02), turn_rad(row)), SCANSEG_OK);
        }
        assert_eq!(session.finish(), SCANSEG_OK);
        seen.insert(format!("{:?} {:?}", session.labels, session.events));
    }
    assert_eq!(seen.len(), with.len());
}

#[test]
fn listed_columns_as_the_core() {
    let angles_rad: Vec<f32> = (0..COLUMNS).map(|i| 0.01 * i as f32 + 0.003 * (i as f32).sin() - 0.9).collect();
    for &approach in ANY_APPROACH {
        let mut copy = angles_rad.clone();
        let config =
            Config { column_angles_rad: copy.as_mut_ptr(), column_angle_count: COLUMNS as u32, ..nodding(approach) };
        // slow under Miri, where `nodding_as_the_core` takes the same way
        if !cfg!(miri) {
            let columns = Columns::Listed(&angles_rad);
            compare(&config, Beams::Nodding { columns, axis: TurnAxis::Y }, 0.01);
        }
        // the list need not stay: it is copied
        let mut session = Session::new(&config);
        copy.fill(f32::NAN);
        drop(copy);
        assert_eq!(session.push(&room_m(0, COLUMNS, 0.0), 0.0), SCANSEG_OK);
    }
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn spinning_as_the_core() {
    let step_rad = std::f32::consts::TAU / COLUMNS as f32;
    for (approach, wraps) in
        [(SCANSEG_PLANE, true), (SCANSEG_EDGE, true), (SCANSEG_REGION, true), (SCANSEG_PLANE, false)]
    {
        let config = Config {
            beams: SCANSEG_SPINNING,
            wraps: wraps.into(),
            column_start_rad: 0.0,
            column_step_rad: step_rad,
            ..nodding(approach)
        };
        compare(&config, Beams::Spinning { columns: Columns::Even { start_rad: 0.0, step_rad }, wraps }, 0.01);
    }
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn a_camera_as_the_core() {
    for approach in APPROACHES {
        let [fx_px, fy_px, cx_px, cy_px] = [150.0, 140.0, 90.0, 30.0];
        let config = Config { beams: SCANSEG_PINHOLE, fx_px, fy_px, cx_px, cy_px, ..nodding(approach) };
        compare(&config, Beams::Pinhole { fx_px, fy_px, cx_px, cy_px }, 0.01);
    }
}

#[test]
#[cfg_attr(miri, ignore = "slow")]
fn few_labels_as_the_core() {
    for approach in APPROACHES {
        let config = Config { max_labels: 2, ..nodding(approach) };
        assert!(state_size(&config).unwrap() < state_size(&nodding(approach)).unwrap());
        let labels = compare(&config, Beams::Nodding { columns: EVEN, axis: TurnAxis::Y }, 0.01);
        assert!(labels.contains(&SCANSEG_UNLABELLED) || approach == SCANSEG_PLANE);
    }
}

/// Pushes the rows of an image and applies the joins, as a user would: the labels, and the segments
/// that are left.
fn by_rows(config: &Config, rows: &[Vec<f32>]) -> (Vec<u32>, Vec<Event>) {
    let mut session = Session::new(config);
    for (row, ranges_m) in rows.iter().enumerate() {
        assert_eq!(session.push(ranges_m, turn_rad(row)), SCANSEG_OK);
    }
    assert_eq!(session.finish(), SCANSEG_OK);
    let (mut into, mut segments) = (BTreeMap::new(), BTreeMap::new());
    for event in &session.events {
        if event.kind == SCANSEG_JOIN {
            into.insert(event.label, event.into);
            segments.remove(&event.label);
        } else {
            segments.insert(event.label, *event);
        }
    }
    let last = |mut label: u32| {
        while let Some(&next) = into.get(&label) {
            label = next;
        }
        label
    };
    (session.labels.iter().map(|&label| last(label)).collect(), segments.into_values().collect())
}

/// Segments an image in one call, with room for so many events.
fn by_image(session: &Session, rows: &[Vec<f32>], room: usize) -> (Status, Vec<u32>, Vec<Event>, usize) {
    let ranges_m = rows.concat();
    let turns_rad: Vec<_> = (0..rows.len()).map(turn_rad).collect();
    let mut labels = vec![77; ranges_m.len()];
    let mut events = vec![Event::default(); room];
    let mut work = vec![0xA5A5_A5A5; 2 * (ranges_m.len() + 1)];
    let mut out = Output {
        labels: labels.as_mut_ptr(),
        label_capacity: labels.len(),
        events: events.as_mut_ptr(),
        event_capacity: events.len(),
        ..output()
    };
    // SAFETY: the segmenter of a session, and arrays of these sizes.
    let status = unsafe {
        let (ranges_m, turns_rad) = (ranges_m.as_ptr(), turns_rad.as_ptr());
        let (work, size) = (work.as_mut_ptr(), work.len());
        scanseg_segment_image(session.segmenter, ranges_m, rows.len(), COLUMNS, turns_rad, null(), work, size, &mut out)
    };
    assert_eq!((out.first_row, out.row_count, out.scan_rows), (0, rows.len() as u32, rows.len() as u32));
    assert_eq!(out.unlabelled as usize, labels.iter().filter(|&&label| label == SCANSEG_UNLABELLED).count());
    events.truncate(out.event_count);
    (status, labels, events, out.events_lost)
}

/// A whole image is its rows with all joins applied, whatever the room for events; the next image
/// needs no reset.
#[test]
fn an_image_is_its_rows() {
    let mut joined = 0;
    for (approach, noise, max_labels) in APPROACHES.into_iter().flat_map(|a| [(a, 0.02, 0), (a, 3.0, 0), (a, 0.5, 9)]) {
        if cfg!(miri) && (approach, max_labels) != (SCANSEG_EDGE, 9) {
            continue;
        }
        let rows: Vec<_> = (0..ROWS).map(|row| room_m(row, COLUMNS, noise)).collect();
        let config = Config { max_labels, ..nodding(approach) };
        let (labels, segments) = by_rows(&config, &rows);
        let mut session = Session::new(&config);
        assert_eq!(session.push(&rows[0], 0.0), SCANSEG_OK); // to be dropped
        let most = segments.len();
        for room in
            [most + 9, most, most.saturating_sub(1), most / 2, 1, 0].into_iter().take(if cfg!(miri) { 1 } else { 6 })
        {
            let (status, found, events, lost) = by_image(&session, &rows, room);
            assert_eq!(status, if lost > 0 { SCANSEG_EVENTS_FULL } else { SCANSEG_OK });
            assert_eq!(found, labels, "approach {approach}, noise {noise}, room {room}");
            assert_eq!((events.len() + lost, lost > 0), (most, room < most));
            assert!(events.is_sorted_by_key(|event| event.label));
            assert!(events.iter().all(|event| segments.contains(event)));
            // each has the pixels that are said
            for event in &events {
                assert_eq!(found.iter().filter(|&&label| label == event.label).count(), event.pixels as usize);
            }
        }
        joined += segments.len();
    }
    assert!(joined > 20 || cfg!(miri));
}

/// `SCANSEG_MAX_EVENTS` is 2 * columns + 4: the array of a session. Each event of a call is the end
/// of another label. Labels that can end are those that were live before, up to columns / 2 + 1,
/// and those that begin in a row, up to (columns + 1) / 2; at the end of an edge-based scan three
/// rows are decided in one call. That is not above the bound.
#[test]
#[cfg_attr(miri, ignore = "slow")]
fn events_of_one_call_stay_within_the_bound() {
    for approach in APPROACHES {
        let mut most = 0;
        for (gap, noise) in [(2, 0.0), (2, 3.0), (3, 1.0), (usize::MAX, 0.1), (usize::MAX, 3.0)] {
            let mut session = Session::new(&nodding(approach));
            for row in 0..ROWS {
                // combs whose teeth move, so that as many areas as possible begin and end in each
                // row
                let mut ranges_m = room_m(row, COLUMNS, noise);
                for range_m in ranges_m.iter_mut().skip(row % 2).step_by(gap) {
                    *range_m = 0.0;
                }
                assert_eq!(session.push(&ranges_m, turn_rad(row)), SCANSEG_OK);
            }
            assert_eq!(session.finish(), SCANSEG_OK);
            most = most.max(session.most_events);
        }
        println!("approach {approach}: {most} events at most, in {COLUMNS} columns");
        assert!(most > COLUMNS / 20);
    }
}

/// Rows whose beams lie beside one another, free directions and full turns come out as the core has
/// them.
#[test]
fn beams_of_rows() {
    let ranging = Ranging::new(0.01);
    let listed: Vec<f32> = (0..COLUMNS).map(|c| -0.9 + 0.01 * c as f32).collect();
    let beside: Vec<f32> = (0..COLUMNS).map(|c| 0.002 * (c % 3) as f32).collect();
    let directions: Vec<[f32; 3]> =
        (0..COLUMNS).map(|c| listed[c].sin_cos()).map(|(sin, cos)| [cos * 0.8, sin, cos * 0.6]).collect();
    let turns = scanseg_core::ColumnTurns { step_rad: 1e-5, sets: 2, set_rad: 0.003 };
    let nodding_config = Config {
        column_angles_rad: listed.as_ptr(),
        column_angle_count: COLUMNS as u32,
        column_turns_rad: beside.as_ptr(),
        column_turn_count: COLUMNS as u32,
        full_turns: 1,
        ..nodding(SCANSEG_PLANE)
    };
    let free_config = Config { beams: SCANSEG_FREE, ..nodding(SCANSEG_EDGE) };
    let columns = Columns::Beside { angles_rad: &listed, turns_rad: &beside };
    let by_turns =
        scanseg_core::RowBeams::from(0.2).with_offset_rad(0.05).with_lever_arm_m(0.1).with_column_turns(turns);
    let cases: [(Config, AnyConfig<'_>, Beams<'_>, scanseg_core::RowBeams<'_>); 2] = [
        (
            nodding_config,
            PlaneConfig::new(ranging).with_full_turns().into(),
            Beams::Nodding { columns, axis: TurnAxis::Y },
            by_turns,
        ),
        (
            free_config,
            EdgeConfig::paper().into(),
            Beams::Free { wraps: false },
            scanseg_core::RowBeams::free(&directions),
        ),
    ];
    for (config, core, beams, row) in cases {
        let mut session = Session::new(&config);
        let sizes = core.sizes_for(&beams, COLUMNS);
        let (mut numbers, mut halves) = (vec![0.0; sizes.numbers], vec![0; sizes.halves]);
        let (mut words, mut areas) = (vec![0; sizes.words], vec![Area::EMPTY; sizes.areas]);
        let memory = Memory { numbers: &mut numbers, halves: &mut halves, words: &mut words, areas: &mut areas };
        let mut found = Collected::default();
        let mut segmenter = AnySegmenter::new(core, beams, COLUMNS, memory).unwrap();
        for i in 0..ROWS {
            let ranges_m = room_m(i, COLUMNS, 0.01);
            let mut of_c = std::mem::MaybeUninit::<RowBeams>::uninit();
            // SAFETY: room for one; initialised if that is said.
            let mut of_c = unsafe {
                let status = scanseg_row_beams_init(of_c.as_mut_ptr(), size_of::<RowBeams>() as u32, turn_rad(i));
                assert_eq!(status, SCANSEG_OK);
                of_c.assume_init()
            };
            (of_c.offset_rad, of_c.lever_arm_m) = (row.offset_rad, row.lever_arm_m);
            (of_c.column_turn_rad, of_c.sets) = (row.column_turns.step_rad, row.column_turns.sets.into());
            of_c.set_turn_rad = row.column_turns.set_rad;
            (of_c.directions, of_c.direction_count) = (row.directions.as_ptr().cast(), 3 * row.directions.len());
            assert_eq!(session.push_beams(&ranges_m, &of_c), SCANSEG_OK);
            let mut at = row;
            at.turn_rad = turn_rad(i);
            segmenter.push_row(&ranges_m, at, &mut found).unwrap();
        }
        assert_eq!(session.finish(), SCANSEG_OK);
        segmenter.finish(&mut found);
        assert_eq!(session.labels, found.labels);
        assert!(found.labels.iter().any(|&label| label > 0 && label < 0xFFFF_FFFE));
        assert_eq!(session.events.iter().filter(|e| e.kind == SCANSEG_SEGMENT).count(), found.segments.len());
    }
}
