#!/bin/sh
# thickening_experiments.sh SOURCE RHEOLOG: the small versions of the cheap experiments with the thickening model print what
# thickening_experiments.txt has, with the mean of what they measured in every step. After an intended change:
#
#   sh tests/thickening_experiments.sh . build/rheolog --write
set -eu
LC_ALL=C
export LC_ALL
kept=$1/tests/thickening_experiments.txt rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
names='drop drop-pair incline positions-drop hole lumps gentle settling impact'
# shellcheck disable=SC2086 # words
"$rheolog" experiments $names --small --quiet -o "$tmp" >"$tmp/now"
awk -f "$1/tests/column_means.awk" "$tmp"/*.csv >>"$tmp/now"
if [ "${3-}" = --write ]; then
    cp "$tmp/now" "$kept"
    exit
fi
diff "$kept" "$tmp/now" || { echo "the experiments have changed; see the head of tests/thickening_experiments.sh"; exit 1; }
