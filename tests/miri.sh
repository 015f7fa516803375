#!/usr/bin/env bash
# Under Miri, at reduced sizes. The library for C, which has `unsafe`, on a 32-bit processor: nothing undefined, nothing
# misaligned, no overflow. Core and drivers, which forbid `unsafe`, on a 64-bit one whose bytes lie the other way round: their own
# tests, those of telegrams and link among them, and a few goldens, at least one of each approach. How references alias cannot go
# wrong without `unsafe`, and is not followed there. Not on x86, where libm has assembly that Miri cannot run.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
if ! cargo +nightly miri --version >/dev/null 2>&1 &&
    ! alone rustup toolchain install nightly --profile minimal --component miri --component rust-src; then
    echo "skipped: Miri could not be installed"
    exit 0
fi
export MIRIFLAGS="-Zmiri-strict-provenance -Zmiri-symbolic-alignment-check"
# Tests leak the memory that they lend for ever; the core and the drivers allocate none.
MIRIFLAGS+=" -Zmiri-ignore-leaks"
# Few cases of each property, and no file in which proptest keeps those that failed.
MIRIFLAGS+=" -Zmiri-env-set=PROPTEST_CASES=3 -Zmiri-env-set=PROPTEST_DISABLE_FAILURE_PERSISTENCE=1"
log=$(mktemp)
trap 'rm -f "$log"' EXIT
miri() { # target, then what to test
    timeout 15m cargo +nightly miri test --target-dir target/miri --target "$@" >"$log" 2>&1 ||
        { tail -n 40 "$log"; echo "failed, or not done in a quarter of an hour"; exit 1; }
    echo "$*: $(awk '/^test result/ { passed += $4; ignored += $8 } END { print passed " tests, " ignored " left out" }' "$log")"
}
miri armv7-unknown-linux-gnueabihf -p scanseg-capi --tests
MIRIFLAGS+=" -Zmiri-disable-stacked-borrows"
miri s390x-unknown-linux-gnu -p scanseg-core -p scanseg-hal --features scanseg-hal/link --tests
miri s390x-unknown-linux-gnu -p scanseg-tests --test all -- corner join_of_a_u
