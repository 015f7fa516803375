//! The tests are run with overflow checks.

use std::hint::black_box;

#[test]
#[cfg_attr(not(debug_assertions), ignore = "optimised for release")]
fn overflow_is_found() {
    let sum = std::panic::catch_unwind(|| black_box(u8::MAX) + black_box(1));
    assert!(sum.is_err(), "sums go round in silence");
}
