#!/bin/sh
# tables.sh TABLES RHEOLOG: measures tiny scenes and checks that bench/tables.sh prints their numbers. Bad calls must fail.
set -eu
tables=$1 rheolog=$2
tmp=$(mktemp -d)
trap 'rm -rf "$tmp"' EXIT
fails() { # fails TEXT COMMAND...: the command must end with exit code 2 and print the text
    said=$1 code=0
    shift
    "$@" >"$tmp/said" 2>&1 || code=$?
    { [ $code = 2 ] && grep -q -e "$said" "$tmp/said"; } || { echo "not refused ($code): $*"; cat "$tmp/said"; exit 1; }
}
prints() { # prints TEXT: a line of the tables holds the text
    grep -q -F -e "$1" "$tmp/tables" || { echo "no line with \"$1\" in:"; cat "$tmp/tables"; exit 1; }
}
tiny="--particles 500 --settle 5 --steps 2 --repetitions 1 --csv --quiet"
# A program that measures tiny scenes only.
cat >"$tmp/tiny" <<END
#!/bin/sh
[ "\$2" != table1 ] || set -- "\$@" --windows 0,50
[ "\$2" != stability ] || exec "$rheolog" "\$@" --particles 500 --settle 5 --steps 2 --ratios 1,20 --quiet
exec "$rheolog" "\$@" $tiny
END
chmod +x "$tmp/tiny"
sh "$tables" --folder "$tmp" --machine here "$tmp/tiny" table1 features scaling stability >"$tmp/tables"
cell() { # cell TABLE LINE COLUMN
    sed 's/"[^"]*"/text/g' "$tmp/$1-here.csv" | awk -F , -v line="$2" -v name="$3" '
        NR == 1 { for (i = 1; i <= NF; i++) if ($i == name) column = i }
        NR == line + 1 { print $column }'
}
prints "| bowling-ball | none | d = 50 |"
prints "$(printf '| whole step, summed | %.0f |' "$(cell table1 1 ns_median)")"
prints "$(printf '| whole step, sequential | %.0f |' "$(cell table1 3 ns_median)")"
prints "| [O]: step without the history | 61300 | 66750 |"
prints "$(printf '| whole step, ns | %.0f |' "$(cell scaling 1 ns_median)")"
prints "$(printf '| fluid alone | %.0f |' "$(cell features 1 ns_median)")"
prints "$(printf '| walls add | %.0f |' "$(cell features 2 ns_own)")"
prints "| solver | step | 1 | 20 |"
prints "| passive | 0.033 | sinks | sinks |"
grep -q "passive" "$tmp/stability-here.svg"
sh "$tables" --print --folder "$tmp" --machine here table1 features scaling stability >"$tmp/again"
cmp "$tmp/tables" "$tmp/again"
fails "there are no results" sh "$tables" --print --folder "$tmp" --machine here history
fails "there is no table drag" sh "$tables" drag
fails "unknown option --draw" sh "$tables" --draw
fails "there is no program" sh "$tables" "$tmp/none" scaling
# A failed measurement leaves the old results.
code=0
sh "$tables" --folder "$tmp" --machine here /bin/false scaling >/dev/null 2>&1 || code=$?
[ $code = 1 ] && [ -s "$tmp/scaling-here.csv" ] && [ ! -e "$tmp/scaling-here.csv.new" ]
echo "tables: right"
