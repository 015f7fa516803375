//! What must not be done is answered with a status, and nothing happens. Under Miri: and nothing
//! undefined does.

use std::ffi::{CStr, c_void};
use std::ptr::{null, null_mut};

use scanseg_capi::*;
use scanseg_capi_tests::{
    ANY_APPROACH, APPROACHES, COLUMNS, ROWS, Session, bad_field, defaults, nodding, output, room_m, state_size,
};

/// The same pointer, not aligned.
fn odd<T>(pointer: *mut T) -> *mut T {
    pointer.wrapping_byte_add(1)
}

#[test]
fn every_null_is_told() {
    let config = nodding(SCANSEG_PLANE);
    let mut session = Session::new(&config);
    let (segmenter, ranges) = (session.segmenter, [1.0_f32; COLUMNS]);
    let (mut out, mut size, mut made) = (output(), 0, null_mut());
    let mut event = Event::default();
    let mut plane = PlaneFit::default();
    // SAFETY: NULL where it is tested, else references.
    unsafe {
        for status in [
            scanseg_config_init(null_mut(), size_of::<Config>() as u32, SCANSEG_ABI_VERSION),
            scanseg_state_size(null(), &mut size),
            scanseg_state_size(&config, null_mut()),
            scanseg_init(null_mut(), 1 << 20, &config, &mut made),
            scanseg_init(session.memory.cast::<c_void>(), 8 * session.words, null(), &mut made),
            scanseg_init(session.memory.cast::<c_void>(), 8 * session.words, &config, null_mut()),
            scanseg_push_row(null_mut(), ranges.as_ptr(), COLUMNS, 0.0, &mut out),
            scanseg_push_row(segmenter, null(), COLUMNS, 0.0, &mut out),
            scanseg_push_row(segmenter, ranges.as_ptr(), COLUMNS, 0.0, null_mut()),
            scanseg_finish(null_mut(), &mut out),
            scanseg_finish(segmenter, null_mut()),
            scanseg_reset(null_mut()),
            scanseg_fit_plane(null(), &mut plane),
            scanseg_fit_plane(&event, null_mut()),
        ] {
            assert_eq!(status, SCANSEG_ERROR_NULL);
        }
        assert!(scanseg_bad_field(null()).is_null());
        // no array, but a capacity
        let mut out = Output { event_capacity: 1, ..output() };
        assert_eq!(scanseg_push_row(segmenter, ranges.as_ptr(), COLUMNS, 0.0, &mut out), SCANSEG_ERROR_NULL);
        event.first_moments[0] = i64::MIN;
        event.pixels = 100;
        assert_eq!(scanseg_fit_plane(&event, &mut plane), SCANSEG_NO_PLANE);
    }
    // none of that was a row
    assert_eq!(session.push(&ranges, 0.0), SCANSEG_OK);
    assert_eq!(session.labels.len(), COLUMNS);
}

