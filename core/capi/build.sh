#!/usr/bin/env bash
# Builds the library for C into a folder: libscanseg.a, and on Linux libscanseg.so, a link to libscanseg.so.N of the ABI version N.
#
#     build.sh OUT [TARGET] [CPU]     TARGET: a Rust target such as thumbv7em-none-eabihf; CPU: as of rustc's target-cpu
#
# The library has no run-time and cannot panic: it asks for memcpy and memset of C, and nothing else. For bare metal the archive also
# holds the compiler's arithmetic (division of 64 bits, floating point in software), for linkers that bring none.
# CARGO_PROFILE_CAPI_OPT_LEVEL=s makes it smaller, and slower.
set -euo pipefail
out=$1
target=${2:-}
cpu=${3:-generic}
mkdir -p "$out"
out=$(cd "$out" && pwd)
cd "$(dirname "$0")"
abi=$(sed -n 's/^#define SCANSEG_ABI_VERSION //p' include/scanseg.h)
host=$(rustc -vV | sed -n 's/^host: //p')
target=${target:-$host}
[ "$cpu" = generic ] && flags="" || flags="-Ctarget-cpu=$cpu"
built=$out/cargo/$target/capi
# Without the standard library, and a panic ends the program. Not in a Cargo.toml: a package's own
# profiles do not count within a workspace, nor a workspace's in a package.
profile=()
for setting in 'inherits="release"' 'panic="abort"' 'lto="fat"' 'codegen-units=1' 'debug=false'; do
    profile+=(--config "profile.capi.$setting")
done
build() { # crate type, what rustc is told beside
    local types=$1
    shift
    RUSTFLAGS=$flags cargo rustc --quiet "${profile[@]}" --profile capi --package scanseg-capi --no-default-features \
        --crate-type "$types" --target "$target" --target-dir "$out/cargo" -- "$@"
}
case $target in
*-none-*)
    build staticlib
    cp "$built/libscanseg_capi.a" "$out/libscanseg.a"
    ;;
*)
    case $target in
    *-linux-*) build staticlib,cdylib -C "link-arg=-Wl,-soname,libscanseg.so.$abi" ;;
    *) build staticlib ;;
    esac
    # without the compiler's arithmetic, which C's linker has: it would get between a program and its libm
    rm -rf "$out/objects" "$out/libscanseg.a"
    mkdir "$out/objects"
    (cd "$out/objects" && ar x "$built/libscanseg_capi.a" && ar rcs "$out/libscanseg.a" scanseg_capi*.o)
    rm -rf "$out/objects"
    if [ -f "$built/libscanseg_capi.so" ]; then
        cp "$built/libscanseg_capi.so" "$out/libscanseg.so.$abi"
        ln -sf "libscanseg.so.$abi" "$out/libscanseg.so"
    fi
    ;;
esac
