#!/usr/bin/env bash
# What each rule of the default is worth: correct detections (T = 0.8, %) at 0, 5 and 10 mm with the rule switched off, on
# the tuning and the validation scenes; and the recorded scans with known planes. Each line is a build of a copy of the
# sources with one constant or call changed. Some ten minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/scanseg"
git ls-files -z | tar --null -T - -cf - | tar -xf - -C "$work/scanseg"
[ -d ../shared ] && ln -s "$(cd ../shared && pwd)" "$work/shared"
export CARGO_TARGET_DIR=$work/target
copy=$work/scanseg

line() { # name
    local out
    out=$(cd "$copy" && cargo run --release --quiet -p scanseg-sim --example quality default)
    printf '%-44s' "$1"
    awk '$1 == "default" {printf " %6s", $4} /mean best/ {printf " %6s", $6} /correct at/ {printf "  %s/%s", $2, $4} END {print ""}' <<<"$out"
}
without() { # name file sed-expression
    cp "$copy/$2" "$work/kept"
    sed -i -E "$3" "$copy/$2"
    cmp -s "$copy/$2" "$work/kept" && { echo "$1: nothing to change in $2"; exit 1; }
    line "$1"
    cp "$work/kept" "$copy/$2"
}

printf '%-44s %20s %20s %13s %s\n' "" "tuning 0/5/10 mm" "validation" "corridor" "synpeb"
line "the default"
c=core/src
without "leaving a plane costs nothing" $c/follow.rs 's/^(const LEAVE: f32 =).*/\1 0.0;/'
without "beams are where they are said to be" $c/follow.rs 's/^(const BEAM_RAD2: f32 =).*/\1 0.0;/'
without "only the pixel straight above is followed" $c/follow.rs 's/start\.saturating_sub\(1\)\.max\(from\) - from, \(stop \+ 1\)\.min/start.max(from) - from, stop.min/'
without "least noise 0.5 mm instead of 2 mm" $c/plane_segmenter.rs 's/^(const LEAST_NOISE_M: f32 =).*/\1 0.0005;/'
without "lines of three pixels up, not of two" $c/piece.rs 's/end - begin > 1/end - begin > 2/'
without "neighbours do not join" $c/plane_segmenter.rs 's/^( *)join_neighbours\(&mut.*/\1let _ = join_neighbours::<S>;/'
without "nothing joins across a gap" $c/plane_segmenter.rs 's/^ *self\.surfaces\.bridge\(.*//'
without "no join within the noise, by chance only" $c/surface.rs 's/^(const BENT: f64 =).*/\1 -1e9;/'
without "large areas that bend do not join" $c/surface.rs 's/^(const BEND_STEP: f32 =).*/\1 0.0;/'
without "the turn is what the encoder says" $c/turn.rs 's/^(const GAIN: f32 =).*/\1 1e9;/'
