//! The memory of a segmenter, on the heap.

use scanseg_core::{AnyConfig, Approach, Area, Beams, Memory, Sizes, live_labels};

/// Returns the size of a table of live areas that has room for any image of so many columns.
#[must_use]
pub fn enough_labels(approach: Approach, columns: usize) -> usize {
    match approach {
        // one for each pixel of two rows
        Approach::Plane => 2 * columns,
        Approach::Edge | Approach::Region => live_labels(columns),
    }
}

/// The slices that a segmenter works in.
#[derive(Clone, Debug)]
pub struct OwnedMemory {
    numbers: Vec<f32>,
    halves: Vec<u16>,
    words: Vec<u32>,
    areas: Vec<Area>,
}

impl OwnedMemory {
    /// Returns memory for images of `columns` columns with any beams, with a table of `max_labels`
    /// areas; without it there is room for any image.
    pub fn new<'a>(config: impl Into<AnyConfig<'a>>, columns: usize, max_labels: Option<usize>) -> OwnedMemory {
        let config = config.into();
        let enough = enough_labels(config.approach(), columns);
        let areas = max_labels.unwrap_or(enough).min(enough);
        OwnedMemory::of(Sizes { areas, ..config.sizes_for(&Beams::Free { wraps: false }, columns) })
    }

    /// Returns memory of these sizes.
    pub fn of(sizes: Sizes) -> OwnedMemory {
        OwnedMemory {
            numbers: vec![0.0; sizes.numbers],
            halves: vec![0; sizes.halves],
            words: vec![0; sizes.words],
            areas: vec![Area::EMPTY; sizes.areas],
        }
    }

    /// Returns the slices, for a segmenter to work in.
    pub fn memory(&mut self) -> Memory<'_> {
        Memory { numbers: &mut self.numbers, halves: &mut self.halves, words: &mut self.words, areas: &mut self.areas }
    }
}
