#!/usr/bin/env bash
# Licences, sources and duplicates of all dependencies, by cargo-deny and deny.toml. Of the fuzz
# targets, the firmware, the images on embassy, the package for Python and the page, which are workspaces of their own,
# licences and sources.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
cargo_command cargo-deny 0.20.2 || { echo "skipped: no cargo-deny, and it could not be installed"; exit 0; }
cargo deny --locked check bans licenses sources
for workspace in fuzz hal-adapter/embassy hal-adapter/firmware host-sim/python host-sim/web; do
    cargo deny --locked --manifest-path $workspace/Cargo.toml --config deny.toml check licenses sources
done
