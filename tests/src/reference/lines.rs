//! Lines of the rows of an image by turning angles (paper, section 4: "break each scan row into
//! some smooth segments").
//!
//! The turning angle at a pixel is BA(next) - BA(this) + Phi(next), 0 on a straight line: the angle
//! between the chord to this pixel's point and the chord from it. Longer chords, of k pixels either
//! way, see the same turn with less noise.

use super::beams::{Beams, angle_between};
use super::doubt::{Answer, Doubt};
use super::{Image, Size};
use nalgebra::Vector3;

/// Thresholds of lines and regions.
#[derive(Clone, Copy, Debug)]
pub struct Thresholds {
    /// A line ends where it turns by more than this, rad.
    pub line_angle_rad: f64,
    /// Standard deviation of one range, metres.
    pub range_noise_m: f64,
    /// Surfaces are planes to within this, metres.
    pub plane_distance_m: f64,
}

/// A turn must be seen beyond so many standard deviations of a point's distance from the chord of
/// its neighbours.
pub const TURN_SIGMAS: f64 = 1.75;

/// The square of a smaller product of two lengths is below all digits of single precision, m^2.
pub const LEAST_M2: f64 = 1e-17;

/// A line: columns `start..end` of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Line {
    /// First column.
    pub start: usize,
    /// Column after the last.
    pub end: usize,
}

/// The lines of a row.
#[derive(Clone, Debug)]
pub struct RowLines {
    /// From the left, each of two pixels or more.
    pub lines: Vec<Line>,
    /// Whether the last column and the first are on one line, across the seam.
    pub seam: bool,
}

/// A turn at a pixel, as one length of the chords shows it.
struct Turn {
    /// It is sharper than the threshold and beyond the noise.
    turns: bool,
    /// 1 - its cosine.
    sharpness: f64,
    /// Its error by rounding, rad.
    error_rad: f64,
    /// Half of the way between the outer points, across the beam, metres.
    across_m: f64,
}

fn turn(points: [Vector3<f64>; 3], thresholds: &Thresholds, doubt: &mut Doubt) -> Turn {
    let [before, here, after] = points;
    let (a, b, span) = (here - before, after - here, after - before);
    let [before_m, here_m, after_m] = points.map(|point| point.norm());
    let angle_rad = angle_between(a, b);
    // f32 has its points to within 7e-7 of their range, and the square of a cosine to within 4e-7. A small angle is off by
    // up to that over itself: t - sqrt(t^2 - e) is at most e / t
    let square = 4e-7 / angle_rad.max(thresholds.line_angle_rad);
    let chords = before_m.max(here_m) / a.norm() + after_m.max(here_m) / b.norm();
    let error_rad = 1.5e-6 * chords + 1e-6 + square;
    let across_m = (span - here * (span.dot(&here) / here.norm_squared())).norm();
    // the distance from the chord and its standard deviation, both times the length of the chord
    let (off, sigma) = (a.cross(&b).norm(), 1.5f64.sqrt() * thresholds.range_noise_m * across_m);
    let cancelled = (span.norm() / across_m).powi(2) * 1e-6 + 1e-3;
    let turned = Answer::above(angle_rad, thresholds.line_angle_rad, error_rad);
    let margin = cancelled * TURN_SIGMAS * sigma + 3e-6 * before_m.max(here_m).max(after_m) * (a.norm() + b.norm());
    let beyond = Answer::above(off, TURN_SIGMAS * sigma, margin);
    let no_noise = thresholds.range_noise_m == 0.0;
    let turns = if no_noise { turned } else { turned.and(beyond) };
    let digits = across_m * here_m >= LEAST_M2;
    let turns = doubt.decide(Answer { sure: turns.sure && digits, ..turns });
    Turn { turns, sharpness: 1.0 - angle_rad.cos(), error_rad, across_m: across_m / 2.0 }
}

/// The points of a row; `None` without a return.
pub fn points(image: &Image, beams: &Beams, row: usize) -> Vec<Option<Vector3<f64>>> {
    let point = |column| Some(beams.direction((row, column)) * f64::from(image.range((row, column))?));
    (0..image.size.columns).map(point).collect()
}

