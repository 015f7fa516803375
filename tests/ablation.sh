#!/usr/bin/env bash
# What each rule of the default is worth: correct detections (T = 0.8, %) at 0, 5 and 10 mm with the
# rule switched off, on the tuning and the validation scenes; and the recorded scans with known
# planes, where ../shared/data is there: of the corridor the mean of 16 draws of half a millimetre of noise. One to five minutes.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo build --release --quiet -p scanseg-sim --example quality
[ -d ../shared/data ] || echo "skipped: recorded scans (no ../shared/data)"

line() { # name, then rules that are changed: RULE=NUMBER
    printf '%-44s' "$1"
    "${CARGO_TARGET_DIR:-target}/release/examples/quality" default "${@:2}" | awk '
        $1 == "default" { printf " %6s", $4 }
        /on average/ { printf " %6s", $3 }
        /correct at/ { printf "  %s/%s", $2, $4 }
        END { print "" }'
}

printf '%-44s %20s %20s %13s %s\n' "" "tuning 0/5/10 mm" "validation" "corridor" "synpeb"
line "the default"
line "leaving a plane costs nothing" leave_price=0
line "beams are where they are said to be" least_beam_rad=0
line "least noise 0.5 mm instead of 1.5 mm" least_noise_m=0.0005
line "lines and joins do not go across missing pixels" gap_columns=0
line "areas are followed however rough they are" rough=1e9
line "nothing joins across a gap" gap_points=4294967295
line "pieces join whatever lies between" hidden=0
line "no join within the noise, by chance only" bent=-1e9
line "surfaces are as flat as the noise is said to be" uneven=0
line "areas that join are no rougher than the noise" rougher=1
line "large areas that bend do not join" bend_step=0
line "seams of the servo part areas" seam_rad=0
line "the turn is what the encoder says" turn_gain=1e9
line "the noise is what it is said to be" noise_trust=1e9
