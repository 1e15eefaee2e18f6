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
prints "$(printf '| fluid | | %.0f in all |' "$(cell features 1 ns_least)")"
prints "| walls | fluid | $(printf '%+.0f | %.0f |' "$(cell features 2 more_ns)" "$(cell features 2 ns_own)")"
prints "| solver | step | 1 | 20 |"
prints "| passive | 0.033 | sinks | sinks |"
grep -q "passive" "$tmp/stability-here.svg"
sh "$tables" --print --folder "$tmp" --machine here table1 features scaling stability >"$tmp/again"
cmp "$tmp/tables" "$tmp/again"
# A study of `bench error`: its front is bold, its orders are in brackets.
{
    echo 'study,scene,setting,quantity,value,error,us_time,order,front,machine,compiler,real,simd'
    echo 'steps,drop,step,height,1.04,0.04,10,,1,here,cc,float,scalar'
    echo 'steps,drop,step/2,height,.98,-0.02,20,1.00,1,here,cc,float,scalar'
    echo 'steps,drop,"sequential, step/2",height,1.25,-0.0002,30,,0,here,cc,float,scalar'
    echo 'steps,drop,step,dip,,,10,,0,here,cc,float,scalar'
} >"$tmp/error-steps-here.csv"
sh "$tables" --print --folder "$tmp" --machine here error-steps >"$tmp/tables"
prints "| drop | µs per particle and time | height | dip |"
prints "| step | 10.0 | **+4.0 %** | – |"
prints "| step/2 | 20.0 | **-2.0 % (1.0)** |  |"
prints "| sequential, step/2 | 30.0 | -2.0e-04 |  |"
prints "| sequential, step/2 | 1.250 |"
fails "there are no results" sh "$tables" --print --folder "$tmp" --machine here history
fails "there is no table drag" sh "$tables" drag
fails "unknown option --draw" sh "$tables" --draw
fails "there is no program" sh "$tables" "$tmp/none" scaling
# Studies of `bench error`: their tables go into the page; float and double are joined.
page=$tmp/page.md error=$(dirname "$tables")/error.sh
mark() { printf '<!-- error-%s -->\nold\n<!-- end -->\n' "$1"; }
{ echo "# Page"; mark number; echo "between"; mark spacing; } >"$page"
cat >"$tmp/small" <<END
#!/bin/sh
exec "$rheolog" "\$@" --scenes drop --particles 300 --steps 30 --quiet
END
chmod +x "$tmp/small"
sh "$error" --folder "$tmp" --machine here --page "$page" --plots "$tmp/plots" "$tmp/small" "$tmp/small" number spacing 2>"$tmp/said"
grep -q 'number (1 of 2)' "$tmp/said"
cp "$page" "$tmp/tables"
prints "| drop | 3"
prints "| resolution 4/3 | "
prints "between"
! grep -q old "$page"
[ -s "$tmp/plots/error-spacing.csv" ]
sh "$error" --check --folder "$tmp" --machine here --page "$page" number spacing
sed -i 's/between/changed/; s/| resolution 2 |/| resolution 3 |/' "$page"
code=0
sh "$error" --check --folder "$tmp" --machine here --page "$page" spacing >"$tmp/said" 2>&1 || code=$?
[ $code = 1 ] && grep -q '^> | resolution 2' "$tmp/said" && ! grep -q changed "$tmp/said"
fails "there is no study drag" sh "$error" drag
fails "there are no results" sh "$error" --print --folder "$tmp" --machine here --page "$page" sweeps
code=0
sh "$error" --folder "$tmp" --machine here --page "$page" /bin/false number >"$tmp/said" 2>&1 || code=$?
[ $code = 1 ] && grep -q "number failed" "$tmp/said" && [ -s "$tmp/error-number-here.csv" ] && [ ! -e "$tmp/error-number-here.csv.new" ]
# Every study of the program is in the script, and the page of this checkout has the tables of its results.
"$rheolog" bench error --study none >"$tmp/said" 2>&1 || true
for study in $(sed -n 's/.*there are \(.*\) (see.*/\1/p' "$tmp/said" | sed 's/,/ /g; s/ and / /'); do
    grep -q "^studies=\"[^\"]*\<$study\>" "$error" || { echo "bench/error.sh does not have the study $study"; exit 1; }
done
sh "$error" --check --machine x86_64 || { echo "docs/error.md has other tables than bench/results; run bench/error.sh --print"; exit 1; }
# A failed measurement leaves the old results.
code=0
sh "$tables" --folder "$tmp" --machine here /bin/false scaling >/dev/null 2>&1 || code=$?
[ $code = 1 ] && [ -s "$tmp/scaling-here.csv" ] && [ ! -e "$tmp/scaling-here.csv.new" ]
echo "tables: right"
