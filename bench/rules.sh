#!/bin/sh
# Cost of the determinism rules: builds copies of the sources that break one rule each, and runs them in turn with the unchanged
# build, pinned to one core. Prints CSV: build, ns per particle and step, ratio to the first, hash. The time is the minimum of
# all repetitions, because other load only adds to it. The copies skip the check of the floating-point environment, which would
# refuse them.
#
#   bench/rules.sh [REPETITIONS] [STEPS]
set -eu
repetitions=${1:-7} steps=${2:-200}
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pin=
command -v taskset >/dev/null && pin="taskset -c 0"

# variant NAME OPTIONS SCRIPT: builds a copy of the sources whose meson.build a sed script has changed.
variant() {
    name=$1 options=$2 script=$3
    mkdir "$work/$name"
    cp -r meson.build meson_options.txt include src bench docs tests ./*.md CITATION.cff LICENSE "$work/$name"
    sed -i "$script" "$work/$name/meson.build"
    if [ "$name" != unchanged ]; then
        printf '%s\n' '#include "core/environment.h"' 'rheo_result rheo__check_environment(rheo_error *error)' \
            '{' '(void)error;' 'return RHEO_OK;' '}' >"$work/$name/src/core/environment.c"
        printf '%s\n' '#include <float.h>' >"$work/$name/src/core/strict.h"
    fi
    # shellcheck disable=SC2086
    program=rheolog
    [ "$name" != double ] || program=rheolog-double
    if ! { meson setup "$work/$name/build" "$work/$name" -Dtests=disabled -Djson=disabled $options &&
        ninja -C "$work/$name/build" $program; } >"$work/$name/log" 2>&1; then
        tail -n 20 "$work/$name/log" >&2
        exit 1
    fi
    mv "$work/$name/build/$program" "$work/$name/program"
    names="$names $name"
}
names=
variant unchanged "" ""
variant scalar_only "-Dlanes=scalar" ""
variant native "-Dc_args=-march=native" ""
variant native_contracted "-Dc_args=-march=native" "s/'-ffp-contract=off'/'-ffp-contract=fast'/"
# Lanes are padded with NaN, so the program would never end with the whole of -ffast-math.
variant native_fast_math "-Dc_args=-march=native" "s/'-ffp-contract=off'/'-ffast-math', '-fno-finite-math-only'/"
variant double "-Dreal=double" ""

# Every build loads the same settled state and runs the fluid with its history.
number() { sed -n "s/.*\"$1\": \"\{0,1\}\([0-9a-f.]*\).*/\1/p" | head -n 1; }
for real in float double; do
    build=unchanged
    [ $real = float ] || build=double
    "$work/$build/program" run bowling-ball --steps 0 -o "$work/$real.rlog" --quiet >/dev/null
done
repetition=0
while [ $repetition -lt "$repetitions" ]; do
    for name in $names; do
        real=float
        [ "$name" != double ] || real=double
        line=$($pin "$work/$name/program" run --from "$work/$real.rlog" --steps "$steps" --json --quiet || true)
        echo "$name $(echo "$line" | sed 's/"stages".*//' | number ns_per_particle_step) $(echo "$line" | number hash)" >>"$work/out"
    done
    repetition=$((repetition + 1))
done
echo "build,ns_per_particle_step,ratio,hash"
for name in $names; do
    grep "^$name " "$work/out" | sort -k2,2n | awk 'NR == 1 { print $2, $3 }' |
        sed "s/^/$name /"
done | awk 'NR == 1 { first = $2 } { printf "%s,%.1f,%.3f,%s\n", $1, $2, $2 / first, $3 }'
