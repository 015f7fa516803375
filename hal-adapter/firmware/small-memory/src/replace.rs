//! The routines that compiled code calls, by the names that the Arm run-time ABI gives them. Those for 4 and 8 bytes of
//! alignment are the same.

use super::{copy, fill};

// SAFETY (all): these are the names, types and results that the ABI gives these routines; the
// compiler's are weak. What they may touch the caller says, as for `copy` and `fill`.

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy(to: *mut u8, from: *const u8, bytes: usize) {
    // SAFETY: see above
    unsafe { copy(to, from, bytes) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy4(to: *mut u8, from: *const u8, bytes: usize) {
    // SAFETY: see above
    unsafe { __aeabi_memcpy(to, from, bytes) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memcpy8(to: *mut u8, from: *const u8, bytes: usize) {
    // SAFETY: see above
    unsafe { __aeabi_memcpy(to, from, bytes) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memset(to: *mut u8, bytes: usize, value: i32) {
    // SAFETY: see above
    unsafe { fill(to, bytes, value as u8) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memset4(to: *mut u8, bytes: usize, value: i32) {
    // SAFETY: see above
    unsafe { __aeabi_memset(to, bytes, value) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memclr4(to: *mut u8, bytes: usize) {
    // SAFETY: see above
    unsafe { __aeabi_memset(to, bytes, 0) }
}

#[unsafe(no_mangle)]
unsafe extern "C" fn __aeabi_memclr8(to: *mut u8, bytes: usize) {
    // SAFETY: see above
    unsafe { __aeabi_memset(to, bytes, 0) }
}
