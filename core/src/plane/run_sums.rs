//! Weighted sums over a run of a row, eight pixels side by side, and the plane of a line.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::{below, dot, less, plus};
use crate::plane::noise::{Spread, Variance};
use crate::plane::scanline::{Along, At, Cached, Scanline};
use crate::plane::work::count;
use crate::row::bits::{CHUNK, VECTORS};
use crate::row::fan::{Frame, Lanes};
use crate::row::within::part;
use crate::weighted::fitted::Fitted;
use crate::weighted::sums::{Errors, Sums};

/// One over the range at which a plane is met is at least this share of what was measured: beyond,
/// it is no plane that the pixel could lie on.
const LEAST_SHARE: f32 = 0.05;

/// The sum of so many pixels is the same in any order.
const FEW: usize = 2;

/// Pixels that are summed side by side.
const LANES: usize = 8;

type Eight = [f32; LANES];

/// The number of each pixel of a chunk.
const NUMBERS: [f32; CHUNK] = {
    let mut numbers = [0.0; CHUNK];
    let mut i = 0;
    while i < CHUNK {
        numbers[i] = i as f32;
        i += 1;
    }
    numbers
};

/// What weights and errors of a run are found with.
struct Weighing {
    along: Along,
    /// Squared length of the plane.
    steep: f32,
    variance: Variance,
    spread: Spread,
    /// Pixels that count as one.
    alike: f32,
    /// A beam of the run, near its middle.
    middle: At,
    /// Whether beams lie beside the plane of the row.
    beside: bool,
}

/// Sums over the pixels of a run.
struct RunSums {
    /// Of w, w c, w s, w e, and of the products of the latter with c, s and e: see
    /// [`Weighing::terms`].
    plain: [Eight; 10],
    /// Of w t, and of its products with c, s, t and e. Left out in plain rows.
    beside: [Eight; 5],
}

impl RunSums {
    const NONE: RunSums = RunSums { plain: [[0.0; LANES]; 10], beside: [[0.0; LANES]; 5] };

    /// The sums of all eight; those of other rows than plain ones where they are wanted.
    #[inline(always)]
    fn total(&self, beside: bool) -> ([f32; 10], [f32; 5]) {
        (self.plain.map(total), if beside { self.beside.map(total) } else { [0.0; 5] })
    }
}

/// One of the eight of [`RunSums`]: for targets that work on one number at a time.
#[derive(Clone, Copy)]
struct EachSums {
    plain: [f32; 10],
    beside: [f32; 5],
}

impl EachSums {
    const NONE: EachSums = EachSums { plain: [0.0; 10], beside: [0.0; 5] };

    /// [`RunSums::total`].
    #[inline(always)]
    fn total(each: &[EachSums; LANES], beside: bool) -> ([f32; 10], [f32; 5]) {
        let (mut plain, mut others) = ([0.0; 10], [0.0; 5]);
        for (i, to) in plain.iter_mut().enumerate() {
            *to = total(core::array::from_fn(|j| each[j].plain[i]));
        }
        if beside {
            for (i, to) in others.iter_mut().enumerate() {
                *to = total(core::array::from_fn(|j| each[j].beside[i]));
            }
        }
        (plain, others)
    }
}

impl Weighing {
    /// Weight w, parts c, s and t of the beam along the row's axes less those in the middle, and
    /// error e of a pixel with a return. `first`: the plane is not known well enough to linearise
    /// about it.
    #[inline(always)]
    fn terms(&self, first: bool, pixel: At) -> [f32; 5] {
        let Weighing { along: Along { a, b, k, turned }, steep, variance, spread, alike, middle, .. } = self;
        let At { cos, sin, beside, range_m: r } = pixel;
        let predicted = cos * a + sin * b + beside * turned + k;
        let (q, range_m2) = if first {
            (1.0 / r, r * r)
        } else {
            let q = if below(LEAST_SHARE, predicted * r) { predicted } else { LEAST_SHARE / r };
            (q, 1.0 / (q * q))
        };
        let q2 = q * q;
        // tan(incidence), squared
        let tan_square = spread.tan_square(steep * range_m2 - 1.0);
        let variance_m2 = variance.at(r) + spread.at(range_m2, tan_square);
        let weight = 1.0 / (variance_m2 * q2 * q2 * alike);
        // what 1 / r is more than the plane has it
        let error = if first { q - predicted } else { q * (1.0 - r * q) };
        [weight, cos - middle.cos, sin - middle.sin, beside - middle.beside, error]
    }

