//! The routines that compiled code calls, by the names that the Arm run-time ABI gives them.

use core::arch::global_asm;

use super::{SIGN, add, at_most, divide, less, multiply, rare};

extern "C" fn rare_product(a: u32, b: u32) -> u32 {
    rare::multiply(a, b)
}

extern "C" fn rare_sum(a: u32, b: u32) -> u32 {
    rare::add(a, b)
}

// SAFETY (all): these are the names, types and results that the ABI gives these routines; the
// compiler's are weak.

// `multiply` by hand: the compiler keeps too few of its values in registers. Some 52 instructions
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
    // significands: 16 bits each in r3 and r5, and 8 bits in r0 and r1
    "movs r6, #1",
    "lsls r6, r6, #31",
    "lsls r3, r0, #8",
    "orrs r3, r6",
    "lsrs r3, r3, #16",
    "uxtb r0, r0",
    "lsls r5, r1, #8",
    "orrs r5, r6",
    "lsrs r5, r5, #16",
    "uxtb r1, r1",
    // r6 * 2^16 + r4 * 2^8 + r0 = r0 * r1: two products of 24 bits have room for their sum
    "mov r6, r3",
    "muls r6, r5, r6",
    "mov r4, r0",
    "muls r4, r5, r4",
    "muls r3, r1, r3",
    "adds r4, r4, r3",
    "muls r0, r1, r0",
    "lsrs r1, r0, #8",
    "adds r4, r4, r1",
    "lsrs r1, r4, #8",
    "adds r6, r6, r1",
    // the highest bit to the upper end
    "bmi 1f",
    "adds r6, r6, r6",
    "b 2f",
    "1:",
    "movs r5, #1",
    "lsls r5, r5, #23",
    "adds r2, r2, r5",
    "2:",
    // the carry is the half: round it up, and back to the even number if it was just that
    "lsrs r3, r6, #8",
    "adcs r2, r3",
    "lsls r3, r6, #25",
    "bne 3f",
    "lsrs r6, r6, #8",
    "bcc 3f",
    "lsls r4, r4, #24",
    "bne 3f",
    "lsls r0, r0, #24",
    "bne 3f",
    "lsrs r2, r2, #1",
    "lsls r2, r2, #1",
    "3:",
    "mov r0, r2",
    "pop {{r4, r5, r6, pc}}",
    // with a zero
    "9:",
    "cmp r2, #255",
    "beq 8f",
    "cmp r3, #255",
    "beq 8f",
    "lsls r4, r0, #1",
    "beq 7f",
    "lsls r4, r1, #1",
    "bne 8f",
    "7:",
    "eors r0, r1",
    "lsrs r0, r0, #31",
    "lsls r0, r0, #31",
    "pop {{r4, r5, r6, pc}}",
    "8:",
    "bl {rare}",
    "pop {{r4, r5, r6, pc}}",
    rare = sym rare_product,
);