#[test]
fn every_pointer_is_to_be_aligned() {
    let mut config = nodding(SCANSEG_PLANE);
    let mut session = Session::new(&config);
    let (segmenter, mut ranges) = (session.segmenter, [1.0_f32; COLUMNS]);
    let (mut out, mut size, mut made) = (output(), 0, null_mut());
    let (mut event, mut plane) = (Event::default(), PlaneFit::default());
    let (memory, bytes) = (session.memory.cast::<c_void>(), 8 * session.words);
    // SAFETY: what is not aligned is not used, the rest are references.
    unsafe {
        for status in [
            scanseg_config_init(odd(&mut config), size_of::<Config>() as u32, SCANSEG_ABI_VERSION),
            scanseg_state_size(odd(&mut config), &mut size),
            scanseg_state_size(&config, odd(&mut size)),
            scanseg_init(memory.byte_add(4), bytes - 4, &config, &mut made),
            scanseg_init(memory, bytes, odd(&mut config), &mut made),
            scanseg_init(memory, bytes, &config, odd(&mut made)),
            scanseg_push_row(odd(segmenter), ranges.as_ptr(), COLUMNS, 0.0, &mut out),
            scanseg_push_row(segmenter, odd(ranges.as_mut_ptr()), COLUMNS, 0.0, &mut out),
            scanseg_push_row(segmenter, ranges.as_ptr(), COLUMNS, 0.0, odd(&mut out)),
            scanseg_finish(segmenter, odd(&mut out)),
            scanseg_reset(odd(segmenter)),
            scanseg_fit_plane(odd(&mut event), &mut plane),
            scanseg_fit_plane(&event, odd(&mut plane)),
        ] {
            assert_eq!(status, SCANSEG_ERROR_ALIGNMENT);
        }
        let (mut labels, mut events) = ([0_u32; COLUMNS], [event; 2]);
        for mut out in [
            Output { labels: odd(labels.as_mut_ptr()), label_capacity: COLUMNS, ..output() },
            Output { events: odd(events.as_mut_ptr()), event_capacity: 1, ..output() },
        ] {
            let status = scanseg_push_row(segmenter, ranges.as_ptr(), COLUMNS, 0.0, &mut out);
            assert_eq!(status, SCANSEG_ERROR_ALIGNMENT);
        }
        let list = Config { column_angles_rad: odd(ranges.as_mut_ptr()), column_angle_count: COLUMNS as u32, ..config };
        assert_eq!(scanseg_state_size(&list, &mut size), SCANSEG_ERROR_ALIGNMENT);
    }
    assert_eq!(session.push(&ranges, 0.0), SCANSEG_OK);
    assert_eq!(session.labels.len(), COLUMNS);
}

#[test]
fn structs_of_other_versions_are_refused() {
    let mut session = Session::new(&nodding(SCANSEG_PLANE));
    for struct_size in [0, 4, size_of::<Config>() as u32 - 8, size_of::<Config>() as u32 + 8, u32::MAX] {
        let config = Config { struct_size, ..nodding(SCANSEG_PLANE) };
        assert_eq!(state_size(&config), Err(SCANSEG_ERROR_STRUCT_SIZE));
        let mut config = defaults();
        // SAFETY: references.
        let status = unsafe { scanseg_config_init(&mut config, struct_size, SCANSEG_ABI_VERSION) };
        assert_eq!(status, SCANSEG_ERROR_STRUCT_SIZE);
        let mut out = Output { struct_size, ..output() };
        // SAFETY: the segmenter of the session.
        assert_eq!(unsafe { scanseg_finish(session.segmenter, &mut out) }, SCANSEG_ERROR_STRUCT_SIZE);
    }
    let config = Config { abi_version: SCANSEG_ABI_VERSION + 1, ..nodding(SCANSEG_PLANE) };
    assert_eq!(state_size(&config), Err(SCANSEG_ERROR_ABI_VERSION));
    assert_eq!(session.finish(), SCANSEG_OK);
    // a header with fewer fields: nothing beyond its end is read
    let short = [4_u32];
    let mut size = 0;
    // SAFETY: as many bytes as its first field says.
    assert_eq!(unsafe { scanseg_state_size(short.as_ptr().cast(), &mut size) }, SCANSEG_ERROR_STRUCT_SIZE);
}

#[test]
fn memory_that_is_too_small_is_refused() {
    for approach in APPROACHES {
        let config = nodding(approach);
        let size = state_size(&config).unwrap();
        let mut memory = vec![0_u64; size.div_ceil(8)];
        let before = memory.clone();
        for short in [0, 1, 8, size / 2, size - 1] {
            let mut made = std::ptr::dangling_mut();
            // SAFETY: the memory is larger than what is said.
            let status = unsafe { scanseg_init(memory.as_mut_ptr().cast(), short, &config, &mut made) };
            assert_eq!((status, made), (SCANSEG_ERROR_MEMORY_SIZE, null_mut()));
        }
        assert_eq!(memory, before);
    }
}

