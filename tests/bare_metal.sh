#!/usr/bin/env bash
# Builds the core and the drivers for bare-metal targets. Takes the targets from rustup; where that has none, Debian's
# rustc-web and rust-web-src, which build the standard library's core from source.
set -euo pipefail
cd "$(dirname "$0")/.."
targets="thumbv6m-none-eabi thumbv7em-none-eabihf riscv32imc-unknown-none-elf"
build() { # cargo and its flags
    for target in $targets; do
        for package in scanseg-core scanseg-hal; do
            "$@" build --quiet --release -p "$package" --target "$target"
            echo "$package for $target: good"
        done
    done
}
# shellcheck disable=SC2086
if rustup target add $targets >/dev/null 2>&1; then
    build cargo
elif { apt-get update && apt-get install -y rustc-web cargo-web rust-web-src lld; } >/dev/null 2>&1; then
    export RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc CARGO_TARGET_DIR=target/debian
    build /usr/bin/cargo -Zbuild-std=core
else
    echo "no bare-metal targets: neither rustup nor Debian's packages gave them"
    exit 1
fi
