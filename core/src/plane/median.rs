//! A weighted median without a sort: the standard library's sorts can panic.

use crate::row::within::{at, swap};

/// Rounds after which the median is good enough: some seven are needed for a hundred samples.
const ROUNDS: usize = 32;

/// The least key for which the weights of the keys up to it reach `half`. Leaves the samples in
/// another order.
pub(crate) fn weighted_median<const N: usize>(
    samples: &mut [[f32; N]],
    key: impl Fn([f32; N]) -> f32,
    weight: impl Fn([f32; N]) -> f32,
    half: f32,
) -> f32
where
    [f32; N]: Default,
{
    let (mut low, mut high, mut below, mut pivot) = (0, samples.len(), 0.0, 0.0);
    for _ in 0..ROUNDS {
        if low >= high {
            break;
        }
        pivot = key(at(samples, (low + high) / 2));
        // in three parts: less than the pivot up to `less`, more from `more` on
        let (mut less, mut next, mut more) = (low, low, high);
        let (mut lighter, mut equal) = (0.0, 0.0);
        while next < more {
            let sample = at(samples, next);
            if key(sample) < pivot {
                lighter += weight(sample);
                swap(samples, next, less);
                less += 1;
                next += 1;
            } else if key(sample) > pivot {
                more -= 1;
                swap(samples, next, more);
            } else {
                equal += weight(sample);
                next += 1;
            }
        }
        if below + lighter >= half {
            high = less;
        } else if below + lighter + equal >= half {
            break;
        } else {
            below += lighter + equal;
            low = more;
        }
    }
    pivot
}
