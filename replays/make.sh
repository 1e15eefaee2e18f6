#!/bin/sh
# Makes the golden recordings anew. Only when a change of results is meant: write why into README.md beside this file,
# and commit both apart from the change itself.
#
#   replays/make.sh PROGRAM      e.g. replays/make.sh build/rheolog
set -eu
program=$(realpath "$1")
cd "$(dirname "$0")"
for scene in scenes/*.json; do
    name=$(basename "$scene" .json)
    "$program" run "$scene" -o "$name.rlog" --full --keyframes 1000 --quiet --force
done
# Commands: a run that goes on from another one's middle, with parameters and the ball changed on the way.
"$program" run --from ball.rlog@40 --steps 30 -o commands.rlog --full --keyframes 1000 --quiet --force \
    --set fluid.stiffness=310 --set history.order=0.6 --set "ball.velocity=[0, 12, 0]" --set walls.sticking=2
