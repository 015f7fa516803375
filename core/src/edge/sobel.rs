//! Edges in a bearing-angle image (paper section 4).
//!
//! Roof edges: the 3 x 3 Sobel operator on each image separately, thresholded: |Gx| + |Gy| >= 4 x
//! the roof angle. A neighbour without a bearing angle, or outside of the image, takes the centre's
//! value. Sobel works on eighths of the image's resolution (pi / 8192, 0.02 deg), which 16-bit
//! arithmetic holds exactly.
//!
//! Step edges: a bearing angle near 0 or pi, where the range changes by more than the noise.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::round;
use crate::config::Ranging;
use crate::edge::bearing::{COUNTS_PER_RAD, Pairs, Pixel};
use crate::edge::config::EdgeConfig;
use crate::row::bits::{CHUNK, pack};

/// Thresholds in the units of the images.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Thresholds {
    /// Of |Gx| + |Gy|, eighths.
    roof: u16,
    /// First and number of the counts that are farther from 0 and pi than a step's.
    between: (i32, i32),
    /// Of the change of range, metres.
    step_range_m: f32,
}

impl Thresholds {
    pub fn new(config: &EdgeConfig) -> Self {
        let step = round(config.step_angle_rad * COUNTS_PER_RAD);
        Self {
            roof: round(config.roof_angle_rad * (COUNTS_PER_RAD / 2.0)) as u16,
            between: (step + 1, (65534 - 2 * step).max(0)),
            step_range_m: config.step_range_m(),
        }
    }
}

/// The bit of an eighth that says that there is no bearing angle; the others then mean nothing.
pub(crate) const GAP: u16 = 1 << 15;

/// Sobel's kernel on its way along a row: three rows of eighths, of which the last two columns are
/// remembered.
pub(crate) struct Sobel {
    roof: u16,
    /// Above, centre, below.
    last: [[u16; 2]; 3],
}

impl Sobel {
    /// Starts to the right of a column, `[above, centre, below]`; all [`GAP`] for none.
    pub fn new(thresholds: &Thresholds, left: [u16; 3]) -> Self {
        Self { roof: thresholds.roof, last: left.map(|eighth| [GAP, eighth]) }
    }

    /// Roof edges, packed, of the columns from the one before the chunk to the last but one in it.
    #[inline(always)]
    pub fn next(&mut self, above: &[u16; CHUNK], centre: &[u16; CHUNK], below: &[u16; CHUNK]) -> u32 {
        let [mut left, mut middle] = [0, 1].map(|i| column_sums(self.last[0][i], self.last[1][i], self.last[2][i]));
        let mut gaps = self.last.as_flattened().iter().fold(0, |gaps, eighth| gaps | eighth);
        let mut edges = [false; CHUNK];
        for i in 0..CHUNK {
            gaps |= above[i] | centre[i] | below[i];
            let right = column_sums(above[i], centre[i], below[i]);
            edges[i] = strength(left, middle, right) >= self.roof;
            (left, middle) = (middle, right);
        }
        let mut edges = pack(&edges);
        if gaps & GAP != 0 {
            edges = self.around_gaps(edges, above, centre, below);
        }
        self.last = [above, centre, below].map(|row| [row[CHUNK - 2], row[CHUNK - 1]]);
        edges
    }

    /// The same where something under the kernel is missing.
    #[inline(never)]
    fn around_gaps(&self, mut edges: u32, above: &[u16; CHUNK], centre: &[u16; CHUNK], below: &[u16; CHUNK]) -> u32 {
        let rows = [above, centre, below];
        let mut window = [[0; CHUNK + 2]; 3];
        for (row, (last, chunk)) in window.iter_mut().zip(self.last.iter().zip(rows)) {
            (row[0], row[1]) = (last[0], last[1]);
            row[2..].copy_from_slice(chunk);
        }
        let edge = |left: usize| {
            let own = window[1][left + 1];
            let sums = |column: usize| {
                let [above, centre, below] = [0, 1, 2].map(|row| {
                    let eighth = window[row][column];
                    if eighth & GAP == 0 { eighth } else { own }
                });
                column_sums(above, centre, below)
            };
            (strength(sums(left), sums(left + 1), sums(left + 2)) >= self.roof) & (own & GAP == 0)
        };
        // with vectors, all columns cost as much as three
        if cfg!(any(target_feature = "sse2", target_feature = "neon")) {
            return pack(&core::array::from_fn(edge));
        }
        // bit i is column i of the chunk; a kernel's bit is that of its right column
        let gaps = pack(&core::array::from_fn(|i| (above[i] | centre[i] | below[i]) & GAP != 0));
        let missing = pack(&centre.map(|eighth| eighth & GAP != 0));
        let last = [0, 1].map(|i| u32::from(self.last.iter().any(|row| row[i] & GAP != 0)));
        let own = (missing << 1) | u32::from(self.last[1][1] >> 15);
        let mut near = (gaps | (gaps << 1) | (gaps << 2) | last[0] | (last[1] * 3)) & !own;
        edges &= !own;
        while near != 0 {
            let i = near.trailing_zeros() as usize % CHUNK;
            near &= near - 1;
            edges = (edges & !(1 << i)) | (u32::from(edge(i)) << i);
        }
        edges
    }
}

/// Sums of the kernel over a column: a + 2 b + c, and c - a. They wrap.
#[inline(always)]
fn column_sums(above: u16, centre: u16, below: u16) -> (u16, u16) {
    (above.wrapping_add(centre << 1).wrapping_add(below), below.wrapping_sub(above))
}

/// Returns |Gx| + |Gy| of three columns. Sums of four eighths wrap at 16 bits, but the differences
/// fit: 4 x 8191 at most. Of gaps it means nothing.
#[inline(always)]
fn strength(left: (u16, u16), middle: (u16, u16), right: (u16, u16)) -> u16 {
    let gx = right.0.wrapping_sub(left.0);
    let gy = left.1.wrapping_add(middle.1 << 1).wrapping_add(right.1);
    (gx as i16).unsigned_abs().wrapping_add((gy as i16).unsigned_abs())
}

/// Bearing angles of a chunk in eighths, as Sobel takes them: 1 to 8192 for counts of 1 to 65535,
/// with [`GAP`] for none. Returns its step edges, packed.
// A function of its own: what it is given cannot overlap what it writes, and the compiler knows.
#[inline(never)]
pub(crate) fn bearings(pairs: &Pairs, ranging: &Ranging, thresholds: &Thresholds, eighths: &mut [u16; CHUNK]) -> u32 {
    let (ranging, (first, counts)) = (*ranging, thresholds.between);
    let step_range = thresholds.step_range_m.to_bits();
    let mut steps = [false; CHUNK];
    for i in 0..CHUNK {
        let Pixel { change_m, count, missing } = pairs.get(i, &ranging);
        eighths[i] = (count.wrapping_add(7) >> 3) as u16 | ((missing >> 16) as u16 & GAP);
        // in the highest bits, without a comparison: what is below 0 has it
        let above = count.wrapping_sub(first);
        let near = (above | (counts - 1).wrapping_sub(above)) as u32;
        let jump = step_range.wrapping_sub(change_m.abs().to_bits());
        steps[i] = (near & jump & !missing) >> 31 != 0;
    }
    pack(&steps)
}
