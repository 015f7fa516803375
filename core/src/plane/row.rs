//! A row as it was pushed, and sums over its runs.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::config::Ranging;
use crate::plane::noise::Variance;
use crate::row::bits::{CHUNK, load};
use crate::row::fan::{Fan, Frame};
use crate::sums::{Errors, Fitted, Sums};
use core::ops::Range;

/// Squared tangent by which lines are taken to lean until they have a plane.
const LEAN_SQUARE: f32 = 4.0;

/// Sums by pixel of a chunk: of w, w c, w s, w e, of w times cc, cs, ss, ec, es, ee, and the number.
type Lanewise = [[f32; CHUNK]; 11];

/// 0 to 31.
const NUMBERS: [f32; CHUNK] = {
    let mut numbers = [0.0; CHUNK];
    let mut i = 0;
    while i < CHUNK {
        numbers[i] = i as f32;
        i += 1;
    }
    numbers
};

/// In an order that does not depend on the processor.
#[inline(always)]
fn total(lanes: &[f32; CHUNK]) -> f32 {
    let mut sums = [0.0f32; 8];
    for eight in lanes.as_chunks::<8>().0 {
        for j in 0..8 {
            sums[j] += eight[j];
        }
    }
    let l = sums;
    ((l[0] + l[4]) + (l[2] + l[6])) + ((l[1] + l[5]) + (l[3] + l[7]))
}

pub(crate) struct RowView<'a> {
    pub ranging: &'a Ranging,
    pub fan: &'a Fan<'a>,
    pub frame: Frame,
    pub ranges_m: &'a [f32],
    pub wraps: bool,
    pub variance: Variance,
    /// Weights are divided by this: errors that are alike count once.
    pub alike: f32,
    /// The same within a row.
    pub alike_row: f32,
    /// The row was turned by this more than was reported, and its ranges are too large by this: what is followed is
    /// looked for there, and sums forgive as much.
    pub turned_rad: f32,
    /// See above.
    pub offset_m: f32,
    /// Variance of the turn that sums forgive.
    pub shared_rad2: f32,
    /// As it was stated.
    pub stated_rad2: f32,
    /// Columns without a return that lines go across.
    pub gap_columns: u16,
}

pub(crate) struct Lanes {
    pub cos: [f32; CHUNK],
    pub sin: [f32; CHUNK],
    pub range_m: [f32; CHUNK],
}

impl Lanes {
    pub const EMPTY: Lanes = Lanes { cos: [0.0; CHUNK], sin: [0.0; CHUNK], range_m: [0.0; CHUNK] };
}

/// The chunk that was read last.
pub(crate) struct Cached {
    pub lanes: Lanes,
    pub chunk: usize,
}

impl Cached {
    pub const EMPTY: Cached = Cached { lanes: Lanes::EMPTY, chunk: usize::MAX };

    #[inline(always)]
    pub fn at(&mut self, row: &RowView, column: usize) -> (&Lanes, usize) {
        if self.chunk != column / CHUNK {
            self.chunk = column / CHUNK;
            row.lanes(self.chunk * CHUNK, &mut self.lanes);
        }
        (&self.lanes, column % CHUNK)
    }
}

