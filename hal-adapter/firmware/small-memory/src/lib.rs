//! Copying and filling of memory, in 0.2 KB of flash in place of the compiler's 1.5 KB.
//!
//! A row copies and fills some kilobytes, so that speed hardly counts. `use small_memory as _;` in a program puts the
//! routines in place: the linker prefers them to the compiler's.
#![cfg_attr(not(test), no_std)]
// else the compiler makes a call of `memcpy` of a loop that copies
#![no_builtins]

#[cfg(target_os = "none")]
mod replace;

/// Copies bytes.
///
/// # Safety
/// `to` is valid for writes of so many bytes and `from` for reads, and they do not overlap.
#[inline(never)]
pub unsafe fn copy(to: *mut u8, from: *const u8, bytes: usize) {
    let mut at = 0;
    // SAFETY: all that is read and written lies within `bytes`, and is aligned
    unsafe {
        if (to.addr() | from.addr()).is_multiple_of(4) {
            while bytes - at >= 4 {
                to.add(at).cast::<u32>().write(from.add(at).cast::<u32>().read());
                at += 4;
            }
        }
        while at < bytes {
            to.add(at).write(from.add(at).read());
            at += 1;
        }
    }
}

/// Fills bytes.
///
/// # Safety
/// `to` is valid for writes of so many bytes.
#[inline(never)]
pub unsafe fn fill(to: *mut u8, bytes: usize, value: u8) {
    let word = u32::from(value) * 0x0101_0101;
    let mut at = 0;
    // SAFETY: all that is written lies within `bytes`, and is aligned
    unsafe {
        if to.addr().is_multiple_of(4) {
            while bytes - at >= 4 {
                to.add(at).cast::<u32>().write(word);
                at += 4;
            }
        }
        while at < bytes {
            to.add(at).write(value);
            at += 1;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[repr(align(4))]
    struct Aligned([u8; 80]);

    /// Of all lengths and alignments, and nothing beside.
    #[test]
    fn as_slices() {
        let from = Aligned(core::array::from_fn(|i| i as u8 + 1));
        for (start, other, bytes) in (0..5).flat_map(|a| (0..5).flat_map(move |b| (0..70).map(move |n| (a, b, n)))) {
            let (mut to, mut expected) = (Aligned([0; 80]), [0; 80]);
            // SAFETY: all of it lies within 80 bytes
            unsafe { copy(to.0.as_mut_ptr().add(start), from.0.as_ptr().add(other), bytes) };
            expected[start..start + bytes].copy_from_slice(&from.0[other..other + bytes]);
            assert_eq!(to.0, expected);
            // SAFETY: as above
            unsafe { fill(to.0.as_mut_ptr().add(start), bytes, 0xA5) };
            expected[start..start + bytes].fill(0xA5);
            assert_eq!(to.0, expected);
        }
    }
}