#[test]
fn bad_fields_are_named() {
    let good = nodding(SCANSEG_PLANE);
    assert_eq!(bad_field(&good), None);
    let with = |change: fn(&mut Config)| {
        let mut config = good;
        change(&mut config);
        assert_eq!(state_size(&config), Err(SCANSEG_ERROR_CONFIG));
        let (mut memory, mut made) = ([0_u64; 1000], null_mut());
        // SAFETY: so much memory.
        let status = unsafe { scanseg_init(memory.as_mut_ptr().cast(), size_of_val(&memory), &config, &mut made) };
        assert_eq!((status, made), (SCANSEG_ERROR_CONFIG, null_mut()));
        bad_field(&config).unwrap()
    };
    assert_eq!(with(|c| c.columns = 0), "columns");
    assert_eq!(with(|c| c.columns = 16_385), "columns");
    assert_eq!(with(|c| c.columns = u32::MAX), "columns");
    assert_eq!(with(|c| c.approach = 3), "approach");
    assert_eq!(with(|c| c.beams = 0), "beams");
    assert_eq!(with(|c| c.beams = 6), "beams");
    assert_eq!(with(|c| c.wraps = 2), "wraps");
    assert_eq!(with(|c| c.closing = 2), "closing");
    assert_eq!(with(|c| c.trace_count = 0), "trace_count");
    assert_eq!(with(|c| c.trace_count = 9), "trace_count");
    assert_eq!(with(|c| c.traces[1].rows = 17), "traces");
    assert_eq!(with(|c| c.traces[0].columns = 0), "traces");
    assert_eq!(with(|c| c.column_step_rad = 0.0), "column_step_rad");
    assert_eq!(with(|c| c.column_start_rad = f32::NAN), "column_start_rad");
    assert_eq!(with(|c| c.column_angle_count = COLUMNS as u32), "column_angles_rad");
    assert_eq!(with(|c| c.column_angles_rad = [1.0_f32; 2].as_ptr()), "column_angle_count");
    assert_eq!(
        with(|c| {
            c.column_angles_rad = [f32::INFINITY; COLUMNS].as_ptr();
            c.column_angle_count = COLUMNS as u32;
        }),
        "column_angles_rad"
    );
    assert_eq!(
        with(|c| {
            c.beams = SCANSEG_SPINNING;
            c.wraps = 1;
        }),
        "wraps"
    );
    assert_eq!(with(|c| c.beams = SCANSEG_PINHOLE), "fx_px");
    assert_eq!(with(|c| c.range_noise_m = f32::NAN), "range_noise_m");
    assert_eq!(with(|c| c.range_noise_per_m = -0.1), "range_noise_per_m");
    assert_eq!(with(|c| c.range_noise_per_m2 = 1.1), "range_noise_per_m2");
    assert_eq!(with(|c| c.range_step_m = 10.1), "range_step_m");
    assert_eq!(with(|c| c.range_step_per_m2 = -0.1), "range_step_per_m2");
    assert_eq!(with(|c| c.noise_correlation_px = 0.5), "noise_correlation_px");
    assert_eq!(with(|c| c.beam_noise_rad = 0.2), "beam_noise_rad");
    assert_eq!(with(|c| c.turn_noise_rad = f32::NAN), "turn_noise_rad");
    assert_eq!(with(|c| c.flatness_m = 11.0), "flatness_m");
    assert_eq!(with(|c| c.min_range_m = 0.0), "min_range_m");
    assert_eq!(with(|c| c.max_range_m = 501.0), "max_range_m");
    assert_eq!(with(|c| c.roof_angle_rad = 0.0), "roof_angle_rad");
    assert_eq!(with(|c| c.step_angle_rad = 2.0), "step_angle_rad");
    assert_eq!(with(|c| c.line_angle_rad = -1.0), "line_angle_rad");
    assert_eq!(with(|c| c.plane_distance_m = 2.0), "plane_distance_m");
}

