#!/bin/sh
# Cost of a step, in ns per particle and step, against the size of the history: the paper's Table 1 for the built-in
# scenes. CSV on standard output. Pinned to one core; runs alternate and the median of each is given, since machines are
# noisy; a run whose hash is not that of its first repetition fails the benchmark.
#
#   bench/steps.sh [PROGRAM] [REPETITIONS] [STEPS]
set -eu
program=${1:-build/rheolog} repetitions=${2:-5} steps=${3:-300}
pin=
command -v taskset >/dev/null && pin="taskset -c 0"
out=$(mktemp)
trap 'rm -f "$out"' EXIT
number() { sed -n "s/.*\"$1\": \"\{0,1\}\([0-9a-f.]*\).*/\1/p" | head -n 1; }
repetition=0
while [ $repetition -lt "$repetitions" ]; do
    for scene in bowling-ball vibration; do
        for d in 0 50 150 500; do
            if [ $d = 0 ]; then set -- --set history.stiffness=0; else set -- --set history.window=$d; fi
            line=$($pin "$program" run $scene "$@" --steps "$steps" --json --quiet)
            total=$(echo "$line" | sed 's/"stages".*//' | number ns_per_particle_step)
            history=$(echo "$line" | grep -o '"fractional_derivative", "ns_per_particle_step": [0-9.]*' | sed 's/.* //')
            echo "$scene $d $total ${history:-0} $(echo "$line" | number hash) $(echo "$line" | number history_bytes)" >>"$out"
        done
    done
    repetition=$((repetition + 1))
done
echo "scene,window,ns_per_particle_step,ns_history,history_bytes,hash,ratio_to_no_history"
sort -k1,1 -k2,2n -k3,3n "$out" | awk '
    { key = $1 " " $2; if (!(key in count)) order[++keys] = key
      total[key, ++count[key]] = $3; history[key] += $4
      if (count[key] > 1 && hash[key] != $5) { print "hashes differ: " key > "/dev/stderr"; bad = 1 }
      hash[key] = $5; bytes[key] = $6 }
    END { for (i = 1; i <= keys; i++) { key = order[i]; split(key, part, " ")
            median = total[key, int((count[key] + 1) / 2)]
            if (part[2] == 0) base = median
            printf "%s,%s,%.1f,%.1f,%s,%s,%.2f\n", part[1], part[2], median, history[key] / count[key], bytes[key], hash[key], median / base }
          exit bad }'
