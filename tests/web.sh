#!/usr/bin/env bash
# The page that runs the core, in a headless Chromium: host-sim/web/test.mjs. PICTURES=FOLDER keeps
# what it looks like.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
target=${CARGO_TARGET_DIR:-$PWD/target}
targets wasm32-unknown-unknown || { echo "skipped: the target wasm32-unknown-unknown could not be installed"; exit 0; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
CARGO_TARGET_DIR=$target bash host-sim/web/build.sh "$work/page"
[ "$(cat "$work"/page/* | wc -c)" -lt 1000000 ] || { echo "the page has a megabyte or more"; exit 1; }
have node && have npm || install nodejs npm || { echo "skipped: no npm"; exit 0; }
cp -r host-sim/web "$work/web"
mkdir -p "$work/src/view"
(cd "$work/web" && rm -rf node_modules && npm ci --silent --no-audit --no-fund >/dev/null 2>&1) ||
    { echo "skipped: the packages of npm could not be installed"; exit 0; }
(cd "$work/web" && npm run --silent build >/dev/null 2>&1)
cmp host-sim/src/view/view.min.js "$work/src/view/view.min.js" ||
    { echo "host-sim/src/view/view.min.js is not what \`npm run build\` makes"; exit 1; }
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome || true)
[ -n "$browser" ] || { install chromium && browser=$(command -v chromium); } || { echo "skipped: no chromium"; exit 0; }
cargo build --quiet -p scanseg-sim --features db3,ros2 # as other checks do
scanseg() { "$target/debug/scanseg" "$@" >/dev/null; }
scanseg demo --out "$work/demo" --write pcd
for approach in edge region; do
    scanseg demo --out "$work/$approach" --write pcd --approach $approach
done
scanseg segment "$work/demo/points.pcd" --out "$work/cloud" --write pcd
mkdir "$work/bin"
ln -s "$(command -v true)" "$work/bin/xdg-open" # opens nothing
PATH=$work/bin:$PATH scanseg segment "$work/demo/scan.pgm" --geometry "$work/demo/geometry.toml" --out "$work/view" --open
cd "$work/web"
node test.mjs "$work/page" "$work" "$browser" ${PICTURES:+"$PICTURES"}
