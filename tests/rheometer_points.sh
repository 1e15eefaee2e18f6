#!/bin/sh
# rheometer_points.sh SOURCE RHEOLOG: what small protocols of `rheolog rheometer` measure is what rheometer_points.txt has, with the
# means of all columns of their files. After an intended change:
#
#   sh tests/rheometer_points.sh . build/rheolog --write
set -eu
LC_ALL=C
export LC_ALL
kept=$1/tests/rheometer_points.txt rheolog=$2 means=$1/tests/column_means.awk
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT

measure() {
    echo "# rheometer $*"
    rm -rf "$tmp/out"
    "$rheolog" rheometer "$@" --quiet -o "$tmp/out"
    awk -f "$means" "$tmp"/out/*.csv
}

{
    measure bowling-ball-small --small
    measure bowling-ball-small flow stop --small --set history.stiffness=0 --rate 0.03,0.06,0.12,0.25,0.5
    measure bowling-ball-small --pair amplitude --set history.stiffness=0 --omega 0.5,1 --gamma 0.01,0.1
    measure bowling-ball-small --pair response stop --small
    measure melting-bunny flow --small
} >"$tmp/now"
if [ "${3-}" = --write ]; then
    cp "$tmp/now" "$kept"
    exit
fi
diff "$kept" "$tmp/now" || { echo "rheometer measures something else; see the head of tests/rheometer_points.sh"; exit 1; }

# Proves that another number is noticed.
printf 'time,stress\n1,2\n2,3\n' >"$tmp/a.csv"
printf 'time,stress\n1,2\n2,-3\n' >"$tmp/b.csv"
[ "$(awk -f "$means" "$tmp/a.csv")" = "a, 2 rows: time 1.5, stress 2.5" ] &&
    [ "$(awk -f "$means" "$tmp/b.csv")" = "b, 2 rows: time 1.5, stress -0.5" ] ||
    { echo "column_means.awk has other means"; exit 1; }
echo "rheometer_points: $(grep -c '^#' "$tmp/now") measurements are as they were"
