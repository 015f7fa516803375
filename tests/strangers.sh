#!/usr/bin/env bash
# Files of other programs' writers are read, and what we write is read by other programs: tests/strangers.py and
# tests/strangers_captures.py. Topics of running programs likewise: tests/ros2.py. With packages of PyPI in an
# environment that is thrown away.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
have python3 || { echo "skipped: no python3"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
alone python3 -m venv "$work/env" || { install python3-venv && alone python3 -m venv "$work/env"; } ||
    { echo "skipped: no virtual environment of Python"; exit 0; }
"$work/env/bin/pip" install --quiet --disable-pip-version-check --no-cache-dir \
    numpy plyfile pye57 pypcd4 mcap-ros2-support rosbags >/dev/null 2>&1 ||
    { echo "skipped: the packages of PyPI could not be installed"; exit 0; }
# 1.2 GB
"$work/env/bin/pip" install --quiet --disable-pip-version-check --no-cache-dir open3d >/dev/null 2>&1 ||
    echo "without open3d, which could not be installed"
cargo build --quiet -p scanseg-sim --features db3,ros2
"$work/env/bin/python" tests/strangers.py "${CARGO_TARGET_DIR:-target}/debug/scanseg" "$work"
if "$work/env/bin/pip" install --quiet --disable-pip-version-check --no-cache-dir cyclonedds >/dev/null 2>&1; then
    "$work/env/bin/python" tests/ros2.py "${CARGO_TARGET_DIR:-target}/debug/scanseg"
else
    echo "skipped: topics of ROS 2: cyclonedds could not be installed from PyPI"
fi
# takes an older rosbags along
"$work/env/bin/pip" install --quiet --disable-pip-version-check --no-cache-dir ouster-sdk >/dev/null 2>&1 ||
    echo "without ouster-sdk, which could not be installed"
mkdir "$work/captures"
"$work/env/bin/python" -W ignore tests/strangers_captures.py "${CARGO_TARGET_DIR:-target}/debug/scanseg" "$work/captures"