/// The lines of a row:
/// 1. Between neighbours of which one has no return, or which both turn, is a cut. A pixel that
///    turns and whose neighbours do not has a cut to its right.
/// 2. Where the noise would hide a turn by the threshold, chords of 2, 4, 8 or 16 pixels are taken,
///    the shortest that does not (by what neighbours have across the beam), but none across a cut.
///    Of pixels next to each other that turn so, the sharpest gets a cut to its right.
/// 3. What cuts leave is a line if it has two pixels or more. The seam is always between two lines.
pub fn row_lines(points: &[Option<Vector3<f64>>], size: Size, thresholds: &Thresholds, doubt: &mut Doubt) -> RowLines {
    let columns = points.len();
    let neighbour = |column, right| size.neighbour((0, column), 0, right).map(|(_, column)| column);
    let shortest: Vec<Option<Turn>> = (0..columns)
        .map(|column| {
            let (left, right) = (neighbour(column, -1)?, neighbour(column, 1)?);
            Some(turn([points[left]?, points[column]?, points[right]?], thresholds, doubt))
        })
        .collect();
    let turns = |column: Option<usize>| column.and_then(|c| shortest[c].as_ref()).is_some_and(|turn| turn.turns);
    // cut[c]: between c and the column to its left
    let mut cut: Vec<bool> = (0..columns)
        .map(|column| {
            let Some(left) = neighbour(column, -1) else { return true };
            let (here, there) = (turns(Some(column)), turns(Some(left)));
            let alone = there && !here && !turns(neighbour(left, -1));
            points[column].is_none() || points[left].is_none() || (here && there) || alone
        })
        .collect();
    let seam = size.wraps && !cut[0];
    cut[0] = true;

    let reach_m = 2.0 * 1.5f64.sqrt() * TURN_SIGMAS * thresholds.range_noise_m / thresholds.line_angle_rad.sin();
    for piece in pieces(points, &cut) {
        let mut sharpest: Option<(f64, usize)> = None;
        for (here, shortest) in shortest.iter().enumerate().take(piece.end).skip(piece.start + 1) {
            let room = (here - piece.start).min(piece.end - 1 - here);
            let mut k = 1;
            if let Some(turn) = shortest {
                while k < 16 && doubt.decide(Answer::above(reach_m, k as f64 * turn.across_m, 1e-3 * reach_m)) {
                    k *= 2;
                }
            }
            while k > room {
                k /= 2;
            }
            let point = |column: usize| points[column].unwrap();
            let long = (k > 1).then(|| turn([point(here - k), point(here), point(here + k)], thresholds, doubt));
            match long.filter(|turn| turn.turns) {
                Some(turn) => {
                    let margin = 3.0 * turn.error_rad;
                    if sharpest.is_none_or(|(most, _)| doubt.decide(Answer::above(turn.sharpness, most, margin))) {
                        sharpest = Some((turn.sharpness, here));
                    }
                }
                None => {
                    if let Some((_, corner)) = sharpest.take() {
                        cut[corner + 1] = true;
                    }
                }
            }
        }
    }
    let lines = pieces(points, &cut).into_iter().filter(|line| line.end - line.start > 1).collect();
    RowLines { lines, seam }
}

