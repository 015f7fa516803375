//! What the paper claims, beside what was found: verdicts that follow from the numbers alone.

use crate::experiment::counts::Counts;
use crate::experiment::method::{COMPARED_AT, EDGE, REGION, TOLERANCES};
use crate::experiment::results::Results;

/// "A few percent better": more than 0 and at most so many percentage points.
const FEW_PERCENT: f64 = 10.0;

/// "Low" under-segmentation: at most so many percent of the truth regions, at any tolerance.
const LOW_PERCENT: f64 = 5.0;

/// A method that finds fewer of the truth regions than this at every tolerance, percent, has no
/// merit in mixing few.
const LITTLE_PERCENT: f64 = 20.0;

/// "Linear": instructions go with points to a power of at most this.
const LINEAR_POWER: f64 = 1.05;

/// Whether a claim holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// In every case.
    Holds,
    /// In some cases.
    HoldsInPart,
    /// In none.
    DoesNotHold,
    /// No case counts: too little is found.
    Open,
}

impl Verdict {
    /// As words.
    pub fn words(self) -> &'static str {
        match self {
            Verdict::Holds => "holds",
            Verdict::HoldsInPart => "holds in part",
            Verdict::DoesNotHold => "does not hold",
            Verdict::Open => "cannot be told",
        }
    }

    /// As words, of several claims.
    pub fn words_of_many(self) -> &'static str {
        match self {
            Verdict::Holds => "hold",
            Verdict::HoldsInPart => "hold in part",
            Verdict::DoesNotHold => "do not hold",
            Verdict::Open => "cannot be told",
        }
    }

    /// By cases; those that are `None` do not count.
    fn of(cases: &[Option<bool>]) -> Verdict {
        let count = |holds| cases.iter().filter(|case| **case == Some(holds)).count();
        match (count(true), count(false)) {
            (0, 0) => Verdict::Open,
            (_, 0) => Verdict::Holds,
            (0, _) => Verdict::DoesNotHold,
            _ => Verdict::HoldsInPart,
        }
    }
}

/// A claim of the paper and what became of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Claim {
    /// What the paper says.
    pub claim: &'static str,
    /// When it counts as held.
    pub criterion: String,
    /// Whether it does.
    pub verdict: Verdict,
    /// The numbers, case by case.
    pub found: Vec<String>,
    /// Why, as far as the numbers tell; empty if there is nothing to explain.
    pub why: String,
}

/// Returns the claims, for results that have the paper's two methods; none for others.
pub fn claims(results: &Results) -> Vec<Claim> {
    let (Some(edge), Some(region)) = (results.method(EDGE), results.method(REGION)) else { return vec![] };
    vec![better(results, edge, region), zero(results, edge, region), under(results, &[edge, region]), linear(results)]
}

fn noise(mm: u32) -> String {
    if mm == 0 { "Without noise".to_string() } else { format!("At {mm} mm") }
}

fn better(results: &Results, edge: usize, region: usize) -> Claim {
    let (mut cases, mut found, mut at_all) = (vec![], vec![], false);
    for &mm in &results.noises_mm {
        let correct = |method, percent| {
            let counts = results.counts(method, mm, percent);
            counts.percent(counts.correct)
        };
        let mean = |method| TOLERANCES.map(|p| correct(method, p)).sum::<f64>() / TOLERANCES.count() as f64;
        let (e, r) = (correct(edge, COMPARED_AT), correct(region, COMPARED_AT));
        cases.push(Some(r > e && r - e <= FEW_PERCENT));
        at_all |= r > e;
        found.push(format!(
            "{}: region-based {r:.1} %, edge-based {e:.1} %, a difference of {:+.1} points (mean over all T: {:.1} % and \
             {:.1} %).",
            noise(mm),
            r - e,
            mean(region),
            mean(edge)
        ));
    }
    let verdict = match Verdict::of(&cases) {
        Verdict::DoesNotHold if at_all => Verdict::HoldsInPart,
        verdict => verdict,
    };
    let why = if verdict == Verdict::Holds { String::new() } else { rim_and_noise(results, edge, region) };
    Claim {
        claim: "The region-based approach finds a few percent more of the regions than the edge-based one.",
        criterion: format!(
            "At T = {:.1}, region-based is better by more than 0 and at most {FEW_PERCENT} percentage points of the truth \
             regions. In part: better, but by more, or not at every level of noise.",
            f64::from(COMPARED_AT) / 100.0
        ),
        verdict,
        found,
        why,
    }
}

