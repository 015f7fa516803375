//! Small arithmetic that all stages use: numbers in two precisions, dot products, rounding and a
//! root without a call.

use core::ops::{Add, Div, Mul, Sub};

/// The numbers that planes are computed in.
pub(crate) trait Real:
    Copy + Default + PartialOrd + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    const ONE: Self;
    /// Square of the relative size at which a number is lost in rounding.
    const ROUNDING: Self;
    fn sqrt(self) -> Self;
}

impl Real for f32 {
    const ONE: f32 = 1.0;
    const ROUNDING: f32 = f32::EPSILON * f32::EPSILON / 16.0;
    fn sqrt(self) -> f32 {
        libm::sqrtf(self)
    }
}

impl Real for f64 {
    const ONE: f64 = 1.0;
    const ROUNDING: f64 = f64::EPSILON * f64::EPSILON / 16.0;
    fn sqrt(self) -> f64 {
        libm::sqrt(self)
    }
}

pub(crate) fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a - b.
#[inline(always)]
pub(crate) fn less(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + k b.
#[inline(always)]
pub(crate) fn plus(a: [f32; 3], k: f32, b: [f32; 3]) -> [f32; 3] {
    [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
}

/// a x b.
#[inline(always)]
pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// 1 / sqrt(x) to 2e-7 relative for normal x, finite (not infinite) for 0. Without a branch or a
/// call, so that loops over columns vectorise, and no slower than a division on a Cortex-M4F.
#[inline(always)]
pub(crate) fn inverse_sqrt(x: f32) -> f32 {
    let half = 0.5 * x;
    let mut y = f32::from_bits(0x5f37_5a86_u32.wrapping_sub(x.to_bits() >> 1));
    for _ in 0..3 {
        y *= 1.5 - half * y * y;
    }
    y
}

/// Nearest integer of |x| < 2^22, without a call: adding 1.5 * 2^23 leaves it in the low bits.
#[inline(always)]
pub(crate) fn round(x: f32) -> i32 {
    const MAGIC: f32 = 12_582_912.0;
    ((x + MAGIC).to_bits() as i32).wrapping_sub(MAGIC.to_bits() as i32)
}
