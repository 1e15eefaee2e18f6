#!/bin/sh
# Proves that missing golden recordings are a failure: an empty folder, no folder, an empty command line.
#
#   no_golden.sh EXAMPLE_GOLDEN RHEOLOG
set -eu
example=$1 rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fails() { # fails TEXT COMMAND...: the command must fail and print the text
    said=$1
    shift
    if "$@" >"$tmp/said" 2>&1; then
        echo "passes without a golden recording: $*"
        exit 1
    fi
    grep -q "$said" "$tmp/said" || { cat "$tmp/said"; exit 1; }
}
mkdir "$tmp/empty"
fails "no golden recordings in" env GOLDEN="$tmp/empty" "$example"
fails "there is no folder" env GOLDEN="$tmp/none" "$example"
fails "nothing was verified" "$rheolog" verify
fails "cannot read" "$rheolog" verify "$tmp/empty/*.rlog"
echo "no_golden: missing recordings are failures"
