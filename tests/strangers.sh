#!/usr/bin/env bash
# Files of other programs' writers are read, and what we write is read by other programs: tests/strangers.py and
# tests/strangers_captures.py. Topics of running programs likewise: tests/ros2.py. With packages of PyPI in an
# environment that is thrown away.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
python_in "$work/env" || exit 0
get numpy plyfile pye57 pypcd4 mcap-ros2-support rosbags ||
    { echo "skipped: the packages of PyPI could not be installed"; exit 0; }
# 1.2 GB
get open3d || echo "without open3d, which could not be installed"
cargo build --quiet -p scanseg-sim --features db3,ros2
"$python" tests/strangers.py "${CARGO_TARGET_DIR:-target}/debug/scanseg" "$work"
if get cyclonedds; then
    "$python" tests/ros2.py "${CARGO_TARGET_DIR:-target}/debug/scanseg"
else
    echo "skipped: topics of ROS 2: cyclonedds could not be installed from PyPI"
fi
# takes an older rosbags along
get ouster-sdk ||
    echo "without ouster-sdk, which could not be installed"
mkdir "$work/captures"
"$python" -W ignore tests/strangers_captures.py "${CARGO_TARGET_DIR:-target}/debug/scanseg" "$work/captures"