/// What cuts and missing returns leave of a row.
fn pieces(points: &[Option<Vector3<f64>>], cut: &[bool]) -> Vec<Line> {
    let mut pieces: Vec<Line> = Vec::new();
    for column in (0..points.len()).filter(|&column| points[column].is_some()) {
        match pieces.last_mut() {
            Some(piece) if piece.end == column && !cut[column] => piece.end += 1,
            _ => pieces.push(Line { start: column, end: column + 1 }),
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference::Trace;
    use crate::reference::beams::TurnAxis;
    use crate::reference::bearing::bearing_angles;

    /// The angle between chords is the turning angle of the bearing angles, where beams lie in a
    /// plane.
    #[test]
    fn turning_angle_of_bearing_angles() {
        let beam_rad = [-0.3, -0.25, -0.1, 0.0, 0.2, 0.3].to_vec();
        let range_m = vec![2.0f32, 2.1, 1.5, 4.0, 3.9, 0.7];
        let beams = Beams::Nodding { beam_rad: beam_rad.clone(), turn_rad: vec![0.4], axis: TurnAxis::Z };
        let image = Image::new(Size { rows: 1, columns: 6, wraps: false }, range_m);
        let bearing = bearing_angles(&image, &beams, Trace::HORIZONTAL);
        let points: Vec<_> = points(&image, &beams, 0).into_iter().map(Option::unwrap).collect();
        for i in 1..5 {
            let turning = bearing[i + 1].unwrap() - bearing[i].unwrap() + beam_rad[i + 1] - beam_rad[i];
            let chords = angle_between(points[i] - points[i - 1], points[i + 1] - points[i]);
            assert!((turning.abs() - chords).abs() < 1e-12, "{i}: {turning} {chords}");
        }
    }

    /// The noise that is allowed for is what the paper's formula gives: sigma_BA = sqrt(2) sigma
    /// sin^2(BA) / (r sin Phi), sqrt(3) of it for the turning angle, of a wall straight ahead.
    #[test]
    fn noise_of_a_turn() {
        let (phi, r, sigma) = (0.01f64, 4.0, 1e-4);
        let thresholds = Thresholds { line_angle_rad: 1e-4, range_noise_m: sigma, plane_distance_m: 0.0 };
        let turns_by = |turn_rad: f64| {
            let half = r * phi;
            let points =
                [Vector3::new(r, -half, 0.0), Vector3::new(r, 0.0, 0.0), Vector3::new(r + half * turn_rad, half, 0.0)];
            turn(points, &thresholds, &mut Doubt::default()).turns
        };
        let expected = TURN_SIGMAS * 3f64.sqrt() * 2f64.sqrt() * sigma / (r * phi);
        assert!(turns_by(1.01 * expected) && !turns_by(0.99 * expected));
    }

    /// A corner between the third pixel and the fourth, a corner at a pixel, a step, a hole.
    #[test]
    fn lines_of_known_shapes() {
        let thresholds = Thresholds { line_angle_rad: 0.05, range_noise_m: 0.0, plane_distance_m: 0.0 };
        let lines = |points: &[(f64, f64)]| {
            let points: Vec<_> = points.iter().map(|&(x, y)| (x > 0.0).then(|| Vector3::new(x, y, 0.0))).collect();
            let size = Size { rows: 1, columns: points.len(), wraps: false };
            let found = row_lines(&points, size, &thresholds, &mut Doubt::default());
            found.lines.iter().map(|line| (line.start, line.end)).collect::<Vec<_>>()
        };
        let wall = |x: f64, n: std::ops::Range<i32>| n.map(move |i| (x, 0.1 * f64::from(i)));
        let side = |n: std::ops::Range<i32>| n.map(|i| (2.0 - 0.1 * f64::from(i), 0.25));
        let between: Vec<_> = wall(2.0, 0..3).chain(side(1..4)).collect();
        assert_eq!(lines(&between), [(0, 3), (3, 6)]);
        let at: Vec<_> = wall(2.0, 0..3).chain((1..4).map(|i| (2.0 - 0.1 * f64::from(i), 0.2))).collect();
        assert_eq!(lines(&at), [(0, 3), (3, 6)]);
        let step: Vec<_> = wall(2.0, 0..4).chain(wall(3.0, 4..6)).collect();
        assert_eq!(lines(&step), [(0, 4), (4, 6)]);
        let hole: Vec<_> = wall(2.0, 0..2).chain([(0.0, 0.0)]).chain(wall(2.0, 3..4)).chain([(0.0, 0.0)]).collect();
        assert_eq!(lines(&hole), [(0, 2)]);
    }

    /// Noise of 5 mm on two walls that meet at 90 degrees, 4 m away: with long chords they are told
    /// apart, within two pixels, which between neighbours no threshold could.
    #[test]
    fn corner_in_noise() {
        let thresholds = Thresholds { line_angle_rad: 0.05, range_noise_m: 0.005, plane_distance_m: 0.0 };
        let beam_rad: Vec<f64> = (0..60).map(|c| (0.5 * f64::from(c) + 30.2).to_radians()).collect();
        let noise = |c: usize| [0.004, -0.006, 0.001, 0.005, -0.003, -0.004, 0.006][c * 5 % 7];
        let range_m = (0..60).map(|c| {
            let exact = (2.8 / beam_rad[c].cos()).min(2.8 / beam_rad[c].sin());
            (exact + noise(c)) as f32
        });
        let size = Size { rows: 1, columns: 60, wraps: false };
        let image = Image::new(size, range_m.collect());
        let beams = Beams::Nodding { beam_rad, turn_rad: vec![0.0], axis: TurnAxis::Y };
        let found = row_lines(&points(&image, &beams, 0), size, &thresholds, &mut Doubt::default());
        // the corner is at 45 degrees: between columns 29 and 30
        assert!(found.lines.iter().any(|line| line.start.abs_diff(30) <= 2), "{found:?}");
        assert!(found.lines.iter().all(|line| line.start >= 28 || line.end <= 32), "{found:?}");
    }
}
