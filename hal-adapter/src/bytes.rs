//! Copying without a panic, and without a second routine for it in the image.

/// Copies as many bytes as both slices have. `copy_from_slice` checks the lengths, and leaves a
/// panic in the image wherever the compiler cannot prove that they are equal.
pub(crate) fn copy(to: &mut [u8], from: &[u8]) {
    to.iter_mut().zip(from).for_each(|(to, from)| *to = *from);
}

/// Moves what is in `bytes` from `from` on to its beginning. `copy_within` links a routine of
/// 1.5 KB for bytes that overlap.
pub(crate) fn move_down(bytes: &mut [u8], from: usize) {
    let bytes = core::cell::Cell::from_mut(bytes).as_slice_of_cells();
    let Some(rest) = bytes.get(from..) else { return };
    // one after the other: they may overlap
    bytes.iter().zip(rest).for_each(|(to, from)| to.set(core::hint::black_box(from.get())));
}
