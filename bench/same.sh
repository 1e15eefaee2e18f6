#!/bin/sh
# Measures the rung `statistics` of `rheolog same` (docs/same.md): the smallest change of each parameter that is found with 20 and
# with 30 members, the false alarms, and what they cost. Takes some minutes of one processor.
#
#   bench/same.sh PROGRAM [SCENE RESOLUTION STEPS PARAMETER...]
set -eu
export LC_ALL=C
[ $# -ge 1 ] || { echo "usage: bench/same.sh PROGRAM [SCENE RESOLUTION STEPS PARAMETER...]" >&2; exit 2; }
program=$(realpath "$1")
scene=${2:-bowling-ball-small} resolution=${3:-0.5} steps=${4:-200}
[ $# -lt 4 ] || shift 3
shift
[ $# -gt 0 ] || set -- gravity fluid.stiffness fluid.near_stiffness fluid.linear_viscosity springs.stiffness \
    springs.plasticity history.stiffness history.onset
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
ladder='0.01 0.02 0.05 0.1 0.2 0.5 1 2 5 10 20 50 100'

# The value of a parameter in the recording, changed by $2 percent; of a vector, its second component.
changed() {
    "$program" info "$work/20.rlog" --json |
        sed -n "s/.*\"parameters\": {.*\"$1\": \(\[[-0-9.e]*, \)*\([-0-9.e]*\)[],}].*/\2/p" |
        awk -v p="$2" -v vector="$([ "$1" != gravity ] || echo yes)" \
            '{ printf vector ? "[0, %.9g, 0]" : "%.9g", $1 * (1 + p / 100) }'
}

# Whether a change of parameter $1 by $2 percent is found with $3 members.
found() {
    value=$(changed "$1" "$2")
    status=0
    "$program" same "$work/$3.rlog" --members "$3" --set "$1=$value" --quiet >"$work/out" 2>"$work/error" || status=$?
    [ "$status" -le 1 ] || { cat "$work/error" >&2; exit 1; }
    [ "$status" = 1 ]
}

# The first percentage of the ladder that is found, by halving; all larger ones are taken to be found.
smallest() {
    low=0 high=$(echo "$ladder" | wc -w)
    high=$((high + 1))
    while [ $((high - low)) -gt 1 ]; do
        middle=$(((low + high) / 2))
        if found "$1" "$(echo "$ladder" | cut -d' ' -f$middle)" "$2"; then high=$middle; else low=$middle; fi
    done
    if [ "$high" -gt "$(echo "$ladder" | wc -w)" ]; then echo "none"; else echo "$(echo "$ladder" | cut -d' ' -f$high) %"; fi
}

for members in 20 30; do
    "$program" run "$scene" --set resolution="$resolution" --steps "$steps" -o "$work/$members.rlog" --keyframes 1000 \
        --quiet >/dev/null
    "$program" same "$work/$members.rlog" --keep-members --members $members --quiet >/dev/null
done
echo "$scene, resolution $resolution, $steps steps:"
echo
echo "| parameter | 20 members | 30 members |"
echo "|---|---|---|"
for parameter; do
    echo "| \`$parameter\` | $(smallest "$parameter" 20) | $(smallest "$parameter" 30) |"
done
for members in 20 30; do
    alarms=$("$program" same "$work/$members.rlog" --members $members --self-check --json --quiet |
        sed -n 's/.*"false_alarms": *\([0-9]*\).*/\1/p')
    seconds=$( (time -p "$program" same "$work/$members.rlog" --members $members --set "$1=$(changed "$1" 100)" --quiet \
        >/dev/null) 2>&1 | awk '/^user/ { print $2 }')
    echo
    echo "$members members: $alarms false alarms in 1000, $seconds s of processor time"
done
