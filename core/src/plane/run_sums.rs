//! Weighted sums over a run of a row, eight pixels side by side, and the plane of a line.
#![allow(clippy::indexing_slicing)] // arrays of known length

use core::ops::Range;

use crate::arithmetic::dot;
use crate::plane::fitted::Fitted;
use crate::plane::scanline::{Along, At, Cached, Lanes, Scanline};
use crate::plane::sums::{Errors, Sums, less, plus};
use crate::plane::work::count;
use crate::row::bits::CHUNK;
use crate::row::fan::Frame;
use crate::row::within::{part, part_mut};

/// One over the range at which a plane is met is at least this share of what was measured: beyond,
/// it is no plane that the pixel could lie on.
const LEAST_SHARE: f32 = 0.05;

/// Squared tangent by which lines are taken to lean across the row until they have a plane: 63 deg.
const LEAN_SQUARE: f32 = 4.0;

type Eight = [f32; 8];

/// What is summed, by pixel of a chunk: weight, cosine and sine of the beam less those of a beam in
/// the middle, error.
struct Terms {
    w: [f32; CHUNK],
    c: [f32; CHUNK],
    s: [f32; CHUNK],
    e: [f32; CHUNK],
}

impl Terms {
    const ZERO: Terms = Terms { w: [0.0; CHUNK], c: [0.0; CHUNK], s: [0.0; CHUNK], e: [0.0; CHUNK] };

    /// Adds eight pixels to the sums of w, w c, w s, w e, and of the products of the latter with c,
    /// s and e.
    #[inline(always)]
    fn add(&self, block: usize, sums: &mut [Eight; 10]) {
        let pick = |lane: &[f32; CHUNK]| -> Eight { lane.as_chunks::<8>().0[block % (CHUNK / 8)] };
        let (w, c, s, e) = (pick(&self.w), pick(&self.c), pick(&self.s), pick(&self.e));
        let product = |a: &Eight, b: &Eight| -> Eight { core::array::from_fn(|j| a[j] * b[j]) };
        let (wc, ws, we) = (product(&w, &c), product(&w, &s), product(&w, &e));
        let [s0, s1, s2, s3, s4, s5, s6, s7, s8, s9] = sums;
        add(s0, &w);
        add(s1, &wc);
        add(s2, &ws);
        add(s3, &we);
        add_product(s4, &wc, &c);
        add_product(s5, &wc, &s);
        add_product(s6, &ws, &s);
        add_product(s7, &we, &c);
        add_product(s8, &we, &s);
        add_product(s9, &we, &e);
    }
}

#[inline(always)]
fn add(sum: &mut Eight, x: &Eight) {
    for j in 0..8 {
        sum[j] += x[j];
    }
}

#[inline(always)]
fn add_product(sum: &mut Eight, x: &Eight, y: &Eight) {
    for j in 0..8 {
        sum[j] += x[j] * y[j];
    }
}

#[inline(always)]
fn total(l: Eight) -> f32 {
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}

