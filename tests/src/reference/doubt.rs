//! How sure the decisions of the reference are, where single precision may decide otherwise.

use std::ops::Not;

/// An answer, and whether rounding could not turn it.
#[derive(Clone, Copy, Debug)]
pub struct Answer {
    /// What it is in double precision.
    pub yes: bool,
    /// It is the same in single precision.
    pub sure: bool,
}

impl Answer {
    /// Whether `value` is above `threshold`; not sure where they are nearer than `margin`, or not
    /// numbers.
    pub fn above(value: f64, threshold: f64, margin: f64) -> Answer {
        Answer { yes: value > threshold, sure: (value - threshold).abs() > margin }
    }

    /// Both. A sure no is enough to be sure.
    pub fn and(self, other: Answer) -> Answer {
        let sure_no = |answer: Answer| answer.sure && !answer.yes;
        let sure = (self.sure && other.sure) || sure_no(self) || sure_no(other);
        Answer { yes: self.yes && other.yes, sure }
    }

    /// One of both at least.
    pub fn or(self, other: Answer) -> Answer {
        !(!self).and(!other)
    }
}

impl Not for Answer {
    type Output = Answer;

    fn not(self) -> Answer {
        Answer { yes: !self.yes, ..self }
    }
}

/// The decisions that fell so close to a threshold that rounding could turn them. They can be given,
/// so that the reference goes the other way as well.
#[derive(Clone, Debug, Default)]
pub struct Doubt {
    /// How the first ones are to be decided; the others as in double precision.
    pub given: Vec<bool>,
    /// How those in doubt were decided.
    pub decided: Vec<bool>,
    /// The row of each.
    pub rows: Vec<usize>,
    /// The row that is worked on.
    pub row: usize,
}

impl Doubt {
    /// Takes an answer as it is if it is sure, else as it is given.
    pub fn decide(&mut self, answer: Answer) -> bool {
        if answer.sure {
            return answer.yes;
        }
        let yes = self.given.get(self.decided.len()).copied().unwrap_or(answer.yes);
        self.decided.push(yes);
        self.rows.push(self.row);
        yes
    }

    /// What else to give for all that single precision may find: each decision beyond the given ones
    /// the other way, after those before it.
    pub fn others(&self) -> impl Iterator<Item = Vec<bool>> + '_ {
        let other = |i: usize| self.decided[..i].iter().copied().chain([!self.decided[i]]).collect();
        (self.given.len()..self.decided.len()).map(other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [Answer; 4] = [
        Answer { yes: true, sure: true },
        Answer { yes: false, sure: true },
        Answer { yes: true, sure: false },
        Answer { yes: false, sure: false },
    ];

    /// What an answer may be.
    fn may(answer: Answer) -> Vec<bool> {
        if answer.sure { vec![answer.yes] } else { vec![false, true] }
    }

    #[test]
    fn sure_is_what_no_doubt_turns() {
        for (a, b) in ALL.into_iter().flat_map(|a| ALL.map(|b| (a, b))) {
            let all = |both: fn(bool, bool) -> bool| {
                let mut all: Vec<_> =
                    may(a).iter().flat_map(|&a| may(b).into_iter().map(move |b| both(a, b))).collect();
                all.sort_unstable();
                all.dedup();
                all
            };
            assert_eq!((may(a.and(b)), a.and(b).yes), (all(|a, b| a && b), a.yes && b.yes), "{a:?} {b:?}");
            assert_eq!((may(a.or(b)), a.or(b).yes), (all(|a, b| a || b), a.yes || b.yes), "{a:?} {b:?}");
        }
        assert!(!Answer::above(1.0, 0.9, 0.2).sure && !Answer::above(f64::NAN, 0.0, 0.0).sure);
        assert!(Answer::above(1.0, 0.9, 0.05).sure && Answer::above(1.0, 0.9, 0.05).yes);
    }

    /// Three decisions, of which a yes to the first makes the second one sure: six ways, each gone
    /// once.
    #[test]
    fn all_ways_are_gone_once() {
        let (mut open, mut ways) = (vec![vec![]], vec![]);
        while let Some(given) = open.pop() {
            let mut doubt = Doubt { given, ..Doubt::default() };
            let first = doubt.decide(ALL[2]);
            doubt.decide(Answer { yes: true, sure: first });
            doubt.decide(ALL[3]);
            open.extend(doubt.others());
            ways.push(doubt.decided);
        }
        ways.sort();
        let (t, f) = (true, false);
        let expected = [vec![f, f, f], vec![f, f, t], vec![f, t, f], vec![f, t, t], vec![t, f], vec![t, t]];
        assert_eq!(ways, expected);
    }
}
