//! Elements and parts of rows that are known to be there.
//!
//! The compiler does not know, and an index would link the machinery of panics into the image of a
//! microcontroller. Here what is not there reads as the default and is not written, which no test
//! ever saw: builds with debug assertions refuse it.

use core::ops::Range;

#[inline(always)]
pub(crate) fn at<T: Copy + Default>(row: &[T], index: usize) -> T {
    debug_assert!(index < row.len(), "{index} of {}", row.len());
    row.get(index).copied().unwrap_or_default()
}

#[inline(always)]
pub(crate) fn put<T>(row: &mut [T], index: usize, value: T) {
    debug_assert!(index < row.len(), "{index} of {}", row.len());
    if let Some(to) = row.get_mut(index) {
        *to = value;
    }
}

#[inline(always)]
pub(crate) fn part<T>(row: &[T], range: Range<usize>) -> &[T] {
    debug_assert!(range.start <= range.end && range.end <= row.len(), "{range:?} of {}", row.len());
    row.get(range).unwrap_or_default()
}

#[inline(always)]
pub(crate) fn part_mut<T>(row: &mut [T], range: Range<usize>) -> &mut [T] {
    debug_assert!(range.start <= range.end && range.end <= row.len(), "{range:?} of {}", row.len());
    row.get_mut(range).unwrap_or_default()
}

/// The first `at` elements and the rest.
#[inline(always)]
pub(crate) fn split<T>(row: &[T], at: usize) -> (&[T], &[T]) {
    debug_assert!(at <= row.len(), "{at} of {}", row.len());
    row.split_at_checked(at).unwrap_or_default()
}

/// The same, to write.
#[inline(always)]
pub(crate) fn split_mut<T>(row: &mut [T], at: usize) -> (&mut [T], &mut [T]) {
    debug_assert!(at <= row.len(), "{at} of {}", row.len());
    row.split_at_mut_checked(at).unwrap_or_default()
}

#[inline(always)]
pub(crate) fn swap<T: Copy + Default>(row: &mut [T], a: usize, b: usize) {
    let (one, other) = (at(row, a), at(row, b));
    put(row, a, other);
    put(row, b, one);
}
