//! Calls of the library for C: what it gives out is what the core gives, whatever else was asked
//! for in between, and what must not be asked for is answered with a status.
#![no_main]

use arbitrary::{Arbitrary, Result, Unstructured};
use libfuzzer_sys::fuzz_target;
use scanseg_capi::*;
use scanseg_capi_tests::{Session, bad_field, defaults, output, state_size};
use scanseg_core::{Approach, Element, Join, Moments, Pixel, Segment, SegmentSums, TurnAxis};
use scanseg_fuzz::case::{APPROACHES, Case};
use scanseg_tests::stream::{self, Angles, Rig, Scan};
use std::ffi::c_void;
use std::ptr::null_mut;

#[derive(Clone, Copy, Debug, Arbitrary)]
enum Call {
    /// A row of the scan.
    Push(u8),
    /// All of them.
    PushAll,
    /// A row of another length, or at an angle that may be none.
    Odd {
        length: u8,
        turn_rad: f32,
    },
    Finish,
    /// With a callback that stops at the event after so many, and tries to use the segmenter.
    Stop {
        after: u8,
        finish: bool,
    },
    Reset,
    /// A pointer that is NULL, or not aligned.
    Bad {
        which: u8,
        null: bool,
    },
    /// An array of labels that is too small, structs of another size.
    Small {
        labels: u8,
        struct_size: u32,
    },
    /// The segmenter somewhere else, and memory that holds none.
    Elsewhere(u8),
    /// The plane of any numbers.
    Plane([i64; 9], u32),
    /// The same, as the plane approach has it.
    PlaneSums([f32; 15], u32, u16),
    /// In memory of another size.
    Init {
        less: u16,
        misaligned: bool,
    },
}

#[derive(Debug)]
struct Calls {
    case: Case,
    /// Fields of the configuration that are any bits.
    bits: Vec<(u8, u32)>,
    list: Vec<Call>,
}

impl Arbitrary<'_> for Calls {
    fn arbitrary(u: &mut Unstructured) -> Result<Calls> {
        let list = u.arbitrary_iter()?.take(30).collect::<Result<_>>()?;
        let bits = if u.ratio(1u8, 8u8)? { u.arbitrary()? } else { vec![] };
        Ok(Calls { bits, case: Case::arbitrary(u)?, list })
    }
}

/// As C has the configuration of a case, whose angles stay where they are.
fn config(case: &Case) -> Config {
    let (ranging, edge, region) = (case.settings.ranging, case.settings.edge(), case.settings.region);
    let mut config = Config {
        approach: match case.approach {
            Approach::Plane => SCANSEG_PLANE,
            Approach::Edge => SCANSEG_EDGE,
            Approach::Region => SCANSEG_REGION,
        },
        columns: case.scan.columns as u32,
        max_labels: case.areas as u32,
        range_noise_m: ranging.range_noise_m,
        min_range_m: ranging.min_range_m,
        max_range_m: ranging.max_range_m,
        roof_angle_rad: edge.roof_angle_rad,
        step_angle_rad: edge.step_angle_rad,
        closing: if edge.closing == Element::Square { SCANSEG_SQUARE } else { SCANSEG_PLUS },
        line_angle_rad: region.line_angle_rad,
        plane_distance_m: region.plane_distance_m,
        trace_count: edge.traces.len() as u32,
        ..defaults()
    };
    for (to, trace) in config.traces.iter_mut().zip(edge.traces) {
        *to = Trace { rows: trace.rows, columns: trace.columns };
    }
    let angles = match &case.scan.rig {
        Rig::Nodding { angles, axis } => {
            config.beams = if *axis == TurnAxis::Y { SCANSEG_NODDING_Y } else { SCANSEG_NODDING_Z };
            angles
        }
        Rig::Spinning { angles, wraps } => {
            (config.beams, config.wraps) = (SCANSEG_SPINNING, (*wraps).into());
            angles
        }
        &Rig::Pinhole { fx_px, fy_px, cx_px, cy_px } => {
            return Config { beams: SCANSEG_PINHOLE, fx_px, fy_px, cx_px, cy_px, ..config };
        }
    };
    match angles {
        Angles::Even { start_rad, step_rad } => {
            (config.column_start_rad, config.column_step_rad) = (*start_rad, *step_rad);
        }
        Angles::Listed(list) => {
            (config.column_angles_rad, config.column_angle_count) = (list.as_ptr(), list.len() as u32);
        }
    }
    config
}

