#!/bin/sh
# time_travel.sh RHEOLOG [--write | --check]: asks a recording of 3000 steps of 20 000 particles every kind of question, and prints
# the table of docs/debugging.md: what `--cost` says of each answer. --write puts it into the page. --check compares it with the page,
# but for the times.
set -eu
rheolog=$(realpath "$1") mode=${2-}
page=$(cd "$(dirname "$0")" && pwd)/debugging.md
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
cd "$tmp"
"$rheolog" run bowling-ball --steps 3000 -o ball.rlog --quiet >run
between=$("$rheolog" info ball.rlog --json | sed 's/.*"keyframe_spacing": \([0-9]*\).*/\1/')

# row QUESTION COST: a row of the table, from a line of --cost.
row() {
    printf '%s\n' "$2" | awk -v question="$1" -v between="$between" \
        '{ printf "| `%s` | %d | %.2f | %d | %.1f |\n", question, $2, $2 / between, $5, $8 }'
}
# ask 'COMMAND ...': what the program says of one command.
ask() {
    eval "set -- $1 --cost --quiet"
    "$rheolog" "$@" >out 2>err || [ $? = 1 ] || { cat err >&2; exit 1; }
    row "${asked-rheolog $question}" "$(sed -n '$p' err)"
}
# One session of `rheolog debug`, with a row for each of its commands.
session() {
    "$rheolog" debug ball.rlog -x commands --cost --quiet >out 2>err || { cat err >&2; exit 1; }
    grep '^(ball ' out >prompts # the prompt of each command, and the command
    grep '^cost: ' err >costs
    exec 3<costs
    while IFS= read -r prompt; do
        IFS= read -r cost <&3
        row "$prompt" "$cost"
    done <prompts
    exec 3<&-
}

table() {
    echo "| question | steps simulated | intervals | states read | CPU time, s |"
    echo "|---|---|---|---|---|"
    while IFS= read -r question; do
        ask "$question"
    done <<END
when ball.rlog 'springs > 226000' --last
when ball.rlog 'springs > 227000' --all
when ball.rlog 'ball: y < 9' --after 1100
when ball.rlog 'ball: y < 9' --last
when ball.rlog 'ball: y > 9' --before 1340 --last
when ball.rlog 'ball: y < 9'
when ball.rlog 'ball: y > 9' --last
inspect ball.rlog --step 2009 --stage forces@2
track ball.rlog --ball --from 2000 --to 2009
track ball.rlog --ball --every 670
why ball.rlog --step 2009 --particle 10000
why ball.rlog --step 2009 --particle 10000 --depth 6
why-not ball.rlog --step 2009 --pair 10000:10001
END
    cat >commands <<END
goto 1339
back
back
stage
goto 1001
until ball: y < 10
until springs > 226000
back until ball: y > 10
back until springs > 227000
track ball y -10
set gravity [0, -20, 0]
until ball: y < 9
back until ball: y > 9
diff
END
    session
}
table >table
case $mode in
'') cat table ;;
--write)
    awk '/^\| question \| steps simulated \|/ { while ((getline row <"'"$tmp"'/table") > 0) print row; on = 1 }
        !/^\|/ { on = 0 } !on' "$page" >page
    cat page >"$page"
    ;;
--check)
    sed 's/|[^|]*|$/|/' table >made
    sed -n '/^| question | steps simulated |/,/^$/p' "$page" | grep '^|' | sed 's/|[^|]*|$/|/' >there
    diff there made
    ;;
esac
