//! What happens should the core ever panic, where there is no standard library: the program ends.

/// Ends the program.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end()
}

/// With an operating system: as C's `abort`.
#[cfg(not(target_os = "none"))]
fn end() -> ! {
    unsafe extern "C" {
        fn abort() -> !;
    }
    // SAFETY: C's own, always there, no condition.
    unsafe { abort() }
}

/// Without one: an instruction that no processor has, so that the board's fault handler takes over.
#[cfg(target_os = "none")]
fn end() -> ! {
    // SAFETY: it does not return, and touches nothing.
    #[cfg(target_arch = "arm")]
    unsafe {
        core::arch::asm!("udf #0", options(noreturn, nomem, nostack))
    }
    // SAFETY: as above.
    #[cfg(any(target_arch = "riscv32", target_arch = "riscv64"))]
    unsafe {
        core::arch::asm!("unimp", options(noreturn, nomem, nostack))
    }
    #[cfg(not(any(target_arch = "arm", target_arch = "riscv32", target_arch = "riscv64")))]
    loop {
        core::hint::spin_loop();
    }
}
