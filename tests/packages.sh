#!/usr/bin/env bash
# What would be published of each crate: its README, both licences, nothing that is large. Each
# builds from its package alone. Nothing is sent.
set -euo pipefail
cd "$(dirname "$0")/.."
# In the gate what is packaged is what is committed.
[ -n "${CI:-}" ] && dirty=() || dirty=(--allow-dirty)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
export CARGO_TARGET_DIR=target/packages
# Cargo takes a package for unchanged as long as its version is.
rm -rf "$CARGO_TARGET_DIR" "${CARGO_HOME:-$HOME/.cargo}"/registry/src/-*/scanseg-*

crates=()
for folder in core core/capi hal-adapter host-sim/formats host-sim/virtual-rig host-sim; do
    crate=$(sed -n 's/^name = "\(scanseg-.*\)"/\1/p' $folder/Cargo.toml)
    crates+=(-p "$crate")
    cargo package --list "${dirty[@]}" --quiet -p "$crate" >"$work/files"
    for file in README.md LICENSE-MIT LICENSE-APACHE; do
        grep -qx $file "$work/files" || { echo "$crate: no $file in the package"; exit 1; }
    done
    for file in LICENSE-MIT LICENSE-APACHE; do
        cmp $file $folder/$file
    done
done

cargo publish --dry-run --no-verify "${dirty[@]}" --quiet -p scanseg-core
cargo package "${dirty[@]}" --quiet "${crates[@]}"
for package in $CARGO_TARGET_DIR/package/*.crate; do
    bytes=$(wc -c <"$package")
    [ "$bytes" -lt 500000 ] || { echo "$package: $bytes bytes"; exit 1; }
    echo "$(basename "$package"): $(tar tf "$package" | wc -l) files, $bytes bytes, builds"
done

# The README's example and those of examples/, with what is in the package alone.
tar xf $CARGO_TARGET_DIR/package/scanseg-core-*.crate -C "$work"
(cd "$work"/scanseg-core-* && CARGO_TARGET_DIR=$work/target cargo test --quiet --doc && cargo check --quiet --examples)
echo "scanseg-core: the examples of the package build and run"