#[test]
fn rows_that_cannot_be_taken_change_nothing() {
    for &approach in ANY_APPROACH {
        let (mut one, mut other) = (Session::new(&nodding(approach)), Session::new(&nodding(approach)));
        for row in 0..ROWS {
            let ranges_m = room_m(row, COLUMNS, 0.01);
            assert_eq!(one.push(&ranges_m[1..], 0.0), SCANSEG_ERROR_ROW_LENGTH);
            assert_eq!(one.push(&[], 0.0), SCANSEG_ERROR_ROW_LENGTH);
            assert_eq!(one.push(&ranges_m, f32::NAN), SCANSEG_ERROR_TURN_ANGLE);
            let mut labels = [0; 1];
            let mut out = Output { labels: labels.as_mut_ptr(), label_capacity: COLUMNS - 1, ..output() };
            // SAFETY: nothing is written to what is too small.
            let status = unsafe { scanseg_push_row(one.segmenter, ranges_m.as_ptr(), COLUMNS, 0.0, &mut out) };
            assert_eq!(status, SCANSEG_ERROR_LABELS_SIZE);
            for session in [&mut one, &mut other] {
                assert_eq!(session.push(&ranges_m, 0.01 * row as f32), SCANSEG_OK);
            }
        }
        let mut labels = [0; 1];
        let mut out = Output { labels: labels.as_mut_ptr(), label_capacity: 1, ..output() };
        if approach == SCANSEG_EDGE {
            // SAFETY: as above.
            assert_eq!(unsafe { scanseg_finish(one.segmenter, &mut out) }, SCANSEG_ERROR_LABELS_SIZE);
        }
        assert_eq!((one.finish(), other.finish()), (SCANSEG_OK, SCANSEG_OK));
        assert_eq!((&one.labels, &one.events), (&other.labels, &other.events));
        assert_eq!(one.labels.len(), ROWS * COLUMNS);
    }
}

#[test]
fn a_scan_has_its_order() {
    for approach in APPROACHES {
        let mut session = Session::new(&nodding(approach));
        let ranges_m = room_m(0, COLUMNS, 0.0);
        assert_eq!(session.push(&ranges_m, 0.0), SCANSEG_OK);
        assert_eq!(session.finish(), SCANSEG_OK);
        assert_eq!(session.finish(), SCANSEG_ERROR_SCAN_OVER);
        assert_eq!(session.push(&ranges_m, 0.0), SCANSEG_ERROR_SCAN_OVER);
        assert_eq!((session.reset(), session.reset()), (SCANSEG_OK, SCANSEG_OK));
        // an empty scan
        assert_eq!(session.finish(), SCANSEG_OK);
        assert_eq!((session.labels.len(), session.events.len()), (0, 0));
    }
}

#[test]
fn memory_that_holds_no_segmenter_is_told() {
    for approach in APPROACHES {
        let config = nodding(approach);
        let mut never = vec![0_u64; state_size(&config).unwrap() / 8 + 1];
        // SAFETY: memory of that size.
        assert_eq!(unsafe { scanseg_reset(never.as_mut_ptr().cast()) }, SCANSEG_ERROR_NO_SEGMENTER);

        let mut session = Session::new(&config);
        session.push(&room_m(0, COLUMNS, 0.0), 0.0);
        // A copy: its slices would be the original's. The original is not used after it, since
        // nobody else may read its memory in between. SAFETY: both have that many bytes.
        unsafe {
            never.as_mut_ptr().cast::<u8>().copy_from_nonoverlapping(session.memory.cast(), 8 * session.words);
            assert_eq!(scanseg_reset(never.as_mut_ptr().cast()), SCANSEG_ERROR_NO_SEGMENTER);
        }

        // made again in the same memory, after another use of it
        // SAFETY: the segmenter is not in use meanwhile.
        unsafe {
            session.memory.write_bytes(0xFF, session.words);
            assert_eq!(scanseg_reset(session.segmenter), SCANSEG_ERROR_NO_SEGMENTER);
            let mut made = null_mut();
            let status = scanseg_init(session.memory.cast(), 8 * session.words, &config, &mut made);
            assert_eq!((status, made), (SCANSEG_OK, session.segmenter));
        }
        session.reset();
        assert_eq!(session.push(&room_m(0, COLUMNS, 0.0), 0.0), SCANSEG_OK);
    }
}

struct Reentry {
    segmenter: *mut State,
    statuses: Vec<Status>,
    answer: i32,
}

