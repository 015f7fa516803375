//! Lines in what follows no plane: Bellman's recursion over the last cut, eight candidates side by side.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::plane::row::{Cached, RowView};
use crate::plane::rules::Rules;
use crate::row::within::{at, put};
use core::ops::{ControlFlow, Range};

/// Last cuts that are kept.
const CUTS: usize = 8;

/// What stands for a cut that is out.
const OUT: f32 = 1e30;

type Eight = [f32; CUTS];

/// Last cuts: each a line that may begin there.
struct Cuts {
    column: [u32; CUTS],
    /// Least cost of what is before.
    cost: Eight,
    cos: Eight,
    sin: Eight,
    inverse_m: Eight,
    pixels: Eight,
    /// The triangle of the solution: d (A + r B - y)^2 + D (B - Y)^2 + squares.
    solved: [Eight; 5],
    squares: Eight,
}

impl Cuts {
    const NONE: Cuts = Cuts {
        column: [0; CUTS],
        cost: [OUT; CUTS],
        cos: [1.0; CUTS],
        sin: [0.0; CUTS],
        inverse_m: [0.0; CUTS],
        pixels: [0.0; CUTS],
        solved: [[0.0; CUTS]; 5],
        squares: [0.0; CUTS],
    };

    fn put(&mut self, i: usize, column: usize, cost: f32, cos: f32, sin: f32, inverse_m: f32) {
        let i = i % CUTS;
        self.column[i] = column as u32;
        (self.cost[i], self.cos[i], self.sin[i], self.inverse_m[i]) = (cost, cos, sin, inverse_m);
        (self.pixels[i], self.squares[i]) = (0.0, 0.0);
        for s in &mut self.solved {
            s[i] = 0.0;
        }
    }

    /// One more pixel of every line; `root` is the root of its weight.
    #[inline(always)]
    fn add(&mut self, cos: f32, sin: f32, inverse_m: f32, root: f32) {
        let [sd, sr, sy, sdd, syy] = &mut self.solved;
        for i in 0..CUTS {
            let along = cos * self.cos[i] + sin * self.sin[i];
            let across = sin * self.cos[i] - cos * self.sin[i];
            let (a, b, e) = (root * along, root * across, root * (inverse_m - along * self.inverse_m[i]));
            let (b, e) = (b - a * sr[i], e - a * sy[i]);
            let before = sd[i];
            let d = before + a * a;
            let over = 1.0 / d;
            let (share, weight) = (a * over, before * over);
            sd[i] = d;
            sr[i] += share * b;
            sy[i] += share * e;
            let e = e - b * syy[i];
            let before = sdd[i];
            let dd = before + weight * b * b;
            let per = if dd > 0.0 { weight / dd } else { 0.0 };
            sdd[i] = dd;
            syy[i] += per * b * e;
            self.squares[i] += per * before * e * e;
            self.pixels[i] += 1.0;
        }
    }
}

/// Cuts the free pixels of `run` into lines, and gives them from right to left; of single pixels none.
pub(crate) fn lines<B>(
    run: Range<usize>,
    row: &RowView,
    rules: &Rules,
    from: &mut [u16],
    cached: &mut Cached,
    mut found: impl FnMut(Range<usize>, &mut Cached) -> ControlFlow<B>,
) -> ControlFlow<B> {
    let start = run.start;
    let share = 1.0 / row.alike_row;
    let mut cuts = Cuts::NONE;
    let mut cost = 0.0;
    for column in run.clone() {
        let (lanes, i) = cached.at(row, column);
        let (cos, sin, range_m) = (lanes.cos[i], lanes.sin[i], lanes.range_m[i]);
        if range_m == 0.0 {
            continue;
        }
        let inverse_m = 1.0 / range_m;
        let square = range_m * range_m;
        let root = libm::sqrtf(share / row.variance.at(range_m)) * square;
        let mut worst = (-1.0, 0);
        for j in 0..CUTS {
            let total = cuts.cost[j] + cuts.squares[j];
            if total > worst.0 {
                worst = (total, j);
            }
        }
        let per = 1.0 / (cos * cos + sin * sin);
        cuts.put(worst.1, column, cost, cos, sin, inverse_m * per);
        cuts.add(cos, sin, inverse_m, root);
        let totals: Eight = core::array::from_fn(|j| {
            cuts.cost[j] + if cuts.pixels[j] == 1.0 { rules.lone } else { rules.line + cuts.squares[j] }
        });
        let mut best = (totals[0], 0);
        for (j, &total) in totals.iter().enumerate() {
            if total < best.0 {
                best = (total, j);
            }
        }
        cost = best.0;
        put(from, column, (cuts.column[best.1 % CUTS] as usize - start) as u16);
        for (of_cut, total) in cuts.cost.iter_mut().zip(totals) {
            *of_cut = if total > cost + rules.line { OUT } else { *of_cut };
        }
    }
    let mut end = run.end;
    while end > start {
        let (lanes, i) = cached.at(row, end - 1);
        if lanes.range_m[i] == 0.0 {
            end -= 1;
            continue;
        }
        let begin = start + usize::from(at(from, end - 1));
        found(begin..end, cached)?;
        end = begin;
    }
    ControlFlow::Continue(())
}
