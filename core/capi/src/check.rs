//! What is asked of every pointer and struct of the caller.

use crate::status::{SCANSEG_ERROR_ALIGNMENT, SCANSEG_ERROR_NULL, SCANSEG_ERROR_STRUCT_SIZE, Status};

/// Counts the incompatible changes of structs and functions. `scanseg_config_init` and
/// `scanseg_init` compare it with the library's.
pub const SCANSEG_ABI_VERSION: u32 = 4;

/// Whether a pointer can be used.
pub fn check_pointer<T>(pointer: *const T) -> Result<(), Status> {
    match pointer {
        p if p.is_null() => Err(SCANSEG_ERROR_NULL),
        p if !p.is_aligned() => Err(SCANSEG_ERROR_ALIGNMENT),
        _ => Ok(()),
    }
}

/// Whether a struct of the caller is the one that we know.
///
/// # Safety
/// `of` is NULL or points to as many bytes as `size`, a field of it, says; at least to that field.
pub unsafe fn check_struct<T>(of: *const T, size: *const u32) -> Result<(), Status> {
    check_pointer(of)?;
    // SAFETY: a field of a struct that is there and aligned.
    let size = unsafe { size.read() };
    if size as usize == size_of::<T>() { Ok(()) } else { Err(SCANSEG_ERROR_STRUCT_SIZE) }
}