unsafe extern "C" fn reenter(user: *mut c_void, event: *const Event) -> i32 {
    // SAFETY: the test passes a `Reentry`, and the event lives for the call.
    let (seen, event) = unsafe { (&mut *user.cast::<Reentry>(), &*event) };
    assert!(event.kind == SCANSEG_SEGMENT || event.kind == SCANSEG_JOIN);
    let (mut out, ranges) = (output(), [1.0; COLUMNS]);
    // SAFETY: the segmenter is there, and busy.
    seen.statuses.extend(unsafe {
        [
            scanseg_push_row(seen.segmenter, ranges.as_ptr(), COLUMNS, 0.0, &mut out),
            scanseg_finish(seen.segmenter, &mut out),
            scanseg_reset(seen.segmenter),
        ]
    });
    seen.answer
}

#[test]
fn a_callback_cannot_use_the_segmenter_and_may_stop() {
    for &approach in ANY_APPROACH {
        for answer in [0, 1] {
            let mut session = Session::new(&nodding(approach));
            for row in 0..ROWS {
                assert_eq!(session.push(&room_m(row, COLUMNS, 0.0), 0.01 * row as f32), SCANSEG_OK);
            }
            let mut seen = Reentry { segmenter: session.segmenter, statuses: vec![], answer };
            let mut out = Output { on_event: Some(reenter), user: (&raw mut seen).cast(), ..output() };
            // SAFETY: the segmenter of the session.
            let status = unsafe { scanseg_finish(session.segmenter, &mut out) };
            assert_eq!(status, if answer == 0 { SCANSEG_OK } else { SCANSEG_STOPPED });
            assert!(!seen.statuses.is_empty() && seen.statuses.iter().all(|&s| s == SCANSEG_ERROR_BUSY));
            assert!(answer == 0 || seen.statuses.len() == 3);
            assert_eq!((out.event_count, out.events_lost), (0, 0));
            assert_eq!(session.finish(), SCANSEG_ERROR_SCAN_OVER);
            session.reset();
            assert_eq!(session.push(&room_m(0, COLUMNS, 0.0), 0.0), SCANSEG_OK);
        }
    }
}

#[test]
fn events_that_do_not_fit_are_counted() {
    for &approach in ANY_APPROACH {
        let mut all = Session::new(&nodding(approach));
        let mut few = Session::new(&nodding(approach));
        for row in 0..ROWS {
            let ranges_m = room_m(row, COLUMNS, 0.0);
            assert_eq!((all.push(&ranges_m, 0.0), few.push(&ranges_m, 0.0)), (SCANSEG_OK, SCANSEG_OK));
        }
        all.events.clear();
        assert_eq!(all.finish(), SCANSEG_OK);
        let found = all.events.len();
        assert!(found > 1);
        let mut events = vec![Event::default(); found];
        let mut out = Output { events: events.as_mut_ptr(), event_capacity: found - 1, ..output() };
        // SAFETY: the segmenter of the session, and that many events.
        assert_eq!(unsafe { scanseg_finish(few.segmenter, &mut out) }, SCANSEG_EVENTS_FULL);
        assert_eq!((out.event_count, out.events_lost), (found - 1, 1));
        assert_eq!((&events[..found - 1], events[found - 1]), (&all.events[..found - 1], Event::default()));
    }
}

