//! Lines in what follows no plane (paper section 4, region-based: each row is first broken into lines).
//!
//! A run of pixels is cut into lines so that the sum of squared range errors, in units of the noise, plus a price for each
//! line is least: Bellman's recursion over the last cut. Within a row 1 / range is linear in the cosine and the sine of the
//! beam on every straight line, whatever its incidence, so that no bearing angle and no threshold on one is needed.
//!
//! Only [`CANDIDATES`] last cuts are kept: one that a line from it costs more than the best by the price of a line can never
//! win again, and of the others the worst goes. Work is linear in the pixels.

use core::ops::Range;

/// Last cuts that are kept.
const CANDIDATES: usize = 8;

/// Price of a line: the squared errors that a cut must save.
const LINE: f32 = 14.0;

/// Price of a pixel in no line.
const LONE: f32 = 10.0;

/// A line of a row.
pub(crate) struct Line {
    pub columns: Range<usize>,
    /// Its squared range errors, in units of the noise.
    pub squares: f32,
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
    /// The range error of a pixel is e - (A a + B b). Its squares d (A + r B - y)^2 + D (B - Y)^2 + squares, as d, r, y, D, Y.
    solved: [f32; 5],
    /// Those that the best A and B leave, m^2.
    squares_m2: f32,
}

impl Cut {
    fn new(column: usize, cost: f32, [x, y]: [f32; 2]) -> Cut {
        let inverse = 1.0 / libm::sqrtf(x * x + y * y);
        Cut { column, cost, x, y, inverse, ..Cut::default() }
    }

    /// One more pixel of the line. What is solved for is the difference from a circle about the scanner: small numbers, but
    /// for lines across a step, where sums of products would lose all their digits. So the triangle of the solution is kept
    /// instead, and turned by each pixel (Gentleman 1973, Givens rotations without square roots).
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

/// Cuts `run` into lines, and gives them from right to left; of single pixels none. `point` gives the place of a column
/// within its row, metres. `from` is scratch, one element per column of the image: where the last line up to each begins.
pub(crate) fn lines<B>(
    run: Range<usize>,
    noise_m2: f32,
    from: &mut [u16],
    mut point: impl FnMut(usize) -> [f32; 2],
    mut found: impl FnMut(Line) -> core::ops::ControlFlow<B>,
) -> core::ops::ControlFlow<B> {
    let (start, per_noise) = (run.start, 1.0 / noise_m2);
    let mut cuts = [Cut::default(); CANDIDATES];
    let mut kept = 0;
    let mut cost = 0.0;
    for column in run.clone() {
        let at = point(column);
        let range_m = libm::sqrtf(at[0] * at[0] + at[1] * at[1]);
        if kept == CANDIDATES {
            // the last costs of all cuts are within the price of a line; the one with the greatest goes
            kept -= 1;
            cuts.swap(0, kept);
        }
        cuts[kept] = Cut::new(column, cost, at);
        kept += 1;
        let mut costs = [0.0; CANDIDATES];
        let (mut best, mut worst) = (0, 0);
        for i in 0..kept {
            cuts[i].add(at, range_m);
            let price = if cuts[i].pixels == 1 { LONE } else { LINE + cuts[i].squares_m2 * per_noise };
            costs[i] = cuts[i].cost + price;
            if costs[i] < costs[best] {
                best = i;
            }
        }
        cost = costs[best];
        from[column] = (cuts[best].column - start) as u16;
        let mut left = 0;
        for i in 0..kept {
            if costs[i] <= cost + LINE {
                if costs[i] > costs[worst] || left == 0 {
                    worst = left;
                }
                cuts[left] = cuts[i];
                costs[left] = costs[i];
                left += 1;
            }
        }
        kept = left;
        cuts.swap(0, worst);
    }
    let mut end = run.end;
    while end > start {
        let begin = start + usize::from(from[end - 1]);
        if end - begin > 1 {
            let mut line = Cut::new(begin, 0.0, point(begin));
            for column in begin..end {
                let at = point(column);
                line.add(at, libm::sqrtf(at[0] * at[0] + at[1] * at[1]));
            }
            found(Line { columns: begin..end, squares: line.squares_m2 * per_noise })?;
        }
        end = begin;
    }
    core::ops::ControlFlow::Continue(())
}
