//! The memory of a segmenter, on the heap.

use scanseg_core::{Area, Memory, Sizes};

/// The slices that a segmenter works in.
#[derive(Clone, Debug)]
pub struct OwnedMemory {
    numbers: Vec<f32>,
    halves: Vec<u16>,
    words: Vec<u32>,
    areas: Vec<Area>,
}

impl OwnedMemory {
    /// Returns memory of these sizes, which the configuration of an approach tells. `max_labels`
    /// limits the table of live labels; without it there is room for as many as `sizes` says.
    pub fn new(sizes: Sizes, max_labels: Option<usize>) -> OwnedMemory {
        OwnedMemory {
            numbers: vec![0.0; sizes.numbers],
            halves: vec![0; sizes.halves],
            words: vec![0; sizes.words],
            areas: vec![Area::EMPTY; max_labels.unwrap_or(sizes.areas).min(sizes.areas)],
        }
    }

    /// Returns the slices, for a segmenter to work in.
    pub fn memory(&mut self) -> Memory<'_> {
        Memory { numbers: &mut self.numbers, halves: &mut self.halves, words: &mut self.words, areas: &mut self.areas }
    }
}
