#!/bin/sh
# A second implementation in Python (reference/, docs/bits.md) makes recordings again and compares every hash.
#
#   reference.sh SOURCE golden             the golden recordings; before, proves that the check finds changed bits
#   reference.sh SOURCE made PROGRAM       the recordings that PROGRAM (reference_recordings.c) makes
set -eu
source=$1 what=$2
. "$source/tests/numpy.sh"
page=$source/docs/parameters.md
[ "$what" = golden ] || program=$(realpath "$3")
cd "$source/tests/reference"
if [ "$what" = golden ]; then
    "$python" test_check.py "$page" "$source/replays"
    exec "$python" check.py "$page" "$source"/replays/*.rlog
fi
made=$(mktemp -d)
trap 'rm -rf "$made"' EXIT
"$program" "$made"
"$python" check.py "$page" "$made"/*.rlog
