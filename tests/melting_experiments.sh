#!/bin/sh
# melting_experiments.sh SOURCE RHEOLOG: the small versions of the experiments with the melting model print what melting_experiments.txt
# has, with the mean of what they measured in every step, and that comes in the order that the paper tells. After an intended change:
#
#   sh tests/melting_experiments.sh . build/rheolog --write
set -eu
LC_ALL=C
export LC_ALL
kept=$1/tests/melting_experiments.txt rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
names='melting-bunny chair kernel melting-all melting-logo melting-cost melting-drop'
# shellcheck disable=SC2086 # words
"$rheolog" experiments $names --small --quiet -o "$tmp" >"$tmp/now"
awk -f "$1/tests/column_means.awk" "$tmp"/*.csv >>"$tmp/now"
if [ "${3-}" = --write ]; then
    cp "$tmp/now" "$kept"
    exit
fi
diff "$kept" "$tmp/now" || { echo "the experiments have changed; see the head of tests/melting_experiments.sh"; exit 1; }

# order NAME VARIANT AWK: runs an awk program over the rows of a variant. It has the columns by name, as $(c["top"]), and calls fail().
order() {
    sed -n "1p; /^\"$2\",/p" "$tmp/$1-small.csv" | sed 's/^"[^"]*"/variant/' | awk -F , '
        function fail(what) { print "'"$1, $2"': step " $3 ": " what; failed = 1; exit 1 }
        function grows(column) { if (FNR > 2 && $(c[column]) < last[column]) fail(column " falls"); last[column] = $(c[column]) }
        NR == 1 { for (i = 1; i <= NF; i++) c[$i] = i; next }
        '"$3"'
        END { if (!failed && NR < 50 && "'"$1"'" != "melting-cost") { print "'"$1, $2"': only " NR " rows"; exit 1 } }'
}
# The ear touches the back, then it cools; the bunny below has not moved. Without a flow of heat no ear cools.
bunny='
    { grows("iterations") }
    NR == 2 { back = $(c["back_ear"]); free = $(c["free_ear"]) }
    !touched && $(c["back_touch"]) > 0 { touched = $3 }
    !cooled && $(c["back_ear"]) < back - 0.05 { cooled = $3; if (!touched) fail("the ear cools before it touches") }
    $(c["base"]) > 0.002 { fail("the cold part moves") }
    back - $(c["back_ear"]) < free - $(c["free_ear"]) - 0.01 { fail("the free ear cools more") }'
order melting-bunny "heat flows" "$bunny"'END { if (!failed && !(touched && cooled > touched)) fail("the ear touches and cools") }'
order melting-bunny "none flows" "$bunny"'END { if (!failed && cooled) fail("an ear cools without a flow of heat") }'
# The holes close before the top has sunk by a third, and while the feet stand.
order chair "hot back" '
    NR == 2 { open = $(c["open"]); top = $(c["top"]); if ($(c["holes"]) != 3) fail("there are not three holes") }
    !closed && $(c["open"]) < 0.05 * open { closed = $3; if ($(c["top"]) < 0.7 * top) fail("the top sinks before the holes close") }
    $(c["base"]) > 0.005 { fail("the feet move") }
    END { if (!failed && !closed) fail("the holes stay open") }'
order chair "all cold" '$(c["holes"]) != 3 { fail("a hole closes") }'
# The weight falls with the distance, and its integral grows to 1.
order kernel exact '
    { grows("inside") }
    NR > 2 && $(c["W h^3"]) > before { fail("the weight grows") }
    { before = $(c["W h^3"]) }
    END { if (!failed && !($(c["inside"]) > 0.99999 && $(c["inside"]) < 1.00001)) fail("the integral is not 1") }'
# What is below flattens first.
order melting-all molten '
    { grows("iterations") }
    !body && $(c["body"]) < 0.75 { body = $3 }
    !head && $(c["head"]) < 0.75 { head = $3; if (!body) fail("the head flattens first") }
    END { if (!failed && !(body && head > body)) fail("body, then head") }'
# The tops sink, and never rise; the feet stand.
order melting-logo adaptive '
    NR > 2 && $(c["top"]) > before + 0.002 { fail("the top rises") }
    { before = $(c["top"]) }
    $(c["base"]) > 0.03 { fail("the feet move") }'
# The drop lands, then it solidifies, and stays solid.
order melting-drop "heat flows" '
    { grows("solid") }
    NR == 2 { start = $(c["height"]) }
    !solid && $(c["solid"]) > 0 { solid = $3; if ($(c["height"]) > start - 0.1) fail("it is solid before it lands") }
    END { if (!failed && $(c["solid"]) < 0.9) fail("it is liquid at the end") }'

# Proves that another digit, and events in another order, are noticed.
sed '0,/0\./s//1./' "$tmp/now" >"$tmp/other"
if cmp -s "$kept" "$tmp/other"; then
    echo "melting_experiments.sh does not notice another digit"
    exit 1
fi
{ sed 1q "$tmp/melting-drop-small.csv" && sed 1d "$tmp/melting-drop-small.csv" | sed '1!G; h; $!d'; } >"$tmp/turned"
mv "$tmp/turned" "$tmp/melting-drop-small.csv"
if order melting-drop "heat flows" '{ grows("solid") }' >/dev/null; then
    echo "melting_experiments.sh does not notice another order"
    exit 1
fi
echo "melting_experiments: $(echo "$names" | wc -w) experiments are as they were"
