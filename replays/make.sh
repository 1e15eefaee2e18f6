#!/bin/sh
# Makes the golden recordings anew and blesses them, with one reason for all. Only when a change of results is meant.
#
#   replays/make.sh PROGRAM "what changed, and why that is right"
set -eu
[ $# = 2 ] || { echo "usage: replays/make.sh PROGRAM \"what changed, and why that is right\"" >&2; exit 2; }
program=$(realpath "$1") because=$2
cd "$(dirname "$0")"
new=$(mktemp -d)
trap 'rm -rf "$new"' EXIT
for scene in scenes/*.json; do
    "$program" run "$scene" -o "$new/$(basename "$scene" .json).rlog" --full --keyframes 1000 --quiet >/dev/null
done
# Commands: a run that goes on from another one's middle, with parameters and the ball changed on the way.
"$program" run --from "$new/ball.rlog@40" --steps 30 -o "$new/commands.rlog" --full --keyframes 1000 --quiet \
    --set fluid.stiffness=310 --set history.order=0.6 --set "ball.velocity=[0, 12, 0]" --set walls.sticking=2 >/dev/null
# A run that ends with a step that goes bad: springs far too stiff for the step.
"$program" run --from "$new/ball.rlog@40" --steps 30 -o "$new/failure.rlog" --full --keyframes 1000 --quiet \
    --set springs.stiffness=37.5 --set history.stiffness=3000 >/dev/null 2>&1 || [ $? = 1 ]
for recording in "$new"/*.rlog; do
    "$program" bless "$(basename "$recording")" "$recording" --because "$because"
done