// `add` by hand, for the same reason: some 45 instructions instead of 80.
global_asm!(
    ".section .text.__aeabi_fadd, \"ax\", %progbits",
    ".global __aeabi_fsub",
    ".type __aeabi_fsub, %function",
    ".thumb_func",
    "__aeabi_fsub:",
    "movs r2, #1",
    "lsls r2, r2, #31",
    "eors r1, r2",
    ".global __aeabi_fadd",
    ".type __aeabi_fadd, %function",
    ".thumb_func",
    "__aeabi_fadd:",
    // the larger one to r0
    "lsls r2, r0, #1",
    "lsls r3, r1, #1",
    "cmp r2, r3",
    "bhs 1f",
    "mov r12, r0",
    "mov r0, r1",
    "mov r1, r12",
    "mov r12, r2",
    "mov r2, r3",
    "mov r3, r12",
    "1:",
    // exponents
    "lsrs r3, r3, #24",
    "beq 8f",
    "lsrs r2, r2, #24",
    "cmp r2, #255",
    "beq 9f",
    "push {{r4, r5}}",
    // the smaller significand, with seven bits below
    "movs r5, #1",
    "lsls r5, r5, #31",
    "lsls r4, r1, #8",
    "orrs r4, r5",
    "lsrs r4, r4, #1",
    "subs r3, r2, r3",
    // sign: whether the signs differ
    "eors r1, r0",
    "cmp r3, #7",
    "bhi 6f",
    "lsrs r4, r3",
    "2:",
    // the larger one
    "lsls r3, r0, #8",
    "orrs r3, r5",
    "lsrs r3, r3, #1",
    "cmp r1, #0",
    "bmi 4f",
    "adds r3, r3, r4",
    "bmi 3f",
    "5:",
    // sign and exponent, below which the significand is added
    "ands r0, r5",
    "subs r2, #1",
    "lsls r2, r2, #23",
    "orrs r0, r2",
    // the carry is the half: round it up, and back to the even number if it was just that
    "lsrs r2, r3, #7",
    "adcs r0, r2",
    "lsls r3, r3, #25",
    "cmp r3, r5",
    "beq 7f",
    "pop {{r4, r5}}",
    "bx lr",
    "7:",
    "lsrs r0, r0, #1",
    "lsls r0, r0, #1",
    "pop {{r4, r5}}",
    "bx lr",
    // one place more; infinite if there is none
    "3:",
    "adds r2, #1",
    "cmp r2, #255",
    "beq 31f",
    "movs r4, #1",
    "ands r4, r3",
    "lsrs r3, r3, #1",
    "orrs r3, r4",
    "b 5b",
    "31:",
    "lsls r2, r2, #23",
    "ands r0, r5",
    "orrs r0, r2",
    "pop {{r4, r5}}",
    "bx lr",
    // the difference, moved to the upper end
    "4:",
    "subs r3, r3, r4",
    "beq 43f",
    "lsls r4, r3, #1",
    "bmi 5b",
    "41:",
    "lsrs r4, r3, #22",
    "bne 42f",
    "lsls r3, r3, #8",
    "subs r2, #8",
    "b 41b",
    "42:",
    "subs r2, #1",
    "lsls r3, r3, #1",
    "lsls r4, r3, #1",
    "bpl 42b",
    "cmp r2, #0",
    "bgt 5b",
    "eors r1, r0",
    "pop {{r4, r5}}",
    "b 9f",
    "43:",
    "movs r0, #0",
    "pop {{r4, r5}}",
    "bx lr",
    // far below: what is lost must not be forgotten
    "6:",
    "cmp r3, #31",
    "bhi 61f",
    "mov r12, r4",
    "lsrs r4, r3",
    "mov r5, r4",
    "lsls r5, r3",
    "cmp r5, r12",
    "beq 62f",
    "movs r5, #1",
    "orrs r4, r5",
    "62:",
    "movs r5, #1",
    "lsls r5, r5, #31",
    "b 2b",
    "61:",
    "movs r4, #1",
    "b 2b",
    // with a zero; two negative ones are negative
    "8:",
    "lsls r3, r1, #1",
    "bne 9f",
    "lsrs r3, r2, #24",
    "cmp r3, #255",
    "beq 9f",
    "cmp r2, #0",
    "bne 81f",
    "ands r0, r1",
    "81:",
    "bx lr",
    "9:",
    "push {{r4, lr}}",
    "bl {rare}",
    "pop {{r4, pc}}",
    rare = sym rare_sum,
);

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fdiv(a: f32, b: f32) -> f32 {
    let (a, b) = (a.to_bits(), b.to_bits());
    f32::from_bits(divide(a, b).unwrap_or_else(|| rare::divide(a, b)))
}

/// Whether the routines in assembler compute what [`multiply`] and [`add`] do, tried on so many
/// pairs of numbers.
pub fn is_right(pairs: u32) -> bool {
    let mut number = super::numbers();
    (0..pairs).all(|_| {
        let (a, b) = (number(), number());
        let (x, y) = (f32::from_bits(a), f32::from_bits(b));
        let same = |expected: u32, got: f32| expected == got.to_bits();
        let [product, sum, difference] = [multiply(a, b), add(a, b), add(a, b ^ SIGN)];
        same(product.unwrap_or_else(|| rare::multiply(a, b)), x * y)
            && same(sum.unwrap_or_else(|| rare::add(a, b)), x + y)
            && same(difference.unwrap_or_else(|| rare::add(a, b ^ SIGN)), x - y)
    })
}

// the two below are these with both numbers the other way round: in 0.2 KB less
#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmplt(a: f32, b: f32) -> i32 {
    i32::from(less(a.to_bits(), b.to_bits()))
}

#[inline(never)]
#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmple(a: f32, b: f32) -> i32 {
    i32::from(at_most(a.to_bits(), b.to_bits()))
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmpgt(a: f32, b: f32) -> i32 {
    __aeabi_fcmplt(b, a)
}

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fcmpge(a: f32, b: f32) -> i32 {
    __aeabi_fcmple(b, a)
}
