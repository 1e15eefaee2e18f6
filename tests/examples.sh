#!/bin/sh
# Proves that the examples of golden tests pass where nothing has changed, and fail where something has: the scene, the
# number of steps, the golden recording itself.
#
#   examples.sh RHEOLOG EXAMPLE_MY_SCENE EXAMPLE_PLAIN CHANGED_EXAMPLE_MY_SCENE CHANGED_EXAMPLE_PLAIN
set -eu
rheolog=$1 cmocka=$2 plain=$3 changed_cmocka=$4 changed_plain=$5
program=$(dirname "$0")/example_program.sh
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
passes() { "$@" >"$tmp/said" 2>&1 || { cat "$tmp/said"; echo "fails: $*"; exit 1; }; }
. "$(dirname "$0")/fails.sh"
golden=$tmp/golden.rlog
fails "golden.rlog" "$plain" "$golden"
fails "golden.rlog" env GOLDEN="$golden" "$cmocka"
passes "$plain" --record "$tmp/new.rlog"
passes "$rheolog" bless "$golden" "$tmp/new.rlog" --because "the first"
passes "$plain" "$golden"
passes env GOLDEN="$golden" "$cmocka"
# The scene differs: the golden recording itself still verifies.
fails "of the state at the start; .*in this run" "$changed_plain" "$golden"
fails "of the state at the start; .*in this run" env GOLDEN="$golden" "$changed_cmocka"
passes "$rheolog" verify "$golden"
# The golden recording is shorter, or damaged.
passes "$rheolog" checkpoint "$golden" --step 0 -o "$tmp/short.rlog"
fails "differs in length" "$plain" "$tmp/short.rlog"
fails "differs in length" env GOLDEN="$tmp/short.rlog" "$cmocka"
head -c 1000 "$golden" >"$tmp/torn.rlog"
fails "torn.rlog" "$plain" "$tmp/torn.rlog"

scene="vibration --steps 5 --set settle.time=0"
passes "$rheolog" run $scene --quiet -o "$tmp/run.rlog"
passes "$rheolog" bless "$tmp/scene.rlog" "$tmp/run.rlog" --because "the first"
passes sh "$program" "$rheolog" "$tmp/scene.rlog" $scene
fails "differs at step 1: position after" sh "$program" "$rheolog" "$tmp/scene.rlog" $scene --set fluid.stiffness=310
fails "differs in length" sh "$program" "$rheolog" "$tmp/scene.rlog" $scene --steps 4
fails "none.rlog" sh "$program" "$rheolog" "$tmp/none.rlog" $scene
echo "examples: they pass and fail as they should"
