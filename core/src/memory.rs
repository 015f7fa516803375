//! The memory that a segmenter works in: placed by the user, before the first row.

use crate::bits::{CHUNK, words};
use crate::config::{Config, Trace};
use crate::error::ConfigError;
use crate::label::{Area, frontier_words, live_labels};
use crate::plane_segmenter::{numbers_len, slots_len};
use crate::segmenter::LATENCY_ROWS;

/// The memory that a segmenter works in. What it holds before does not matter; longer slices than [`Sizes`] asks for are
/// fine. [`buffers!`](crate::buffers) makes it at compile time.
#[derive(Debug)]
pub struct Memory<'a> {
    /// Rows of ranges.
    pub ranges: &'a mut [f32],
    /// Rows of bearing angles, two per trace. The region-based approach has scratch of its lines there.
    pub bearings: &'a mut [u16],
    /// Rows of packed bits, and the frontier of the labels.
    pub words: &'a mut [u32],
    /// The table of live labels; more than [`live_labels`] elements are not used. They are enough for every image by the
    /// paper's two approaches. The plane approach holds the areas of two rows in it, which noise alone can make more of. An
    /// area that finds the table full stays without a label, which [`Status`](crate::Status),
    /// [`Finished`](crate::Finished) and [`Pixel::Unlabelled`](crate::Pixel::Unlabelled) report.
    pub areas: &'a mut [Area],
}

impl Memory<'_> {
    /// Whether it is enough for images of `columns` columns; with it what was asked for.
    pub(crate) fn check(&self, columns: usize, config: &Config<'_>) -> Result<Sizes, ConfigError> {
        let needed = Sizes::of(columns, config);
        for (field, needed, got) in [
            ("ranges", needed.ranges, self.ranges.len()),
            ("bearings", needed.bearings, self.bearings.len()),
            ("words", needed.words, self.words.len()),
            ("areas", 1, self.areas.len()),
        ] {
            if got < needed {
                return Err(ConfigError::Memory { field, needed, got });
            }
        }
        Ok(needed)
    }
}

/// Lengths of the slices of a [`Memory`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sizes {
    /// Of [`Memory::ranges`].
    pub ranges: usize,
    /// Of [`Memory::bearings`].
    pub bearings: usize,
    /// Of [`Memory::words`].
    pub words: usize,
    /// Of [`Memory::areas`], for every image to find room.
    pub areas: usize,
}

/// Length of a row of bearing angles: whole chunks, with room for one column more.
pub(crate) const fn padded_row(columns: usize) -> usize {
    (columns / CHUNK + 1) * CHUNK
}

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

/// Packed rows in [`Memory::words`].
pub(crate) const BIT_ROWS: usize = 10;

impl Sizes {
    /// What an image of `columns` columns needs.
    pub const fn of(columns: usize, config: &Config<'_>) -> Sizes {
        Sizes {
            ranges: max(stored_rows(config.traces) * columns, numbers_len(columns)),
            bearings: max(2 * config.traces.len() * padded_row(columns), slots_len(columns)),
            words: BIT_ROWS * words(columns) + frontier_words(columns),
            areas: live_labels(columns),
        }
    }

    /// Bytes of all slices together.
    pub const fn bytes(&self) -> usize {
        4 * self.ranges + 2 * self.bearings + 4 * self.words + size_of::<Area>() * self.areas
    }
}

/// Rows of ranges kept: as far back as a trace reaches, and until the labels are known, which is three rows. The
/// region-based approach keeps the x, y and z of one row instead.
pub(crate) const fn stored_rows(traces: &[Trace]) -> usize {
    let mut rows = LATENCY_ROWS;
    let mut i = 0;
    while i < traces.len() {
        if traces[i].rows as usize > rows {
            rows = traces[i].rows as usize;
        }
        i += 1;
    }
    rows
}

/// Owns the memory of a segmenter. Made by [`buffers!`](crate::buffers), all zeros: in a `static` it costs no flash, and
/// it is never built on the stack.
#[derive(Debug)]
pub struct Buffers<const RANGES: usize, const BEARINGS: usize, const WORDS: usize, const AREAS: usize> {
    ranges: [f32; RANGES],
    bearings: [u16; BEARINGS],
    words: [u32; WORDS],
    areas: [Area; AREAS],
}

impl<const R: usize, const B: usize, const W: usize, const A: usize> Buffers<R, B, W, A> {
    /// All zeros.
    pub const EMPTY: Self = Self { ranges: [0.0; R], bearings: [0; B], words: [0; W], areas: [Area::EMPTY; A] };

    /// For [`EdgeSegmenter::new`](crate::EdgeSegmenter::new) or [`RegionSegmenter::new`](crate::RegionSegmenter::new).
    pub fn memory(&mut self) -> Memory<'_> {
        Memory {
            ranges: &mut self.ranges,
            bearings: &mut self.bearings,
            words: &mut self.words,
            areas: &mut self.areas,
        }
    }
}

/// The type of the [`Buffers`] for an image of so many columns, and with a third argument so many live labels. Both
/// numbers and the [`Config`] must be constants.
///
/// ```
/// use scanseg_core::{Config, Sizes, buffers};
/// const CONFIG: Config = Config::paper();
/// // on a microcontroller: a `static`
/// let mut buffers = <buffers!(181, CONFIG)>::EMPTY;
/// let memory = buffers.memory();
/// assert!(Sizes::of(181, &CONFIG).bytes() <= 12 * 1024);
/// ```
#[macro_export]
macro_rules! buffers {
    ($columns:expr, $config:expr) => {
        $crate::buffers!($columns, $config, $crate::Sizes::of($columns, &$config).areas)
    };
    ($columns:expr, $config:expr, $areas:expr) => {
        $crate::Buffers<
            { $crate::Sizes::of($columns, &$config).ranges },
            { $crate::Sizes::of($columns, &$config).bearings },
            { $crate::Sizes::of($columns, &$config).words },
            { $areas },
        >
    };
}
