//! What the arrangements of beams that are tried have in common.

use crate::beside::Beside;
use crate::geometry::Kind;

/// How far points lie from beams that they are said to lie on, in beams.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Deviation {
    squares: f64,
    points: usize,
    far: usize,
}

impl Deviation {
    /// Adds a point that lies beside its beam by this much of the way to the next.
    pub fn add(&mut self, along_row: f64, along_column: f64) {
        let squares = along_row * along_row + along_column * along_column;
        self.points += 1;
        if squares < 0.25 * 0.25 {
            self.squares += squares;
        } else {
            // also what is not a number
            self.far += 1;
        }
    }

    pub fn root_mean_square(&self) -> f64 {
        (self.squares / (self.points - self.far).max(1) as f64).sqrt()
    }

    /// Whether the points lie on the beams, but for rounding and one in a thousand.
    pub fn fits(&self) -> bool {
        self.points > 0 && 1000 * self.far <= self.points && self.root_mean_square() < 0.06
    }
}

/// Where the beams of a cloud point.
pub(crate) struct Arrangement {
    pub kind: Kind,
    pub beside: Beside,
}

/// Returns the distance of a point.
pub(crate) fn length(point: &[f32; 3]) -> f64 {
    let squares = point.map(|x| f64::from(x) * f64::from(x));
    squares.iter().sum::<f64>().sqrt()
}

/// Returns the middle of some numbers, whose order changes.
pub(crate) fn median(numbers: &mut [f64]) -> Option<f64> {
    let middle = numbers.len() / 2;
    (!numbers.is_empty()).then(|| *numbers.select_nth_unstable_by(middle, f64::total_cmp).1)
}
