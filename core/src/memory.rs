//! The memory that a segmenter works in: placed by the user, before the first row.

use core::fmt;

use crate::area::Area;
use crate::error::ConfigError;

/// The memory that a segmenter works in, as slices of plain numbers. Each approach uses them in its
/// own way. What they hold before does not matter. Slices may be longer than [`Sizes`] asks for.
/// [`buffers!`](crate::buffers) makes them at compile time.
pub struct Memory<'a> {
    /// Single-precision numbers.
    pub numbers: &'a mut [f32],
    /// Numbers of 16 bits.
    pub halves: &'a mut [u16],
    /// Words of 32 bits.
    pub words: &'a mut [u32],
    /// The table of live areas; fewer will do for simple images. By the paper's two approaches
    /// [`live_labels`](crate::live_labels) elements are enough for every image, and more are not
    /// used. The plane approach holds the areas of two rows in it, of which noise alone makes up to
    /// twice as many as there are columns, and keeps those that have ended as long as there is
    /// room. An area that finds the table full stays without a label, which
    /// [`Status`](crate::Status), [`Finished`](crate::Finished) and
    /// [`Pixel::Unlabelled`](crate::Pixel::Unlabelled) report.
    pub areas: &'a mut [Area],
}

impl fmt::Debug for Memory<'_> {
    /// Writes the lengths of the slices.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lengths = [self.numbers.len(), self.halves.len(), self.words.len(), self.areas.len()];
        write!(f, "Memory({lengths:?})")
    }
}

impl Memory<'_> {
    /// Whether it is enough; one area will do.
    pub(crate) fn check(&self, needed: &Sizes) -> Result<(), ConfigError> {
        for (field, needed, got) in [
            ("numbers", needed.numbers, self.numbers.len()),
            ("halves", needed.halves, self.halves.len()),
            ("words", needed.words, self.words.len()),
            ("areas", 1, self.areas.len()),
        ] {
            if got < needed {
                return Err(ConfigError::Memory { field, needed, got });
            }
        }
        Ok(())
    }
}

/// Lengths of the slices of a [`Memory`]. Each configuration has a method `sizes` that gives what
/// its approach needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sizes {
    /// Of [`Memory::numbers`].
    pub numbers: usize,
    /// Of [`Memory::halves`].
    pub halves: usize,
    /// Of [`Memory::words`].
    pub words: usize,
    /// Of [`Memory::areas`].
    pub areas: usize,
}

const fn max(a: usize, b: usize) -> usize {
    if a > b { a } else { b }
}

impl Sizes {
    /// The lengths that are enough for either.
    #[must_use]
    pub const fn max(self, other: Sizes) -> Sizes {
        Sizes {
            numbers: max(self.numbers, other.numbers),
            halves: max(self.halves, other.halves),
            words: max(self.words, other.words),
            areas: max(self.areas, other.areas),
        }
    }

    /// Bytes of all slices together.
    #[must_use]
    pub const fn bytes(&self) -> usize {
        4 * self.numbers + 2 * self.halves + 4 * self.words + size_of::<Area>() * self.areas
    }
}

/// Owns the memory of a segmenter. Made by [`buffers!`](crate::buffers), all zeros: in a `static`
/// it costs no flash, and it is never built on the stack.
pub struct Buffers<const NUMBERS: usize, const HALVES: usize, const WORDS: usize, const AREAS: usize> {
    numbers: [f32; NUMBERS],
    halves: [u16; HALVES],
    words: [u32; WORDS],
    areas: [Area; AREAS],
}

impl<const N: usize, const H: usize, const W: usize, const A: usize> fmt::Debug for Buffers<N, H, W, A> {
    /// Writes the lengths of the slices.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Buffers({:?})", [N, H, W, A])
    }
}

impl<const N: usize, const H: usize, const W: usize, const A: usize> Buffers<N, H, W, A> {
    /// All zeros.
    pub const EMPTY: Self = Self { numbers: [0.0; N], halves: [0; H], words: [0; W], areas: [Area::EMPTY; A] };

    /// The memory, for a segmenter to work in.
    pub fn memory(&mut self) -> Memory<'_> {
        Memory { numbers: &mut self.numbers, halves: &mut self.halves, words: &mut self.words, areas: &mut self.areas }
    }
}

/// The type of the [`Buffers`] for an image of so many columns, and with a third argument so many
/// live areas. The numbers and the configuration, of any approach, must be constants.
///
/// On a microcontroller the buffers are a static, here by the crate `static_cell`, which gives them
/// out once:
///
/// ```
/// use scanseg_core::{Beams, Columns, PlaneConfig, PlaneSegmenter, Ranging, TurnAxis, buffers};
/// use static_cell::ConstStaticCell;
///
/// const COLUMNS: usize = 181;
/// const CONFIG: PlaneConfig = PlaneConfig::new(Ranging::new(0.01));
/// type SegmenterBuffers = buffers!(COLUMNS, CONFIG);
/// static BUFFERS: ConstStaticCell<SegmenterBuffers> = ConstStaticCell::new(SegmenterBuffers::EMPTY);
///
/// fn main() {
///     let columns = Columns::Even { start_rad: -1.57, step_rad: 0.01745 };
///     let beams = Beams::Nodding { columns, axis: TurnAxis::Y };
///     let buffers: &'static mut SegmenterBuffers = BUFFERS.take();
///     let segmenter = PlaneSegmenter::new(CONFIG, beams, COLUMNS, buffers.memory());
///     println!("{} bytes, {:?}", size_of::<SegmenterBuffers>(), segmenter);
/// }
/// ```
///
/// Elsewhere a variable does: `let mut buffers = <buffers!(COLUMNS, CONFIG)>::EMPTY;`.
#[macro_export]
macro_rules! buffers {
    ($columns:expr, $config:expr) => {
        $crate::buffers!($columns, $config, $config.sizes($columns).areas)
    };
    ($columns:expr, $config:expr, $areas:expr) => {
        $crate::Buffers<
            { $config.sizes_with($columns, $areas).numbers },
            { $config.sizes_with($columns, $areas).halves },
            { $config.sizes_with($columns, $areas).words },
            { $areas },
        >
    };
}
