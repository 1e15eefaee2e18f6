#!/bin/sh
# What the rules that keep the bits the same cost in speed: copies of the sources that break one rule each, built and run
# beside the build as it is. CSV on standard output: build, ns per particle and step (the least of all
# repetitions: what else a machine does only adds), ratio to the first, hash.
# The copies accept any floating-point environment, or they would refuse to run. Pinned to one core, the builds in turn.
#
#   bench/rules.sh [REPETITIONS] [STEPS]
set -eu
repetitions=${1:-7} steps=${2:-200}
cd "$(dirname "$0")/.."
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
pin=
command -v taskset >/dev/null && pin="taskset -c 0"

# variant NAME OPTIONS SCRIPT: a copy of the sources, meson.build changed by a sed script.
variant() {
    name=$1 options=$2 script=$3
    mkdir "$work/$name"
    cp -r meson.build meson_options.txt include src bench tests "$work/$name"
    sed -i "$script" "$work/$name/meson.build"
    if [ "$name" != as_it_is ]; then
        printf '%s\n' '#include "core/environment.h"' 'rheo_result rheo__check_environment(rheo_error *error)' \
            '{' '(void)error;' 'return RHEO_OK;' '}' >"$work/$name/src/core/environment.c"
        printf '%s\n' '#include <float.h>' >"$work/$name/src/core/strict.h"
    fi
    # shellcheck disable=SC2086
    if ! { meson setup "$work/$name/build" "$work/$name" -Dtests=disabled -Djson=disabled $options &&
        ninja -C "$work/$name/build" rheolog; } >"$work/$name/log" 2>&1; then
        tail -n 20 "$work/$name/log" >&2
        exit 1
    fi
    names="$names $name"
}
names=
variant as_it_is "" ""
variant scalar_kernels_alone "-Dlanes=scalar" ""
variant native "-Dc_args=-march=native" ""
variant native_contracted "-Dc_args=-march=native" "s/'-ffp-contract=off'/'-ffp-contract=fast'/"
# Not-a-number pads vectors, so that -ffast-math whole never ends.
variant native_fast_math "-Dc_args=-march=native" "s/'-ffp-contract=off'/'-ffast-math', '-fno-finite-math-only'/"
variant double "-Dreal=double" ""

# The fluid with its history, from one settled state, which each build loads by itself.
number() { sed -n "s/.*\"$1\": \"\{0,1\}\([0-9a-f.]*\).*/\1/p" | head -n 1; }
for real in float double; do
    build=as_it_is
    [ $real = float ] || build=double
    "$work/$build/build/rheolog" run bowling-ball --steps 0 -o "$work/$real.rlog" --quiet >/dev/null
done
repetition=0
while [ $repetition -lt "$repetitions" ]; do
    for name in $names; do
        real=float
        [ "$name" != double ] || real=double
        line=$($pin "$work/$name/build/rheolog" run --from "$work/$real.rlog" --steps "$steps" --json --quiet || true)
        echo "$name $(echo "$line" | sed 's/"stages".*//' | number ns_per_particle_step) $(echo "$line" | number hash)" >>"$work/out"
    done
    repetition=$((repetition + 1))
done
echo "build,ns_per_particle_step,ratio,hash"
for name in $names; do
    grep "^$name " "$work/out" | sort -k2,2n | awk 'NR == 1 { print $2, $3 }' |
        sed "s/^/$name /"
done | awk 'NR == 1 { first = $2 } { printf "%s,%.1f,%.3f,%s\n", $1, $2, $2 / first, $3 }'