/// Returns what edges alone cost, what noise does to the input of both methods, and how much of the
/// scan each then gives up.
fn rim_and_noise(results: &Results, edge: usize, region: usize) -> String {
    let rims = results.rims.iter().map(|rim| format!("{:.0} % for a rim of {} px", rim.correct_percent, rim.width_px));
    let errors = results.sample.bearings.iter().filter(|error| error.noise_mm > 0).map(|error| {
        format!(
            "{} mm of noise changes half of the bearing angles along rows by {:.1} deg or more, and {:.0} % of them by \
             more than the turn that counts as a roof edge",
            error.noise_mm, error.median_deg, error.beyond_roof_percent
        )
    });
    let left_out = results.noises_mm.iter().map(|&mm| {
        let percent = |method| results.left_out_percent(method, mm);
        format!("{:.0} % and {:.0} % at {mm} mm", percent(edge), percent(region))
    });
    format!(
        "Edge pixels belong to nobody: if every region were found whole but for its rim, at most so many would be correct: \
         {}. And neighbouring beams are closer together than their ranges are exact: {}. Of all returns the edge-based and the \
         region-based method leave in no segment of 30 pixels or more: {}.",
        rims.collect::<Vec<_>>().join(", "),
        errors.collect::<Vec<_>>().join("; "),
        left_out.collect::<Vec<_>>().join("; ")
    )
}

fn zero(results: &Results, edge: usize, region: usize) -> Claim {
    let (mut cases, mut found) = (vec![], vec![]);
    for &mm in &results.noises_mm {
        let correct = |method, percent| results.counts(method, mm, percent).correct;
        let first = TOLERANCES.rev().take_while(|&percent| correct(edge, percent) == 0).last();
        cases.push(if first == Some(*TOLERANCES.start()) { None } else { Some(first.is_some_and(|p| p < 100)) });
        found.push(match first {
            Some(percent) if percent == *TOLERANCES.start() => {
                format!("{}: edge-based has none at any T, which tells nothing.", noise(mm))
            }
            Some(percent) => format!(
                "{}: edge-based has none from T = {:.2} on, where region-based has {}; at T = 1 region-based has {}.",
                noise(mm),
                f64::from(percent) / 100.0,
                correct(region, percent),
                correct(region, 100)
            ),
            None => format!("{}: edge-based still has {} at T = 1.", noise(mm), correct(edge, 100)),
        });
    }
    let least = results.noises_mm.iter().map(|&mm| results.left_out_percent(edge, mm)).fold(100.0, f64::min);
    let verdict = Verdict::of(&cases);
    let why = format!(
        "Edge pixels belong to nobody: the ridge that Sobel draws is two pixels wide, the closing fills its notches, and \
         every region loses that rim. The edge-based method leaves {least:.0} % of the returns or more in no segment."
    );
    Claim {
        claim: "The edge-based approach reaches zero correct detections before T is 100 %.",
        criterion: "Edge-based has no correct detection at T = 0.99 and at T = 1, but some at smaller T.".to_string(),
        verdict,
        found,
        why: if matches!(verdict, Verdict::Holds | Verdict::HoldsInPart) { why } else { String::new() },
    }
}

