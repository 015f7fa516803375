//! Lines of a row (paper section 4): each row is broken where its bearing angle turns.
//!
//! On a straight line the bearing angle falls by exactly the angle Phi between two beams, whatever
//! the incidence. The turning angle at pixel i,
//!
//! ```text
//! t_i = BA_(i+1) - BA_i + Phi_(i+1)
//! ```
//!
//! is then 0. It is the angle between the chord that ends in the point of pixel i and the chord
//! that begins there, and that is how it is found here: from the points, which the regions need
//! anyway, without an arc tangent. Rows of a spinning scanner lie on cones: there the angle between
//! the chords of a plane is not 0 but that of its conic section, on level floors the azimuth step,
//! elsewhere Phi tan|elevation| tan(incidence) and less. Against the thresholds that is little; a
//! row is then broken a little too early, never too late.
//!
//! A line turns where |t| reaches `line_angle_rad` and is beyond what the noise of that very angle
//! explains:
//!
//! ```text
//! |sin t| > 1.75 sqrt(3) sigma_BA,   sigma_BA = sqrt(2) sigma_r sin BA_i sin(BA_(i+1) + Phi_(i+1)) / (r sin Phi)
//! ```
//!
//! which is: the point of the pixel lies farther off the chord of its neighbours than 1.75 standard
//! deviations. Where noise would hide a turn by `line_angle_rad`, the chords are made longer, 2, 4,
//! 8 or 16 pixels, so that it does not.
//!
//! - Two neighbours that both turn are not on one line: a step, or a corner between the two.
//! - A pixel that turns and whose neighbours do not is a corner: the line to its left ends with it.
//! - With longer chords many pixels around a corner turn: the one that turns most is the corner.
//! - A pixel without a return is on no line.
//!
//! Nothing is fitted, and lines are not merged within a row.
#![allow(clippy::indexing_slicing)] // arrays of known length

use crate::arithmetic::cos_sin;
use crate::region::config::RegionConfig;
use crate::row::bits::{CHUNK, load, mask, pack, store, touching_runs};
use crate::row::within::{at, put};

/// Standard deviations that a turn must be beyond the noise. Few: a line broken once too often
/// still joins its region in two parts, while one that goes on beyond a corner joins none.
const TURN_SIGMAS: f32 = 1.75;

/// Thresholds of the lines.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TurnThresholds {
    /// Square of the cosine of `line_angle_rad`.
    cos_square: f32,
    /// Of the variance of a point's distance from the chord of its neighbours, straight on, m^2.
    noise_square_m2: f32,
    /// Chords of which a shorter part than this lies across the beam are made longer, m; squared.
    reach_square_m2: f32,
}

impl TurnThresholds {
    pub fn new(config: &RegionConfig) -> Self {
        let (cos, sin) = cos_sin(config.line_angle_rad);
        let noise_m = config.ranging.range_noise_m;
        // a point, less the mean of its neighbours: a variance of 1 + 1/4 + 1/4
        let noise_square_m2 = 1.5 * TURN_SIGMAS * TURN_SIGMAS * noise_m * noise_m;
        // the point is off by half of the sine of the turn on either side
        Self { cos_square: cos * cos, noise_square_m2, reach_square_m2: 4.0 * noise_square_m2 / (sin * sin) }
    }

