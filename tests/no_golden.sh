#!/bin/sh
# Golden recordings that went missing are a failure and no pass: in an empty folder, in none, on an empty command line.
#
#   no_golden.sh EXAMPLE_GOLDEN RHEOLOG
set -eu
example=$1 rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fails() { # what it says, then the command
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
echo "no_golden: fails as it should"
