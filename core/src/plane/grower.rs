//! Pixels of a row become parts of areas: runs that go on with a plane, and lines in the rest.

use core::ops::Range;

use crate::plane::areas::{Areas, FULL};
use crate::plane::line::lines;
use crate::plane::scanline::{Cached, Scanline};
use crate::row::bits::{CHUNK, count_bits, runs};
use crate::row::slots::NONE;
use crate::row::within::{at, part, part_mut};

/// Gives the pixels of a row to areas.
pub(crate) struct Grower<'r> {
    pub line: &'r Scanline<'r>,
    /// Packed: pixels with a return.
    pub returns: &'r [u32],
    pub cached: Cached,
}

impl Grower<'_> {
    /// Areas grow by the pixels that go on with their planes. Runs go across a few missing pixels.
    pub fn extend(&mut self, areas: &mut Areas, slots: &[u16]) {
        let columns = slots.len();
        let same = |from: usize, slot: u16| part(slots, from..columns).iter().take_while(|&&s| s == slot).count();
        let mut start = 0;
        while start < columns {
            let slot = at(slots, start);
            let mut end = start + same(start, slot);
            loop {
                let next = end + same(end, NONE);
                let across = next > end && next - end <= self.line.gap_columns;
                if slot >= FULL
                    || !across
                    || next >= columns
                    || at(slots, next) != slot
                    || (end..next).any(|column| is_one(self.returns, column))
                {
                    break;
                }
                end = next + same(next, slot);
            }
            if slot < FULL {
                let run = start..end;
                let mut fitted = areas.fitted(slot);
                let (sums, errors) = self.line.sums(false, run.clone(), fitted.m, &mut self.cached);
                fitted.extend(&sums, &errors);
                if self.line.offset_m != 0.0 {
                    fitted.move_on(&sums, self.line.offset_m, self.line.known_rows);
                }
                areas.extend(slot, &run, &fitted, count_bits(self.returns, &run));
            }
            start = end;
        }
    }

    /// Cuts the pixels that follow no plane into lines, and gives each to an area above or to a new
    /// one. Returns the pixels of lines that found the table of areas full. `cuts` is scratch, one
    /// element per column.
    pub fn take_lines(
        &mut self,
        areas: &mut Areas,
        above: &[u16],
        slots: &mut [u16],
        free: &[u32],
        cuts: &mut [u16],
    ) -> u32 {
        let (mut unlabelled, mut column) = (0, 0);
        let Self { line, returns, cached } = self;
        while let Some(run) = free_run(line, returns, free, column) {
            column = run.end;
            lines(run, line, areas.rules, cuts, cached, |run, cached| {
                let fitted = line.fitted(run.clone(), cached);
                let points = count_bits(returns, &run);
                let slot = areas.area_for(above, &run, &fitted, points);
                unlabelled += if slot == FULL { points } else { 0 };
                for returns in runs(returns, run.end).from(run.start) {
                    part_mut(slots, returns).fill(slot);
                }
            });
        }
        unlabelled
    }
}

fn is_one(bits: &[u32], column: usize) -> bool {
    at(bits, column / CHUNK) >> (column % CHUNK) & 1 == 1
}

/// The next run of free pixels of a row from a column on, across a few missing ones.
fn free_run(line: &Scanline, returns: &[u32], free: &[u32], from: usize) -> Option<Range<usize>> {
    let mut runs = runs(free, line.ranges_m.len()).from(from);
    let mut run = runs.next()?;
    for next in runs {
        let far = next.start - run.end > line.gap_columns;
        if far || (run.end..next.start).any(|column| is_one(returns, column)) {
            break;
        }
        run.end = next.end;
    }
    Some(run)
}
