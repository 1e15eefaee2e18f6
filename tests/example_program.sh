#!/bin/sh
# A golden test of your own scene file with the program alone: runs the scene again, with the options of the golden
# recording, and compares every step of both. To use it, copy it.
#
#   example_program.sh RHEOLOG GOLDEN SCENE [OPTION...]
set -eu
rheolog=$1 golden=$2
shift 2
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
"$rheolog" run "$@" --quiet -o "$new/new.rlog" >/dev/null
"$rheolog" diff "$golden" "$new/new.rlog" # exit code 1 also if one has more steps
