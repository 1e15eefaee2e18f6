#!/bin/sh
# experiments.sh SOURCE RHEOLOG [whole]: the outputs and pictures of docs/experiments.md and docs/rheometer.md are those that the
# program makes now; without `whole` only those that take seconds: of `rheolog curves`, of the pair and the law of
# `rheolog rheometer`, and of the kernel. The last two print roundings, so a build for double leaves them out. After an intended change:
#
#   sh docs/experiments.sh build/rheolog --write
set -eu
rheolog=$2
if [ "${3-}" = whole ]; then
    sh "$1/docs/experiments.sh" "$rheolog"
    exit
fi
sh "$1/docs/experiments.sh" "$rheolog" curves
sh "$1/docs/experiments.sh" "$rheolog" 'rheometer bowling-ball-small --pair'
case $rheolog in
*-double) ;;
*)
    sh "$1/docs/experiments.sh" "$rheolog" 'rheometer melting-bunny'
    sh "$1/docs/experiments.sh" "$rheolog" 'experiments kernel'
    ;;
esac

# Proves that a digit of an output, a missing command, and a byte or a file too many among the pictures are noticed.
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
notices() { # notices SOURCE WHAT COMMAND [ONLY]: changes a copy in $tmp/docs by the command; the script must then fail
    rm -rf "$tmp/docs"
    cp -R "$1/docs" "$tmp/docs"
    (cd "$tmp/docs" && eval "$3")
    if sh "$tmp/docs/experiments.sh" "$rheolog" "${4:-curves}" >/dev/null 2>&1; then
        echo "experiments.sh does not notice $2"
        exit 1
    fi
}
notices "$1" "another digit" "sed -i 's/1\.109634582/1.109634583/' experiments.md"
notices "$1" "a missing command" "sed -i 's/^\\$ rheolog curves impact -o/\\$ rheolog curves impact --at 7 -o/' experiments.md"
notices "$1" "another picture" "echo >>experiments/weights.svg"
notices "$1" "a picture that nothing makes" "echo >experiments/old.svg"
notices "$1" "a picture that the page does not show" "sed -i 's/](experiments.weights.svg)/](experiments.svg)/' experiments.md"
notices "$1" "another digit of the rheometer" "sed -i 's/^fit_k_hist: 150/fit_k_hist: 151/' rheometer.md" \
    'rheometer bowling-ball-small --pair'
echo "experiments: $(cat "$1/docs/experiments.md" "$1/docs/rheometer.md" | grep -c '^\$ rheolog') commands print what the pages in docs have"
