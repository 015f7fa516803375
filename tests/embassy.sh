#!/usr/bin/env bash
# Builds the images on embassy for their boards, and prints what they take of flash and memory. The linker fails where an
# image does not fit. QEMU has neither board; tests/firmware.sh runs their loop there, on another one.
set -euo pipefail
cd "$(dirname "$0")/../hal-adapter/embassy"
. ../../tests/tools.sh
# of its own, so that it does not wait for other checks, nor they for it
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-../../target}/embassy

skip() { echo "skipped: images on embassy: $*"; exit 0; }
targets thumbv7em-none-eabihf thumbv8m.main-none-eabihf || skip "rustup has no targets"
cargo fetch --quiet --locked 2>/dev/null || skip "their crates could not be downloaded"

cargo clippy --release --quiet --locked -- -D warnings
image() { # name target
    cargo build --quiet --locked --release --bin "$1" --features "$1" --target "$2"
    size "$CARGO_TARGET_DIR/$2/release/$1" | {
        read -r _
        read -r text data bss _
        echo "$1: $((text + data)) bytes of flash, $((data + bss)) bytes of memory without the stack"
    }
}
image stm32f407 thumbv7em-none-eabihf
image rp2350 thumbv8m.main-none-eabihf
