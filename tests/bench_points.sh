#!/bin/sh
# bench_points.sh SOURCE RHEOLOG: what small versions of `rheolog bench` measure, but for the times, is what bench_points.txt has.
# It has every seventh row, and the checksum of all rows. After an intended change:
#
#   sh tests/bench_points.sh . build/rheolog --write
set -eu
LC_ALL=C
export LC_ALL
kept=$1/tests/bench_points.txt rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

# Prints the cells with a name that is not that of a time or of a machine. Numbers have four digits; what is smaller than 1e-8 is
# the rounding error of an exact result, in which mathematical libraries differ.
without_times() {
    awk '
        function cells_of(line, cell,    part, n, i) {
            n = split(line, part, "\"")
            line = ""
            for (i = 1; i <= n; i++) {
                if (i % 2 == 0)
                    gsub(",", ";", part[i])
                line = line part[i]
            }
            return split(line, cell, ",")
        }
        function number(text) {
            if (text !~ /^-?[0-9]*\.[0-9]+(e[-+][0-9]+)?$/ || text !~ /[1-9]/)
                return text
            return text > -1e-8 && text < 1e-8 ? "~0" : sprintf("%.4g", text)
        }
        BEGIN { other = "(^|_)(ns|us|machine)(_|$)|^(compiler|real|simd|front|reached|set_by|ratio|bytes_(process|recorded))$" }
        NR == 1 { count = cells_of($0, name) }
        {
            if (cells_of($0, cell) != count) {
                print "a row has not " count " cells: " $0
                exit
            }
            line = ""
            for (i = 1; i <= count; i++)
                if (name[i] ~ /^paper_/ || name[i] !~ other)
                    line = line (line == "" ? "" : ",") (name[i] == "hash" ? cell[i] : number(cell[i]))
            print line
        }'
}

measure() {
    "$rheolog" bench "$@" --csv --quiet --simd scalar >"$tmp/csv"
    without_times <"$tmp/csv" >"$tmp/rows"
    echo "# bench $*: $(wc -l <"$tmp/rows") rows, cksum $(cksum <"$tmp/rows" | cut -d ' ' -f 1)"
    awk 'NR % 7 == 1' "$tmp/rows"
}

measure_all() {
    measure error --study steps --scenes block,elastic-shear-wave,shear-wave
    measure error --study steps --scenes ball,drop,hydrostatics --particles 200 --settle 3 --steps 2
    measure error --study sweeps --particles 200 --settle 2 --steps 4
    measure error --study springs --particles 200 --settle 3 --steps 1
    measure error --study number --particles 200 --settle 2 --steps 20
    measure error --study history --particles 200 --settle 2 --steps 60
    measure error --study spacing --scenes drop --particles 200 --steps 2
    measure error --study heat --steps 4
    measure error --study channel --steps 1
    measure error --study column --scenes rest --steps 1
    measure error --study bunny --particles 200 --steps 4
    small="--particles 500 --settle 5 --steps 2 --repetitions 1"
    # shellcheck disable=SC2086 # words
    {
        measure table1 --windows 0,5 $small
        measure history --windows 5 $small
        measure scaling $small
        measure features $small
        measure limits $small
    }
    measure scenes --scenes melting-box,bowling-ball-small --settle 1 --steps 1 --repetitions 1
}

measure_all >"$tmp/now"
if [ "${3-}" = --write ]; then
    cp "$tmp/now" "$kept"
    exit
fi
diff "$kept" "$tmp/now" || { echo "bench measures something else; see the head of tests/bench_points.sh"; exit 1; }

# Proves that another digit of a row that is not kept is noticed.
printf 'case,value,ns_step\na,1.5,3\n' | without_times >"$tmp/rows"
printf 'case,value,ns_step\na,1.6,3\n' | without_times >"$tmp/other"
printf 'case,value,ns_step\na,1.5,4\n' | without_times >"$tmp/later"
if cmp -s "$tmp/rows" "$tmp/other" || ! cmp "$tmp/rows" "$tmp/later"; then
    echo "bench_points.sh does not notice another number, or notices another time"
    exit 1
fi
echo "bench_points: $(grep -c '^#' "$tmp/now") measurements are as they were"
