#!/bin/sh
# Cost of recording: the same run with and without a recording, alternating and pinned to one core. Prints medians and their
# ratios as CSV. Runs with different hashes fail the benchmark.
#
#   bench/recording.sh [PROGRAM] [REPETITIONS] [STEPS]
set -eu
program=${1:-build/rheolog} repetitions=${2:-5} steps=${3:-1000}
pin=
command -v taskset >/dev/null && pin="taskset -c 0"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
number() { sed 's/"stages".*//' | sed -n "s/.*\"$1\": \"\{0,1\}\([0-9a-f.]*\).*/\1/p"; }
for how in plain recorded full; do : >"$work/$how"; done
repetition=0
while [ $repetition -lt "$repetitions" ]; do
    for how in plain recorded full; do
        case $how in plain) set -- ;; recorded) set -- -o "$work/run.rlog" --force ;; full) set -- -o "$work/full.rlog" --full --force ;; esac
        line=$($pin "$program" run bowling-ball "$@" --steps "$steps" --json --quiet)
        echo "$(echo "$line" | number ns_per_particle_step) $(echo "$line" | number hash)" >>"$work/$how"
    done
    repetition=$((repetition + 1))
done
[ "$(cat "$work/plain" "$work/recorded" "$work/full" | awk '{ print $2 }' | sort -u | wc -l)" = 1 ] || { echo "hashes differ" >&2; exit 1; }
median() { sort -n "$work/$1" | awk '{ v[NR] = $1 } END { print v[int((NR + 1) / 2)] }'; }
size() { [ -e "$work/$1.rlog" ] && wc -c <"$work/$1.rlog" || echo 0; }
plain=$(median plain)
echo "how,ns_per_particle_step,ratio_to_plain,bytes"
for how in plain recorded full; do
    case $how in plain) bytes=0 ;; recorded) bytes=$(size run) ;; full) bytes=$(size full) ;; esac
    echo "$how,$(median $how),$(echo "$(median $how) $plain" | awk '{ printf "%.3f", $1 / $2 }'),$bytes"
done
