#!/usr/bin/env bash
# Instructions per point of the whole core (ranges to planes), counted by callgrind: of all approaches on the simulated
# office at three sizes; of the default on recorded scans (../shared/data, where it is at hand) and on scenes that make much
# work, at 452 and 1808 columns; and, where the OpenCV program is at hand (../shared/peers/opencv, libopencv-dev), of the
# edges and of that program on its own scenes.
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
per_point() { # arguments of the program but for the last: the difference of one run and none leaves the core alone
    local points none one
    points=$("$cost" "$@" 1 | cut -d ' ' -f 1)
    none=$(counted "$cost" "$@" 0)
    one=$(counted "$cost" "$@" 1)
    awk -v n="$points" -v d=$((one - none)) 'BEGIN {printf "%.1f", d / n}'
}

echo "instructions per point, segments and planes included (callgrind, $(rustc --version | cut -d' ' -f1,2))"
printf '%-24s %10s %10s %10s\n' "simulated office" "default" "edges" "regions"
values=()
by_region=()
by_plane=()
for size in "200 361 nodding" "480 640 spinning" "1024 2048 spinning"; do
    set -- $size
    "$cost" make "$1" "$2" "$3" "$work/scene"
    value=$(per_point run "$work/scene" "$3" edge)
    values+=("$value")
    regions=$(per_point run "$work/scene" "$3" region)
    by_region+=("$regions")
    planes=$(per_point run "$work/scene" "$3" plane)
    by_plane+=("$planes")
    printf '%-24s %10s %10s %10s\n' "$2 x $1, $3" "$planes" "$value" "$regions"
done
awk -v a="${values[0]}" -v b="${values[1]}" -v c="${values[2]}" \
    -v d="${by_region[0]}" -v e="${by_region[1]}" -v f="${by_region[2]}" \
    -v p="${by_plane[0]}" -v q="${by_plane[1]}" -v r="${by_plane[2]}" 'BEGIN {
    if (c > 1.1 * b || c > 1.1 * a) { print "cost per point grows with the image"; exit 1 }
    if (a > 115 || b > 90 || c > 90) { print "cost per point above its ceiling (115, 90, 90)"; exit 1 }
    if (p > 270 || q > 185 || r > 135) { print "default: cost per point above its ceiling (270, 185, 135)"; exit 1 }
    if (f > 1.1 * d || d > 280 || e > 240 || f > 190) { print "regions: cost per point above its ceiling (280, 240, 190)"; exit 1 }
}'

# The cost as scans grow, for the page of `scanseg experiment`: the committed record, which UPDATE=1 writes anew.
record=host-sim/src/experiment/instructions.csv
counted=$work/instructions.csv
echo "method,rows,columns,instructions per point" >"$counted"
for size in "75 135" "110 198" "160 289" "233 421" "340 614" "496 896" "723 1305"; do
    set -- $size
    "$cost" make "$1" "$2" nodding "$work/scene"
    for method in plane:default edge:edge-based region:region-based; do
        echo "${method#*:},$1,$2,$(per_point run "$work/scene" nodding "${method%:*}")" >>"$counted"
    done
done
[ -z "${UPDATE:-}" ] || cp "$counted" "$record"
awk -F, 'NR == FNR {known[$1, $2] = $4; next}
    FNR > 1 && !(known[$1, $2] && $4 < 1.05 * known[$1, $2] && known[$1, $2] < 1.05 * $4) {print "not on record: " $0; wrong = 1}
    END {exit wrong}' "$record" "$counted" || { echo "$record is not of this core: UPDATE=1 bash tests/instructions.sh"; exit 1; }
echo "$record holds"

good=true
within() { # value ceiling scene
    awk -v value="$1" -v most="$2" 'BEGIN {exit value > most}' || { echo "$3: above its ceiling ($2)"; good=false; }
}
data=../shared/data
printf '%-60s %10s\n' "recorded scans" "default"
while IFS='|' read -r geometry image most name; do
    if [ ! -e "$data/$image" ]; then
        echo "skipped: $name (no $data/$image)"
        continue
    fi
    value=$(per_point recorded "$data/$geometry" "$data/$image" plane)
    printf '%-60s %10s\n' "$name" "$value"
    within "$value" "$most" "$name"
done <<'SCANS'
tilting-sick-corridor/geometry.toml|tilting-sick-corridor/scan000.range_mm.pgm|635|corridor, SICK LMS 200 on a tilt, 360 x 226
office1-kinect/geometry.toml|office1-kinect/office1.depth_mm.pgm|372|office, Kinect v1, 640 x 480
ouster-os0/geometry.toml|ouster-os0/range.pgm|727|street, Ouster OS0-128, 1024 x 128
SCANS

printf '%-60s %10s %10s\n' "scenes that make much work, 60 rows" "452" "1808"
while IFS='|' read -r scene most name; do
    values=()
    for columns in 452 1808; do
        values+=("$(per_point hard "$scene" "$columns" plane)")
    done
    printf '%-60s %10s %10s\n' "$name" "${values[@]}"
    within "${values[0]}" "$most" "$name, 452 columns"
    within "${values[1]}" "$most" "$name, 1808 columns"
    awk -v few="${values[0]}" -v many="${values[1]}" 'BEGIN {exit many > 1.25 * few}' ||
        { echo "$name: cost per point grows with the columns"; good=false; }
done <<'SCENES'
vegetation|1465|vegetation: leaves of 5 x 3 pixels at 2 to 8 m, gaps at 12 m
combs|1125|combs: strips of three columns at 2 m and 4 m in turn
chess-board|485|chess-board: a return at 2 m in every second pixel
noise|2000|noise alone: each pixel anywhere from 1 to 5 m
third|310|a wall at 3 m whose noise is stated at a third
SCENES
$good

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
        ours=$(per_point run "$work/scenes/$1_lo.bin" "$3" edge)
        # the peer counts only its frames, two of them
        theirs=$(valgrind --tool=callgrind --instr-atstart=no --callgrind-out-file=/dev/null \
            "$work/peer/build/ocv_callgrind" "$work/scenes/$1_lo.bin" fused 2 1 callg 2>&1 |
            awk -v n="$2" '/Collected/ {printf "%.1f", $4 / 2 / n}')
        printf '%-24s %10s %10s\n' "$1, $3" "$ours" "$theirs"
    done
else
    echo "skipped: the C++ peer (no $peer, or libopencv-dev could not be installed)"
fi