/// Any bits in fields that are neither pointers nor tell how much there is behind one.
fn set_bits(config: &mut Config, bits: &[(u8, u32)]) {
    for &(field, bits) in bits {
        let number = f32::from_bits(bits);
        match field % 30 {
            0 => config.struct_size = bits,
            1 => config.abi_version = bits,
            2 => config.approach = bits,
            3 if config.column_angles_rad.is_null() => config.columns = bits,
            4 => config.max_labels = bits,
            5 => config.beams = bits,
            6 => config.wraps = bits,
            7 => config.column_start_rad = number,
            8 => config.column_step_rad = number,
            9 if config.column_angles_rad.is_null() => config.column_angle_count = bits,
            10 => config.fx_px = number,
            11 => config.fy_px = number,
            12 => config.cx_px = number,
            13 => config.cy_px = number,
            14 => config.range_noise_m = number,
            15 => config.min_range_m = number,
            16 => config.max_range_m = number,
            17 => config.roof_angle_rad = number,
            18 => config.closing = bits,
            19 => config.plane_distance_m = number,
            20 => config.trace_count = bits,
            21 => config.range_noise_per_m = number,
            22 => config.range_noise_per_m2 = number,
            23 => config.range_step_m = number,
            24 => config.range_step_per_m2 = number,
            25 => config.noise_correlation_px = number,
            26 => config.beam_noise_rad = number,
            27 => config.turn_noise_rad = number,
            28 => config.flatness_m = number,
            _ => config.traces[bits as usize % 8] = Trace { rows: (bits >> 8) as u8, columns: (bits >> 16) as i8 },
        }
    }
}

/// What the core gives, as C has it.
fn by_core(case: &Case, scan: &Scan) -> (Vec<u32>, Vec<Event>) {
    let record = scan.record(case.settings.config(case.approach), case.areas);
    let label = |pixel: &Pixel| match pixel {
        Pixel::NoReturn => SCANSEG_NO_RETURN,
        Pixel::Edge => SCANSEG_ON_EDGE,
        Pixel::Segment(label) => label.0,
        Pixel::Unlabelled => SCANSEG_UNLABELLED,
    };
    let event = |event: &stream::Event| match *event {
        stream::Event::Join(Join { from, into }) => {
            Some(Event { kind: SCANSEG_JOIN, label: from.0, into: into.0, ..Event::default() })
        }
        stream::Event::Segment(Segment { label, first_row, last_row, first_column, last_column, sums }) => {
            let (moments, plane_sums) = match sums {
                SegmentSums::Fitted { fitted, .. } => (Moments::default(), fitted.numbers()),
                SegmentSums::Moments(moments) => (moments, [0.0; 15]),
                _ => panic!("sums without a test: {sums:?}"),
            };
            Some(Event {
                kind: SCANSEG_SEGMENT,
                label: label.0,
                into: 0,
                pixels: match sums {
                    SegmentSums::Fitted { pixels, .. } => pixels,
                    _ => moments.points,
                },
                first_row,
                last_row,
                first_column,
                last_column,
                first_moments: moments.first,
                second_moments: moments.second,
                plane_sums,
            })
        }
        _ => None,
    };
    (record.pixels().iter().map(label).collect(), record.events.iter().filter_map(event).collect())
}

struct Stopper {
    segmenter: *mut State,
    after: u8,
}

unsafe extern "C" fn stop(user: *mut c_void, event: *const Event) -> i32 {
    // SAFETY: the target passes a `Stopper`, and the event lives for the call.
    let (stopper, event) = unsafe { (&mut *user.cast::<Stopper>(), &*event) };
    assert!(event.kind == SCANSEG_JOIN || event.kind == SCANSEG_SEGMENT);
    // SAFETY: the segmenter is there, and busy.
    assert_eq!(unsafe { scanseg_reset(stopper.segmenter) }, SCANSEG_ERROR_BUSY);
    let stops = stopper.after == 0;
    stopper.after = stopper.after.saturating_sub(1);
    stops.into()
}