    /// Sums over the returns of a run: see [`RunSums`].
    #[inline(always)]
    fn total(&self, first: bool, row: &Scanline, run: Range<usize>, cached: &mut Cached) -> ([f32; 10], [f32; 5]) {
        if VECTORS && run.len() <= FEW {
            let (mut plain, mut beside) = ([0.0; 10], [0.0; 5]);
            for column in run {
                let pixel = cached.at(row, column);
                if pixel.range_m > 0.0 {
                    let terms = self.terms(first, pixel);
                    plain.iter_mut().zip(products(terms)).for_each(|(sum, term)| *sum += term);
                    if self.beside {
                        beside.iter_mut().zip(products_beside(terms)).for_each(|(sum, term)| *sum += term);
                    }
                }
            }
            return (plain, beside);
        }
        let (mut sums, mut each) = (RunSums::NONE, [EachSums::NONE; LANES]);
        let mut at = run.start;
        while at < run.end {
            let (lanes, i) = cached.lanes(row, at);
            let end = run.end.min((at / CHUNK + 1) * CHUNK);
            let last = i + end - at;
            if VECTORS {
                self.add_eights(first, i, last, lanes, &mut sums);
            } else {
                self.add_each(first, i, last, lanes, &mut each);
            }
            at = end;
        }
        if VECTORS { sums.total(self.beside) } else { EachSums::total(&each, self.beside) }
    }

    /// Adds the returns of a chunk from number `from` up to `to`, eight pixels side by side.
    #[inline(always)]
    fn add_eights(&self, first: bool, from: usize, to: usize, lanes: &Lanes, sums: &mut RunSums) {
        for block in from / LANES..to.div_ceil(LANES) {
            let part = [from as f32, to as f32];
            if first {
                self.add_eight::<true>(block, part, lanes, sums);
            } else {
                self.add_eight::<false>(block, part, lanes, sums);
            }
        }
    }

    /// The same pixel after pixel: for targets that work on one number at a time.
    #[inline(always)]
    fn add_each(&self, first: bool, from: usize, to: usize, lanes: &Lanes, sums: &mut [EachSums; LANES]) {
        let Lanes { cos, sin, beside, range_m } = lanes;
        let [range_m, cos, sin, beside] = [range_m, cos, sin, beside].map(|lane| part(lane, from..to));
        for (i, (((&range_m, &cos), &sin), &beside)) in range_m.iter().zip(cos).zip(sin).zip(beside).enumerate() {
            if below(0.0, range_m) {
                let terms = self.terms(first, At { cos, sin, beside, range_m });
                let sums = &mut sums[(from + i) % LANES];
                sums.plain.iter_mut().zip(products(terms)).for_each(|(sum, term)| *sum += term);
                if self.beside {
                    sums.beside.iter_mut().zip(products_beside(terms)).for_each(|(sum, term)| *sum += term);
                }
            }
        }
    }

    /// Adds those of one block of eight.
    #[inline(always)]
    fn add_eight<const FIRST: bool>(&self, block: usize, [from, to]: [f32; 2], lanes: &Lanes, sums: &mut RunSums) {
        let pick = |lane: &[f32; CHUNK]| -> Eight { lane.as_chunks::<LANES>().0[block % (CHUNK / LANES)] };
        let [ranges_m, cosines, sines, besides, numbers] =
            [&lanes.range_m, &lanes.cos, &lanes.sin, &lanes.beside, &NUMBERS].map(pick);
        let [mut w, mut c, mut s, mut t, mut e] = [[0.0; LANES]; 5];
        for j in 0..LANES {
            let inside = (ranges_m[j] > 0.0) & (numbers[j] >= from) & (numbers[j] < to);
            let range_m = if inside { ranges_m[j] } else { 1.0 };
            let pixel = At { cos: cosines[j], sin: sines[j], beside: besides[j], range_m };
            [w[j], c[j], s[j], t[j], e[j]] = self.terms(FIRST, pixel);
            w[j] = if inside { w[j] } else { 0.0 };
        }
        accumulate(&[w, c, s, e], &mut sums.plain);
        if self.beside {
            let wt: Eight = core::array::from_fn(|j| w[j] * t[j]);
            for (sum, term) in sums.beside.iter_mut().zip([[1.0; LANES], c, s, t, e]) {
                for j in 0..LANES {
                    sum[j] += wt[j] * term[j];
                }
            }
        }
    }
}