fn under(results: &Results, methods: &[usize]) -> Claim {
    let (mut cases, mut found, mut little) = (vec![], vec![], vec![]);
    for &method in methods {
        for &mm in &results.noises_mm {
            let most = |of: fn(&Counts) -> usize| {
                let percent = TOLERANCES.map(|p| results.counts(method, mm, p)).map(|c| c.percent(of(&c)));
                percent.fold(0.0, f64::max)
            };
            let (under, over, correct) = (most(|c| c.under_segmented), most(|c| c.over_segmented), most(|c| c.correct));
            cases.push(match under <= LOW_PERCENT {
                true if correct < LITTLE_PERCENT => None,
                low => Some(low),
            });
            let name = results.methods[method];
            found.push(format!(
                "{}, {name}: {under:.1} % under-segmented at most, {over:.1} % over-segmented, {correct:.1} % correct.",
                noise(mm)
            ));
            if correct < LITTLE_PERCENT {
                little.push(format!("{name} {}", noise(mm).to_lowercase()));
            }
        }
    }
    let why = match little.is_empty() {
        true => String::new(),
        false => format!(
            "Low is no merit where little is found at all, and does not count: fewer than {LITTLE_PERCENT} % of the regions \
             are correct at any tolerance for {}.",
            little.join(", ")
        ),
    };
    Claim {
        claim: "Both approaches are low in under-segmentation.",
        criterion: format!(
            "At no tolerance are there more instances of under-segmentation than {LOW_PERCENT} % of the truth regions (one \
             instance swallows two regions or more)."
        ),
        verdict: Verdict::of(&cases),
        found,
        why,
    }
}

fn linear(results: &Results) -> Claim {
    let (mut cases, mut found) = (vec![], vec![]);
    for (method, name) in results.methods.iter().enumerate() {
        let costs: Vec<_> = results.costs.iter().filter(|cost| cost.method == method).collect();
        let counts: Vec<_> = costs
            .iter()
            .map(|cost| (cost.points() as f64, cost.instructions_per_point * cost.points() as f64))
            .collect();
        let power = power(&counts);
        cases.push(Some(power <= LINEAR_POWER));
        if let (Some(first), Some(last)) = (costs.first(), costs.last()) {
            found.push(format!(
                "{name}: {:.0} instructions per point at {} points, {:.0} at {}; instructions go with points to the power of \
                 {power:.2}.",
                first.instructions_per_point,
                first.points(),
                last.instructions_per_point,
                last.points()
            ));
        }
    }
    Claim {
        claim: "The cost is linear in the number of points.",
        criterion: format!(
            "The instructions that the processor carries out go with points to a power of at most {LINEAR_POWER}. (Less \
             than 1: what a row, a line or a segment costs whatever its size weighs less in large scans.)"
        ),
        verdict: Verdict::of(&cases),
        found,
        why: String::new(),
    }
}

