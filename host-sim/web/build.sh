#!/usr/bin/env bash
# Builds the page that runs the core in the browser: static files for any file server.
#
#     bash host-sim/web/build.sh OUT
#
# Needs cargo alone. What is drawn with three.js is bundled in ../src/view/view.min.js; after a change of
# view/ or of package.json: npm ci && npm run build.
set -euo pipefail
out=$(mkdir -p "${1:?usage: build.sh OUT}" && cd "$1" && pwd)
cd "$(dirname "$0")"
export CARGO_TARGET_DIR=${CARGO_TARGET_DIR:-$PWD/../../target}
rustup target add wasm32-unknown-unknown >/dev/null 2>&1 || true
cargo build --quiet --locked --release --target wasm32-unknown-unknown
cp page/index.html page/page.js page/page.css ../src/style.css ../src/view/view.min.js "$out"
# packed, because not every file server packs it
gzip -9nc "$CARGO_TARGET_DIR/wasm32-unknown-unknown/release/scanseg_web.wasm" >"$out/scanseg.wasm.gz"
echo "$out: $(cat "$out"/{index.html,page.js,page.css,style.css,view.min.js,scanseg.wasm.gz} | wc -c) bytes"
