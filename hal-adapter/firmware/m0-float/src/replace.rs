//! The routines that compiled code calls, by the names that the Arm run-time ABI gives them.

use super::{SIGN, add, at_most, less, multiply};

unsafe extern "C" {
    // the compiler's own
    safe fn __addsf3(a: f32, b: f32) -> f32;
    safe fn __mulsf3(a: f32, b: f32) -> f32;
}

// SAFETY (all): these are the names, types and results that the ABI gives these routines; the compiler's are weak.

#[unsafe(no_mangle)]
extern "C" fn __aeabi_fmul(a: f32, b: f32) -> f32 {
    multiply(a.to_bits(), b.to_bits()).map_or_else(|| __mulsf3(a, b), f32::from_bits)
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