fuzz_target!(|calls: Calls| {
    let Calls { case, bits, list } = calls;
    let mut config = config(&case);
    set_bits(&mut config, &bits);
    let size = match state_size(&config) {
        Ok(size) => size,
        Err(status) => {
            assert!((SCANSEG_ERROR_CONFIG..0).contains(&status));
            assert_eq!(bad_field(&config).is_some(), status == SCANSEG_ERROR_CONFIG);
            assert!(!bits.is_empty() || !is_taken_by_core(&case));
            return;
        }
    };
    assert_eq!(bad_field(&config), None);
    if config.columns > 1000 {
        return;
    }
    let bits_are_used = !bits.is_empty();
    assert!(bits_are_used || is_taken_by_core(&case));
    let mut session = Session::new(&config);
    assert!(size <= 8 * session.words);
    let columns = session.columns;
    let empty = || Scan { range_m: vec![], turn_rad: vec![], ..case.scan.clone() };
    let (mut pushed, mut over) = (empty(), false);
    for call in list {
        match call {
            Call::Push(_) | Call::PushAll | Call::Odd { .. } => {
                let scan = &case.scan;
                let row = |row: usize| match scan.turn_rad.get(row) {
                    Some(&turn_rad) if scan.columns == columns => (scan.row_m(row).to_vec(), turn_rad),
                    _ => (vec![2.0; columns], 0.0),
                };
                let rows = match call {
                    Call::Push(number) => vec![row(usize::from(number) % scan.turn_rad.len().max(1))],
                    Call::Odd { length, turn_rad } => vec![(vec![2.0; length.into()], turn_rad)],
                    _ => (0..scan.turn_rad.len()).map(row).collect(),
                };
                for (ranges_m, turn_rad) in rows {
                    let expected = match () {
                        () if over => SCANSEG_ERROR_SCAN_OVER,
                        () if ranges_m.len() != columns => SCANSEG_ERROR_ROW_LENGTH,
                        () if !(-6300.0..=6300.0).contains(&turn_rad) => SCANSEG_ERROR_TURN_ANGLE,
                        () => SCANSEG_OK,
                    };
                    assert_eq!(session.push(&ranges_m, turn_rad), expected);
                    if expected == SCANSEG_OK {
                        pushed.range_m.extend(ranges_m);
                        pushed.turn_rad.push(turn_rad);
                    }
                }
            }
            Call::Finish => {
                let status = session.finish();
                assert_eq!(status, if over { SCANSEG_ERROR_SCAN_OVER } else { SCANSEG_OK });
                let stretch = session.beam_stretch.abs();
                assert!(stretch == 0.0 || (0.003..=0.12).contains(&stretch), "{stretch}");
                if !over && !bits_are_used {
                    let (labels, events) = by_core(&case, &pushed);
                    assert_eq!((&session.labels, &session.events), (&labels, &events));
                    for event in &events {
                        plane(event);
                    }
                }
                over = true;
            }
            Call::Reset => {
                assert_eq!(session.reset(), SCANSEG_OK);
                (pushed, over) = (empty(), false);
            }
            Call::Stop { after, finish } => {
                let mut stopper = Stopper { segmenter: session.segmenter, after };
                let mut out = Output { on_event: Some(stop), user: (&raw mut stopper).cast(), ..output() };
                let ranges_m = vec![2.0; columns];
                // SAFETY: the segmenter of the session, and as many ranges as it takes.
                let status = unsafe {
                    match finish {
                        true => scanseg_finish(session.segmenter, &mut out),
                        false => scanseg_push_row(session.segmenter, ranges_m.as_ptr(), columns, 0.0, &mut out),
                    }
                };
                let answers = if over { [SCANSEG_ERROR_SCAN_OVER; 2] } else { [SCANSEG_OK, SCANSEG_STOPPED] };
                assert!(answers.contains(&status));
                assert_eq!((out.event_count, out.events_lost), (0, 0));
                // its labels are not in the session
                assert_eq!(session.reset(), SCANSEG_OK);
                (pushed, over) = (empty(), false);
            }
            Call::Bad { which, null } => bad(&session, &config, which, null),
            Call::Small { labels, struct_size } => small(&session, labels, struct_size, over),
            Call::Elsewhere(byte) => elsewhere(&session, byte),
            Call::Plane(moments, pixels) => {
                let [a, b, c, second @ ..] = moments;
                plane(&Event { pixels, first_moments: [a, b, c], second_moments: second, ..Event::default() });
            }
            Call::PlaneSums(plane_sums, pixels, last_row) => {
                plane(&Event { pixels, plane_sums, last_row, ..Event::default() });
            }
            Call::Init { less, misaligned } => {
                let bytes = size - usize::from(less).min(size);
                let mut block = vec![0_u8; bytes + 16];
                let shift = block.as_ptr().align_offset(8) + usize::from(misaligned);
                let mut made = std::ptr::dangling_mut();
                // SAFETY: so many bytes behind the shift of at most 8.
                let status = unsafe { scanseg_init(block.as_mut_ptr().add(shift).cast(), bytes, &config, &mut made) };
                let expected = match () {
                    () if misaligned => SCANSEG_ERROR_ALIGNMENT,
                    () if bytes < size => SCANSEG_ERROR_MEMORY_SIZE,
                    () => SCANSEG_OK,
                };
                assert_eq!((status, made.is_null()), (expected, expected != SCANSEG_OK));
            }
        }
    }
});

/// The settings of all approaches are checked, whichever is chosen.
fn is_taken_by_core(case: &Case) -> bool {
    APPROACHES.into_iter().all(|approach| case.refused(case.settings.config(approach)).is_none())
}

