//! Lines in what follows no plane (paper section 4, region-based: each row is first broken into
//! lines).
//!
//! A run of pixels is cut into lines so that the sum of squared range errors, in units of the
//! noise, plus a price for each line is least: Bellman's recursion over the last cut. Within a row
//! 1 / range is linear in the cosine and the sine of the beam on every straight line, whatever its
//! incidence, so that no bearing angle and no threshold on one is needed.
//!
//! Only [`CANDIDATE_CUTS`] last cuts are kept: one that a line from it costs more than the best by
//! the price of a line can never win again, and of the others the worst goes. Work is linear in the
//! pixels.

use core::ops::Range;

use crate::plane::rules::{CANDIDATE_CUTS, Rules};
use crate::row::within::{at, put};

/// A line of a row.
pub(crate) struct Line {
    pub columns: Range<usize>,
    /// Sum of its squared range errors, in units of the noise.
    pub chi_square: f32,
}

/// A last cut: a line that may begin here, with the least squares of its pixels so far.
#[derive(Clone, Copy, Default)]
struct Cut {
    column: usize,
    /// Least cost of what is before.
    cost: f32,
    /// First point within the row, and one over its range.
    x: f32,
    y: f32,
    inverse: f32,
    pixels: u32,
    /// The range error of a pixel is e - (A a + B b). Its squares d (A + r B - y)^2 + D (B - Y)^2 +
    /// squares, as d, r, y, D, Y.
    solved: [f32; 5],
    /// Those that the best A and B leave, m^2.
    squares_m2: f32,
}

impl Cut {
    fn new(column: usize, cost: f32, [x, y]: [f32; 2]) -> Cut {
        let inverse = 1.0 / libm::sqrtf(x * x + y * y);
        Cut { column, cost, x, y, inverse, ..Cut::default() }
    }

    /// One more pixel of the line. What is solved for is the difference from a circle about the
    /// scanner: small numbers, but for lines across a step, where sums of products would lose all
    /// their digits. So the triangle of the solution is kept instead, and turned by each pixel
    /// (Gentleman 1973, Givens rotations without square roots).
    fn add(&mut self, [x, y]: [f32; 2], range_m: f32) {
        let along = (self.x * x + self.y * y) * self.inverse;
        let across = (self.x * y - self.y * x) * self.inverse;
        let (a, b, e) = (range_m * along, range_m * across, range_m * (1.0 - along * self.inverse));
        self.pixels += 1;
        let [d, r, y, below, below_y] = &mut self.solved;
        let (b, e) = (b - a * *r, e - a * *y);
        let before = *d;
        *d += a * a;
        let share = a / *d;
        let weight = before / *d;
        (*r, *y) = (*r + share * b, *y + share * e);
        let e = e - b * *below_y;
        let before = *below;
        *below += weight * b * b;
        if *below > 0.0 {
            let per = weight / *below;
            *below_y += per * b * e;
            self.squares_m2 += per * before * e * e;
        }
    }
}

/// Cuts `run` into lines, and gives them from right to left; of single pixels none. `point` gives
/// the place of a column within its row, metres. `from` is scratch, one element per column of the
/// image: where the last line up to each begins.
pub(crate) fn lines(
    run: Range<usize>,
    noise_m2: f32,
    rules: &Rules,
    from: &mut [u16],
    mut point: impl FnMut(usize) -> [f32; 2],
    mut found: impl FnMut(Line),
) {
    let &Rules { line_price, lone_price, min_line_pixels, .. } = rules;
    let per_noise = 1.0 / noise_m2;
    let mut cuts = [Cut::default(); CANDIDATE_CUTS];
    let mut kept = 0;
    let mut cost = 0.0;
    for column in run.clone() {
        let place = point(column);
        let range_m = range_of(place);
        if kept == CANDIDATE_CUTS {
            // the last costs of all cuts are within the price of a line; the one with the greatest
            // goes
            kept -= 1;
            cuts.swap(0, kept);
        }
        put(&mut cuts, kept, Cut::new(column, cost, place));
        kept += 1;
        let mut costs = [0.0; CANDIDATE_CUTS];
        let mut best = (f32::MAX, column);
        for (cut, cost) in cuts.iter_mut().zip(&mut costs).take(kept) {
            cut.add(place, range_m);
            *cost = cut.cost + if cut.pixels == 1 { lone_price } else { line_price + cut.squares_m2 * per_noise };
            if *cost < best.0 {
                best = (*cost, cut.column);
            }
        }
        cost = best.0;
        put(from, column, (best.1 - run.start) as u16);
        let (mut left, mut worst) = (0, (f32::MIN, 0));
        for (i, at_cost) in costs.into_iter().enumerate().take(kept) {
            if at_cost <= cost + line_price {
                if at_cost > worst.0 {
                    worst = (at_cost, left);
                }
                let cut = at(&cuts, i);
                put(&mut cuts, left, cut);
                left += 1;
            }
        }
        kept = left;
        cuts.swap(0, worst.1 % CANDIDATE_CUTS);
    }
    let (start, mut end) = (run.start, run.end);
    while end > start {
        let begin = start + usize::from(at(from, end - 1));
        if end - begin >= min_line_pixels {
            found(Line { columns: begin..end, chi_square: squares_m2(begin..end, &mut point) * per_noise });
        }
        end = begin;
    }
}

/// Squared range errors that the best line through some columns leaves, m^2.
fn squares_m2(columns: Range<usize>, mut point: impl FnMut(usize) -> [f32; 2]) -> f32 {
    let mut line = Cut::new(columns.start, 0.0, point(columns.start));
    for column in columns {
        let place = point(column);
        line.add(place, range_of(place));
    }
    line.squares_m2
}

fn range_of([x, y]: [f32; 2]) -> f32 {
    libm::sqrtf(x * x + y * y)
}
