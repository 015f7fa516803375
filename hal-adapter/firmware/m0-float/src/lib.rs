//! Single-precision addition, multiplication, division and comparison for a Cortex-M0: bit for bit
//! what IEEE 754 says, in fewer instructions than the routines that come with the compiler.
//!
//! The M0 has no floating point, no division and no multiplication with 64 bits of result, and most
//! instructions of a segmentation go into these few routines. The compiler's multiply and divide by
//! way of 64-bit integers. Here the usual case, two normal numbers and a normal result, is done in 32 bits; zeros are
//! looked after, and everything rarer is left to [`rare`].
//!
//! `use m0_float as _;` in a program puts them in place: the linker prefers them to the compiler's.
#![cfg_attr(not(test), no_std)]

pub mod rare;
#[cfg(target_os = "none")]
mod replace;
#[cfg(target_os = "none")]
pub use replace::is_right;

const SIGN: u32 = 1 << 31;
const IMPLICIT: u32 = 1 << 23;
const FRACTION: u32 = IMPLICIT - 1;
const INFINITY: u32 = 0xFF << 23;

/// The product of two numbers, as bits; `None` where something is infinite, not a number or
/// subnormal.
#[inline(always)]
#[must_use]
pub fn multiply(a: u32, b: u32) -> Option<u32> {
    let (a_exponent, b_exponent) = (a << 1 >> 24, b << 1 >> 24);
    let exponent = a_exponent + b_exponent;
    // biased by 127; 1 more if the product of the significands is 2 or more
    if is_special(a_exponent) || is_special(b_exponent) || !(128..=380).contains(&exponent) {
        let zero = (a << 1 == 0 && b_exponent < 255) || (b << 1 == 0 && a_exponent < 255);
        return zero.then_some((a ^ b) & SIGN);
    }
    // sign and exponent, below which the significand is added
    let upper = ((a ^ b) & SIGN) | ((exponent - 128) << 23);
    // 24 x 24 bits by halves: high * 2^24 + low, with low below 2^24
    let (a_high, a_low) = ((a << 8 | SIGN) >> 20, a << 20 >> 20);
    let (b_high, b_low) = ((b << 8 | SIGN) >> 20, b << 20 >> 20);
    let middle = a_high * b_low + a_low * b_high;
    let low = (middle << 20 >> 8) + a_low * b_low;
    let high = a_high * b_high + (middle >> 12) + (low >> 24);
    // 24 bits of significand, and the rest moved to the upper end of a word
    let rest = low << 8;
    Some(if high >= IMPLICIT {
        round(upper + IMPLICIT + high, rest)
    } else {
        round(upper + (high << 1 | rest >> 31), rest << 1)
    })
}

/// The quotient of two numbers, as bits; `None` where something is zero, infinite, not a number or
/// subnormal.
#[inline(always)]
#[must_use]
pub fn divide(a: u32, b: u32) -> Option<u32> {
    let (a_exponent, b_exponent) = (a << 1 >> 24, b << 1 >> 24);
    // biased by 127; 1 less if the significand of a is less than that of b
    let exponent = (a_exponent + 127).wrapping_sub(b_exponent);
    if is_special(a_exponent) || is_special(b_exponent) || !(2..=254).contains(&exponent) {
        return None;
    }
    let (mut rest, divisor) = (a & FRACTION | IMPLICIT, b & FRACTION | IMPLICIT);
    let mut upper = ((a ^ b) & SIGN) | ((exponent - 1) << 23);
    if rest < divisor {
        rest <<= 1;
        upper -= IMPLICIT;
    }
    let inverse = inverse(divisor);
    // one digit, then two of 12 bits, each the true one or some less. Of the products the upper
    // bits are lost, which are those of the difference as well
    let mut quotient = 0;
    for _ in 0..2 {
        let digit = ((rest >> 9) * inverse) >> 18;
        rest = (rest << 12).wrapping_sub(digit * divisor);
        quotient = (quotient << 12) + digit;
    }
    while rest >= divisor {
        rest -= divisor;
        quotient += 1;
    }
    // half of its last bit is no quotient of two such numbers, so that there are no ties
    Some(upper + ((quotient + 1) >> 1))
}

/// 2^39 over a significand, up to 2^-13 of it less, by Newton's iteration.
#[inline(always)]
fn inverse(divisor: u32) -> u32 {
    let upper = divisor >> 8;
    // within 9 %
    let mut inverse = 95_492 - upper;
    for _ in 0..3 {
        let off = (SIGN.wrapping_sub(upper * inverse)) as i32 >> 15;
        inverse = inverse.wrapping_add(((inverse as i32 * off) >> 16) as u32);
    }
    inverse - 2
}

/// 0 and 255: zeros and subnormal numbers; infinities and what is not a number.
#[inline(always)]
fn is_special(exponent: u32) -> bool {
    (exponent + 1) & 0xFE == 0
}