/// An image whose arguments cannot be used is refused before the scan that is under way is dropped.
#[test]
fn images_that_cannot_be_taken_are_refused() {
    let rows = 4;
    for beams in [SCANSEG_NODDING_Y, SCANSEG_PINHOLE] {
        if cfg!(miri) && beams != SCANSEG_PINHOLE {
            continue;
        }
        let config = Config { beams, fx_px: 100.0, fy_px: 100.0, ..nodding(SCANSEG_PLANE) };
        let mut session = Session::new(&config);
        assert_eq!(session.push(&room_m(0, COLUMNS, 0.0), 0.0), SCANSEG_OK);
        let ranges_m = vec![2.0_f32; rows * COLUMNS];
        let mut turns_rad = vec![0.0, 0.01, 0.02, 0.03];
        let mut work = vec![0_u32; 2 * (rows * COLUMNS + 1)];
        let mut label = 77;
        let segmenter = session.segmenter;
        let mut call = |ranges_m: *const f32, rows, columns, turns_rad, work, size, labels: usize| {
            let mut out = Output { labels: &raw mut label, label_capacity: labels, ..output() };
            if labels == 0 {
                out.labels = null_mut();
            }
            // SAFETY: arrays that are too small are refused before they are used.
            unsafe {
                scanseg_segment_image(segmenter, ranges_m, rows, columns, turns_rad, null(), work, size, &mut out)
            }
        };
        let (r, t, w, size) = (ranges_m.as_ptr(), turns_rad.as_mut_ptr(), work.as_mut_ptr(), work.len());
        for (expected, status) in [
            (SCANSEG_ERROR_NULL, call(std::ptr::null(), rows, COLUMNS, t, w, size, 0)),
            (SCANSEG_ERROR_NULL, call(r, rows, COLUMNS, t, null_mut(), size, 0)),
            (SCANSEG_ERROR_ALIGNMENT, call(r, rows, COLUMNS, t.wrapping_byte_add(1), w, size, 0)),
            (SCANSEG_ERROR_ROW_LENGTH, call(r, rows, COLUMNS - 1, t, w, size, 0)),
            (SCANSEG_ERROR_TOO_MANY_ROWS, call(r, 65_536, COLUMNS, t, w, usize::MAX, 0)),
            (SCANSEG_ERROR_TOO_MANY_ROWS, call(r, usize::MAX, COLUMNS, t, w, usize::MAX, 0)),
            (SCANSEG_ERROR_WORK_SIZE, call(r, rows, COLUMNS, t, w, size - 1, 0)),
            (SCANSEG_ERROR_LABELS_SIZE, call(r, rows, COLUMNS, t, w, size, 1)),
        ] {
            assert_eq!(status, expected);
        }
        // the scan goes on
        assert_eq!(session.push(&room_m(1, COLUMNS, 0.0), 0.01), SCANSEG_OK);
        // only a camera needs no angles
        let without = call(r, rows, COLUMNS, null_mut(), w, size, 0);
        assert_eq!(without, if beams == SCANSEG_PINHOLE { SCANSEG_OK } else { SCANSEG_ERROR_NULL });
        assert_eq!(call(r, rows, COLUMNS, t, w, size, 0), SCANSEG_OK);
        assert_eq!(call(r, 0, COLUMNS, t, w, size, 0), SCANSEG_OK);
        turns_rad[2] = f32::NAN;
        let t = turns_rad.as_mut_ptr();
        assert_eq!(call(r, rows, COLUMNS, t, w, size, 0), SCANSEG_ERROR_TURN_ANGLE);
        assert_eq!(label, 77);
        // and the segmenter is ready for the next scan
        session.labels.clear();
        assert_eq!(session.push(&room_m(0, COLUMNS, 0.0), 0.0), SCANSEG_OK);
    }
}

/// A callback that stops an image leaves what came so far.
#[test]
fn an_image_may_be_stopped() {
    let session = Session::new(&nodding(SCANSEG_REGION));
    let ranges_m: Vec<f32> = (0..ROWS).flat_map(|row| room_m(row, COLUMNS, 0.0)).collect();
    let turns_rad: Vec<f32> = (0..ROWS).map(|row| 0.01 * row as f32).collect();
    let (mut labels, mut work) = (vec![77; ranges_m.len()], vec![0; 2 * (ranges_m.len() + 1)]);
    let mut seen = Reentry { segmenter: session.segmenter, statuses: vec![], answer: 1 };
    let mut out = Output {
        labels: labels.as_mut_ptr(),
        label_capacity: labels.len(),
        on_event: Some(reenter),
        user: (&raw mut seen).cast(),
        ..output()
    };
    let (r, t) = (ranges_m.as_ptr(), turns_rad.as_ptr());
    // SAFETY: the segmenter of the session, and arrays of these sizes.
    let status = unsafe {
        scanseg_segment_image(session.segmenter, r, ROWS, COLUMNS, t, null(), work.as_mut_ptr(), work.len(), &mut out)
    };
    assert_eq!((status, seen.statuses.len()), (SCANSEG_STOPPED, 3));
    assert!(seen.statuses.iter().all(|&s| s == SCANSEG_ERROR_BUSY));
    let given = out.row_count as usize * COLUMNS;
    assert!(given > 0 && labels[..given].iter().all(|&label| label != 77));
    assert!(labels[given..].iter().all(|&label| label == 77));
}

