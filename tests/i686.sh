#!/usr/bin/env bash
# The tests of the core, the drivers and the library for C, on a 32-bit processor: that of this machine.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
target=i686-unknown-linux-gnu
links() { echo 'int main(void) { return 0; }' | cc -m32 -x c - -o /dev/null 2>/dev/null; }
if ! targets $target || ! { links || install gcc-multilib; } || ! links; then
    echo "skipped: $target: no target or no C library for it"
    exit 0
fi
log=$(mktemp)
trap 'rm -f "$log"' EXIT
cargo test --quiet --target $target -p scanseg-core -p scanseg-tests -p scanseg-hal \
    -p scanseg-capi --features scanseg-hal/link >"$log" 2>&1 || { cat "$log"; exit 1; }
echo "$target: $(awk '/^test result/ { passed += $4 } END { print passed " tests" }' "$log")"
