//! Quadrature encoders: counts of a hardware counter, or of signal edges.

use core::convert::Infallible;

use super::position::{Encoder, Position};
use crate::clock::Clock;

/// Counts the edges of the signals A and B, for boards without a hardware counter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EdgeCounter {
    /// The levels of the signals as a phase, see [`EdgeCounter::phase`].
    phase: u8,
    count: i32,
    missed: u32,
}

impl EdgeCounter {
    /// Returns a counter at 0. `a` and `b` are the present levels of the signals.
    #[must_use]
    pub const fn new(a: bool, b: bool) -> Self {
        Self { phase: Self::phase(a, b), count: 0, missed: 0 }
    }

    /// Takes the present levels of the signals. Call it at every edge, or often enough to miss
    /// none. The count rises while A leads B.
    pub fn step(&mut self, a: bool, b: bool) {
        let phase = Self::phase(a, b);
        match phase.wrapping_sub(self.phase) & 3 {
            1 => self.count = self.count.wrapping_add(1),
            3 => self.count = self.count.wrapping_sub(1),
            2 => self.missed = self.missed.wrapping_add(1),
            _ => {}
        }
        self.phase = phase;
    }

    /// Returns the number of edges, four per cycle. It wraps.
    #[must_use]
    pub const fn count(&self) -> i32 {
        self.count
    }

    /// Returns how often both signals had changed at once. Each time the count is wrong by 2 edges
    /// or more.
    #[must_use]
    pub const fn missed(&self) -> u32 {
        self.missed
    }

    /// Returns the position within the cycle 00, 10, 11, 01 of A and B.
    const fn phase(a: bool, b: bool) -> u8 {
        match (a, b) {
            (false, false) => 0,
            (true, false) => 1,
            (true, true) => 2,
            (false, true) => 3,
        }
    }
}

/// Returns the shaft position at a count, in 2^-32 turns. `counts_per_turn` is four times the
/// encoder's number of cycles per turn; 0 is taken for 1.
#[must_use]
pub const fn turn(count: i32, counts_per_turn: u32) -> u32 {
    let counts_per_turn = if counts_per_turn == 0 { 1 } else { counts_per_turn as u64 };
    let within = (count as i64).rem_euclid(counts_per_turn as i64) as u64;
    ((within << 32) / counts_per_turn) as u32
}

/// A quadrature encoder whose count comes from a function: for instance the count of a timer in
/// encoder mode, widened to 32 bits. The position is 0 where the count is 0, so set the count at
/// the index pulse or an end stop.
#[derive(Debug)]
pub struct Quadrature<F> {
    count: F,
    counts_per_turn: u32,
}

impl<F: FnMut() -> i32> Quadrature<F> {
    /// Returns an encoder. `counts_per_turn` is four times its number of cycles per turn, and not
    /// 0.
    pub const fn new(count: F, counts_per_turn: u32) -> Self {
        Self { count, counts_per_turn }
    }

    /// Returns the function.
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
        let mut edges = EdgeCounter::new(false, false);
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
