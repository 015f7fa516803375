#!/usr/bin/env bash
# The package for Python: its wheel is built, installed into an environment that is thrown away, and
# tested there; labels are compared with those of the command.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python_in "$work/env" || exit 0
get numpy pytest mypy maturin || { echo "skipped: the packages of PyPI could not be installed"; exit 0; }
# Of the examples, whose tests say "no NAME" where one is missing. Open3D's 1.2 GB are left out.
get gtsam || echo "skipped: gtsam could not be installed"
get ouster-sdk || echo "skipped: ouster-sdk could not be installed"
get distributed mcap-ros2-support || echo "skipped: distributed could not be installed"

# With what the other steps have built.
CARGO_TARGET_DIR=$(realpath -m "${CARGO_TARGET_DIR:-target}")
export CARGO_TARGET_DIR
cargo build --quiet -p scanseg-sim --features db3,ros2
"$work/env/bin/maturin" build --quiet --profile dev -m host-sim/python/Cargo.toml -i "$python" \
    --out "$work/wheel"
get "$work"/wheel/scanseg-*-abi3-*.whl || { echo "the wheel cannot be installed"; exit 1; }
cd host-sim/python
SCANSEG=$CARGO_TARGET_DIR/debug/scanseg "$python" -m pytest --quiet -p no:cacheprovider -rs | sed 's/^SKIPPED /skipped: /'
"$work/env/bin/mypy" --strict --cache-dir "$work/mypy" python
"$python" -m mypy.stubtest scanseg._scanseg