/// The sums without what all pixels of a row share: its turn, which adds to the error of each in
/// proportion to its cosine. `share` is the variance that it has in an error at cosine 1.
fn without_shared(sums: [f32; 10], middle: &At, share: f32) -> [f32; 10] {
    let [w, c, s, e, cc, cs, ss, ec, es, ee] = sums;
    // weighted sums of the cosine, and of its products with c, s and e
    let (h, hc, hs, he) = (middle.cos * w + c, middle.cos * c + cc, middle.cos * s + cs, middle.cos * e + ec);
    let share = share / (1.0 + share * (middle.cos * h + hc));
    [
        w - share * h * h,
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
    /// The terms of some pixels of a chunk. `FIRST`: the plane is not known well enough to
    /// linearise about it.
    #[inline(always)]
    fn terms<const FIRST: bool>(
        &self,
        along: &Along,
        middle: &At,
        pixels: Range<usize>,
        lanes: &Lanes,
        terms: &mut Terms,
    ) {
        let Along { a, b, k, .. } = *along;
        let [ranges_m, cosines, sines] = [&lanes.range_m, &lanes.cos, &lanes.sin].map(|l| part(l, pixels.clone()));
        let Terms { w, c, s, e } = terms;
        let [w, c, s, e] = [w, c, s, e].map(|lane| part_mut(lane, pixels.clone()));
        let (alike, offset_m2) = (self.alike_px * self.alike_px, self.offset_m * self.offset_m);
        let to = w.iter_mut().zip(c).zip(s).zip(e);
        for ((((w, c), s), e), ((&range_m, &cos), &sin)) in to.zip(ranges_m.iter().zip(cosines).zip(sines)) {
            let inside = range_m > 0.0;
            let r = if inside { range_m } else { 1.0 };
            let predicted = cos * a + sin * b + k;
            let q = if FIRST {
                1.0 / r
            } else {
                let least = LEAST_SHARE / r;
                if predicted > least { predicted } else { least }
            };
            let q2 = q * q;
            let weight = 1.0 / ((self.variance.at(r) + offset_m2) * q2 * q2 * alike);
            *w = if inside { weight } else { 0.0 };
            // what 1 / r is more than the plane has it
            *e = if FIRST { q - predicted } else { q * (1.0 - r * q) };
            *c = cos - middle.cos;
            *s = sin - middle.sin;
        }
    }

    /// Sums over the returns of a run, and their errors against the plane m.
    #[inline(never)]
    pub fn sums<const FIRST: bool>(&self, run: Range<usize>, m: [f32; 3], cached: &mut Cached) -> (Sums, Errors) {
        count(run.len());
        let along = self.along(m);
        let middle = cached.at(self, (run.start + run.end) / 2);
        let mut sums = [[0.0f32; 8]; 10];
        let mut at = run.start;
        while at < run.end {
            let (lanes, i) = cached.lanes(self, at);
            let end = run.end.min((at / CHUNK + 1) * CHUNK);
            let last = i + end - at;
            let mut terms = Terms::ZERO;
            self.terms::<FIRST>(&along, &middle, i..last, lanes, &mut terms);
            for block in i / 8..last.div_ceil(8) {
                terms.add(block, &mut sums);
            }
            at = end;
        }
        let turned2 = if FIRST { LEAN_SQUARE * dot(m, m) } else { along.turned * along.turned };
        let share = turned2 * if FIRST { self.stated_rad2 } else { self.shared_rad2 };
        let [w, c, s, e, cc, cs, ss, ec, es, ee] = without_shared(sums.map(total), &middle, share);
        let per = if w > 0.0 { 1.0 / w } else { 0.0 };
        let (mc, ms) = (c * per, s * per);
        let (cc, cs, ss) = (cc - c * mc, cs - c * ms, ss - s * ms);
        let (ec, es) = (ec - e * mc, es - e * ms);
        let Frame { p, q, r } = self.frame;
        let (fc, fs) = (middle.cos + mc, middle.sin + ms);
        let pair = |i: usize, j: usize| cc * p[i] * p[j] + cs * (p[i] * q[j] + q[i] * p[j]) + ss * q[i] * q[j];
        let sums = Sums {
            w,
            c: [0, 1, 2].map(|i| fc * p[i] + fs * q[i] + r[i]),
            s: [pair(0, 0), pair(1, 1), pair(2, 2), pair(0, 1), pair(0, 2), pair(1, 2)],
        };
        (sums, Errors { sum: e, along: [0, 1, 2].map(|i| ec * p[i] + es * q[i]), squares: ee })
    }

    /// The plane of a line of this row, which begins and ends with a return.
    pub fn fitted(&self, run: Range<usize>, cached: &mut Cached) -> Fitted {
        let [first, last] = [run.start, run.end - 1].map(|column| cached.at(self, column));
        // to begin with the plane through both ends that leans least across the row
        let [u, v] = [first, last].map(|end| self.beam(end.cos, end.sin));
        let d = less(v, u);
        let square = dot(d, d);
        let middle = plus(u, 0.5, d);
        let size = dot(middle, middle);
        let (q0, q1) = (1.0 / first.range_m, 1.0 / last.range_m);
        let slope = if square > 1e-12 { (q1 - q0) / square } else { 0.0 };
        let m = core::array::from_fn(|i| 0.5 * (q0 + q1) / size * middle[i] + slope * d[i]);
        let (sums, errors) = self.sums::<true>(run, m, cached);
        Fitted::first(sums, m, &errors)
    }
}
