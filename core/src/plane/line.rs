//! Lines in the pixels that follow no plane: the cuts that cost least.
//!
//! Each line costs the squares that its least squares leave, and a price. The cheapest cuts are
//! found by Bellman's recursion over the last cut. Only the best few last cuts are kept, side by
//! side, each with the triangle of the least squares of the line that begins there.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::{below, inverse_sqrt};
use crate::plane::rules::{CANDIDATE_CUTS, LEAN, Rules};
use crate::plane::scanline::{At, Cached, Scanline};
use crate::plane::work::count;
use crate::row::bits::VECTORS;
use crate::row::within::{at, put};

/// Cost of a cut that is out.
const OUT: f32 = 1e30;

type PerCut = [f32; CANDIDATE_CUTS];

/// The last cuts that are kept: each a line that may begin there.
struct Cuts {
    column: [u32; CANDIDATE_CUTS],
    /// Least cost of what is before.
    cost: PerCut,
    /// The beam of its first pixel, and one over its range.
    cos: PerCut,
    sin: PerCut,
    inverse_m: PerCut,
    /// The triangle of the solution: sd (A + sr B - sy)^2 + sdd (B - syy)^2 + squares for the line
    /// that differs by A along and B across from one over the range of the first pixel.
    solved: [PerCut; 5],
    squares: PerCut,
}

impl Cuts {
    /// None yet. No constant, which would be in an image, 352 bytes, and copied.
    fn none() -> Cuts {
        Cuts {
            column: [0; CANDIDATE_CUTS],
            cost: [OUT; CANDIDATE_CUTS],
            cos: [1.0; CANDIDATE_CUTS],
            sin: [0.0; CANDIDATE_CUTS],
            inverse_m: [0.0; CANDIDATE_CUTS],
            solved: [[0.0; CANDIDATE_CUTS]; 5],
            squares: [0.0; CANDIDATE_CUTS],
        }
    }

    /// Puts a cut before a pixel in the place of the worst one; gives its place.
    fn begin(&mut self, column: usize, cost: f32, pixel: &At, inverse_m: f32) -> usize {
        let mut worst = 0;
        for i in 0..CANDIDATE_CUTS {
            let last = CANDIDATE_CUTS - 1 - i;
            if !VECTORS && self.cost[i].to_bits() == OUT.to_bits() {
                worst = key(OUT, last);
                break;
            }
            let key = key(self.cost[i] + self.squares[i], last);
            worst = if key > worst { key } else { worst };
        }
        let i = (CANDIDATE_CUTS - 1 - place(worst)) % CANDIDATE_CUTS;
        self.column[i] = column as u32;
        (self.cost[i], self.cos[i], self.sin[i]) = (cost, pixel.cos, pixel.sin);
        // beams of a pinhole are no unit vectors within their row
        self.inverse_m[i] = inverse_m / (pixel.cos * pixel.cos + pixel.sin * pixel.sin);
        self.squares[i] = 0.0;
        for solved in &mut self.solved {
            solved[i] = 0.0;
        }
        i
    }

    /// One more pixel of every line; `root` is the root of its weight.
    #[inline(always)]
    fn add(&mut self, newest: usize, pixel: &At, inverse_m: f32, root: f32) {
        let [sd, sr, sy, sdd, syy] = &mut self.solved;
        let At { cos, sin, .. } = *pixel;
        for i in 0..CANDIDATE_CUTS {
            if !VECTORS && self.cost[i].to_bits() == OUT.to_bits() {
                continue;
            }
            let along = cos * self.cos[i] + sin * self.sin[i];
            if !VECTORS && i == newest {
                // all of the rest is 0
                let (a, e) = (root * along, root * (inverse_m - along * self.inverse_m[i]));
                sd[i] = a * a;
                sy[i] = a * (1.0 / sd[i]) * e;
                continue;
            }
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
            let per = if below(0.0, dd) { weight / dd } else { 0.0 };
            sdd[i] = dd;
            syy[i] += per * b * e;
            self.squares[i] += per * before * e * e;
        }
    }

    /// The least cost of everything up to here, and the last cut of it. Cuts that cannot become the
    /// best any more are out. The line of the newest one has one pixel.
    fn best(&mut self, newest: usize, rules: &Rules) -> (f32, u32) {
        let mut totals: PerCut = core::array::from_fn(|i| {
            if !VECTORS && self.cost[i].to_bits() == OUT.to_bits() {
                return OUT;
            }
            self.cost[i] + (rules.line_price + self.squares[i])
        });
        let newest = newest % CANDIDATE_CUTS;
        totals[newest] = self.cost[newest] + rules.lone_price;
        let mut best = u64::MAX;
        for (i, &total) in totals.iter().enumerate() {
            let key = key(total, i);
            best = if key < best { key } else { best };
        }
        let best = place(best);
        let least = totals[best];
        let most = least + rules.line_price;
        for (cost, total) in self.cost.iter_mut().zip(totals) {
            *cost = if below(most, total) { OUT } else { *cost };
        }
        (least, self.column[best])
    }
}

/// A number that is not negative, and its place, as one integer in the order of the numbers and,
/// where they are equal, of the places: the least of integers vectorises.
#[inline(always)]
fn key(number: f32, place: usize) -> u64 {
    u64::from(number.to_bits()) * CANDIDATE_CUTS as u64 + place as u64
}

/// The place of a key.
#[inline(always)]
fn place(key: u64) -> usize {
    key as usize % CANDIDATE_CUTS
}

/// Cuts the returns of `run` into lines, and gives them from right to left; each begins and ends
/// with a return. `from` is scratch, one element per column.
pub(crate) fn lines(
    run: Range<usize>,
    row: &Scanline,
    rules: &Rules,
    from: &mut [u16],
    cached: &mut Cached,
    mut found: impl FnMut(Range<usize>, &mut Cached),
) {
    let start = run.start;
    if run.len() <= 2 {
        // a line of two pixels has no squares
        let apart = 2.0 * rules.lone_price < rules.line_price;
        run.clone().for_each(|column| put(from, column, if apart { (column - start) as u16 } else { 0 }));
    } else {
        cut(run.clone(), row, rules, from, cached);
    }
    let mut end = run.end;
    while end > start {
        if !row.is_return(end - 1) {
            end -= 1;
            continue;
        }
        let begin = start + usize::from(at(from, end - 1));
        found(begin..end, cached);
        end = begin;
    }
}

/// Finds for each return of a run where the line begins that ends with it, from the start of the run.
#[inline(never)]
fn cut(run: Range<usize>, row: &Scanline, rules: &Rules, from: &mut [u16], cached: &mut Cached) {
    let start = run.start;
    let (mut cuts, mut cost) = (Cuts::none(), 0.0);
    for column in run {
        let pixel = cached.at(row, column);
        if pixel.range_m == 0.0 {
            continue;
        }
        let inverse_m = 1.0 / pixel.range_m;
        // how the line leans across the row is not known
        let lean_m = LEAN * pixel.range_m * pixel.beside;
        let variance_m2 = row.variance.at(pixel.range_m) + lean_m * lean_m;
        let root = inverse_sqrt(row.alike_px * variance_m2) * (pixel.range_m * pixel.range_m);
        count(CANDIDATE_CUTS);
        let newest = cuts.begin(column, cost, &pixel, inverse_m);
        cuts.add(newest, &pixel, inverse_m, root);
        let (least, cut) = cuts.best(newest, rules);
        cost = least;
        put(from, column, (cut as usize - start) as u16);
    }
}
