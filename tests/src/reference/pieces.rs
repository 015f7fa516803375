//! Lines of a run of pixels: the partition whose squared range errors, in units of the noise, and
//! prices are least in sum.

use super::doubt::Doubt;
use super::lines::Line;
use nalgebra::{Matrix2, Vector2};

/// Price of a line, and of a pixel in none.
const LINE: f64 = 14.0;
const LONE: f64 = 10.0;

/// Cuts that the core remembers. Where more could still win, it has forgotten one.
const CANDIDATES: usize = 8;

/// Squared range errors of the straight line through points of a row that fits them best.
///
/// A line is p . w = 1; at range r along the beam of p it is off by r (p . w - 1).
fn squares_m2(sums: &(usize, Matrix2<f64>, Vector2<f64>, f64)) -> f64 {
    let &(points, matrix, vector, ranges_m2) = sums;
    if points < 3 {
        return 0.0;
    }
    matrix.lu().solve(&vector).map_or(0.0, |w| (ranges_m2 - vector.dot(&w)).max(0.0))
}

/// What it costs to end with a line or a lone pixel.
#[derive(Clone, Copy)]
struct Price {
    price: f64,
    begin: usize,
    /// By how much the core may have it otherwise.
    margin: f64,
}

/// The lines of two pixels and more, from right to left, each with its squared errors. `places`:
/// where the pixels of the run are within their row, metres; the first one is in column `start`.
pub fn pieces(start: usize, places: &[Vector2<f64>], noise_m2: f64, doubt: &mut Doubt) -> Vec<(Line, f64)> {
    // least price of the first n pixels, where its last line begins, and all other ways to end
    // there
    let mut least = vec![(0.0, 0)];
    let mut all = vec![Vec::new()];
    for end in 1..=places.len() {
        let mut sums = (0, Matrix2::zeros(), Vector2::zeros(), 0.0);
        let mut prices = Vec::new();
        for begin in (0..end).rev() {
            let place = places[begin];
            let square = place.norm_squared();
            sums = (sums.0 + 1, sums.1 + place * place.transpose() * square, sums.2 + place * square, sums.3 + square);
            let own = if end - begin == 1 { LONE } else { LINE + squares_m2(&sums) / noise_m2 };
            // the core solves in f32 for errors against a circle through the first pixel
            let off = |p: &Vector2<f64>| p.norm() * (1.0 - p.dot(&place) / square).abs();
            let digits_m = 1e-6 * places[begin..end].iter().map(off).fold(0.0, f64::max) * (sums.0 as f64).sqrt();
            let margin = 0.01 + (2.0 * squares_m2(&sums).sqrt() + digits_m) * digits_m / noise_m2;
            prices.push(Price { price: least[begin].0 + own, begin, margin });
        }
        let best = prices.iter().min_by(|a, b| a.price.total_cmp(&b.price)).unwrap();
        least.push((best.price, best.begin));
        all.push(prices);
    }
    let (mut lines, mut end) = (Vec::new(), places.len());
    while end > 0 {
        let begin = least[end].1;
        let of = |prices: &[Price]| *prices.iter().find(|price| price.begin == begin).unwrap();
        let own = of(&all[end]);
        for other in all[end].iter().filter(|other| other.begin != begin) {
            doubt.above(other.price, own.price, own.margin + other.margin);
        }
        // its squares say which surfaces take it
        doubt.doubtful += usize::from(own.margin > 0.3);
        // where it was among the worst on the way, the core may have forgotten it
        for prices in &all[begin + 1..end] {
            let own = of(prices);
            let better = |other: &&Price| other.begin != begin && other.price - other.margin < own.price + own.margin;
            doubt.doubtful += usize::from(prices.iter().filter(better).count() >= CANDIDATES - 1);
        }
        if end - begin > 1 {
            lines.push((Line { start: start + begin, end: start + end }, own.price - least[begin].0 - LINE));
        }
        end = begin;
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A corner, a step, a pixel between two surfaces, and noise that is no reason to cut.
    #[test]
    fn partitions() {
        let lines = |places: &[(f64, f64)], noise_m: f64| {
            let places: Vec<_> = places.iter().map(|&(x, y)| Vector2::new(x, y)).collect();
            let found = pieces(10, &places, noise_m * noise_m, &mut Doubt::default());
            found.iter().map(|(line, _)| (line.start, line.end)).collect::<Vec<_>>()
        };
        let wall = |x: f64, n: std::ops::Range<i32>| n.map(move |i| (x, 0.1 * f64::from(i)));
        let corner: Vec<_> = wall(2.0, 0..6).chain((1..6).map(|i| (2.0 - 0.1 * f64::from(i), 0.55))).collect();
        assert_eq!(lines(&corner, 0.01), [(16, 21), (10, 16)]);
        let step: Vec<_> = wall(2.0, 0..5).chain(wall(2.1, 5..10)).collect();
        assert_eq!(lines(&step, 0.01), [(15, 20), (10, 15)]);
        assert_eq!(lines(&step, 0.05), [(10, 20)]);
        let lone: Vec<_> = wall(2.0, 0..5).chain([(2.5, 0.62)]).chain(wall(3.0, 6..10)).collect();
        assert_eq!(lines(&lone, 0.01), [(16, 20), (10, 15)]);
    }
}