/// There is none, or it is a plane.
fn plane(event: &Event) {
    let mut fit = PlaneFit::default();
    // SAFETY: references.
    match unsafe { scanseg_fit_plane(event, &mut fit) } {
        SCANSEG_NO_PLANE => assert_eq!(fit, PlaneFit::default()),
        status => {
            assert_eq!(status, SCANSEG_OK);
            let by_planes = event.plane_sums[0] > 0.0;
            let covariance = fit.covariance.as_flattened();
            assert!(!by_planes || covariance.iter().chain(&fit.normal).all(|x| x.is_finite()), "{fit:?}");
        }
    }
    if event.kind == SCANSEG_SEGMENT && fit != PlaneFit::default() {
        let length = fit.normal.iter().map(|c| c * c).sum::<f32>();
        assert!((length - 1.0).abs() < 1e-5 && fit.distance_m >= 0.0 && fit.rms_m >= 0.0, "{fit:?}");
    }
}

/// A pointer that cannot be used is told, and nothing happens.
fn bad(session: &Session, config: &Config, which: u8, null: bool) {
    fn broken<T>(pointer: *mut T, null: bool) -> *mut T {
        if null { null_mut() } else { pointer.wrapping_byte_add(1) }
    }
    let (mut out, mut size, mut made) = (output(), 0, null_mut());
    let mut ranges_m = vec![2.0_f32; session.columns];
    let (memory, bytes) = (session.memory.cast::<c_void>(), 8 * session.words);
    let (mut event, mut fit, mut copy) = (Event::default(), PlaneFit::default(), *config);
    let (good, length) = (session.segmenter, session.columns);
    // SAFETY: what is broken is not used, the rest is there.
    let status = unsafe {
        match which % 13 {
            0 => scanseg_config_init(broken(&mut copy, null), size_of::<Config>() as u32, SCANSEG_ABI_VERSION),
            1 => scanseg_state_size(broken(&mut copy, null), &mut size),
            2 => scanseg_state_size(config, broken(&mut size, null)),
            3 => scanseg_init(broken(memory.cast::<u64>(), null).cast(), bytes, config, &mut made),
            4 => scanseg_init(memory, bytes, broken(&mut copy, null), &mut made),
            5 => scanseg_init(memory, bytes, config, broken(&mut made, null)),
            6 => scanseg_push_row(broken(good, null), ranges_m.as_ptr(), length, 0.0, &mut out),
            7 => scanseg_push_row(good, broken(ranges_m.as_mut_ptr(), null), length, 0.0, &mut out),
            8 => scanseg_push_row(good, ranges_m.as_ptr(), length, 0.0, broken(&mut out, null)),
            9 => scanseg_finish(broken(good, null), &mut out),
            10 => scanseg_finish(good, broken(&mut out, null)),
            11 => scanseg_reset(broken(good, null)),
            _ => scanseg_fit_plane(broken(&mut event, null), &mut fit),
        }
    };
    let expected = if null { SCANSEG_ERROR_NULL } else { SCANSEG_ERROR_ALIGNMENT };
    assert!(status == expected || status == SCANSEG_ERROR_SCAN_OVER, "{status}");
}

fn small(session: &Session, labels: u8, struct_size: u32, over: bool) {
    let mut array = vec![0; usize::from(labels).min(session.columns - 1)];
    let ranges_m = vec![2.0_f32; session.columns];
    let mut out = Output { labels: array.as_mut_ptr(), label_capacity: array.len(), ..output() };
    // SAFETY: the segmenter of the session, and arrays of these sizes.
    let push =
        |out: &mut Output| unsafe { scanseg_push_row(session.segmenter, ranges_m.as_ptr(), session.columns, 0.0, out) };
    let expected = |status| if over { SCANSEG_ERROR_SCAN_OVER } else { status };
    assert_eq!(push(&mut out), expected(SCANSEG_ERROR_LABELS_SIZE));
    if struct_size as usize != size_of::<Output>() {
        assert_eq!(push(&mut Output { struct_size, ..output() }), expected(SCANSEG_ERROR_STRUCT_SIZE));
    }
}

/// Memory that holds something else, or a copy of the segmenter.
fn elsewhere(session: &Session, byte: u8) {
    let mut other = vec![u64::from_ne_bytes([byte; 8]); session.words];
    if byte == 0 {
        // SAFETY: both have that many words.
        unsafe { other.as_mut_ptr().copy_from_nonoverlapping(session.memory, session.words) };
    }
    let mut out = output();
    // SAFETY: memory of that size.
    unsafe {
        assert_eq!(scanseg_reset(other.as_mut_ptr().cast()), SCANSEG_ERROR_NO_SEGMENTER);
        assert_eq!(scanseg_finish(other.as_mut_ptr().cast(), &mut out), SCANSEG_ERROR_NO_SEGMENTER);
    }
}