/// What a pixel of these terms adds to the sums in plain rows.
#[inline(always)]
fn products([w, c, s, _, e]: [f32; 5]) -> [f32; 10] {
    let (wc, ws, we) = (w * c, w * s, w * e);
    [w, wc, ws, we, wc * c, wc * s, ws * s, we * c, we * s, we * e]
}

/// And to those of other rows.
#[inline(always)]
fn products_beside([w, c, s, t, e]: [f32; 5]) -> [f32; 5] {
    let wt = w * t;
    [wt, wt * c, wt * s, wt * t, wt * e]
}

/// Adds eight pixels with these terms to the sums. A function of its own, so that the compiler keeps
/// the eight side by side.
#[inline(never)]
fn accumulate([w, c, s, e]: &[Eight; 4], sums: &mut [Eight; 10]) {
    let product = |a: &Eight, b: &Eight| -> Eight { core::array::from_fn(|j| a[j] * b[j]) };
    let (wc, ws, we) = (product(w, c), product(w, s), product(w, e));
    let products = [(&wc, c), (&wc, s), (&ws, s), (&we, c), (&we, s), (&we, e)];
    let [s0, s1, s2, s3, others @ ..] = sums;
    for (sum, terms) in [(s0, w), (s1, &wc), (s2, &ws), (s3, &we)] {
        for j in 0..LANES {
            sum[j] += terms[j];
        }
    }
    for (sum, (a, b)) in others.iter_mut().zip(products) {
        for j in 0..LANES {
            sum[j] += a[j] * b[j];
        }
    }
}

#[inline(always)]
fn total(l: Eight) -> f32 {
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}

/// The elements of the scatter of [`Sums`] in their order.
#[inline(always)]
fn pairs(of: impl Fn(usize, usize) -> f32) -> [f32; 6] {
    [of(0, 0), of(1, 1), of(2, 2), of(0, 1), of(0, 2), of(1, 2)]
}

/// The sums without what all pixels of a row share: its turn, or the offset of its ring. The error
/// of a pixel changes with it by `slope[0]`, and by `slope[1]` more for each 1 of c. `variance` is
/// that of what is shared.
fn without_shared(sums: [f32; 10], beside: &mut [f32; 5], slope: [f32; 2], variance: f32) -> [f32; 10] {
    let [w, c, s, e, cc, cs, ss, ec, es, ee] = sums;
    let [at, per] = slope;
    // weighted sums of the slope, and of its products with c, s and e
    let (h, hc, hs, he) = (at * w + per * c, at * c + per * cc, at * s + per * cs, at * e + per * ec);
    let off = 1.0 + variance * (at * h + per * hc);
    let share = variance / off;
    let ht = at * beside[0] + per * beside[1];
    for (sum, with) in beside.iter_mut().zip([h, hc, hs, ht, he]) {
        *sum -= share * ht * with;
    }
    // by Cauchy and Schwarz so much is left, where the difference has no digits
    let (left, least) = (w - share * h * h, w / off);
    [
        if left > least { left } else { least },
        c - share * h * hc,
        s - share * h * hs,
        e - share * h * he,
        cc - share * hc * hc,
        cs - share * hc * hs,
        ss - share * hs * hs,
        ec - share * hc * he,
        es - share * hs * he,
        ee - share * he * he,
    ]
}

