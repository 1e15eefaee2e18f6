#!/bin/sh
# sweeps.sh SOURCE RHEOLOG ENGINE [SEEDS]: makes the sweep of docs/sweeps.md with ENGINE (parallel or snakemake), as printed but
# with SEEDS seeds for each of its 4 orders (6; the page has 50). Kills it twice in between, tears a recording, and gives the same
# command again. The recordings must have the bytes of a sweep that nothing disturbed.
set -eu
source=$(realpath "$1") rheolog=$(realpath "$2") engine=$3 seeds=${4:-6}
for program in "$engine" setsid ps; do
    command -v "$program" >/dev/null || { echo "there is no $program"; exit 77; }
done
tmp=$(mktemp -d)
sid=
trap '[ -z "$sid" ] || end KILL; rm -rf "$tmp"' EXIT
. "$source/tests/fails.sh"
. "$source/tests/sweep_support.sh"
export HOME="$tmp" XDG_CACHE_HOME="$tmp/cache" # engines keep files there
command=$(sed -n "s/^$engine .*/&/p" "$source/docs/sweeps.md")
[ "$(echo "$command" | wc -l)" = 1 ] || { echo "sweeps.sh does not find the command of $engine"; exit 1; }
export PARALLEL=-j2
command=$(echo "$command" | sed 's/--cores all/--cores 2/')

begin() { # begins the sweep in a session of its own
    setsid sh -c "$command" >said 2>&1 &
    sid=$!
}
end() { # ends the whole session by a signal
    # shellcheck disable=SC2046 # a list
    kill -"$1" $(ps -s "$sid" -o pid=) 2>/dev/null || true
    wait "$sid" 2>/dev/null || true
    i=0
    while [ -n "$(ps -s "$sid" -o pid=)" ] && [ $i -lt 300 ]; do
        sleep 0.1
        i=$((i + 1))
    done
    sid=
}
begin_and_end() { # begin_and_end SIGNAL COUNT: ends the sweep when there are so many recordings
    echo $(($2 + 2)) >"$tmp/hold"
    begin
    wait_for_recordings "$2"
    end "$1"
    rm "$tmp/hold"
    whole=$(count_complete)
    [ "$whole" -lt "$all" ] || { echo "the sweep was over before $1 came"; exit 1; }
    echo "after $1: $whole of $all recordings are complete"
}

prepare
undisturbed
begin_and_end KILL $((all / 4))
begin_and_end TERM $((all / 2))
tear
sh -c "$command" >said 2>&1 || { cat said; echo "$engine: the same command does not complete the sweep"; exit 1; }
compare
if [ "$engine" = snakemake ]; then
    [ "$(wc -l <sweep.csv)" -eq $((all + 1)) ] || { echo "the table of the Snakefile lacks rows"; exit 1; }
fi
sh -c "$command" >said 2>&1 || { cat said; echo "$engine: a complete sweep is not confirmed"; exit 1; }
compare
table_of_page
echo "sweeps: $all runs with $engine, killed and torn in between, have the bytes of an undisturbed sweep"
