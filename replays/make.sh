#!/bin/sh
# Records all golden recordings again and blesses those that differ, with one reason for all. Use it only for an intended change
# of results.
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
# Commands: continues another run from its middle, and changes parameters and the ball.
"$program" run --from "$new/ball.rlog@40" --steps 30 -o "$new/commands.rlog" --full --keyframes 1000 --quiet \
    --set fluid.stiffness=310 --set history.order=0.6 --set "ball.velocity=[0, 12, 0]" --set walls.sticking=60 >/dev/null
# Failure: the springs are far too stiff for the time step of scheme sequential, so a step fails.
"$program" run --from "$new/sequential.rlog@40" --steps 30 -o "$new/failure.rlog" --full --keyframes 1000 --quiet \
    --set springs.stiffness=40 --set history.stiffness=4000 >/dev/null 2>&1 || [ $? = 1 ]
# The same for a melting world: changed parameters; then substeps that violate the acoustic limit.
"$program" run --from "$new/melt.rlog@15" --steps 10 -o "$new/melt-commands.rlog" --full --keyframes 1000 --quiet \
    --set "gravity=[1, -4, 0]" --set melting.viscosity=0.1 --set melting.temperature_min=0.4 --set step=0.03 >/dev/null
"$program" run --from "$new/melt.rlog@15" --steps 60 -o "$new/melt-failure.rlog" --full --keyframes 1000 --quiet \
    --set melting.substeps=1 --set step=0.035 >/dev/null 2>&1 || [ $? = 1 ]
# Small versions of the built-in scenes, with the hashes of the steps only.
mkdir "$new/builtin"
"$program" scenes | sed 's/ .*//' >"$new/names"
while read -r scene; do
    "$program" run "$scene" --set resolution=0.4 --steps 24 -o "$new/builtin/$scene.rlog" --keyframes 1000 --quiet >/dev/null
done <"$new/names"
for recording in "$new"/*.rlog "$new"/builtin/*.rlog; do
    golden=${recording#"$new"/}
    if [ -e "$golden" ] && "$program" diff "$golden" "$recording" >/dev/null 2>&1; then
        continue
    fi
    "$program" bless "$golden" "$recording" --because "$because"
done
