//! A segmenter as a C program has it, with its memory on the heap: for tests of the C interface and
//! for fuzzing.

use std::ffi::c_void;
use std::ptr::null_mut;

use scanseg_capi::*;

/// Reduced under Miri.
pub const COLUMNS: usize = if cfg!(miri) { 12 } else { 181 };
/// Reduced under Miri.
pub const ROWS: usize = if cfg!(miri) { 5 } else { 60 };

/// All approaches.
pub const APPROACHES: [u32; 3] = [SCANSEG_PLANE, SCANSEG_EDGE, SCANSEG_REGION];

/// The same; under Miri one of them, for what does not depend on the approach.
pub const ANY_APPROACH: &[u32] = if cfg!(miri) { &[SCANSEG_EDGE] } else { &APPROACHES };

/// Returns the defaults.
pub fn defaults() -> Config {
    let mut config = std::mem::MaybeUninit::<Config>::uninit();
    // SAFETY: room for one configuration; initialised if that is said.
    unsafe {
        assert_eq!(
            scanseg_config_init(config.as_mut_ptr(), size_of::<Config>() as u32, SCANSEG_ABI_VERSION),
            SCANSEG_OK
        );
        config.assume_init()
    }
}

/// A scanner that nods, of [`COLUMNS`] columns.
pub fn nodding(approach: u32) -> Config {
    Config {
        approach,
        columns: COLUMNS as u32,
        beams: SCANSEG_NODDING_Y,
        column_start_rad: -0.9,
        column_step_rad: 0.01,
        ..defaults()
    }
}

/// Returns an output without arrays.
pub fn output() -> Output {
    Output {
        struct_size: size_of::<Output>() as u32,
        first_row: 0,
        labels: null_mut(),
        label_capacity: 0,
        events: null_mut(),
        event_capacity: 0,
        on_event: None,
        user: null_mut(),
        event_count: 0,
        events_lost: 0,
        row_count: 0,
        unlabelled: 0,
        scan_rows: 0,
        beam_stretch: 0.0,
    }
}

/// Returns the bytes that a configuration needs.
pub fn state_size(config: &Config) -> Result<usize, Status> {
    let mut size = usize::MAX;
    // SAFETY: references.
    match unsafe { scanseg_state_size(config, &mut size) } {
        SCANSEG_OK => Ok(size),
        status => {
            assert_eq!(size, 0);
            Err(status)
        }
    }
}

/// A segmenter, all its labels and events.
pub struct Session {
    /// Its memory.
    pub memory: *mut u64,
    /// Words of 64 bits of the memory.
    pub words: usize,
    /// The segmenter in it.
    pub segmenter: *mut State,
    /// Columns of the image.
    pub columns: usize,
    /// The most events of one call.
    pub most_events: usize,
    /// The labels of all rows so far.
    pub labels: Vec<u32>,
    /// All events so far.
    pub events: Vec<Event>,
    /// The share by which beam angles are too small, as the last call that was taken told it.
    pub beam_stretch: f32,
}

impl Session {
    /// Makes a segmenter in memory of its own.
    ///
    /// # Panics
    /// If the configuration is refused.
    pub fn new(config: &Config) -> Session {
        let words = state_size(config).unwrap().div_ceil(8);
        // what was there before must not matter
        let memory = Box::leak(vec![0xA5A5_A5A5_A5A5_A5A5_u64; words].into_boxed_slice()).as_mut_ptr();
        let mut segmenter = null_mut();
        // SAFETY: the memory has that many bytes, and is the segmenter's until this is dropped.
        let status = unsafe { scanseg_init(memory.cast::<c_void>(), 8 * words, config, &mut segmenter) };
        assert_eq!(status, SCANSEG_OK);
        assert_eq!(segmenter.cast(), memory);
        let columns = config.columns as usize;
        Session { memory, words, segmenter, columns, most_events: 0, labels: vec![], events: vec![], beam_stretch: 0.0 }
    }

    fn call(&mut self, rows: usize, call: impl FnOnce(*mut State, *mut Output) -> Status) -> Status {
        let mut labels = vec![77; rows * self.columns];
        let mut events = vec![Event::default(); 2 * self.columns + 4];
        let mut out = Output {
            labels: labels.as_mut_ptr(),
            label_capacity: labels.len(),
            events: events.as_mut_ptr(),
            event_capacity: events.len(),
            ..output()
        };
        let status = call(self.segmenter, &mut out);
        if status >= 0 {
            assert_eq!(out.events_lost, 0);
            assert_eq!(
                out.first_row as usize * usize::from(out.row_count > 0),
                self.labels.len() / self.columns * usize::from(out.row_count > 0)
            );
            self.labels.extend(&labels[..out.row_count as usize * self.columns]);
            self.events.extend(&events[..out.event_count]);
            self.beam_stretch = out.beam_stretch;
            self.most_events = self.most_events.max(out.event_count);
        }
        status
    }

    /// Pushes a row.
    pub fn push(&mut self, ranges_m: &[f32], turn_rad: f32) -> Status {
        // SAFETY: the segmenter of this session, and arrays of these sizes.
        self.call(1, |segmenter, out| unsafe {
            scanseg_push_row(segmenter, ranges_m.as_ptr(), ranges_m.len(), turn_rad, out)
        })
    }

    /// Pushes a row whose beams lie beside where its turn alone says.
    pub fn push_beams(&mut self, ranges_m: &[f32], beams: &RowBeams) -> Status {
        // SAFETY: the segmenter of this session, and arrays of these sizes.
        self.call(1, |segmenter, out| unsafe {
            scanseg_push_row_beams(segmenter, ranges_m.as_ptr(), ranges_m.len(), beams, out)
        })
    }

    /// Ends the scan.
    pub fn finish(&mut self) -> Status {
        // SAFETY: as above.
        self.call(SCANSEG_LATENCY_ROWS, |segmenter, out| unsafe { scanseg_finish(segmenter, out) })
    }

    /// Begins again.
    pub fn reset(&mut self) -> Status {
        self.labels.clear();
        self.events.clear();
        // SAFETY: as above.
        unsafe { scanseg_reset(self.segmenter) }
    }
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: leaked in `new`, of this length; the segmenter is not used any more.
        drop(unsafe { Box::from_raw(std::ptr::slice_from_raw_parts_mut(self.memory, self.words)) });
    }
}

/// Returns the name of the field that is refused.
pub fn bad_field(config: &Config) -> Option<&'static str> {
    // SAFETY: a reference; the name is a constant of the library.
    unsafe {
        let name = scanseg_bad_field(config);
        (!name.is_null()).then(|| std::ffi::CStr::from_ptr(name).to_str().unwrap())
    }
}

/// Returns ranges of a room with a step and a hole in it, and noise of a tenth of the strength
/// given.
pub fn room_m(row: usize, columns: usize, noise: f32) -> Vec<f32> {
    let mut seed = 12_345_u32.wrapping_mul(row as u32 + 1);
    (0..columns)
        .map(|column| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let random = (seed >> 8) as f32 / 16_777_216.0 - 0.5;
            let angle = (column as f32 / columns as f32 - 0.5) * 1.2;
            let wall = if column < columns / 3 { 1.5 } else { 2.0 + 0.02 * row as f32 };
            if column % 29 == 7 { f32::NAN } else { wall / angle.cos() + noise * random }
        })
        .collect()
}
