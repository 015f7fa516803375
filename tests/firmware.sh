#!/usr/bin/env bash
# Builds the images for the microcontrollers, runs them in QEMU with a recorded scan on their serial ports, compares what
# they send with the same chain on this host, byte for byte, and prints what they cost. Fails where anything differs or
# passes a ceiling.
# Takes the targets from rustup; where that has none, Debian's rustc-web and rust-web-src.
set -euo pipefail
cd "$(dirname "$0")/../hal-adapter/firmware"
. ../../tests/tools.sh
# what the simulator needs is built already, for the other tests
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/../../target}

build=(cargo build)
compiler=rustc
if targets thumbv6m-none-eabi thumbv7em-none-eabihf; then
    cargo clippy --quiet --workspace --exclude scanseg-firmware --all-targets -- -D warnings
    # as the images are built, so that their macros are built once
    for framework in rtic embassy; do
        cargo clippy --release --quiet --bin $framework --features $framework --target thumbv7em-none-eabihf -- -D warnings
    done
    for features in "" region plane figures defmt; do
        cargo clippy --release --quiet --bin mps2 --features "$features" --target thumbv7em-none-eabihf -- -D warnings
        cargo clippy --release --quiet --bin microbit --features "$features" --target thumbv6m-none-eabi -- -D warnings
    done
elif install rustc-web cargo-web rust-web-src lld; then
    compiler=/usr/bin/rustc
    build=(env RUSTC_BOOTSTRAP=1 RUSTC=/usr/bin/rustc CARGO_TARGET_THUMBV6M_NONE_EABI_LINKER=ld.lld
        CARGO_TARGET_THUMBV7EM_NONE_EABIHF_LINKER=ld.lld /usr/bin/cargo build -Zbuild-std=core)
else
    echo "no bare-metal targets: neither rustup nor Debian's packages gave them"
    exit 1
fi
CARGO_PROFILE_RELEASE_LTO=off cargo test --quiet --release -p m0-float -p small-memory # two crates: nothing to gain by LTO

images=$(mktemp -d)
trap 'rm -rf "$images"' EXIT
mkdir "$images/tape"
cargo run --quiet -p firmware-check -- --tape "$images/tape"
export SCANSEG_TAPE=$images/tape
image() { # name target features file
    local profile=release
    case $2,$3 in thumbv6m-*,plane*) profile=small ;; esac
    "${build[@]}" --quiet --profile $profile --bin "$1" --target "$2" --features "$3"
    cp "$CARGO_TARGET_DIR/$2/$profile/$1" "$images/$4"
}
for features in defmt figures region,figures plane,figures region plane ""; do
    suffix=${features:+-${features/,/-}}
    image mps2 thumbv7em-none-eabihf "$features" "mps2$suffix"
    image microbit thumbv6m-none-eabi "$features" "microbit$suffix"
done
for framework in rtic embassy; do
    image $framework thumbv7em-none-eabihf $framework $framework
done
# each beam at its own turn
image mps2 thumbv7em-none-eabihf turns,figures mps2-turns
image mps2 thumbv7em-none-eabihf plane,turns,figures mps2-plane-turns
# scenes that make much work, for the dearest row
mkdir "$images/hard"
cargo run --quiet -p firmware-check -- --tape "$images/hard" hard
SCANSEG_TAPE=$images/hard image mps2 thumbv7em-none-eabihf plane,figures mps2-plane-hard
echo "images build, with a log over a probe (defmt) as well"

# A panic is a bug, and none is there: neither in the core nor in the drivers.
for image in mps2 microbit; do
    for approach in "" -region -plane; do
        left=$(nm -C "$images/$image$approach" | sed -n 's/.* core::panicking:://p' | sort -u | tr '\n' ' ')
        [ -z "$left" ] || { echo "$image$approach: panic routines linked: $left"; exit 1; }
    done
done
echo "no panic routine linked into any image ($($compiler --version))"

if ! have qemu-system-arm && ! install qemu-system-arm; then
    echo "skipped: running the images (qemu-system-arm could not be installed)"
    exit 0
fi
qemu-system-arm --version | head -n 1
cargo run --quiet -p firmware-check -- "$images"
