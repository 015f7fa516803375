#!/usr/bin/env bash
# Runs every fuzz target for some seconds (20), from the committed seeds on: `tests/fuzz.sh [SECONDS]`. A find fails, and is left in
# fuzz/artifacts. What is new goes to fuzz/corpus, which longer runs start from as well: see fuzz/README.md.
set -euo pipefail
cd "$(dirname "$0")/../fuzz"
seconds=${1:-20}

skip() { echo "skipped: $*"; exit 0; }
# Instrumented builds want a nightly compiler.
cargo +nightly --version >/dev/null 2>&1 || rustup toolchain install nightly --profile minimal >/dev/null 2>&1 ||
    skip "fuzzing: no nightly Rust, and it could not be installed"
cargo fuzz --version >/dev/null 2>&1 || cargo install cargo-fuzz --locked >/dev/null 2>&1 ||
    skip "fuzzing: no cargo-fuzz, and it could not be installed"

cargo fmt --check
cargo +nightly fuzz build

found=0
printf '\n%-12s %12s %9s %9s %9s %7s\n' target executions a_second edges features seeds
for target in $(cargo fuzz list); do
    mkdir -p "corpus/$target"
    log=$(mktemp)
    # The files that are read may ask for no more memory than in proportion to their length.
    if cargo +nightly fuzz run "$target" "corpus/$target" "seeds/$target" -- -max_total_time="$seconds" -max_len=2048 \
        -len_control=10 -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=64 -print_final_stats=1 >"$log" 2>&1; then
        # #94808 DONE   cov: 3875 ft: 19321 corp: 1280/36Kb lim: 43 exec/s: 5925 rss: 456Mb
        read -r executions edges features a_second < <(sed -n \
            's/^#\([0-9]*\)\tDONE *cov: \([0-9]*\) ft: \([0-9]*\) .*exec\/s: \([0-9]*\) .*/\1 \2 \3 \4/p' "$log")
        printf '%-12s %12s %9s %9s %9s %7s\n' "$target" "$executions" "$a_second" "$edges" "$features" \
            "$(find "seeds/$target" -type f | wc -l)"
    else
        found=1
        echo "$target: a find"
        grep -a -A 12 -E 'panicked at|ERROR: |SUMMARY' "$log" | cut -c 1-400 || tail -n 40 "$log"
        grep -a 'Test unit written' "$log" || true
    fi
    rm -f "$log"
done
exit $found