#[test]
fn every_status_has_its_words() {
    let words = |status| {
        // SAFETY: a constant of the library.
        unsafe { CStr::from_ptr(scanseg_strerror(status)) }.to_str().unwrap()
    };
    let known: std::collections::HashSet<_> = (SCANSEG_ERROR_ROW_BEAMS..=SCANSEG_NO_PLANE).map(words).collect();
    assert_eq!(known.len(), 19);
    assert!(!known.contains("unknown status"));
    assert_eq!([words(4), words(-16), words(i32::MIN)], ["unknown status"; 3]);
}

/// Beams of a row that cannot be used are refused, and the row is not taken.
#[test]
fn beams_of_a_row() {
    let ranges_m = [2.0; COLUMNS];
    let mut beams = std::mem::MaybeUninit::<RowBeams>::uninit();
    let size = size_of::<RowBeams>() as u32;
    // SAFETY: room for one; initialised if that is said.
    let good = unsafe {
        assert_eq!(scanseg_row_beams_init(null_mut(), size, 0.0), SCANSEG_ERROR_NULL);
        assert_eq!(scanseg_row_beams_init(beams.as_mut_ptr(), size - 4, 0.0), SCANSEG_ERROR_STRUCT_SIZE);
        assert_eq!(scanseg_row_beams_init(beams.as_mut_ptr(), size, 0.1), SCANSEG_OK);
        beams.assume_init()
    };
    let mut session = Session::new(&nodding(SCANSEG_PLANE));
    let directions = [0.5f32; 3 * COLUMNS];
    for (beams, status) in [
        (RowBeams { struct_size: 3, ..good }, SCANSEG_ERROR_STRUCT_SIZE),
        (RowBeams { turn_rad: f32::NAN, ..good }, SCANSEG_ERROR_TURN_ANGLE),
        (RowBeams { offset_rad: 7.0, ..good }, SCANSEG_ERROR_ROW_BEAMS),
        (RowBeams { lever_arm_m: f32::NAN, ..good }, SCANSEG_ERROR_ROW_BEAMS),
        (RowBeams { sets: 0, ..good }, SCANSEG_ERROR_ROW_BEAMS),
        (RowBeams { sets: 256, ..good }, SCANSEG_ERROR_ROW_BEAMS),
        (RowBeams { direction_count: 3, ..good }, SCANSEG_ERROR_NULL),
        (good, SCANSEG_OK),
    ] {
        assert_eq!(session.push_beams(&ranges_m, &beams), status, "{beams:?}");
    }
    let mut session = Session::new(&Config { beams: SCANSEG_FREE, ..nodding(SCANSEG_PLANE) });
    let free = RowBeams { directions: directions.as_ptr(), direction_count: directions.len(), ..good };
    for (beams, status) in [
        (good, SCANSEG_ERROR_ROW_LENGTH),
        (RowBeams { direction_count: directions.len() - 1, ..free }, SCANSEG_ERROR_ROW_LENGTH),
        // no unit vectors
        (free, SCANSEG_ERROR_ROW_BEAMS),
    ] {
        assert_eq!(session.push_beams(&ranges_m, &beams), status, "{beams:?}");
    }
    let lists =
        Config { column_turns_rad: directions.as_ptr(), column_turn_count: COLUMNS as u32, ..nodding(SCANSEG_PLANE) };
    assert_eq!(state_size(&lists), Err(SCANSEG_ERROR_CONFIG));
}
