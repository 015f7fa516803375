//! Quadrature encoders: counts of a hardware counter, or edges of the two lines.

use core::convert::Infallible;

use super::{Encoder, Position};
use crate::Clock;

/// Counts edges of the two lines A and B, for boards without a hardware counter.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Edges {
    lines: u8,
    count: i32,
    missed: u32,
}

impl Edges {
    /// Counting begins at 0 with the lines as they are.
    #[must_use]
    pub const fn new(a: bool, b: bool) -> Self {
        Self { lines: Self::phase(a, b), count: 0, missed: 0 }
    }

    /// The lines are now so: call at every edge, or often enough to miss none. A leads B while the count rises.
    pub fn step(&mut self, a: bool, b: bool) {
        let lines = Self::phase(a, b);
        match lines.wrapping_sub(self.lines) & 3 {
            1 => self.count = self.count.wrapping_add(1),
            3 => self.count = self.count.wrapping_sub(1),
            2 => self.missed = self.missed.wrapping_add(1),
            _ => {}
        }
        self.lines = lines;
    }

    /// Edges counted, four to a cycle of the lines; wraps.
    #[must_use]
    pub const fn count(&self) -> i32 {
        self.count
    }

    /// Times when both lines had changed at once: the count is then off by 2 or has lost whole cycles.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Position within the cycle 00, 10, 11, 01.
    const fn phase(a: bool, b: bool) -> u8 {
        match (a, b) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        }
    }
}

/// Shaft position at a count, in 2^-32 turns, for an encoder with so many counts a turn (four times its lines).
/// `counts_per_turn` 0 is taken for 1.
#[must_use]
pub const fn turn(count: i32, counts_per_turn: u32) -> u32 {
    let counts_per_turn = if counts_per_turn == 0 { 1 } else { counts_per_turn as u64 };
    let within = (count as i64).rem_euclid(counts_per_turn as i64) as u64;
    ((within << 32) / counts_per_turn) as u32
}

/// A quadrature encoder whose count a function gives, for instance that of a timer in encoder mode, widened to 32 bits.
/// Zero is where the count is 0: set it at the index pulse or an end stop.
#[derive(Debug)]
pub struct Quadrature<F> {
    count: F,
    counts_per_turn: u32,
}

impl<F: FnMut() -> i32> Quadrature<F> {
    /// `counts_per_turn`: four times the encoder's lines, 2000 for one of 500; not 0.
    pub const fn new(count: F, counts_per_turn: u32) -> Self {
        Self { count, counts_per_turn }
    }

    /// Gives the function back.
    pub fn release(self) -> F {
        self.count
    }
}

impl<F: FnMut() -> i32> Encoder for Quadrature<F> {
    type Error = Infallible;

    fn read(&mut self, clock: &mut impl Clock) -> Result<Position, Infallible> {
        let count = (self.count)();
        Ok(Position { turn: turn(count, self.counts_per_turn), time_us: clock.now_us() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: [(bool, bool); 4] = [(false, false), (true, false), (true, true), (false, true)];

    #[test]
    fn edges_count_both_ways() {
        let mut edges = Edges::new(false, false);
        for at in 1..=10usize {
            edges.step(CYCLE[at % 4].0, CYCLE[at % 4].1);
            edges.step(CYCLE[at % 4].0, CYCLE[at % 4].1);
            assert_eq!(edges.count(), at as i32, "a level seen twice counts once");
        }
        for at in (0..10usize).rev() {
            edges.step(CYCLE[at % 4].0, CYCLE[at % 4].1);
        }
        assert_eq!((edges.count(), edges.missed()), (0, 0));
        edges.step(true, true);
        assert_eq!((edges.count(), edges.missed()), (0, 1));
    }

    #[test]
    fn counts_to_turns() {
        assert_eq!(turn(0, 2000), 0);
        assert_eq!(turn(500, 2000), 1 << 30);
        assert_eq!(turn(-500, 2000), 3 << 30);
        assert_eq!(turn(2000, 2000), 0);
        assert_eq!(turn(i32::MIN, 2000), turn(i32::MIN + 2000, 2000));
        assert_eq!(turn(7, 0), 0);
        assert_eq!(turn(-1, u32::MAX), u32::MAX - 1, "the largest number of counts");
        assert_eq!(turn(i32::MIN, 1 << 31), 0);
        assert_eq!(turn(-1, 3 << 30), u32::MAX - 1);
    }

    /// More than 2^31 counts a turn: they need all of 64 bits.
    #[test]
    fn counts_of_the_finest_encoder() {
        assert_eq!(turn(-1, u32::MAX), u32::MAX - 1);
        assert_eq!(turn(i32::MIN, u32::MAX), 0x7FFF_FFFF);
        assert_eq!(turn(-1, 1 << 31), u32::MAX - 1);
    }
}