/// The sum of two numbers, as bits; `None` where something is infinite, not a number or subnormal.
#[inline(always)]
#[must_use]
pub fn add(a: u32, b: u32) -> Option<u32> {
    let (large, small) = if a << 1 >= b << 1 { (a, b) } else { (b, a) };
    let (mut exponent, small_exponent) = (large << 1 >> 24, small << 1 >> 24);
    if exponent.wrapping_sub(1) >= 254 {
        // both are zero: negative if both are
        return (large << 1 == 0).then_some(large & small);
    }
    if small_exponent == 0 {
        return (small << 1 == 0).then_some(large);
    }
    let shift = exponent - small_exponent;
    // a bit of room above, seven bits below
    let (mut sum, other) = ((large & FRACTION | IMPLICIT) << 7, (small & FRACTION | IMPLICIT) << 7);
    let other = match shift {
        0 => other,
        // what is lost must not be forgotten
        1..32 => other >> shift | u32::from(other << (32 - shift) != 0),
        _ => 1,
    };
    if (large ^ small) & SIGN == 0 {
        sum += other;
        if sum & SIGN != 0 {
            sum = sum >> 1 | sum & 1;
            exponent += 1;
            if exponent == 255 {
                return None;
            }
        }
    } else {
        sum -= other;
        if sum == 0 {
            return Some(0);
        }
        // one place in most cases
        while sum & SIGN >> 1 == 0 {
            sum <<= 1;
            exponent = exponent.wrapping_sub(1);
        }
        if exponent.wrapping_sub(1) >= 254 {
            return None;
        }
    }
    Some(round((large & SIGN | ((exponent - 1) << 23)) + (sum >> 7), sum << 25))
}

/// Rounds a number, as bits, by `rest`, a binary fraction of its last bit. Carries into the
/// exponent, up to infinity, as it must.
#[inline(always)]
fn round(number: u32, rest: u32) -> u32 {
    // to the nearest, ties to the even one
    let (_, up) = rest.overflowing_add((SIGN - 1) + (number & 1));
    number + u32::from(up)
}

/// How two numbers compare.
#[inline(always)]
#[must_use]
pub fn less(a: u32, b: u32) -> bool {
    if (a | b) & SIGN == 0 {
        return a < b && b <= INFINITY;
    }
    ordered(a, b) && order(a) < order(b)
}

/// Equal or less.
#[inline(always)]
#[must_use]
pub fn at_most(a: u32, b: u32) -> bool {
    if (a | b) & SIGN == 0 {
        return a <= b && b <= INFINITY;
    }
    ordered(a, b) && order(a) <= order(b)
}

#[inline(always)]
fn ordered(a: u32, b: u32) -> bool {
    a & !SIGN <= INFINITY && b & !SIGN <= INFINITY
}

/// Integers in the order of the numbers; both zeros are 0.
#[inline(always)]
fn order(a: u32) -> i32 {
    let magnitude = (a & !SIGN) as i32;
    if a & SIGN == 0 { magnitude } else { -magnitude }
}

/// Numbers to try the routines with, as bits: with few bits, at all exponents, next to each other,
/// and any.
pub fn numbers() -> impl FnMut() -> u32 {
    let mut state = 1u64;
    let mut last = 0;
    move || {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let random = (state >> 32) as u32;
        last = match random % 8 {
            0 => random & 0xFFF0_0000,
            1 => last ^ (random & 0x8000_000F),
            2 => [0, SIGN, 1, IMPLICIT, FRACTION, INFINITY, INFINITY | 1, SIGN | INFINITY][random as usize >> 8 & 7],
            3 => last.wrapping_add(random >> 3 & 0x0300_0001),
            // exponents of lengths and angles
            4..=6 => random & 0x87FF_FFFF | 0x3800_0000,
            _ => random,
        };
        last
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_the_processor_of_this_host() {
        let mut number = numbers();
        let (mut products, mut sums, mut quotients) = (0, 0, 0);
        for _ in 0..10_000_000 {
            let (a, b) = (number(), number());
            let (x, y) = (f32::from_bits(a), f32::from_bits(b));
            if let Some(product) = multiply(a, b) {
                assert_eq!(product, (x * y).to_bits(), "{x:e} * {y:e}");
                products += 1;
            }
            if let Some(sum) = add(a, b) {
                assert_eq!(sum, (x + y).to_bits(), "{x:e} + {y:e}");
                sums += 1;
            }
            if let Some(quotient) = divide(a, b) {
                assert_eq!(quotient, (x / y).to_bits(), "{x:e} / {y:e}");
                quotients += 1;
            }
            // hosts differ in which of the things that are no numbers they give
            let is = |found: u32, expected: f32| {
                found == expected.to_bits() || found << 1 > INFINITY << 1 && expected.is_nan()
            };
            assert!(is(rare::multiply(a, b), x * y), "{x:e} * {y:e}");
            assert!(is(rare::add(a, b), x + y), "{x:e} + {y:e}");
            assert!(is(rare::divide(a, b), x / y), "{x:e} / {y:e}");
            assert_eq!((less(a, b), at_most(a, b)), (x < y, x <= y), "{x:e} against {y:e}");
        }
        let enough = products > 6_000_000 && sums > 6_000_000 && quotients > 6_000_000;
        assert!(enough, "{products} products, {sums} sums and {quotients} quotients");
    }

    #[test]
    fn inverses_of_all_significands() {
        for divisor in IMPLICIT..2 * IMPLICIT {
            let rest = (1u64 << 39).checked_sub(u64::from(inverse(divisor)) * u64::from(divisor));
            assert!(rest.is_some_and(|rest| rest < 1 << 26), "{divisor:x} {rest:?}");
        }
    }
}
