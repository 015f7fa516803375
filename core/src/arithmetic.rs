//! Small arithmetic that all stages use: numbers in two precisions, dot products, rounding and a
//! root without a call.

use core::ops::{Add, Div, Mul, Sub};

use crate::row::bits::VECTORS;

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

/// Called where floats are software, as [`plus`] and [`cross`]: five calls in each of a hundred places become one, 1.5 KB less
/// for 0.4 % more instructions.
#[cfg_attr(all(target_os = "none", target_abi = "eabi"), inline(never))]
pub(crate) fn dot<T: Real>(a: [T; 3], b: [T; 3]) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// a - b.
#[inline(always)]
pub(crate) fn less(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// a + k b.
#[cfg_attr(not(all(target_os = "none", target_abi = "eabi")), inline(always))]
#[cfg_attr(all(target_os = "none", target_abi = "eabi"), inline(never))]
pub(crate) fn plus(a: [f32; 3], k: f32, b: [f32; 3]) -> [f32; 3] {
    [a[0] + k * b[0], a[1] + k * b[1], a[2] + k * b[2]]
}

/// a x b.
#[cfg_attr(not(all(target_os = "none", target_abi = "eabi")), inline(always))]
#[cfg_attr(all(target_os = "none", target_abi = "eabi"), inline(never))]
pub(crate) fn cross(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Whether a is less than b; not both are negative, and none is -0. By their bits where the target works
/// on one number at a time: there a comparison of floats is a call, or takes five instructions.
#[inline(always)]
pub(crate) fn below(a: f32, b: f32) -> bool {
    if VECTORS { a < b } else { (a.to_bits() as i32) < b.to_bits() as i32 }
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

/// [`inverse_sqrt`] where it is not needed for each pixel: called on a microcontroller, it is there once.
#[cfg_attr(not(target_os = "none"), inline)]
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn lone_inverse_sqrt(x: f32) -> f32 {
    inverse_sqrt(x)
}

/// The root of x to its last digit but one, 0 for 0: without `libm`'s an image is 0.5 KB smaller.
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn lone_sqrt(x: f32) -> f32 {
    let inverse = lone_inverse_sqrt(x);
    let root = x * inverse;
    root + 0.5 * inverse * (x - root * root)
}

/// Cosine and sine of an angle within +-6300 radians, to 9e-8. Without a branch or a call, so that loops
/// vectorise, and in single precision alone: with `libm`'s an image for a Cortex-M4F is 6 KB larger, most of it
/// double precision.
#[cfg_attr(not(target_os = "none"), inline(always))]
#[cfg_attr(target_os = "none", inline(never))]
pub(crate) fn cos_sin(x_rad: f32) -> (f32, f32) {
    // pi / 2 in three parts: whole multiples of the first two are exact
    const HALF_PI: [f32; 3] = [1.570_312_5, 4.837_513e-4, 7.549_79e-8];
    let quarter = round(x_rad * core::f32::consts::FRAC_2_PI);
    let k = quarter as f32;
    let x = ((x_rad - k * HALF_PI[0]) - k * HALF_PI[1]) - k * HALF_PI[2];
    let z = x * x;
    // minimax over +-pi / 4
    let sin = x + x * z * (-0.166_666_64 + z * (8.332_749e-3 + z * -1.958_800_8e-4));
    let cos = 1.0 - z * (0.5 - z * (0.041_666_664 + z * (-1.388_830_4e-3 + z * 2.454_804e-5)));
    let (sin, cos) = if quarter & 1 == 1 { (cos, sin) } else { (sin, cos) };
    let negative = |x: f32, when: i32| f32::from_bits(x.to_bits() ^ ((when & 2) << 30) as u32);
    (negative(cos, quarter.wrapping_add(1)), negative(sin, quarter))
}

/// Nearest integer of |x| < 2^22, without a call: adding 1.5 * 2^23 leaves it in the low bits.
#[inline(always)]
pub(crate) fn round(x: f32) -> i32 {
    const MAGIC: f32 = 12_582_912.0;
    ((x + MAGIC).to_bits() as i32).wrapping_sub(MAGIC.to_bits() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn roots() {
        for x in (1..100_000u32).map(|i| i as f32 * 1e-3 * 1.7f32.powi(i as i32 % 150 - 75)) {
            let (found, exact) = (lone_sqrt(x), x.sqrt());
            assert!(found.to_bits().abs_diff(exact.to_bits()) <= 1, "{x}: {found} {exact}");
        }
        assert!((0..1000).all(|i| lone_sqrt((i * i) as f32) == i as f32));
        assert_eq!(lone_sqrt(0.25), 0.5);
    }

    #[test]
    fn cosines_and_sines_of_all_turns() {
        for i in (-1_000_000..1_000_000).step_by(if cfg!(miri) { 9_973 } else { 1 }) {
            for step in [1e-6f32, 0.006_299] {
                let x = step * i as f32;
                let (cos, sin) = cos_sin(x);
                let (exact_cos, exact_sin) = (libm::cos(x.into()), libm::sin(x.into()));
                assert!((f64::from(cos) - exact_cos).abs() < 9e-8 && (f64::from(sin) - exact_sin).abs() < 9e-8, "{x}");
            }
        }
        assert_eq!(cos_sin(0.0), (1.0, 0.0));
    }
}
