#!/bin/sh
# Makes the tables of costs in docs/: measures them, keeps the results in bench/results, and prints the tables as Markdown.
# Times from different calls can only be compared if nothing else ran on the machine.
#
#   bench/tables.sh [--print] [--machine NAME] [--folder FOLDER] [PROGRAM] [TABLE...]
#   --print    measure nothing; print the tables of the results that exist
#   --machine  name of the results, instead of that of this machine (x86_64)
#   --folder   where the results are; default: bench/results
#
# PROGRAM: default build/rheolog. Tables: table1, history, scaling, features, limits, scenes (docs/model.md, Cost),
# stability (docs/stability.md; also makes its figure, stability-MACHINE.svg),
# error (docs/model.md, Accuracy; docs/melting.md, Speed against error), table2 (docs/melting.md, Cost); default: all of them.
#
# exit codes: 0 done; 1 a measurement failed; 2 bad usage
set -eu
tables="table1 history scaling features limits scenes error table2 stability"
print=no machine=$(uname -m) folder=$(dirname "$0")/results program= asked=
while [ $# -gt 0 ]; do
    case $1 in
    --print) print=yes ;;
    --machine | --folder)
        [ $# -gt 1 ] || { echo "tables: $1 needs a value" >&2; exit 2; }
        [ "$1" = --folder ] || machine=$2
        [ "$1" = --machine ] || folder=$2
        shift
        ;;
    -*) echo "tables: unknown option $1; there are --print, --machine and --folder" >&2; exit 2 ;;
    */*) program=$1 ;;
    *)
        case " $tables " in *" $1 "*) ;; *) echo "tables: there is no table $1; there are $tables" >&2; exit 2 ;; esac
        asked="$asked $1"
        ;;
    esac
    shift
done
program=${program:-build/rheolog}
[ $print = yes ] || [ -x "$program" ] || { echo "tables: there is no program $program" >&2; exit 2; }

for table in ${asked:-$tables}; do
    if [ $print = no ]; then
        new=$folder/$table-$machine.csv.new
        plot=$folder/$table.new
        set -- "$table"
        [ "$table" != stability ] || set -- "$table" -o "$plot"
        "$program" bench "$@" --csv >"$new" || { rm -rf "$new" "$plot"; echo "tables: $table failed" >&2; exit 1; }
        mv "$new" "$folder/$table-$machine.csv"
        [ ! -d "$plot" ] || { mv "$plot/$table.svg" "$folder/$table-$machine.svg" && rm -r "$plot"; }
    fi
    results=$folder/$table-$machine.csv
    [ -s "$results" ] || { echo "tables: there are no results $results" >&2; exit 2; }
    printf '### %s\n\n' "$table"
    LC_ALL=C awk -v table="$table" -f "$(dirname "$0")/tables.awk" "$results"
done