    /// What the points of three pixels say. Also for points that are missing, but then it says
    /// nothing.
    #[inline(always)]
    fn at(&self, before: [f32; 3], here: [f32; 3], after: [f32; 3]) -> Turn {
        let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let minus = |a: [f32; 3], b: [f32; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
        let cross = |a: [f32; 3], b: [f32; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let (a, b, span) = (minus(here, before), minus(after, here), minus(after, before));
        let (squares, ab, range_square) = (dot(a, a) * dot(b, b), dot(a, b), dot(here, here));
        // cross products, for spikes between beams that almost coincide are thin, and steps almost
        // along the beam: how far the point is off the chord, times its length; and the chord's
        // part across the beam, times the range
        let (off, across) = (cross(a, b), cross(span, here));
        let (off, across) = (dot(off, off), dot(across, across));
        let turned = (ab < 0.0) | (ab * ab < self.cos_square * squares);
        let beyond_noise = off * range_square >= self.noise_square_m2 * across;
        // a chord that is k times as long reaches k times as far across the beam
        let (reached, reach) = (0.25 * across, self.reach_square_m2 * range_square);
        let short = [1.0, 4.0, 16.0, 64.0].map(|k_square| u16::from(k_square * reached < reach));
        let doublings = short[0] + short[1] + short[2] + short[3];
        Turn { turns: turned & beyond_noise, doublings, cos: ab, squares }
    }
}

/// A turn: the angle between two chords.
struct Turn {
    /// Whether a line ends here.
    turns: bool,
    /// How often the length of the chords has to be doubled for the noise, 0 to 4.
    doublings: u16,
    /// The cosine of the angle, times the lengths of the chords.
    cos: f32,
    /// Product of the squared lengths of the chords.
    squares: f32,
}

/// The points of a row.
#[derive(Clone, Copy)]
pub(crate) struct Points<'a> {
    /// x, y, z in metres, one per column; anything where there is no return.
    pub axes: [&'a [f32]; 3],
    /// Packed: pixels with a return.
    pub returns: &'a [u32],
    /// Whether the last column neighbours the first.
    pub wraps: bool,
}

impl Points<'_> {
    fn columns(&self) -> usize {
        self.axes[0].len()
    }

    /// The point of a column.
    #[inline(always)]
    pub fn at(&self, column: usize) -> [f32; 3] {
        self.axes.map(|axis| at(axis, column))
    }
}

/// Lines shorter than this are none, pixels. Two at least: `label.rs` relies on it.
pub(crate) const MIN_LINE_PIXELS: usize = 2;

/// Finds the lines of a row: `lines` gets their pixels, `starts` the first pixel of each, both
/// packed. `turns`, a packed row, and `doublings`, one per column, are scratch. Returns whether the
/// last line goes on with the first across the seam.
pub(crate) fn find_lines(
    thresholds: &TurnThresholds,
    row: &Points,
    doublings: &mut [u16],
    turns: &mut [u32],
    starts: &mut [u32],
    lines: &mut [u32],
) -> bool {
    let columns = row.columns();
    let longer = turn_bits(thresholds, row, doublings, turns);
    cut(row, turns, starts);
    if longer {
        long_chords(thresholds, row, doublings, starts);
    }
    let last = columns - 1;
    let is_set = |bits: &[u32], column: usize| at(bits, column / CHUNK) >> (column % CHUNK) & 1 == 1;
    let seam = row.wraps && !is_set(starts, 0);
    set(starts, 0..1);
    lines.fill(0);
    for line in touching_runs(row.returns, starts, columns).filter(|line| line.len() >= MIN_LINE_PIXELS) {
        set(lines, line);
    }
    seam && is_set(lines, 0) && is_set(lines, last)
}

/// Packed: the pixels where the chords to the neighbouring pixels turn. Returns whether some of
/// these chords are too short.
fn turn_bits(thresholds: &TurnThresholds, row: &Points, doublings: &mut [u16], turns: &mut [u32]) -> bool {
    let (columns, wraps) = (row.columns(), row.wraps);
    let mut longer = 0;
    let mut halo = [[0.0; CHUNK + 2]; 3];
    for (word, out) in turns.iter_mut().enumerate() {
        let from = word * CHUNK;
        for (halo, axis) in halo.iter_mut().zip(row.axes) {
            let left = match from.checked_sub(1) {
                None if wraps => columns - 1,
                None => columns,
                Some(left) => left,
            };
            halo[0] = axis.get(left).copied().unwrap_or(0.0);
            halo[1..=CHUNK].copy_from_slice(load(axis, from, &mut [0.0; CHUNK]));
            halo[CHUNK + 1] = axis.get(from + CHUNK).copied().unwrap_or(0.0);
            if wraps && from + CHUNK >= columns {
                put(halo, columns - from + 1, at(axis, 0));
            }
        }
        let [x, y, z] = &halo;
        let (mut turning, mut short) = ([false; CHUNK], [0; CHUNK]);
        for i in 0..CHUNK {
            let at = |i: usize| [x[i], y[i], z[i]];
            let turn = thresholds.at(at(i), at(i + 1), at(i + 2));
            (turning[i], short[i]) = (turn.turns, turn.doublings);
        }
        let inner = neighbours(row.returns, word, columns, wraps);
        *out = pack(&turning) & inner;
        store(doublings, from, &short);
        longer |= pack(&short.map(|doublings| doublings > 0)) & inner;
    }
    longer != 0
}

/// The word of the row shifted by one column to the right: bit c is bit c - 1.
fn left_of(row: &[u32], word: usize, columns: usize, wraps: bool) -> u32 {
    let last = columns - 1;
    let carry = match word.checked_sub(1) {
        Some(before) => at(row, before) >> (CHUNK - 1),
        None if wraps => at(row, last / CHUNK) >> (last % CHUNK),
        None => 0,
    };
    (at(row, word) << 1) | (carry & 1)
}

/// The pixels of a word that have a return, and both of whose neighbours have one.
fn neighbours(returns: &[u32], word: usize, columns: usize, wraps: bool) -> u32 {
    let carry = returns.get(word + 1).map_or(0, |next| next & 1) << (CHUNK - 1);
    let mut right = (at(returns, word) >> 1) | carry;
    if wraps && word + 1 == returns.len() {
        right |= (at(returns, 0) & 1) << ((columns - 1) % CHUNK);
    }
    at(returns, word) & left_of(returns, word, columns, wraps) & right
}

/// Packed: the pixels that are not on one line with their left neighbour.
fn cut(row: &Points, turns: &[u32], starts: &mut [u32]) {
    let (columns, wraps, returns) = (row.columns(), row.wraps, row.returns);
    let last = columns - 1;
    for (word, out) in starts.iter_mut().enumerate() {
        let turn_left = left_of(turns, word, columns, wraps);
        // one column farther: the bit that `left_of` gave the column before
        let farther = match word.checked_sub(1) {
            Some(before) => left_of(turns, before, columns, wraps) >> (CHUNK - 1),
            None if wraps => match last.checked_sub(1) {
                Some(column) => at(turns, column / CHUNK) >> (column % CHUNK),
                None => 0,
            },
            None => 0,
        };
        let turn_farther = (turn_left << 1) | (farther & 1);
        let here = at(turns, word);
        let step = here & turn_left;
        let corner = turn_left & !here & !turn_farther;
        let missing = !(at(returns, word) & left_of(returns, word, columns, wraps));
        *out = (step | corner | missing) & mask(word, columns);
    }
}

/// Corners that noise hides from short chords, within the pieces that these left.
fn long_chords(thresholds: &TurnThresholds, row: &Points, doublings: &[u16], starts: &mut [u32]) {
    let mut column = 0;
    loop {
        let Some(piece) = touching_runs(row.returns, starts, row.columns()).from(column).next() else { return };
        column = piece.end;
        // the sharpest turn of those next to each other: its 1 - cos, and its pixel
        let mut sharpest: Option<(f32, usize)> = None;
        for (here, doublings) in doublings.iter().enumerate().take(piece.end).skip(piece.start + 1) {
            let room = (here - piece.start).min(piece.end - 1 - here);
            let mut k = 1 << doublings;
            while k > room {
                k /= 2;
            }
            if k > 1 {
                let turn = thresholds.at(row.at(here - k), row.at(here), row.at(here + k));
                if turn.turns {
                    let sharpness = 1.0 - turn.cos / libm::sqrtf(turn.squares);
                    if sharpest.is_none_or(|(most, _)| sharpness > most) {
                        sharpest = Some((sharpness, here));
                    }
                    continue;
                }
            }
            if let Some((_, corner)) = sharpest.take() {
                set(starts, corner + 1..corner + 2);
            }
        }
    }
}

/// Sets the bits of a run.
fn set(row: &mut [u32], run: core::ops::Range<usize>) {
    for column in run {
        put(row, column / CHUNK, at(row, column / CHUNK) | 1 << (column % CHUNK));
    }
}
