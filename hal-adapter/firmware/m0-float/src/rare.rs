//! Sums, products and quotients of any numbers, subnormal, infinite and no numbers among them: what the routines
//! for the usual case leave. In 0.7 KB in place of the compiler's 1.4 KB, and slow.

use super::{INFINITY, SIGN, round};

const NO_NUMBER: u32 = INFINITY | 1 << 22;

/// The biased exponent of a finite number other than zero, and its significand with the highest bit set.
fn parts(a: u32) -> (i32, u32) {
    let exponent = (a << 1 >> 24) as i32;
    if exponent > 0 {
        return (exponent, a << 8 | SIGN);
    }
    let (mut exponent, mut significand) = (1, a << 8);
    while significand & SIGN == 0 {
        significand <<= 1;
        exponent -= 1;
    }
    (exponent, significand)
}

/// `significand`, not 0, over 2^31 times 2^(exponent - 127). Its lowest bit stands for all that is lost of it.
#[inline(never)]
fn number(sign: u32, mut exponent: i32, mut significand: u32) -> u32 {
    while significand & SIGN == 0 {
        significand <<= 1;
        exponent -= 1;
    }
    if exponent > 254 {
        return sign | INFINITY;
    }
    if exponent < 1 {
        significand = moved_down(significand, 1 - exponent);
        exponent = 1;
    }
    // the highest bit, if it is still there, makes the exponent right
    round(sign + ((exponent as u32 - 1) << 23) + (significand >> 8), significand << 24)
}

/// Divided by 2^places; what is lost must not be forgotten.
fn moved_down(significand: u32, places: i32) -> u32 {
    match places {
        0 => significand,
        1..32 => significand >> places | u32::from(significand << (32 - places) != 0),
        _ => 1,
    }
}

/// The product.
#[cold]
#[must_use]
pub fn multiply(a: u32, b: u32) -> u32 {
    let (sign, [x, y]) = ((a ^ b) & SIGN, [a, b].map(|a| a & !SIGN));
    if x > INFINITY || y > INFINITY || x.max(y) == INFINITY && x.min(y) == 0 {
        return NO_NUMBER;
    }
    if x == INFINITY || y == INFINITY {
        return sign | INFINITY;
    }
    if x == 0 || y == 0 {
        return sign;
    }
    let ((x_exponent, x), (y_exponent, y)) = (parts(x), parts(y));
    let product = u64::from(x) * u64::from(y);
    number(sign, x_exponent + y_exponent - 126, (product >> 32) as u32 | u32::from(product as u32 != 0))
}

/// The quotient.
#[cold]
#[must_use]
pub fn divide(a: u32, b: u32) -> u32 {
    let (sign, [x, y]) = ((a ^ b) & SIGN, [a, b].map(|a| a & !SIGN));
    if x > INFINITY || y > INFINITY || x == y && (x == 0 || x == INFINITY) {
        return NO_NUMBER;
    }
    if x == INFINITY || y == 0 {
        return sign | INFINITY;
    }
    if x == 0 || y == INFINITY {
        return sign;
    }
    let ((x_exponent, x), (y_exponent, y)) = (parts(x), parts(y));
    let (mut rest, divisor, mut quotient, mut exponent) = (x >> 1, y >> 1, 0, x_exponent - y_exponent + 127);
    if rest < divisor {
        rest <<= 1;
        exponent -= 1;
    }
    while quotient & SIGN == 0 {
        quotient <<= 1;
        if rest >= divisor {
            rest -= divisor;
            quotient |= 1;
        }
        rest <<= 1;
    }
    number(sign, exponent, quotient | u32::from(rest != 0))
}

/// The sum.
#[cold]
#[must_use]
pub fn add(a: u32, b: u32) -> u32 {
    let (large, small) = if a << 1 >= b << 1 { (a, b) } else { (b, a) };
    let [x, y] = [large, small].map(|a| a & !SIGN);
    if x > INFINITY || y == INFINITY && large != small {
        return NO_NUMBER;
    }
    if y == 0 {
        // both are zero: negative if both are
        return if x == 0 { large & small } else { large };
    }
    if x == INFINITY {
        return large;
    }
    let ((x_exponent, x), (y_exponent, y)) = (parts(x), parts(y));
    let (x, y) = (x >> 1, moved_down(y >> 1, x_exponent - y_exponent));
    let sum = if (large ^ small) & SIGN == 0 { x + y } else { x - y };
    if sum == 0 { 0 } else { number(large & SIGN, x_exponent + 1, sum) }
}
