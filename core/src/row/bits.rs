//! A row of the image as packed bits: column `c` is bit `c % 32` of word `c / 32`. Bits past the
//! last column are 0.

use core::ops::Range;

use crate::row::within::at;

/// Columns per word, and per chunk of every row loop.
pub(crate) const CHUNK: usize = 32;

/// Whether the target works on several numbers at once. Where it does not, loops leave out elements
/// that do not count; the results are the same.
pub(crate) const VECTORS: bool =
    cfg!(any(target_feature = "sse2", target_feature = "neon", target_feature = "simd128", target_feature = "v"));

/// Words of a packed row.
pub(crate) const fn words(columns: usize) -> usize {
    columns.div_ceil(CHUNK)
}

/// The bits of word `word` that are columns of the image.
pub(crate) fn mask(word: usize, columns: usize) -> u32 {
    match columns - word * CHUNK {
        left if left >= CHUNK => u32::MAX,
        left => (1 << left) - 1,
    }
}

/// Packs the flags of 32 columns.
#[inline(always)]
pub(crate) fn pack(flags: &[bool; CHUNK]) -> u32 {
    // eight bytes of 0 or 1 at a time: the product gathers their lowest bits in the highest byte
    let mut word = 0;
    for (i, eight) in flags.map(u8::from).as_chunks().0.iter().enumerate() {
        let gathered = u64::from_le_bytes(*eight).wrapping_mul(0x0102_0408_1020_4080) >> 56;
        word |= (gathered as u32) << (8 * i);
    }
    word
}

/// Packs a condition of 32 columns. A function of its own on a host, so that the compiler keeps the
/// columns side by side.
#[cfg_attr(target_os = "none", inline(always))]
#[cfg_attr(not(target_os = "none"), inline(never))]
pub(crate) fn pack_where(holds: impl Fn(usize) -> bool) -> u32 {
    if VECTORS {
        return (0..CHUNK).fold(0, |word, i| word | u32::from(holds(i)) << i);
    }
    (0..CHUNK).rev().fold(0, |word, i| word << 1 | u32::from(holds(i)))
}

/// The number of set bits among some columns.
pub(crate) fn count_bits(words: &[u32], columns: &Range<usize>) -> u32 {
    let (mut count, mut from) = (0, columns.start);
    while from < columns.end {
        let (word, first) = (from / CHUNK, from % CHUNK);
        let width = (CHUNK - first).min(columns.end - from);
        let bits = at(words, word) >> first << (CHUNK - width);
        count += bits.count_ones();
        from += width;
    }
    count
}

/// The chunk that starts at column `from`, in place; where the row ends within it, a copy with
/// zeros after the end.
#[inline(always)]
pub(crate) fn load<'a, T: Copy + Default>(row: &'a [T], from: usize, copy: &'a mut [T; CHUNK]) -> &'a [T; CHUNK] {
    let rest = row.get(from..).unwrap_or_default();
    match rest.first_chunk() {
        Some(chunk) => chunk,
        None => {
            *copy = [T::default(); CHUNK];
            for (copy, &value) in copy.iter_mut().zip(rest) {
                *copy = value;
            }
            copy
        }
    }
}

/// Writes a chunk to where it belongs in the row; what is past the end is dropped.
#[inline(always)]
pub(crate) fn store<T: Copy>(row: &mut [T], from: usize, chunk: &[T]) {
    let rest = row.get_mut(from..).unwrap_or_default();
    match (rest.first_chunk_mut::<CHUNK>(), chunk.first_chunk()) {
        (Some(to), Some(chunk)) => *to = *chunk,
        _ => rest.iter_mut().zip(chunk).for_each(|(to, &value)| *to = value),
    }
}

/// The runs of a packed row, from the left: set bits next to each other. With `TOUCH` each bit of
/// `starts` begins a new run.
#[derive(Clone)]
pub(crate) struct Runs<'a, const TOUCH: bool> {
    words: &'a [u32],
    starts: &'a [u32],
    column: usize,
    columns: usize,
}

/// Iterates over the runs of set bits of a packed row.
pub(crate) fn runs(words: &[u32], columns: usize) -> Runs<'_, false> {
    Runs { words, starts: &[], column: 0, columns }
}

/// Iterates over the runs of a packed row that may touch. Where `starts` is empty they do not.
pub(crate) fn touching_runs<'a>(words: &'a [u32], starts: &'a [u32], columns: usize) -> Runs<'a, true> {
    Runs { words, starts, column: 0, columns }
}

impl<const TOUCH: bool> Runs<'_, TOUCH> {
    /// The runs from a column on.
    pub fn from(mut self, column: usize) -> Self {
        self.column = column;
        self
    }

    /// First column from `self.column` on whose bit differs from those of `invert`, or, with
    /// `TOUCH`, that begins a run; `columns` if there is none.
    #[cfg_attr(target_os = "none", inline(never))] // in three places it takes 500 bytes more
    fn seek(&mut self, invert: u32) {
        let mut word = self.column / CHUNK;
        let mut keep = u32::MAX << (self.column % CHUNK);
        while let Some(&bits) = self.words.get(word) {
            let mut found = bits ^ invert;
            if TOUCH && invert != 0 {
                found |= self.starts.get(word).copied().unwrap_or(0);
            }
            found &= keep;
            if found != 0 {
                self.column = (word * CHUNK + found.trailing_zeros() as usize).min(self.columns);
                return;
            }
            keep = u32::MAX;
            word += 1;
        }
        self.column = self.columns;
    }
}

impl<const TOUCH: bool> Iterator for Runs<'_, TOUCH> {
    type Item = Range<usize>;

    fn next(&mut self) -> Option<Range<usize>> {
        self.seek(0);
        let start = self.column;
        if start == self.columns {
            return None;
        }
        // its own first bit does not end it
        self.column += usize::from(TOUCH);
        self.seek(u32::MAX);
        Some(start..self.column)
    }
}
