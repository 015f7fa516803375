//! The routines that compiled code calls, by the names that the Arm run-time ABI gives them.

use core::arch::global_asm;

use super::{SIGN, add, at_most, less, multiply};

unsafe extern "C" {
    // the compiler's own
    safe fn __addsf3(a: f32, b: f32) -> f32;
    safe fn __mulsf3(a: f32, b: f32) -> f32;
}

// SAFETY (all): these are the names, types and results that the ABI gives these routines; the
// compiler's are weak.

// `multiply` by hand: the compiler keeps too few of its values in registers. Some 55 instructions
// instead of 72.
global_asm!(
    ".section .text.__aeabi_fmul, \"ax\", %progbits",
    ".global __aeabi_fmul",
    ".type __aeabi_fmul, %function",
    ".thumb_func",
    "__aeabi_fmul:",
    "push {{r4, r5, r6, lr}}",
    // exponents; everything special goes the long way
    "lsls r2, r0, #1",
    "lsrs r2, r2, #24",
    "lsls r3, r1, #1",
    "lsrs r3, r3, #24",
    "subs r4, r2, #1",
    "cmp r4, #253",
    "bhi 9f",
    "subs r4, r3, #1",
    "cmp r4, #253",
    "bhi 9f",
    "adds r2, r2, r3",
    "subs r2, #128",
    "cmp r2, #252",
    "bhi 9f",
    // r2: sign and exponent, below which the significand is added
    "mov r4, r0",
    "eors r4, r1",
    "lsrs r4, r4, #31",
    "lsls r4, r4, #31",
    "lsls r2, r2, #23",
    "orrs r2, r4",
    // significands at the upper end of a word
    "movs r5, #1",
    "lsls r5, r5, #31",
    "lsls r0, r0, #8",
    "orrs r0, r5",
    "lsls r1, r1, #8",
    "orrs r1, r5",
    // r6, r0 = r0 * r1, by halves
    "lsrs r3, r0, #16",
    "uxth r0, r0",
    "lsrs r5, r1, #16",
    "uxth r1, r1",
    "mov r6, r3",
    "muls r6, r5, r6",
    "muls r3, r1, r3",
    "muls r5, r0, r5",
    "muls r0, r1, r0",
    "movs r4, #0",
    "adds r3, r3, r5",
    "adcs r4, r4",
    "lsls r4, r4, #16",
    "adds r6, r6, r4",
    "lsls r5, r3, #16",
    "lsrs r3, r3, #16",
    "adds r0, r0, r5",
    "adcs r6, r3",
    // the highest bit to the upper end
    "bmi 1f",
    "adds r0, r0, r0",
    "adcs r6, r6",
    "b 2f",
    "1:",
    "movs r5, #1",
    "lsls r5, r5, #23",
    "adds r2, r2, r5",
    "2:",
    // the carry is the half: round it up, and back to the even number if it was just that
    "lsrs r3, r6, #8",
    "adcs r2, r3",
    "cmp r0, #0",
    "bne 3f",
    "lsls r6, r6, #24",
    "movs r3, #1",
    "lsls r3, r3, #31",
    "cmp r6, r3",
    "bne 3f",
    "lsrs r2, r2, #1",
    "lsls r2, r2, #1",
    "3:",
    "mov r0, r2",
    "pop {{r4, r5, r6, pc}}",
    "9:",
    "bl {rare}",
    "pop {{r4, r5, r6, pc}}",
    rare = sym rare_product,
);

/// A product with something special about it.
extern "C" fn rare_product(a: f32, b: f32) -> f32 {
    multiply(a.to_bits(), b.to_bits()).map_or_else(|| __mulsf3(a, b), f32::from_bits)
}

/// Whether the routine in assembler multiplies as [`multiply`] does, tried on so many pairs of
/// numbers.
pub fn multiplies(pairs: u32) -> bool {
    let mut number = super::numbers();
    (0..pairs).all(|_| {
        let (a, b) = (number(), number());
        let product = f32::from_bits(a) * f32::from_bits(b);
        multiply(a, b).is_none_or(|expected| expected == product.to_bits())
    })
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fadd(a: f32, b: f32) -> f32 {
    add(a.to_bits(), b.to_bits()).map_or_else(|| __addsf3(a, b), f32::from_bits)
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fsub(a: f32, b: f32) -> f32 {
    let minus_b = b.to_bits() ^ SIGN;
    add(a.to_bits(), minus_b).map_or_else(|| __addsf3(a, f32::from_bits(minus_b)), f32::from_bits)
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmplt(a: f32, b: f32) -> i32 {
    i32::from(less(a.to_bits(), b.to_bits()))
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmple(a: f32, b: f32) -> i32 {
    i32::from(at_most(a.to_bits(), b.to_bits()))
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmpgt(a: f32, b: f32) -> i32 {
    i32::from(less(b.to_bits(), a.to_bits()))
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmpge(a: f32, b: f32) -> i32 {
    i32::from(at_most(b.to_bits(), a.to_bits()))
}
