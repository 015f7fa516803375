#!/usr/bin/env bash
# Builds the core and the drivers for bare-metal targets. Takes the targets from rustup; where that has none, Debian's
# rustc-web and rust-web-src, which build the standard library's core from source.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
triples="thumbv6m-none-eabi thumbv7em-none-eabihf riscv32imc-unknown-none-elf"
build() { # cargo and its flags
    for target in $triples; do
        for package in "scanseg-core" "scanseg-hal" "scanseg-hal --features link"; do
            # shellcheck disable=SC2086
            "$@" build --quiet -p $package --target "$target"
            echo "$package for $target: good"
        done
    done
}
# shellcheck disable=SC2086
if targets $triples; then
    export CARGO_PROFILE_DEV_OPT_LEVEL=0 # what does not build does not build either way
    build cargo
elif install rustc-web cargo-web rust-web-src lld; then
    export RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc CARGO_TARGET_DIR=target/debian
    build /usr/bin/cargo -Zbuild-std=core
else
    echo "no bare-metal targets: neither rustup nor Debian's packages gave them"
    exit 1
fi
