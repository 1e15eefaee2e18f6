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
# table2 (docs/melting.md, Cost), predictor (docs/stability.md; it also writes predictor/predictor.csv, a line for each scene, and
# predictor.svg), stability (docs/stability.md; also makes its figure, stability-MACHINE.svg); default: all of them. Those of docs/error.md, one per study of `rheolog bench error`, are named error-STUDY;
# bench/error.sh makes all of them.
#
# exit codes: 0 done; 1 a measurement failed; 2 bad usage
set -eu
tables="table1 history scaling features limits scenes table2 stability predictor"
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
        case " $tables error-${1#error-} " in
        *" $1 "*) ;;
        *) echo "tables: there is no table $1; there are $tables and error-STUDY" >&2; exit 2 ;;
        esac
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
        case $table in
        error-*) set -- error --study "${table#error-}" --csv ;;
        stability) set -- stability -o "$plot" --csv ;;
        predictor) set -- predictor -o "$folder/predictor" ;;
        *) set -- "$table" --csv ;;
        esac
        "$program" bench "$@" >"$new" || { rm -rf "$new" "$plot"; echo "tables: $table failed" >&2; exit 1; }
        mv "$new" "$folder/$table-$machine.csv"
        [ ! -d "$plot" ] || { mv "$plot/$table.svg" "$folder/$table-$machine.svg" && rm -r "$plot"; }
    fi
    results=$folder/$table-$machine.csv
    [ -s "$results" ] || { echo "tables: there are no results $results" >&2; exit 2; }
    printf '### %s\n\n' "$table"
    LC_ALL=C awk -v table="$table" -f "$(dirname "$0")/tables.awk" "$results"
done