impl Scanline<'_> {
    /// Sums over the returns of a run, and their errors against the plane m; `first`: it is not known
    /// well enough to linearise about it.
    #[inline(never)]
    pub fn sums(&self, first: bool, run: Range<usize>, m: [f32; 3], cached: &mut Cached) -> (Sums, Errors) {
        count(run.len());
        let along = self.along(m);
        // of its first chunk, which is read first
        let middle = ((run.start + run.end) / 2).min(run.start | (CHUNK - 1));
        let middle = cached.at(self, middle);
        let weighing = Weighing {
            along,
            steep: dot(m, m),
            variance: self.variance,
            spread: self.spread,
            alike: self.alike_px * self.alike_px,
            middle,
            beside: !self.frame.plain,
        };
        let (sums, mut beside) = weighing.total(first, self, run, cached);
        let (slope, off2) = if self.fan.spins() {
            let q = middle.cos * along.a + middle.sin * along.b + along.k;
            ([q * q, 0.0], self.off2)
        } else {
            // what a turn does to a line depends on the plane that takes it
            ([along.turned * middle.cos, along.turned], if first { 0.0 } else { self.off2 })
        };
        let all = sums[0];
        let [w, c, s, e, cc, cs, ss, ec, es, ee] = without_shared(sums, &mut beside, slope, off2);
        let [t, ct, st, tt, et] = beside;
        let per = if w > 0.0 { 1.0 / w } else { 0.0 };
        let (mc, ms, mt) = (c * per, s * per, t * per);
        let (cc, cs, ss) = (cc - c * mc, cs - c * ms, ss - s * ms);
        let (ct, st, tt) = (ct - c * mt, st - s * mt, tt - t * mt);
        let (ec, es, et) = (ec - e * mc, es - e * ms, et - e * mt);
        let Frame { p, q, r, t, plain, .. } = self.frame;
        let (fc, fs, ft) = (middle.cos + mc, middle.sin + ms, middle.beside + mt);
        let both = |a: [f32; 3], b: [f32; 3], i: usize, j: usize| a[i] * b[j] + b[i] * a[j];
        let along = |i: usize, j: usize| cc * p[i] * p[j] + cs * both(p, q, i, j) + ss * q[i] * q[j];
        let scatter = if plain {
            pairs(along)
        } else {
            pairs(|i, j| along(i, j) + ct * both(p, t, i, j) + st * both(q, t, i, j) + tt * t[i] * t[j])
        };
        let along_axes = |c, s, beside| plus(plus(p.map(|x| c * x), s, q), beside, t);
        let sums = Sums { w, all, c: plus(along_axes(fc, fs, ft), 1.0, r), s: scatter };
        (sums, Errors { sum: e, along: along_axes(ec, es, et), squares: ee })
    }

    /// The plane of a line of this row, which begins and ends with a return.
    pub fn fitted(&self, run: Range<usize>, cached: &mut Cached) -> Fitted {
        // the last one first: lines come from right to left, and sums are from left to right
        let [last, first] = [run.end - 1, run.start].map(|column| cached.lone(self, column));
        // to begin with the plane through both ends that leans least across the row
        let [u, v] = [first, last].map(|end| self.beam(&end));
        let d = less(v, u);
        let square = dot(d, d);
        let middle = plus(u, 0.5, d);
        // ends half a turn apart have no middle
        let square_of_middle = dot(middle, middle);
        let size = if square_of_middle > 1e-3 { square_of_middle } else { 1e-3 };
        let (q0, q1) = (1.0 / first.range_m, 1.0 / last.range_m);
        let slope = if square > 1e-12 { (q1 - q0) / square } else { 0.0 };
        let m = core::array::from_fn(|i| 0.5 * (q0 + q1) / size * middle[i] + slope * d[i]);
        let (sums, errors) = self.sums(true, run, m, cached);
        Fitted::first(sums, m, &errors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Ranging;
    use crate::plane::rules::Rules;

    /// Both ways to add pixels give the same sums, bit for bit.
    #[test]
    fn one_by_one_is_side_by_side() {
        let ranging = Ranging::new(0.005).with_growing_noise(0.0, 0.001);
        let mut lanes = Lanes::EMPTY;
        for i in 0..CHUNK {
            let (sin, cos) = (0.3 + 0.02 * i as f32).sin_cos();
            (lanes.cos[i], lanes.sin[i], lanes.beside[i]) = (cos, sin, 0.01 * (i % 5) as f32);
            lanes.range_m[i] = if i % 7 == 3 { 0.0 } else { 2.0 + 0.01 * (i * i % 11) as f32 };
        }
        let m = [0.4, 0.1, 0.2];
        for beside in [false, true] {
            let weighing = Weighing {
                along: Along { a: m[0], b: m[1], k: 0.01, turned: m[2] },
                steep: dot(m, m),
                variance: Variance::stated(&ranging, 0.0015),
                spread: Spread::new(&ranging, &Rules::TUNED),
                alike: 4.0,
                middle: At { cos: 0.8, sin: 0.6, beside: 0.02, range_m: 2.0 },
                beside,
            };
            for (first, from, to) in [(true, 0, CHUNK), (false, 0, CHUNK), (true, 5, 9), (false, 3, 30)] {
                let (mut each, mut eight) = ([EachSums::NONE; LANES], RunSums::NONE);
                weighing.add_each(first, from, to, &lanes, &mut each);
                weighing.add_eights(first, from, to, &lanes, &mut eight);
                let [each, eight] = [EachSums::total(&each, beside), eight.total(beside)];
                assert_eq!(each, eight, "{first} {from} {to}");
                assert_eq!(each.1 != [0.0; 5], beside);
            }
        }
    }
}
