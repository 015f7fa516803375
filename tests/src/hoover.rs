//! The five classes of Hoover et al. 1996, straight from the definitions and in whole numbers:
//! every ratio is a multiple of 1 / [`UNIT`], so averages are compared exactly. For images of at
//! most 64 pixels.

/// Least common multiple of 1 to 64: every ratio of two areas is a whole number of 1 / `UNIT`.
pub const UNIT: u128 = lcm_to(64);

/// An instance: class (0 correct, 1 over-segmented, 2 under-segmented), truth ids, segment ids.
pub type Instance = (u8, Vec<u16>, Vec<u16>);

/// The instances that stand, best first; the missed truth regions; the noise segments; how many
/// instances conflicts have dropped.
pub type Classes = (Vec<Instance>, Vec<u16>, Vec<u16>, usize);

const fn lcm_to(last: u128) -> u128 {
    let (mut lcm, mut n) = (1, 2);
    while n <= last {
        let (mut a, mut b) = (lcm, n);
        while b != 0 {
            (a, b) = (b, a % b);
        }
        lcm = lcm / a * n;
        n += 1;
    }
    lcm
}

/// Classifies two label images of one size, at most 64 pixels, at a tolerance of `percent` / 100.
pub fn classify(truth: &[u16], labels: &[u16], percent: usize, min_pixels: usize) -> Classes {
    assert!(truth.len() == labels.len() && truth.len() <= 64);
    let area = |image: &[u16], id: u16| image.iter().filter(|&&i| i == id).count();
    let overlap = |n: u16, m: u16| truth.iter().zip(labels).filter(|&(&t, &l)| t == n && l == m).count();
    let regions = |image: &[u16]| {
        let mut ids = image.to_vec();
        ids.sort();
        ids.dedup();
        ids.retain(|&id| id != 0 && area(image, id) >= min_pixels);
        ids
    };
    let (mut missed, mut noise) = (regions(truth), regions(labels));
    let enough = |o: usize, p: usize| o * 100 >= percent * p;
    let ratio = |o: usize, p: usize| o as u128 * UNIT / p as u128;

    // (average as numerator and denominator in units of 1 / UNIT, instance)
    let mut candidates: Vec<((u128, u128), Instance)> = Vec::new();
    for &n in &missed {
        for &m in &noise {
            let o = overlap(n, m);
            if enough(o, area(truth, n)) && enough(o, area(labels, m)) {
                let sum = ratio(o, area(truth, n)) + ratio(o, area(labels, m));
                candidates.push(((sum, 2), (0, vec![n], vec![m])));
            }
        }
        let parts: Vec<u16> = noise.iter().copied().filter(|&m| enough(overlap(n, m), area(labels, m))).collect();
        let total: usize = parts.iter().map(|&m| overlap(n, m)).sum();
        if parts.len() >= 2 && enough(total, area(truth, n)) {
            let singles: u128 = parts.iter().map(|&m| ratio(overlap(n, m), area(labels, m))).sum();
            let x = parts.len() as u128;
            candidates.push(((singles + x * ratio(total, area(truth, n)), 2 * x), (1, vec![n], parts)));
        }
    }
    for &m in &noise {
        let parts: Vec<u16> = missed.iter().copied().filter(|&n| enough(overlap(n, m), area(truth, n))).collect();
        let total: usize = parts.iter().map(|&n| overlap(n, m)).sum();
        if parts.len() >= 2 && enough(total, area(labels, m)) {
            let singles: u128 = parts.iter().map(|&n| ratio(overlap(n, m), area(truth, n))).sum();
            let x = parts.len() as u128;
            candidates.push(((singles + x * ratio(total, area(labels, m)), 2 * x), (2, parts, vec![m])));
        }
    }

    let (mut standing, all) = (Vec::new(), candidates.len());
    while !candidates.is_empty() {
        let mut best = 0;
        for i in 1..candidates.len() {
            let (((a, da), one), ((b, db), two)) = (&candidates[i], &candidates[best]);
            let (left, right) = (a * db, b * da);
            if left > right || (left == right && one < two) {
                best = i;
            }
        }
        let (_, taken) = candidates.remove(best);
        candidates.retain(|(_, other)| {
            !other.1.iter().any(|n| taken.1.contains(n)) && !other.2.iter().any(|m| taken.2.contains(m))
        });
        missed.retain(|n| !taken.1.contains(n));
        noise.retain(|m| !taken.2.contains(m));
        standing.push(taken);
    }
    let dropped = all - standing.len();
    (standing, missed, noise, dropped)
}
