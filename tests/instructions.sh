#!/usr/bin/env bash
# Instructions per point of the whole core (bearing angles to planes), counted by callgrind, at three sizes; and, where the
# OpenCV program is at hand (../shared/peers/opencv, libopencv-dev), the same for it on its own scenes.
# Fails where the cost per point grows with the image or passes its ceiling.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
have valgrind || install valgrind || { echo "skipped: no valgrind, and it could not be installed"; exit 0; }
cargo build --release --quiet -p scanseg-sim --example cost
cost=${CARGO_TARGET_DIR:-target}/release/examples/cost
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

counted() { # command...: instructions of the whole run
    valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 >/dev/null | awk '/Collected/ {print $4}'
}
per_point() { # points file kind approach: the difference of two runs and one leaves the core alone
    local one two
    one=$(counted "$cost" run "$2" "$3" "$4" 1)
    two=$(counted "$cost" run "$2" "$3" "$4" 2)
    awk -v n="$1" -v d=$((two - one)) 'BEGIN {printf "%.1f", d / n}'
}

echo "instructions per point, segments and planes included (callgrind, $(rustc --version | cut -d' ' -f1,2))"
printf '%-24s %10s %10s %10s\n' "simulated office" "default" "edges" "regions"
values=()
by_region=()
by_plane=()
for size in "200 361 nodding" "480 640 spinning" "1024 2048 spinning"; do
    set -- $size
    "$cost" make "$1" "$2" "$3" "$work/scene"
    value=$(per_point $(($1 * $2)) "$work/scene" "$3" edge)
    values+=("$value")
    regions=$(per_point $(($1 * $2)) "$work/scene" "$3" region)
    by_region+=("$regions")
    planes=$(per_point $(($1 * $2)) "$work/scene" "$3" plane)
    by_plane+=("$planes")
    printf '%-24s %10s %10s %10s\n' "$2 x $1, $3" "$planes" "$value" "$regions"
done
awk -v a="${values[0]}" -v b="${values[1]}" -v c="${values[2]}" \
    -v d="${by_region[0]}" -v e="${by_region[1]}" -v f="${by_region[2]}" \
    -v p="${by_plane[0]}" -v q="${by_plane[1]}" -v r="${by_plane[2]}" 'BEGIN {
    if (c > 1.1 * b || c > 1.1 * a) { print "cost per point grows with the image"; exit 1 }
    if (a > 115 || b > 90 || c > 90) { print "cost per point above its ceiling (115, 90, 90)"; exit 1 }
    if (r > 1.1 * p || p > 2.5 * a || q > 2.5 * b || r > 2.5 * c) { print "default: more than 2.5 times the edges"; exit 1 }
    if (f > 1.1 * d || d > 280 || e > 240 || f > 190) { print "regions: cost per point above its ceiling (280, 240, 190)"; exit 1 }
}'

peer=../shared/peers/opencv
opencv() { pkg-config --exists opencv4 2>/dev/null; }
if [ -d "$peer" ] && { opencv || { install pkg-config libopencv-dev g++ && opencv; }; }; then
    cp -r "$peer" "$work/peer"
    chmod -R u+w "$work/peer"
    bash "$work/peer/build.sh" 2>/dev/null
    mkdir "$work/scenes"
    "$work/peer/build/gen_scenes" "$work/scenes" >/dev/null
    printf '%-24s %10s %10s\n' "scenes of the peer" "scanseg" "C++ OpenCV"
    for scene in "361x200 72200 nodding" "640x480 307200 spinning" "2048x1024 2097152 spinning"; do
        set -- $scene
        ours=$(per_point "$2" "$work/scenes/$1_lo.bin" "$3" edge)
        # the peer counts only its frames, two of them
        theirs=$(valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null \
            "$work/peer/build/ocv_callgrind" "$work/scenes/$1_lo.bin" fused 2 1 callg 2>&1 |
            awk -v n="$2" '/Collected/ {printf "%.1f", $4 / 2 / n}')
        printf '%-24s %10s %10s\n' "$1, $3" "$ours" "$theirs"
    done
else
    echo "skipped: the C++ peer (no $peer, or libopencv-dev could not be installed)"
fi
