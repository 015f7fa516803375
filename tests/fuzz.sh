#!/usr/bin/env bash
# Runs every fuzz target for some seconds (20), one on each processor, from the committed seeds on:
# `tests/fuzz.sh [SECONDS [SEED]]`. Without a SEED it takes another way each time; the seed is printed, and leads the same way
# again. A find fails, and is left in fuzz/artifacts. What is new goes to fuzz/corpus, from which the next run starts as well: see
# fuzz/README.md.
set -euo pipefail
cd "$(dirname "$0")/../fuzz"
. ../tests/tools.sh
seconds=${1:-20}
seed=${2:-$((RANDOM * 32768 + RANDOM + 1))}

skip() { echo "skipped: $*"; exit 0; }
# Instrumented builds want a nightly compiler.
toolchain nightly || skip "fuzzing: no nightly Rust, and it could not be installed"
cargo_command cargo-fuzz 0.13.2 || skip "fuzzing: no cargo-fuzz, and it could not be installed"

# Those with `unsafe`, and those whose inputs claim memory, run under AddressSanitizer. For the others it would only take
# time, and so would tracing every comparison: fuzz/README.md.
flags() { # target
    case $1 in
    capi | files | captures | clouds) ;;
    *) echo "--sanitizer none --no-trace-compares --no-default-features" ;;
    esac
}

for target in $(cargo fuzz list); do
    # shellcheck disable=SC2046 # several words
    cargo +nightly fuzz build $(flags "$target") "$target"
done

run() { # target
    local target=$1 log executions edges features a_second
    # a new target has no seeds yet
    mkdir -p "corpus/$target" "seeds/$target"
    log=$(mktemp)
    # What files claim must not make their readers take much more memory than they are long.
    # shellcheck disable=SC2046 # several words
    if cargo +nightly fuzz run $(flags "$target") "$target" "corpus/$target" "seeds/$target" -- -seed="$seed" -entropic=0 \
        -max_total_time="$seconds" -max_len=2048 -len_control=10 -timeout=10 -rss_limit_mb=1024 -malloc_limit_mb=64 \
        >"$log" 2>&1; then
        # #94808 DONE   cov: 3875 ft: 19321 corp: 1280/36Kb lim: 43 exec/s: 5925 rss: 456Mb
        read -r executions edges features a_second < <(sed -n \
            's/^#\([0-9]*\)\tDONE *cov: \([0-9]*\) ft: \([0-9]*\) .*exec\/s: \([0-9]*\) .*/\1 \2 \3 \4/p' "$log")
        printf '%-12s %12s %9s %9s %9s\n' "$target" "$executions" "$a_second" "$edges" "$features"
        rm "$log"
    else
        echo "$target: a find"
        grep -a -A 12 -E 'panicked at|ERROR: |SUMMARY' "$log" | cut -c 1-400 || tail -n 40 "$log"
        grep -a 'Test unit written' "$log" || true
        return 1
    fi
}

printf '\nseed %s\n%-12s %12s %9s %9s %9s\n' "$seed" target executions a_second edges features
found=0 running=0
for target in $(cargo fuzz list); do
    if [ $running = "$(nproc)" ]; then
        wait -n || found=1
        running=$((running - 1))
    fi
    run "$target" &
    running=$((running + 1))
done
while [ $running -gt 0 ]; do
    wait -n || found=1
    running=$((running - 1))
done
exit $found
