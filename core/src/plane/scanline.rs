//! A row as it was pushed, its beams and its planes.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::dot;
use crate::config::Ranging;
use crate::plane::noise::{Spread, Variance};
use crate::row::bits::{CHUNK, VECTORS};
use crate::row::fan::{Fan, Frame, Lanes};
use crate::row::within::at;

/// Nearer returns count as being there, metres: the fourth power of a range is a number.
const LEAST_RANGE_M: f32 = 1e-3;

/// A row of ranges and the beams along which they were measured.
pub(crate) struct Scanline<'a> {
    pub ranging: &'a Ranging,
    pub fan: &'a Fan<'a>,
    pub frame: Frame<'a>,
    pub ranges_m: &'a [f32],
    pub wraps: bool,
    /// Variance of a range.
    pub variance: Variance,
    /// What it grows by where a surface is seen at an angle.
    pub spread: Spread,
    /// Pixels along a row whose errors are alike: together they count once.
    pub alike_px: f32,
    /// The row was turned by this more than was reported, radians. Planes are followed where they
    /// then are, and the sums forgive as much.
    pub turned_rad: f32,
    /// Ranges are too large by this, metres: the offset of the ring of a spinning scanner. It is taken
    /// off them.
    pub offset_m: f32,
    /// Rows of the oldest plane that tells of that offset.
    pub known_rows: f32,
    /// Variance of what all pixels of the row are off by alike: rad^2 of its turn, m^2 of the offset
    /// of its ring. To begin with what is stated, then with what the scan tells.
    pub off2: f32,
    /// Columns without a return that lines and runs go across.
    pub gap_columns: usize,
}

/// A plane in one row: u . m = a cos + b sin + turned beside + k, and `turned` cos more for each
/// radian that the row turns.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Along {
    pub a: f32,
    pub b: f32,
    pub k: f32,
    pub turned: f32,
}

impl Scanline<'_> {
    /// A plane u . m = 1 / r in this row.
    pub fn along(&self, m: [f32; 3]) -> Along {
        let Frame { p, q, r, t, .. } = self.frame;
        let [a, b, k, turned] = [p, q, r, t].map(|along| dot(along, m));
        Along { a, b, k, turned }
    }

    /// The chunk that starts at column `from`. Called on a microcontroller: in six places it takes 0.8 KB more.
    #[cfg_attr(not(target_os = "none"), inline)]
    #[cfg_attr(target_os = "none", inline(never))]
    pub fn lanes(&self, from: usize, lanes: &mut Lanes) {
        let row = self.ranges_m.get(from..).unwrap_or_default();
        if let Some(row) = row.first_chunk() {
            let row: &[f32; CHUNK] = row;
            lanes.range_m.iter_mut().zip(row).for_each(|(to, &range_m)| *to = self.known(range_m));
        } else {
            lanes.range_m.fill(0.0);
            lanes.range_m.iter_mut().zip(row).for_each(|(to, &range_m)| *to = self.known(range_m));
        }
        if self.offset_m != 0.0 {
            self.take_off(lanes);
        }
        self.fan.lanes(&self.frame, from, lanes);
    }

    /// Whether a pixel is a return.
    pub fn is_return(&self, column: usize) -> bool {
        self.ranging.no_return(at(self.ranges_m, column)) >> 31 == 0
    }

    /// The range of a return as it was measured, 0 for none.
    pub fn range_m(&self, column: usize) -> f32 {
        self.known(at(self.ranges_m, column))
    }

    /// A range less the offset of its ring; nearer ones than twice that are left alone.
    fn right(&self, range_m: f32) -> f32 {
        let is_off = self.offset_m != 0.0 && range_m > 2.0 * self.offset_m.abs();
        if is_off { range_m - self.offset_m } else { range_m }
    }

    /// The same of a chunk. Apart, since few scanners need it.
    #[inline(never)]
    fn take_off(&self, lanes: &mut Lanes) {
        for range_m in &mut lanes.range_m {
            *range_m = self.right(*range_m);
        }
    }

    /// A range as it is reckoned with, 0 for no return.
    #[inline(always)]
    fn known(&self, range_m: f32) -> f32 {
        // the bits of positive numbers are in the order of the numbers
        let near_m = f32::from_bits(range_m.to_bits().max(LEAST_RANGE_M.to_bits()));
        if self.ranging.no_return(range_m) >> 31 == 0 { near_m } else { 0.0 }
    }

    /// The direction of the beam of a pixel.
    pub fn beam(&self, pixel: &At) -> [f32; 3] {
        let Frame { p, q, r, t, .. } = self.frame;
        core::array::from_fn(|i| pixel.cos * p[i] + pixel.sin * q[i] + pixel.beside * t[i] + r[i])
    }

    /// The column so many to the right, if it is there.
    pub fn to_the_right(&self, column: usize, ahead: usize) -> Option<usize> {
        let columns = self.ranges_m.len();
        match column + ahead {
            c if c < columns => Some(c),
            c if self.wraps && c < 2 * columns => Some(c - columns),
            _ => None,
        }
    }
}

/// A pixel: its beam within its row, as [`Lanes`] have it, and its range, 0 for no return.
#[derive(Clone, Copy, Debug)]
pub(crate) struct At {
    pub cos: f32,
    pub sin: f32,
    pub beside: f32,
    pub range_m: f32,
}

/// The chunk that was read last.
pub(crate) struct Cached {
    pub lanes: Lanes,
    chunk: usize,
}

impl Cached {
    /// None was read yet. No constant, which would be in an image, 516 bytes, and copied.
    pub fn empty() -> Cached {
        Cached { lanes: Lanes::EMPTY, chunk: usize::MAX }
    }

    /// The chunk of a column, and the place of the column in it.
    #[inline(always)]
    pub fn lanes(&mut self, row: &Scanline, column: usize) -> (&Lanes, usize) {
        if self.chunk != column / CHUNK {
            self.chunk = column / CHUNK;
            row.lanes(self.chunk * CHUNK, &mut self.lanes);
        }
        (&self.lanes, column % CHUNK)
    }

    /// A pixel.
    #[inline(always)]
    pub fn at(&mut self, row: &Scanline, column: usize) -> At {
        let (lanes, i) = self.lanes(row, column);
        At { cos: lanes.cos[i], sin: lanes.sin[i], beside: lanes.beside[i], range_m: lanes.range_m[i] }
    }

    /// A pixel that is needed alone: its chunk is not read for it where that costs more.
    #[inline(never)]
    pub fn lone(&mut self, row: &Scanline, column: usize) -> At {
        if VECTORS || !row.frame.plain {
            return self.at(row, column);
        }
        let i = column % CHUNK;
        let (cos, sin) = if self.chunk == column / CHUNK {
            (self.lanes.cos[i], self.lanes.sin[i])
        } else {
            row.fan.row_beam(&row.frame, column)
        };
        At { cos, sin, beside: 0.0, range_m: row.right(row.range_m(column)) }
    }
}
