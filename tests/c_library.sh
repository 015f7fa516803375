#!/usr/bin/env bash
# The library for C and C++: built, linked, run, and compared with the command. See core/capi.
set -euo pipefail
cd "$(dirname "$0")/.."
. tests/tools.sh
root=$PWD
capi=$root/core/capi
out=$root/target/c-library
lib=$out/lib
rm -rf "$out/run"
mkdir -p "$out/run"
cd "$out/run"

quiet() { # runs a command, shows what it says if it fails
    "$@" >"$out/run/log" 2>&1 || { cat "$out/run/log"; echo "failed: $*"; exit 1; }
}

# what the parts below want, and do without where it cannot be had
missing=()
for tool in g++ clang valgrind cmake make pkg-config qemu-system-arm arm-none-eabi-gcc; do
    have $tool || missing+=("${tool/arm-none-eabi-gcc/gcc-arm-none-eabi}")
done
[ ${#missing[@]} = 0 ] || install "${missing[@]}" || echo "skipped: could not be installed: ${missing[*]}"
# the sanitizers' run-time, which comes apart
sanitizes() { echo 'int main(void) { return 0; }' | $1 -fsanitize=address,undefined -x c - -o /dev/null 2>/dev/null; }
! have clang || sanitizes clang || install "libclang-rt-$(clang -dumpversion | cut -d. -f1)-dev" || true

(cd "$root" && quiet cargo test --quiet -p scanseg-capi-tests --features header)
echo "the header is that of the crate"

"$capi/build.sh" "$lib"

# nothing but our names goes out, and of C nothing but copying comes in: not even `abort`, for there is no panic
names=$(nm -g --defined-only "$lib/libscanseg.a" | awk 'NF == 3 { print $3 }')
others=$(grep -v '^scanseg_' <<<"$names" || true)
[ -n "$names" ] && [ -z "$others" ] || { echo "exported: $others"; exit 1; }
wanted=$(nm -u "$lib/libscanseg.a" | awk '$1 == "U" { print $2 }' | sort | tr '\n' ' ')
[ "$wanted" = "memcpy memset " ] || { echo "wanted from C: $wanted"; exit 1; }
if [ "$(uname)" = Linux ]; then
    dynamic=$(nm -D --defined-only "$lib/libscanseg.so" | awk '{ print $3 }' | sort)
    [ "$dynamic" = "$(sort <<<"$names")" ] || { echo "exported by libscanseg.so: $dynamic"; exit 1; }
fi
echo "exported: $(wc -l <<<"$names") functions scanseg_*; wanted from C: $wanted"

c="-std=c99 -g -O1 -Wall -Wextra -pedantic -Werror"
cxx="-std=c++17 -g -O1 -Wall -Wextra -pedantic -Werror -fno-exceptions -fno-rtti"
built=0
for cc in gcc clang; do
    have $cc && have ${cc/gcc/g}++ || { echo "skipped: $cc is not here"; continue; }
    kinds=("" -asan)
    if ! sanitizes $cc; then
        echo "skipped: $cc has no AddressSanitizer here"
        kinds=("")
    fi
    for kind in "${kinds[@]}"; do
        [ -z "$kind" ] && sanitize="" || sanitize="-fsanitize=address,undefined -fno-sanitize-recover=all"
        # shellcheck disable=SC2086
        {
            quiet $cc $c $sanitize -I"$capi/include" "$capi/tests/smoke.c" "$lib/libscanseg.a" -o smoke-$cc$kind
            quiet $cc $c $sanitize -I"$capi/include" "$capi/examples/wall.c" "$lib/libscanseg.a" -lm -o wall-$cc$kind
            quiet $cc $c $sanitize -I"$capi/include" "$capi/examples/segment_pgm.c" "$lib/libscanseg.a" -lm \
                -o segment_pgm-$cc$kind
            quiet ${cc/gcc/g}++ $cxx $sanitize -I"$capi/include" "$capi/examples/organised_cloud.cpp" \
                "$lib/libscanseg.a" -o organised_cloud-$cc$kind
            quiet ${cc/gcc/g}++ ${cxx/-fno-exceptions -fno-rtti/-DSCANSEG_EXCEPTIONS} $sanitize -I"$capi/include" \
                "$capi/tests/smoke.cpp" "$lib/libscanseg.a" -o smoke_cpp-$cc$kind
        }
        for program in smoke smoke_cpp organised_cloud wall; do
            quiet "./$program-$cc$kind"
        done
        [[ $(cat log) = "10860 pixels, 2.000 m away, normal -1.000"* ]] || { cat log; echo "not the wall"; exit 1; }
    done
    built=$((built + 1))
    echo "$cc: built without warnings; runs${kinds[1]+, also with AddressSanitizer}"
done
[ $built -gt 0 ] || { echo "skipped: no C compiler"; exit 0; }

if have valgrind; then
    for program in {smoke,smoke_cpp,organised_cloud}-{gcc,clang}; do
        [ -x $program ] || continue
        quiet valgrind --error-exitcode=9 --leak-check=full ./$program
    done
    echo "valgrind: no errors"
else
    echo "skipped: valgrind is not here"
fi

# Installed, and found by CMake and by pkg-config.
if have cmake && have g++; then
    prefix=$out/run/prefix
    # with what is built already
    mkdir -p "$out/cmake"
    [ -e "$out/cmake/cargo" ] || cp -a "$lib/cargo" "$out/cmake/cargo"
    quiet cmake -S "$capi" -B "$out/cmake" -DCMAKE_INSTALL_PREFIX="$prefix"
    quiet cmake --build "$out/cmake"
    quiet cmake --install "$out/cmake"
    quiet cmake -S "$capi/examples" -B examples -DCMAKE_PREFIX_PATH="$prefix"
    quiet cmake --build examples
    quiet examples/organised_cloud
    shared() { ldd "$1" | grep "libscanseg.so.[0-9]* => $prefix/" >/dev/null; }
    if [ "$(uname)" = Linux ]; then
        quiet examples/organised_cloud_shared
        shared examples/organised_cloud_shared || { echo "scanseg::shared is not used"; exit 1; }
        ! shared examples/organised_cloud || { echo "scanseg::scanseg is not static"; exit 1; }
    fi
    echo "find_package(scanseg): found, linked, runs, static and shared"
    if have pkg-config && have make; then
        mkdir make
        cp "$capi"/examples/{Makefile,*.c,*.cpp} make
        pc=$(dirname "$(find "$prefix" -name scanseg.pc)")
        PKG_CONFIG_PATH=$pc quiet make -C make
        export LD_LIBRARY_PATH=${pc%/pkgconfig}
        quiet make/organised_cloud
        [ "$(uname)" != Linux ] || shared make/organised_cloud || { echo "pkg-config: not the shared library"; exit 1; }
        unset LD_LIBRARY_PATH
        echo "pkg-config and make: found, linked, runs"
    else
        echo "skipped: pkg-config or make is not here"
    fi
else
    echo "skipped: cmake is not here"
fi

# Without an operating system or a C library.
board="-std=c99 -Os -Wall -Wextra -pedantic -Werror -ffreestanding -nostdlib -mcpu=cortex-m4 -I$capi/include
    -T $capi/examples/bare_metal/mps2_an386.ld $capi/examples/bare_metal/main.c"
rust_lld=$(rustc --print sysroot)/lib/rustlib/$(rustc -vV | sed -n 's/^host: //p')/bin/gcc-ld/ld.lld
if ! targets thumbv7em-none-eabihf; then
    echo "skipped: rustup does not give thumbv7em-none-eabihf"
else
    "$capi/build.sh" "$lib-thumbv7em" thumbv7em-none-eabihf
    # shellcheck disable=SC2086
    {
        ! have arm-none-eabi-gcc || quiet arm-none-eabi-gcc -mfloat-abi=hard -mfpu=fpv4-sp-d16 $board \
            "$lib-thumbv7em/libscanseg.a" -o board-gcc.elf
        ! { have clang && [ -x "$rust_lld" ]; } || quiet clang --target=thumbv7em-none-eabihf --ld-path="$rust_lld" $board \
            "$lib-thumbv7em/libscanseg.a" -o board-clang.elf
    }
    for cc in gcc clang; do
        [ -f board-$cc.elf ] || { echo "skipped: bare metal: $cc for Arm is not here"; continue; }
        have qemu-system-arm || { echo "skipped: qemu-system-arm is not here; board-$cc.elf was linked"; continue; }
        quiet timeout 60 qemu-system-arm -M mps2-an386 -nographic -semihosting-config enable=on,target=native \
            -kernel board-$cc.elf
        grep '^approach' log | sed "s/^/Cortex-M4F, $cc: /"
    done
fi

# The labels of the C example are those of the command.
(cd "$root" && cargo build --release --quiet -p scanseg-sim && cargo build --quiet -p scanseg-tests --example same_labels)
target=$(cd "$root" && realpath "${CARGO_TARGET_DIR:-target}")
scanseg=$target/release/scanseg
scan=$root/../shared/data/tilting-sick-corridor/scan000.range_mm.pgm
geometry=$root/../shared/data/tilting-sick-corridor/geometry.toml
if [ ! -f "$scan" ]; then
    echo "skipped: ../shared/data is not here; a simulated office in its place"
    "$scanseg" office --scene 0 --noise-m 0.005 --out "$out/run/office" >/dev/null
    scan=$out/run/office/tuning-00.pgm
    geometry=$out/run/office/geometry.toml
fi
number() { sed -n "s/^$1 = \([-0-9.e]*\).*/\1/p" "$geometry"; }
angle() { sed -n "s/^$1 = {.*$2 = \([-0-9.e]*\).*/\1/p" "$geometry"; }
settings="unit_m=$(number unit_m) beam_start_deg=$(angle beam_deg start) beam_step_deg=$(angle beam_deg step)
    turn_start_deg=$(angle turn_deg start) turn_step_deg=$(angle turn_deg step)"
for limit in range_noise_m min_range_m max_range_m; do
    value=$(number $limit)
    settings="$settings ${value:+$limit=$value}"
done
for count in $(sed -n 's/^no_return = \[\(.*\)\].*/\1/p' "$geometry" | tr , ' '); do
    settings="$settings no_return=$count"
done
approach=0
for name in plane edge region; do
    "$scanseg" segment "$scan" --geometry "$geometry" --approach $name --out "$out/run/$name" >/dev/null
    for program in segment_pgm-*; do
        # shellcheck disable=SC2086
        quiet "./$program" "$scan" "$name.pgm" $settings approach=$approach
        same=$("$target/debug/examples/same_labels" "$out/run/$name/labels.png" "$out/run/$name.pgm") ||
            { echo "$program, $name: $same"; exit 1; }
    done
    if have valgrind; then
        # shellcheck disable=SC2086
        quiet valgrind --error-exitcode=9 --leak-check=full "./$(ls segment_pgm-* | grep -v asan | head -1)" "$scan" \
            "$name.pgm" $settings approach=$approach
    fi
    echo "labels of the C example and of the command, $name: $same"
    approach=$((approach + 1))
done
