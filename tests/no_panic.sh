#!/usr/bin/env bash
# Shows that the core cannot panic: the library for C, with all three segmenters behind it, is linked for bare metal with all
# of its functions kept, and no panic routine is left. As a control, a function that can panic goes the same way.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
out=$PWD/target/no-panic
triples="thumbv6m-none-eabi thumbv7em-none-eabihf riscv32imc-unknown-none-elf"
lld=$(rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/gcc-ld/ld.lld
[ -x "$lld" ] || { echo "skipped: this Rust brings no linker"; exit 0; }
# shellcheck disable=SC2086
targets $triples || { echo "skipped: rustup does not give the targets"; exit 0; }

functions() { nm -g --defined-only "$1" 2>/dev/null | awk 'NF == 3 && $3 ~ /^scanseg_/ { print $3 }' | sort -u; }
panics() { # archive, target: the panic routines that are linked with its functions
    local names emulation=armelf
    mapfile -t names < <(functions "$1")
    case $2 in riscv*) emulation=elf32lriscv ;; esac
    "$lld" -m $emulation --gc-sections --entry=0 "${names[@]/#/--undefined=}" "$1" -o "$out/image"
    nm "$out/image" | grep -o 'core9panicking.*' || true
}
mkdir -p "$out"
cat >"$out/control.rs" <<'RUST'
#![no_std]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! { loop {} }
#[unsafe(no_mangle)]
pub extern "C" fn scanseg_control(i: usize) -> u8 { [1, 2, 3][i] }
RUST
for target in $triples; do
    rustc --edition 2024 -O -C panic=abort --crate-type staticlib --target "$target" "$out/control.rs" -o "$out/control.a"
    [ -n "$(panics "$out/control.a" "$target")" ] || { echo "$target: the control should panic"; exit 1; }
    core/capi/build.sh "$out/$target" "$target"
    archive=$out/$target/libscanseg.a
    count=$(functions "$archive" | wc -l)
    [ "$count" -gt 10 ] || { echo "$target: the library's functions are not found"; exit 1; }
    left=$(panics "$archive" "$target")
    [ -z "$left" ] || { echo "$target: can panic: $left"; exit 1; }
    echo "$target: $count functions, no panic"
done
rustc --version