impl RowView<'_> {
    /// A plane in this row: u . m = a cos + b sin + k, and d cos more for each radian that the row turns.
    pub fn along(&self, m: [f32; 3]) -> [f32; 4] {
        let dot = |u: [f32; 3]| u[0] * m[0] + u[1] * m[1] + u[2] * m[2];
        let ([ax, ay, az], [x, y, z]) = (self.fan.axis(), self.frame.p);
        let turned = [ay * z - az * y, az * x - ax * z, ax * y - ay * x];
        [dot(self.frame.p), dot(self.frame.q), dot(self.frame.r), dot(turned)]
    }

    #[inline]
    pub fn lanes(&self, from: usize, lanes: &mut Lanes) {
        lanes.range_m = load(self.ranges_m, from, &mut [0.0; CHUNK]).map(|range_m| self.ranging.clean(range_m));
        self.fan.row_lanes(&self.frame, from, &mut lanes.cos, &mut lanes.sin);
    }

    /// Second differences of 1 / r of every other chunk.
    pub fn measure(&self, columns: usize, number: usize, measured: &mut crate::plane::noise::Measured) {
        let every = measured.every();
        let mut ahead = 2;
        let mut lanes = Lanes::EMPTY;
        for from in (number % every * CHUNK..columns).step_by(every * CHUNK) {
            self.lanes(from, &mut lanes);
            let (c, s) = (&lanes.cos, &lanes.sin);
            // a degree to either side
            let step = s[1] * c[0] - c[1] * s[0];
            ahead = [8, 4, 3, 2].into_iter().find(|&n| n as f32 * step.abs() < 0.0185).unwrap_or(2).max(ahead);
            let inverse = lanes.range_m.map(|r| if r > 0.0 { 1.0 / r } else { 0.0 });
            let mut ratios = [-1.0f32; CHUNK];
            for i in ahead..CHUNK - ahead {
                let (l, r) = ((i - ahead) % CHUNK, (i + ahead) % CHUNK);
                let alpha = s[r] * c[i] - c[r] * s[i];
                let beta = s[i] * c[l] - c[i] * s[l];
                let gamma = s[r] * c[l] - c[r] * s[l];
                let d = inverse[l] * alpha + inverse[r] * beta - inverse[i] * gamma;
                let range_m = lanes.range_m[i];
                let square = range_m * range_m;
                let per = self.variance.at(range_m) * (alpha * alpha + beta * beta + gamma * gamma);
                let all = (lanes.range_m[l] > 0.0) & (lanes.range_m[r] > 0.0) & (range_m > 0.0);
                ratios[i] = if all { d * d * square * square / per } else { -1.0 };
            }
            for (ratio, range_m) in ratios.iter().zip(lanes.range_m).skip(ahead).step_by(3) {
                if *ratio >= 0.0 {
                    measured.add(*ratio, range_m);
                }
            }
        }
    }

    /// The beam of a column.
    pub fn beam(&self, cos: f32, sin: f32) -> [f32; 3] {
        let Frame { p, q, r } = self.frame;
        core::array::from_fn(|i| cos * p[i] + sin * q[i] + r[i])
    }

    /// Adds the pixels of a chunk that are within `from..to`, of those in `eights`, which are whole
    /// eights. `plane` is a, b, k of [`RowView::along`].
    #[inline(always)]
    fn add<const FIRST: bool>(
        &self,
        plane: [f32; 3],
        middle: [f32; 2],
        eights: Range<usize>,
        within: [f32; 2],
        lanes: &Lanes,
        sums: &mut Lanewise,
    ) -> Option<()> {
        let ([a, b, k], [cos0, sin0], [from, to]) = (plane, middle, within);
        let offset = self.offset_m * self.offset_m;
        let n = eights.len();
        let ranges = lanes.range_m.get(eights.clone())?.get(..n)?;
        let coses = lanes.cos.get(eights.clone())?.get(..n)?;
        let sins = lanes.sin.get(eights.clone())?.get(..n)?;
        let numbers = NUMBERS.get(eights.clone())?.get(..n)?;
        let [s0, s1, s2, s3, s4, s5, s6, s7, s8, s9, s10] = sums;
        let s0 = s0.get_mut(eights.clone())?.get_mut(..n)?;
        let s1 = s1.get_mut(eights.clone())?.get_mut(..n)?;
        let s2 = s2.get_mut(eights.clone())?.get_mut(..n)?;
        let s3 = s3.get_mut(eights.clone())?.get_mut(..n)?;
        let s4 = s4.get_mut(eights.clone())?.get_mut(..n)?;
        let s5 = s5.get_mut(eights.clone())?.get_mut(..n)?;
        let s6 = s6.get_mut(eights.clone())?.get_mut(..n)?;
        let s7 = s7.get_mut(eights.clone())?.get_mut(..n)?;
        let s8 = s8.get_mut(eights.clone())?.get_mut(..n)?;
        let s9 = s9.get_mut(eights.clone())?.get_mut(..n)?;
        let s10 = s10.get_mut(eights.clone())?.get_mut(..n)?;
        for j in 0..n {
            let (range_m, cos, sin) = (ranges[j], coses[j], sins[j]);
            let inside = (range_m > 0.0) & (numbers[j] >= from) & (numbers[j] < to);
            let r = if range_m > 0.0 { range_m } else { 1.0 };
            let predicted = cos * a + sin * b + k;
            let q = if FIRST {
                // a line of its own: the plane is not known well enough to linearise about it
                1.0 / r
            } else {
                let least = 0.05 / r;
                if predicted > least { predicted } else { least }
            };
            let q2 = q * q;
            let weight = 1.0 / (((self.variance.at(r) + offset) * q2 * q2) * self.alike);
            let w = if inside { weight } else { 0.0 };
            // what 1 / r is more than the plane has it
            let e = if FIRST { q - predicted } else { q * (1.0 - r * q) };
            let (c, s) = (cos - cos0, sin - sin0);
            let (wc, ws, we) = (w * c, w * s, w * e);
            s0[j] += w;
            s1[j] += wc;
            s2[j] += ws;
            s3[j] += we;
            s4[j] += wc * c;
            s5[j] += wc * s;
            s6[j] += ws * s;
            s7[j] += we * c;
            s8[j] += we * s;
            s9[j] += we * e;
            s10[j] += if inside { 1.0 } else { 0.0 };
        }
        Some(())
    }

    /// Sums over the returns of a run, and their errors against the plane m.
    #[inline(never)]
    pub fn sums<const FIRST: bool>(&self, run: Range<usize>, m: [f32; 3], cached: &mut Cached) -> (Sums, Errors, u32) {
        let [a, b, k, turned] = self.along(m);
        let middle = (run.start + run.end) / 2;
        let (cos0, sin0) = {
            let (lanes, i) = cached.at(self, middle);
            (lanes.cos[i], lanes.sin[i])
        };
        // sums of w, w c, w s, w e, and of their products with c, s, e
        let mut sums = [[0.0f32; CHUNK]; 11];
        let mut at = run.start;
        while at < run.end {
            let (lanes, i) = cached.at(self, at);
            let end = run.end.min((at / CHUNK + 1) * CHUNK);
            let last = i + end - at;
            let eights = i / 8 * 8..last.next_multiple_of(8);
            let _ = self.add::<FIRST>([a, b, k], [cos0, sin0], eights, [i as f32, last as f32], lanes, &mut sums);
            at = end;
        }
        let [w, c, s, e, cc, cs, ss, ec, es, ee, count] = [0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10].map(|i| total(&sums[i]));
        let count = count as u32;
        // what all pixels share is the turn of the row, which adds to each error in proportion to
        // its cosine: taken out as far as rows
        // are off
        let (hc, hs) = (cos0 * c + cc, cos0 * s + cs);
        let (h, he) = (cos0 * w + c, cos0 * e + ec);
        let tells = cos0 * h + hc;
        let turned2 = turned * turned;
        // how a line of its own leans is not known: by 63 deg
        let turned2 = if FIRST { LEAN_SQUARE * (m[0] * m[0] + m[1] * m[1] + m[2] * m[2]) } else { turned2 };
        let share = turned2 * if FIRST { self.stated_rad2 } else { self.shared_rad2 };
        let share = share / (1.0 + share * tells);
        let (w, c, s) = (w - share * h * h, c - share * h * hc, s - share * h * hs);
        let (cc, cs, ss) = (cc - share * hc * hc, cs - share * hc * hs, ss - share * hs * hs);
        let (e, ec, es, ee) = (e - share * h * he, ec - share * hc * he, es - share * hs * he, ee - share * he * he);
        let per = if w > 0.0 { 1.0 / w } else { 0.0 };
        let (mc, ms) = (c * per, s * per);
        let (cc, cs, ss) = (cc - c * mc, cs - c * ms, ss - s * ms);
        let (ec, es) = (ec - e * mc, es - e * ms);
        let Frame { p, q, r } = self.frame;
        let (fc, fs) = (cos0 + mc, sin0 + ms);
        let pair = |i: usize, j: usize| cc * p[i] * p[j] + cs * (p[i] * q[j] + q[i] * p[j]) + ss * q[i] * q[j];
        let sums = Sums {
            w,
            c: [0, 1, 2].map(|i| fc * p[i] + fs * q[i] + r[i]),
            s: [pair(0, 0), pair(1, 1), pair(2, 2), pair(0, 1), pair(0, 2), pair(1, 2)],
        };
        let errors = Errors { sum: e, along: [0, 1, 2].map(|i| ec * p[i] + es * q[i]), squares: ee };
        (sums, errors, count)
    }

    /// A line of this row, which has one return at least.
    pub fn fitted(&self, run: Range<usize>, cached: &mut Cached) -> (Fitted, u32) {
        let (lanes, i) = cached.at(self, run.start);
        let (c0, s0, r0) = (lanes.cos[i], lanes.sin[i], lanes.range_m[i]);
        let (lanes, i) = cached.at(self, run.end - 1);
        let (c1, s1, r1) = (lanes.cos[i], lanes.sin[i], lanes.range_m[i]);
        // the plane through both ends that leans least across the row
        let (u, v) = (self.beam(c0, s0), self.beam(c1, s1));
        let (uu, vv, uv) = (crate::sums::dot(u, u), crate::sums::dot(v, v), crate::sums::dot(u, v));
        let (q0, q1) = (1.0 / r0, 1.0 / r1);
        let _ = uu;
        let d = crate::sums::less(v, u);
        let dd = crate::sums::dot(d, d);
        let _ = (vv, uv);
        let middle = crate::sums::plus(u, 0.5, d);
        let size = crate::sums::dot(middle, middle);
        let slope = if dd > 1e-12 { (q1 - q0) / dd } else { 0.0 };
        let m = core::array::from_fn(|i| 0.5 * (q0 + q1) / size * middle[i] + slope * d[i]);
        let (sums, errors, count) = self.sums::<true>(run, m, cached);
        (Fitted::first(sums, m, &errors), count)
    }
}