/// Returns the power p of the y = a x^p that fits best (least squares of the logarithms).
fn power(points: &[(f64, f64)]) -> f64 {
    let logs: Vec<_> = points.iter().map(|(x, y)| (x.ln(), y.ln())).collect();
    let mean = |of: fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
    let (mx, my) = (mean(|p| p.0), mean(|p| p.1));
    logs.iter().map(|(x, y)| (x - mx) * (y - my)).sum::<f64>() / logs.iter().map(|(x, _)| (x - mx).powi(2)).sum::<f64>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::experiment::cost::Cost;
    use crate::experiment::made_up::made_up;

    fn verdicts(results: &Results) -> [Verdict; 4] {
        claims(results).iter().map(|claim| claim.verdict).collect::<Vec<_>>().try_into().unwrap()
    }

    use Verdict::{DoesNotHold, Holds, HoldsInPart, Open};

    #[test]
    fn better_means_by_a_few_percent_at_every_noise() {
        let better = |correct| verdicts(&made_up(correct))[0];
        // one region of 20 is 5 %, two are 10 %, three are 15 %
        assert_eq!(better([[9, 9], [10, 11]]), Holds);
        assert_eq!(better([[9, 9], [10, 12]]), HoldsInPart);
        assert_eq!(better([[9, 9], [10, 9]]), HoldsInPart);
        assert_eq!(better([[9, 9], [12, 12]]), HoldsInPart, "more than a few");
        assert_eq!(better([[9, 9], [8, 9]]), DoesNotHold);
        let claim = &claims(&made_up([[9, 9], [8, 9]]))[0];
        let found = "Without noise: region-based 25.0 %, edge-based 30.0 %, a difference of -5.0 points";
        assert!(claim.found[0].starts_with(found), "{claim:?}");
        assert!(
            claim.why.contains("61 % for a rim of 1 px")
                && claim.why.contains("8.5 deg")
                && claim.why.contains("25 % and 25 % at 5 mm"),
            "{claim:?}"
        );
        assert_eq!(claims(&made_up([[9, 9], [10, 11]]))[0].why, "");
    }

    #[test]
    fn zero_means_before_the_end() {
        let claim = |correct| claims(&made_up(correct))[1].clone();
        // 4 are gone from 0.9 on, 5 at 1.0 only, 6 never
        let early = claim([[4, 4], [9, 9]]);
        assert_eq!(early.verdict, Holds);
        let found = "Without noise: edge-based has none from T = 0.90 on, where region-based has 10; at T = 1 region-based has 8.";
        assert_eq!(early.found[0], found);
        assert_eq!(claim([[4, 5], [9, 9]]).verdict, HoldsInPart);
        let late = claim([[6, 5], [9, 9]]);
        assert_eq!(late.verdict, DoesNotHold);
        assert_eq!(late.found[0], "Without noise: edge-based still has 2 at T = 1.");
        // nothing at any T is no fall to zero
        assert_eq!(claim([[4, 0], [9, 9]]).verdict, Holds);
        assert_eq!(claim([[6, 0], [9, 9]]).verdict, DoesNotHold);
        assert_eq!(claim([[0, 0], [9, 9]]).verdict, Open);
    }

    #[test]
    fn low_under_segmentation_means_at_any_tolerance() {
        // 1 instance for 40 truth regions: 2.5 %
        let mut results = made_up([[9, 9], [10, 10]]);
        assert_eq!(verdicts(&results)[2], Holds);
        assert_eq!(claims(&results)[2].why, "");
        results.runs.iter_mut().filter(|run| run.method == 1).for_each(|run| run.at[30].under_segmented = 2);
        assert_eq!(verdicts(&results)[2], HoldsInPart);
        results.runs.iter_mut().for_each(|run| run.at[30].under_segmented = 2);
        assert_eq!(verdicts(&results)[2], DoesNotHold);
        let little = claims(&made_up([[9, 3], [10, 10]]))[2].clone();
        assert!(little.why.ends_with("for edge-based at 5 mm."), "{little:?}");
        assert_eq!(little.verdict, Holds);
        assert_eq!(verdicts(&made_up([[3, 3], [3, 3]]))[2], Open);
        // mixing much counts even where little is found
        let mut results = made_up([[3, 3], [3, 3]]);
        results.runs.iter_mut().for_each(|run| run.at[30].under_segmented = 2);
        assert_eq!(verdicts(&results)[2], DoesNotHold);
    }

    #[test]
    fn linear_means_a_power_of_one_or_less() {
        let mut results = made_up([[9, 9], [10, 10]]);
        assert_eq!(verdicts(&results)[3], Holds);
        let logarithm = |cost: &mut Cost| cost.instructions_per_point = 10.0 * (cost.points() as f64).ln();
        results.costs.iter_mut().filter(|cost| cost.method == 1).for_each(logarithm);
        assert_eq!(verdicts(&results)[3], HoldsInPart, "n log n is more");
        let few = |cost: &mut Cost| cost.instructions_per_point = 10.0 + 0.1 * (cost.points() as f64).ln();
        results.costs.iter_mut().filter(|cost| cost.method == 1).for_each(few);
        assert_eq!(verdicts(&results)[3], Holds, "a little that grows");
        let less = |cost: &mut Cost| cost.instructions_per_point = 10.0 + 1e5 / cost.points() as f64;
        results.costs.iter_mut().filter(|cost| cost.method == 0).for_each(less);
        assert_eq!(verdicts(&results)[3], Holds);
        let root = |cost: &mut Cost| cost.instructions_per_point = 10.0 * (cost.points() as f64).sqrt();
        results.costs.iter_mut().filter(|cost| cost.method == 1).for_each(root);
        assert_eq!(verdicts(&results)[3], HoldsInPart);
        assert!(claims(&results)[3].found[1].contains("power of 1.50"));
        results.costs.iter_mut().for_each(root);
        assert_eq!(verdicts(&results)[3], DoesNotHold);
    }

    #[test]
    fn other_methods_make_no_claims() {
        let mut results = made_up([[9, 9], [10, 10]]);
        results.methods[1] = "another";
        assert_eq!(claims(&results), []);
    }
}
