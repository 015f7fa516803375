//! The points of a row, and their sums.

use core::ops::Range;

use crate::moments::Moments;
use crate::row::bits::{CHUNK, load};
use crate::row::fan::{Fan, Frame};

/// The points of a row, chunk by chunk.
#[derive(Debug)]
pub(crate) struct RowPoints<'a> {
    fan: &'a Fan<'a>,
    frame: Frame<'a>,
    ranges_m: &'a [f32],
    /// The chunk that `points` holds.
    chunk: usize,
    points: [[i32; CHUNK]; 3],
}

impl<'a> RowPoints<'a> {
    /// The points of the ranges that were measured along the beams of a row. Only runs of returns
    /// are asked for.
    pub fn new(fan: &'a Fan<'a>, frame: Frame<'a>, ranges_m: &'a [f32]) -> Self {
        Self { fan, frame, ranges_m, chunk: usize::MAX, points: [[0; CHUNK]; 3] }
    }

    /// The sums of a run.
    pub fn moments(&mut self, run: Range<usize>) -> Moments {
        let mut moments = Moments::default();
        let mut column = run.start;
        while column < run.end {
            let chunk = column / CHUNK;
            let from = chunk * CHUNK;
            if self.chunk != chunk {
                self.fan.points(&self.frame, from, load(self.ranges_m, from, &mut [0.0; CHUNK]), &mut self.points);
                self.chunk = chunk;
            }
            let end = run.end.min(from + CHUNK);
            moments.add_points(&self.points, column - from, end - from);
            column = end;
        }
        moments
    }
}
